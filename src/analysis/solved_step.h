// What a solved step does to blocks and contacts, read off its problem and its solution. Nothing here changes anything.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "openclose/integrator/enforcement.h"

namespace openclose {

/// [m] The farthest way of a vertex.
double largest_move(const BlockSystem& system, const StepSolution& solution);

/// [m] What the trapezoid leaves out in a step with these end forces, dt^2 (a1 - a0)/12, as a displacement of any vertex. a0 are the accelerations by
/// the forces that the last step ended with.
double local_error(const StepProblem& problem, const StepSolution& solution);

/// [N] Of a static step: largest sum of forces without inertia on a block, with what friction that lags behind the normal force misses its bound by.
/// On blocks that are much lighter than the heaviest one it counts for more, see emphasis_at_rest().
double unbalanced_force(const StepProblem& problem, const StepSolution& solution);

/// [m] By how much friction gives way in a contact that slides at the end.
/// \param elastic  contacts have springs, whose stretch is not slip
double friction_slip(const StepProblem& problem, const StepSolution& solution, std::size_t contact, bool elastic);

/// [-] The largest shares of what they can lose that joints lose by how their contacts end.
struct LossesOfStep {
  double any = 0.0;
  double along_slip = 0.0;  ///< of those that weaken along their slip and do not open
};
LossesOfStep losses(const StepProblem& problem, const StepSolution& solution, bool elastic);

/// Whether a step in motion begins and ends without velocities and moves no block: in balance. Where contacts stay as they are, too, the next one
/// that is as long repeats it bit for bit.
bool moves_nothing(const StepProblem& problem, const StepSolution& solution);

/// Whether a block with this velocity has come to rest by the end of a step in motion: tolerance::rest of gravity gives
/// it more in the step.
bool has_come_to_rest(const StepProblem& problem, int b, const Motion::Unknowns& velocity);

/// [J] Of a step in motion.
double kinetic_change(const StepProblem& problem, const StepSolution& solution);

/// A rigid contact in motion carries this part of its force [-] on a block for this step alone: it did not carry it before, or it stops an approach.
struct Blow {
  int block;
  double part;
};
/// Of rigid contacts, with the forces that they have from the step before.
std::vector<Blow> blows(const StepProblem& problem, const StepSolution& solution);

/// [N, N, N m] Sum of the forces on every free block as it stands, without dashpots.
Eigen::VectorXd forces_now(const StepProblem& problem, const Enforcement& enforcement);

}  // namespace openclose
