#include "openclose/integrator/subdomains.h"

#include <algorithm>

#include "openclose/integrator/newton.h"

namespace openclose {
namespace {

/// [-] After an iteration in which contacts have changed their state most of the residual is near these. Blocks with more than this part of the
/// largest residual are seeds of parts that are solved for themselves before the next iteration of the whole: few, and in separate places.
constexpr double seed_residual = 0.1;
/// [-] of the rows: blocks with less of it are seeds, too, as long as there are no more. After two or three iterations hardly any block is out of
/// balance, and the parts end the step. (40 m of a failing slope of 9,745 free blocks: iterations of the whole and instructions 0.81 and 0.92 with
/// 0.01, 0.73 and 0.85 with 0.02, 0.69 and 0.85 with 0.04. 3 s of 1,000 boxes that fall on a heap: 0.76 of the iterations.)
constexpr double few_seeds = 0.02;
/// Inertia holds blocks so well that the neighbours of neighbours feel a third or less. (Slopes of 984 to 10,208 blocks: with one ring 4 % more work,
/// with three 0.)
constexpr int rings_of_a_part = 2;
/// [-] of the rows: a larger part is not worth the trouble. (Without it twice as many rows are solved in parts on slopes of 1,773 and 4,568 blocks.)
constexpr double largest_part = 0.25;

}  // namespace

std::vector<Part> Subdomains::unbalanced_parts(const StepEquations& whole, double norm, double end) {
  const int rows = whole.rows();
  if (neighbourhood_.rows() != rows) neighbourhood_.build(rows, whole.contacts().size(), [&](std::size_t c) { return whole.contacts().places(c); });
  std::vector<double> residuals(static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) residuals[static_cast<std::size_t>(row)] = whole.unbalanced(row) / whole.tolerated(row);
  const std::vector<int> seeds = most_unbalanced(residuals, norm, end, seed_residual, static_cast<int>(few_seeds * rows));
  return neighbourhood_.parts(seeds, rings_of_a_part, static_cast<int>(largest_part * rows));
}

double Subdomains::solve(StepEquations& whole, StepSolution& solution, double norm) {
  memory_ = {};
  const NewtonEnd end{std::max(1.0, linear_reduction * norm), whole.problem().method.max_iterations};
  const std::vector<Part> parts = unbalanced_parts(whole, norm, end.norm);
  if (parts.empty()) return norm;
  Newton newton;  // gone again when the whole is solved: a part may be a quarter of it
  Eigen::VectorXd trial = solution.d;
  // No block is in two parts: an iteration of all of them is no more work than one of the whole.
  StepSolution found;
  for (const Part& part : parts) {
    found.clear();
    found.d = rows_of(solution.d, part.rows);
    if (newton.solve_part(whole, part, end, found)) {
      for (std::size_t i = 0; i < part.rows.size(); ++i) trial.segment<dofs>(dofs * part.rows[i]) = found.d.segment<dofs>(dofs * i);
    }
    counters_ += newton.linear_counters();
    memory_.grow_to(newton.present_memory() + found.memory());
    ++solution.effort.parts;
    solution.effort.part_iterations += found.effort.iterations;
    solution.effort.part_rows += static_cast<long>(found.effort.iterations) * static_cast<long>(part.rows.size());
  }
  whole.evaluate(trial);
  const double norm_with_parts = whole.residual_norm();
  if (norm_with_parts <= norm) {  // equal where the worst part could not be solved, the others of use all the same
    solution.d = trial;
    return norm_with_parts;
  }
  whole.evaluate(solution.d);
  return norm;
}

}  // namespace openclose
