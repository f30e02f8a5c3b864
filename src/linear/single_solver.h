// A solver for estimates: the whole factor of a matrix, kept as whole numbers of 16 bits (see incomplete.h). Four to five digits of the solution are
// right where the matrix is as well conditioned as groups of blocks that neighbours hold; solves read a fifth of the bytes of a factor in double
// precision. Rows are eliminated in an order for narrow bands: for matrices of which only small groups of rows hang together. Where more digits are
// needed, as for blocks that hold on to each other but to hardly anything else, it goes over to the solver with all of them.
#pragma once

#include <memory>

#include "openclose/linear/solver.h"

namespace openclose {

std::unique_ptr<LinearSolver> make_estimating_solver();

}  // namespace openclose
