#include "openclose/integrator/newton.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [-] Rounding errors of this many units in the last place may meet in one residual: a dozen products and sums per contact.
constexpr double rounding_units = 16.0;
constexpr double rounding_of_sums = rounding_units * std::numeric_limits<double>::epsilon();
/// [-] Share of contacts that may change state in an iteration with the exact tangent still being the better one.
constexpr double few_switches = 0.02;
/// [-] Part of the shear stiffness that sliding contacts keep in the symmetric tangent of statics, where nothing else would hold them.
constexpr double static_slip_stiffness = 0.01;
/// [-] A line search is good enough when the energy's slope has fallen to this part.
constexpr double line_search_slope = 0.9;
constexpr int line_search_steps = 8;
/// [-] Backtracking along the exact step: decrease of the residual asked for, as a part of what the linear model promises, and the shortest part of
/// the step worth taking (6 halvings; below, the symmetric tangent gets on better).
constexpr double sufficient_decrease = 0.1;
constexpr double shortest_backtrack = 0.01;
/// [-] Of the residual by an iterative linear solver. What is left of it falls to the next iteration, which starts with more than that: from the
/// contacts that change state, or from the turning of the others. Iterations of all steps of a slope of 1,773 free blocks: 411 with 1e-12, 418 with
/// 1e-6, 420 with 1e-5, 432 with 1e-4.
constexpr double linear_reduction = 1e-5;
/// [-] Where the end of the iteration is within reach of a solve with the first of these, it goes as far as that; no residual is brought down farther
/// than to a part of what ends the iteration.
constexpr double farthest_reduction = 1e-6, loosest_reduction = 0.1;
constexpr double end_to_spare = 0.3;
/// [-] The same with held contacts: single loose blocks, whose residual is a small part of the whole, need their digits, too.
constexpr double held_linear_reduction = 1e-12;
/// [-] Of rows of the tangent that a factor may be left with, see LinearSolver::factor(): the turning of blocks that only tremble. 40 m of a failing
/// slope of 387 free blocks: with 0 all rows are factored anew in 2,427 iterations, with 1e-8 117 of them in 2,439, with 1e-7 88 in 2,522, with
/// 1e-5 68 in 2,622, with 1e-4 40 in 3,178.
constexpr double kept_change = 1e-8;
/// [-] The same in statics, whose steps are few and end with changes of contacts rather than with the turning of blocks. Instructions of settling a
/// slope of 387 free blocks with `soft` and with `hard`, of its strength reduction with either, and of settling 1,773 free blocks, over those with
/// 1e-8: 0.98, 0.97, 0.98, 0.95, 0.98 with 1e-6; 0.98, 0.98, 0.98, 0.95, 0.98 with 1e-5.
constexpr double static_kept_change = 1e-6;
/// After so many refusals of the exact step without gain the symmetric steps in between get shorter, so that the two do not go round in a circle.
constexpr int patience = 1;
/// [-] A static step of which the line search takes less is begun again with held contacts.
constexpr double shortest_common_step = 1e-3;
/// [-] Held contacts keep this part of their hold from iteration to iteration, so that what they let go at a time is about twice what they have
/// tried.
constexpr double hold_decay = 0.5;
/// [-] A smaller part of the springs holds nothing.
constexpr double weakest_hold = 1e-4;
/// [-] Residual, over the largest force, from which on contacts are held with all of their springs; below in proportion, so that the end is Newton's.
constexpr double residual_of_full_hold = 1e-2;
/// [-] A static step from blocks that nothing has loaded yet, in whose first iteration more than this part of the contacts open or slide, has a cold
/// start: which ones will do so in the end is not known at all.
constexpr double cold_start_switches = 0.1;
/// [-] There, contacts that have just opened or begun to slide keep this part of their springs for one iteration.
constexpr double hold_of_opened = 0.1, hold_of_slid = 0.3;
/// After so many iterations a cold start that has not ended goes round in a circle with few contacts, which the line searches are for.
constexpr int most_cold_iterations = 15;
/// [-] Part of the largest force at the start of the step that may count as balanced. The forces of a trial that has run away, of which rounding and
/// the tolerance are parts, would excuse any residual. Forces may grow by 1e9 in a step before the usual tolerance of 1e-12 comes here.
constexpr double loosest_balance = 1e-3;
constexpr double largest_force_growth = 1e9;  ///< [-] the same margin for a tolerance that the scene makes coarser

/// [-] After an iteration in which contacts have changed their state most of the residual is near these. Blocks with more than this part of the
/// largest residual are seeds of parts that are solved for themselves before the next iteration of the whole: few, and in separate places.
constexpr double seed_residual = 0.1;
/// [-] of the rows: blocks with less of it are seeds, too, as long as there are no more. After two or three iterations hardly any block is out of
/// balance, and the parts end the step. (40 m of a failing slope of 9,745 free blocks: iterations of the whole and instructions 0.81 and 0.92 with
/// 0.01, 0.73 and 0.85 with 0.02, 0.69 and 0.85 with 0.04.)
constexpr double few_seeds = 0.02;
/// Inertia holds blocks so well that the neighbours of neighbours feel a third or less. (Slopes of 984 to 10,208 blocks: with one ring 4 % more work,
/// with three 0.)
constexpr int rings_of_a_part = 2;
/// [-] of the rows: a larger part is not worth the trouble.
constexpr double largest_part = 0.25;
/// [-] of that of one iteration of the whole system, after which no further part is begun, in case that none of them converges.
constexpr double work_on_parts = 3.0;
/// Below, the plan of a part's factorisation costs what it saves (387 rows: work 1.04 to 1.08, 850 rows: 0.82 to 0.94).
constexpr int smallest_system_with_parts = 600;
/// The same where contact forces are averaged over the path, with which parts take more iterations (1,119 rows: work 1.10 of that without, 1,773 rows
/// 1.16, 2,740 rows 0.91, 4,568 rows 0.95).
constexpr int smallest_averaged_system_with_parts = 2000;

/// Whether an iteration still gets somewhere.
class Headway {
 public:
  /// \param most_iterations  in which the value must be halved
  Headway(double value, int most_iterations) : reached_(value), most_iterations_(most_iterations) {}

  /// To be asked once an iteration.
  /// \param best  the smallest value of what it must reduce, so far
  bool is_lost(double best) {
    if (best > 0.5 * reached_) return ++iterations_ > most_iterations_;
    reached_ = best;
    iterations_ = 0;
    return false;
  }

 private:
  double reached_;
  int most_iterations_;
  int iterations_ = 0;  ///< since then
};

/// To be asked of an iterative solver, where the iteration ends with this part of the residual that it has now.
/// \param usual  as long as that is out of reach
double reduction_to(double end, double usual) {
  return end >= farthest_reduction ? std::min(end, usual) : usual;
}

int differences(const std::vector<Branch>& a, const std::vector<Branch>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0, std::plus<>(), std::not_equal_to<>());
}

/// Whether the forces are already on the linear piece of their law that holds in this status; sliding has several.
bool is_on_piece(ContactStatus now, double normal_by_gap, ContactStatus wanted) {
  if (now != wanted) return false;
  return now == ContactStatus::open || (now == ContactStatus::sticking && normal_by_gap != 0.0);
}

/// [J] Of forces along a way, summed in the order of the blocks: zeros of further blocks change no bit of it.
double work(const Eigen::VectorXd& forces, const Eigen::VectorXd& way) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < forces.size(); ++i) sum += forces[i] * way[i];
  return sum;
}

/// Of the blocks of a part.
Eigen::VectorXd rows_of(const Eigen::VectorXd& whole, const std::vector<int>& rows) {
  Eigen::VectorXd part(dofs * static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) part.segment<dofs>(dofs * i) = whole.segment<dofs>(dofs * rows[i]);
  return part;
}

}  // namespace

void Newton::prepare(const StepProblem& problem, const SpringSource& springs) {
  const BlockSystem& system = problem.system;
  problem_ = &problem;
  contact_count_ = problem.contacts.size();
  renewal_.renew(problem, springs, *starts_);
  blocks_.clear();
  blocks_.reserve(system.free_count());
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    const Unknowns still = Unknowns::Zero();
    blocks_.push_back({b, problem.external.has_elements(b), block.rotation_locked, block.radius, problem.inertia * block.mass,
                       problem.external.force(system, b, still), problem.drift(b), problem.external.magnitude(system, b, still),
                       problem.external.spring_scale(system, b)});
  }
  find_blocks_alone();
  block_scale_ = 0.0;
  for (const StepBlock& block : blocks_) {
    if (block.is_alone) continue;
    block_scale_ = std::max({block_scale_, block.magnitude, Motion::largest_force(block.inertia.cwiseProduct(block.drift), block.radius)});
  }
  start_scale_ = std::max(openclose::begin(contacts()), block_scale_);
  resize_closely(trials_, contacts().size());
  step_forces_ = problem.averages_path() ? StepForces::averaged : StepForces::at_end;
  branches_.assign(batch_size * contacts().size(), 0);
  moves_.assign(system.free_count() + 1, BlockMove());
  neighbourhood_.clear();
}

void Newton::find_blocks_alone() {
  for (StepBlock& block : blocks_) block.is_alone = !block.has_elements;
  const int rows = static_cast<int>(blocks_.size());
  const auto touch = [&](int row) {
    if (row < rows) blocks_[row].is_alone = false;
  };
  for (const ContactBatch& batch : contacts()) {
    for (int k = 0; k < batch_size; ++k) {
      touch(batch.vertex_place(k));
      touch(batch.edge_place(k));
    }
  }
}

void Newton::move_blocks_alone(Eigen::VectorXd& d) const {
  for (std::size_t row = 0; row < blocks_.size(); ++row) {
    const StepBlock& block = blocks_[row];
    if (!block.is_alone) continue;
    Unknowns by_force = block.force.cwiseQuotient(block.inertia);
    if (block.rotation_locked) by_force[Motion::rotation_index] = 0.0;
    d.segment<dofs>(dofs * static_cast<Eigen::Index>(row)) = block.drift + by_force;
  }
}

void Newton::prepare_start(const std::vector<ContactSprings>& springs) {
  start_scale_ = block_scale_;
  for (std::size_t c = 0; c < contact_count_; ++c) {
    const ContactSprings& s = springs[c];
    contacts()[c / batch_size].set_springs(lane(c), s);
    start_scale_ = std::max({start_scale_, s.shift - s.normal * (s.gap - s.target), std::abs(s.initial_shear)});
  }
}

void Newton::evaluate_block(int row, const Eigen::VectorXd& d) {
  const BlockSystem& system = problem_->system;
  const double theta = problem_->end_weight;
  const StepBlock& block = blocks_[row];
  const int at = dofs * row;
  const Unknowns db = d.segment<dofs>(at);
  Lanes& sums = rows_[row].sums;
  sums += rows_[row].of_odd_lanes;
  Unknowns force(sums[0], sums[1], sums[2]);
  if (block.has_elements) {
    force += averages_path() ? problem_->external.mean_force(system, block.block, db) : problem_->external.force(system, block.block, db);
  } else {
    force += block.force;
  }
  Unknowns r = block.inertia.cwiseProduct(block.drift - db) + theta * force;
  if (theta < 1.0) r += (1.0 - theta) * start_force_.segment<dofs>(at);
  if (block.rotation_locked) r[Motion::rotation_index] = 0.0;
  if (block.is_alone) r.setZero();
  residual_.segment<dofs>(at) = r;
  const Unknowns moved = block.inertia.cwiseProduct(block.drift.cwiseAbs() + db.cwiseAbs());
  sums = Lanes{force[0], force[1], force[2], sums[dofs]};
  sums[dofs] += rounding_of_sums * (Motion::largest_force(moved, block.radius) + magnitude(block, db) + block.rounding_of_coordinates);
}

double Newton::magnitude(const StepBlock& block, const Unknowns& d) const {
  return block.has_elements ? problem_->external.magnitude(problem_->system, block.block, d) : block.magnitude;
}

void Newton::move_block(int row, const Eigen::VectorXd& d) {
  moves_[row] = BlockMove(d.segment<dofs>(dofs * row), problem_->system.rotation_kind(), blocks_[row].radius);
}

void Newton::find_force_scale(double of_contacts, const Eigen::VectorXd& d) {
  force_scale_ = of_contacts;
  for (int row = 0; row < static_cast<int>(blocks_.size()); ++row) {
    if (blocks_[row].is_alone) continue;
    force_scale_ = std::max(force_scale_, magnitude(blocks_[row], d.segment<dofs>(dofs * row)));
  }
}

void Newton::evaluate(const Eigen::VectorXd& d) {
  const int rows = static_cast<int>(blocks_.size());
  for (int row = 0; row < rows; ++row) move_block(row, d);
  rows_.assign(moves_.size(), ForceRow());
  residual_.resize(dofs * static_cast<Eigen::Index>(blocks_.size()));
  const double largest = openclose::evaluate(step_forces_, ramp_, contacts(), moves_.data(), rounding_of_sums, trials_, branches_, rows_);
  for (int row = 0; row < rows; ++row) evaluate_block(row, d);
  find_force_scale(largest, d);
  has_replaced_forces_ = false;
}

void Newton::evaluate_moved(const std::vector<int>& moved, const Eigen::VectorXd& d, StepEffort& effort) {
  const auto all = static_cast<long>(contacts().size());
  // Forces that were replaced are to be the law's again everywhere.
  if (!problem_->method.skip_unmoved || has_replaced_forces_) {
    effort.part_batches += all;
    return evaluate(d);
  }
  for (int row : moved) move_block(row, d);
  const std::vector<int> pushed = neighbourhood_.with_neighbours(moved);
  std::vector<char> is_due(contacts().size(), 0);
  neighbourhood_.for_contacts_of(pushed, [&](int c) { is_due[c / batch_size] = 1; });
  for (int row : pushed) rows_[row] = ForceRow();
  // Their batches have contacts of other rows, too, whose sums stay.
  std::vector<std::pair<int, ForceRow>> sums_of_others;
  std::vector<char> is_known(rows_.size(), 0);
  for (int row : pushed) is_known[row] = 1;
  const auto keep_sums = [&](int row) {
    if (is_known[row]) return;
    is_known[row] = 1;
    sums_of_others.emplace_back(row, rows_[row]);
  };
  long due = 0;
  for (std::size_t batch = 0; batch < contacts().size(); ++batch) {
    if (!is_due[batch]) continue;
    ++due;
    for (int k = 0; k < batch_size; ++k) {
      keep_sums(contacts()[batch].vertex_place(k));
      keep_sums(contacts()[batch].edge_place(k));
    }
    openclose::evaluate_one(step_forces_, ramp_, contacts(), batch, moves_.data(), rounding_of_sums, trials_, branches_, rows_);
  }
  effort.part_batches += due;
  effort.part_batches_skipped += all - due;
  for (const auto& [row, sums] : sums_of_others) rows_[row] = sums;
  for (int row : pushed) evaluate_block(row, d);
  find_force_scale(largest_force(trials_), d);
}

double Newton::tolerated(int row) const {
  return problem_->method.residual_tolerance * force_scale_ + rows_[row].sums[dofs];
}

double Newton::unbalanced(int row) const {
  return Motion::largest_force(residual_.segment<dofs>(dofs * row), blocks_[row].radius);
}

double Newton::residual_norm() const {
  double worst = 0.0, largest = 0.0;
  const double loosest = std::max(loosest_balance, largest_force_growth * problem_->method.residual_tolerance) * start_scale_;
  for (int row = 0; row < static_cast<int>(blocks_.size()); ++row) {
    const double r = unbalanced(row);
    if (!(r <= std::numeric_limits<double>::max())) return std::numeric_limits<double>::infinity();
    if (r == 0.0) continue;
    if (tolerated(row) > loosest) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, r / tolerated(row));
    largest = std::max(largest, r);
  }
  return largest <= problem_->negligible_force ? std::min(worst, 1.0) : worst;
}

double Newton::largest_unbalanced() const {
  double largest = 0.0;
  for (int row = 0; row < static_cast<int>(blocks_.size()); ++row) largest = std::max(largest, unbalanced(row));
  return largest;
}

double Newton::merit(double norm) const {
  if (problem_->statics || !std::isfinite(norm)) return norm;
  double work = 0.0;  // [J]
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Unknowns residual = residual_.segment<dofs>(dofs * static_cast<int>(i));
    work += residual.dot(residual.cwiseQuotient(blocks_[i].inertia));
  }
  return std::sqrt(work);
}

void Newton::assemble(const Eigen::VectorXd& d, Tangent tangent) {
  BlockMatrix& matrix = tangent_.matrix();
  matrix.set_zero();
  const bool open_ones_too = averages_path() || !holds_.empty();
  const BatchTangent asked{step_forces_, tangent == Tangent::exact, problem_->end_weight, problem_->statics ? static_slip_stiffness : 0.0,
                           open_ones_too};
  openclose::add_stiffness(contacts(), moves_.data(), trials_, branches_, asked, tangent_.slots(), matrix);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const StepBlock& block = blocks_[i];
    const int row = static_cast<int>(i);
    auto& diagonal = matrix.value(matrix.diagonal(row));
    diagonal.diagonal() += block.inertia;
    if (!block.has_elements) continue;
    const Unknowns db = d.segment<dofs>(dofs * row);
    if (averages_path()) {
      diagonal += problem_->external.mean_stiffness(problem_->system, block.block, db);
    } else {
      diagonal += problem_->end_weight * problem_->external.stiffness(problem_->system, block.block, db);
    }
  }
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].rotation_locked) matrix.eliminate(static_cast<int>(i), Motion::rotation_index);
  }
}

Eigen::VectorXd Newton::direction(const Eigen::VectorXd& d, Tangent tangent, double reduction, double enough) {
  assemble(d, tangent);
  Eigen::VectorXd step;
  if (tangent_.factor(problem_->statics ? static_kept_change : kept_change)) step = tangent_.solve(residual_, reduction, enough);
  return step;
}

double Newton::line_search(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double slope) {
  // Root of the energy's slope along the step by regula falsi; the slope falls along the step because the symmetric tangent is positive definite.
  double low = 0.0, slope_low = slope, high = 1.0;
  evaluate(trial_ = d + step);
  double slope_high = work(residual_, step);
  if (std::abs(slope_high) <= line_search_slope * std::abs(slope) || slope_high > 0.0) return high;
  double alpha = high;
  for (int i = 0; i < line_search_steps; ++i) {
    alpha = low + (high - low) * std::clamp(slope_low / (slope_low - slope_high), 0.1, 0.9);
    evaluate(trial_ = d + alpha * step);
    const double s = work(residual_, step);
    if (std::abs(s) <= line_search_slope * std::abs(slope)) break;
    if (s > 0.0) {
      low = alpha;
      slope_low = s;
    } else {
      high = alpha;
      slope_high = s;
    }
  }
  return alpha;
}

double Newton::backtrack(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double merit_before) {
  for (double alpha = 0.5; alpha > shortest_backtrack; alpha *= 0.5) {
    evaluate(trial_ = d + alpha * step);
    if (merit(residual_norm()) <= (1.0 - sufficient_decrease * alpha) * merit_before) return alpha;
  }
  return 0.0;
}

ContactSprings Newton::seen_springs(std::size_t c) const {
  ContactSprings springs = this->springs(c);
  if (averages_path()) {
    // The same force at the start of the step.
    springs.shift -= 0.5 * springs.normal * springs.gap;
    springs.normal *= 0.5;
    springs.shear *= 0.5;
  }
  return springs;
}

void Newton::replace_forces(std::size_t c, const ContactForces& forces) {
  TrialBatch& batch = trial(c);
  const int k = lane(c);
  const ContactPose pose = force_pose(c);
  const double normal = problem_->end_weight * (forces.normal - batch.normal[k]), shear = problem_->end_weight * (forces.shear - batch.shear[k]);
  // In single numbers: what has just been stored number by number cannot be loaded in pairs at once.
  const double x = normal * pose.normal.x() - shear * pose.normal.y(), y = normal * pose.normal.y() + shear * pose.normal.x();
  const auto push = [&](int row, double sign, const Vec2& arm) {
    if (row >= static_cast<int>(blocks_.size())) return;
    double* const residual = residual_.data() + static_cast<std::ptrdiff_t>(dofs) * row;
    residual[0] += sign * x;
    residual[1] += sign * y;
    residual[2] += sign * (arm.x() * y - arm.y() * x);
    if (blocks_[row].rotation_locked) residual[Motion::rotation_index] = 0.0;
  };
  push(start(c).vertex_place(k), 1.0, pose.vertex_arm);
  push(start(c).edge_place(k), -1.0, pose.edge_arm);
  batch.set_forces(k, forces);
  branches_[c] = branch(forces);
  has_replaced_forces_ = true;
}

int Newton::hold_reversed() {
  int held = 0;
  for (std::size_t c = 0; c < contact_count_; ++c) {
    const bool reversed = std::abs(branches_before_[c]) == sliding_branch && branches_before_[c] == -branches_[c];
    if (!reversed) continue;
    ++held;
    const ContactSprings springs = seen_springs(c);
    const ContactForces f = forces(c);
    ContactForces stuck = tangent_for_status(springs, start(c).strength(lane(c)), ContactStatus::sticking, f.normal, f.shear);
    stuck.normal = f.normal;
    stuck.shear = springs.initial_shear - (springs.shear + springs.shear_damping) * trial(c).slip_change[lane(c)];
    replace_forces(c, stuck);
  }
  return held;
}

void Newton::take_state(std::size_t c, ContactStatus wanted, double normal, double shear) {
  const TrialBatch& now = trial(c);
  const int k = lane(c);
  if (!averages_path() && is_on_piece(status(branches_[c]), now.normal_by_gap[k], wanted)) return;
  replace_forces(c, prolonged(seen_springs(c), start(c).strength(k), wanted, normal, shear, now.gap_change[k], now.slip_change[k]));
}

void Newton::take_last_states() {
  // Statics begins with the drawing, whose rounding is in the gaps; a motion knows which of its contacts are open.
  const double touching_gap = problem_->statics ? tolerance::rounding_of_ways_m : 0.0;
  for (std::size_t c = 0; c < contact_count_; ++c) {
    const Contact& contact = problem_->contacts[c];
    const bool touching = contact.status == ContactStatus::open && start(c).gap_off_target[lane(c)] <= touching_gap && start(c).shift[lane(c)] >= 0.0;
    take_state(c, touching ? ContactStatus::sticking : contact.status, contact.normal_force, contact.shear_force);
  }
}

void Newton::take_states_before() {
  for (std::size_t c = 0; c < contact_count_; ++c) {
    take_state(c, status(branches_before_[c]), start(c).shift[lane(c)], start(c).initial_shear[lane(c)]);
  }
}

std::vector<ElasticBatch> Newton::report_paths(StepSolution& solution) {
  std::vector<ElasticBatch> elastic(trials_.size());
  for (std::size_t c = 0; c < contact_count_; ++c) {
    const ContactSprings springs = this->springs(c);
    TrialBatch& at = trial(c);
    const int k = lane(c);
    const PathAverage path = path_average(springs, start(c).strength(k), at.gap_change[k], at.slip_change[k], springs.dissipation);
    solution.paths.push_back({path.mean.normal, path.mean.shear, path.energies, force_pose(c)});
    at.normal[k] = path.end.normal;
    at.shear[k] = path.end.shear;
    elastic[c / batch_size].normal[k] = path.end.elastic_normal;
    elastic[c / batch_size].shear[k] = path.end.elastic_shear;
    branches_[c] = branch(path.end);
  }
  return elastic;
}

std::vector<ElasticBatch> Newton::elastic_parts() const {
  std::vector<ElasticBatch> elastic(trials_.size());
  find_elastic(ramp_, contacts(), trials_, elastic);
  return elastic;
}

void Newton::lend(StepSolution& solution) {
  solution.paths.clear();
  solution.contacts.borrow(starts_, moves_, trials_, branches_, averages_path() ? report_paths(solution) : elastic_parts());
  note_memory(solution.memory());
}

void Newton::hold_changed(double norm) {
  const double residual = norm * problem_->method.residual_tolerance;
  const double fullest = std::min(1.0, residual / residual_of_full_hold);
  for (std::size_t c = 0; c < holds_.size(); ++c) {
    double& hold = holds_[c];
    hold = std::min(branches_[c] != branches_before_[c] ? 1.0 : hold_decay * hold, fullest);
    if (hold < weakest_hold) hold = 0.0;
  }
}

void Newton::hold_contacts(bool friction_lags) {
  for (std::size_t c = 0; c < contact_count_; ++c) {
    if (holds_[c] == 0.0 || status(branches_[c]) == ContactStatus::sticking) continue;
    const ContactBatch& contact = contacts()[c / batch_size];
    TrialBatch& trial = trials_[c / batch_size];
    const int k = lane(c);
    trial.shear_by_slip[k] -= holds_[c] * contact.shear[k];
    if (status(branches_[c]) == ContactStatus::open) trial.normal_by_gap[k] -= holds_[c] * contact.normal[k];
    if (friction_lags) trial.shear_by_gap[k] = 0.0;
  }
}

void Newton::take_part(const Newton& whole, const Part& part) {
  is_part_ = true;
  problem_ = whole.problem_;
  step_forces_ = whole.step_forces_;
  start_scale_ = whole.start_scale_;
  ramp_ = whole.ramp_;
  const int rows = static_cast<int>(part.rows.size());
  blocks_.clear();
  moves_.clear();
  if (problem_->end_weight < 1.0) start_force_ = rows_of(whole.start_force_, part.rows);
  std::unordered_map<int, int> places;  // by those in the whole
  const auto place = [&](int of_whole) {
    const auto [at, is_new] = places.try_emplace(of_whole, static_cast<int>(moves_.size()));
    if (is_new) moves_.push_back(whole.moves_[of_whole]);
    return at->second;
  };
  for (int row : part.rows) {
    blocks_.push_back(whole.blocks_[row]);
    place(row);
  }
  contact_count_ = part.contacts.size();
  contacts().assign((contact_count_ + batch_size - 1) / batch_size, ContactBatch());
  std::vector<std::pair<int, int>> ends;
  const int nobody = place(static_cast<int>(whole.moves_.size()) - 1);
  for (std::size_t c = 0; c < batch_size * contacts().size(); ++c) {
    ContactBatch& batch = contacts()[c / batch_size];
    const int k = lane(c);
    batch.set_places(k, nobody, nobody);
    if (c >= contact_count_) continue;
    const int of_whole = part.contacts[c];
    const ContactBatch& from = whole.start(of_whole);
    batch.copy(k, from, lane(of_whole));
    const int vertex = place(from.vertex_place(lane(of_whole))), edge = place(from.edge_place(lane(of_whole)));
    batch.set_places(k, vertex, edge);
    ends.emplace_back(vertex, edge);
  }
  trials_.resize(contacts().size());
  branches_.assign(batch_size * contacts().size(), 0);
  tangent_.fit_part(problem_->method, rows, static_cast<int>(moves_.size()), ends);
}

std::vector<Part> Newton::unbalanced_parts(double norm, double end) {
  const int rows = static_cast<int>(blocks_.size());
  if (neighbourhood_.rows() != rows) {
    neighbourhood_.build(rows, contact_count_,
                         [&](std::size_t c) { return std::pair(start(c).vertex_place(lane(c)), start(c).edge_place(lane(c))); });
  }
  std::vector<double> residuals(rows);
  for (int row = 0; row < rows; ++row) residuals[row] = unbalanced(row) / tolerated(row);
  const std::vector<int> seeds = most_unbalanced(residuals, norm, end, seed_residual, static_cast<int>(few_seeds * rows));
  return neighbourhood_.parts(seeds, rings_of_a_part, static_cast<int>(largest_part * rows));
}

double Newton::solve_parts(StepSolution& solution, double norm) {
  const Until until{std::max(1.0, linear_reduction * norm), problem_->method.max_iterations};
  const std::vector<Part> parts = unbalanced_parts(norm, until.norm);
  if (parts.empty()) return norm;
  Newton newton_of_part;  // gone again when the whole is solved: a part may be a quarter of it
  trial_ = solution.d;
  std::vector<int> moved;
  const long most_rows = static_cast<long>(work_on_parts * static_cast<double>(blocks_.size()));
  long rows = 0;  // of all linear solves
  for (const Part& part : parts) {
    newton_of_part.take_part(*this, part);
    StepSolution found;
    found.d = rows_of(solution.d, part.rows);
    newton_of_part.evaluate(found.d);
    double norm_of_part = newton_of_part.residual_norm();
    const double norm_before = norm_of_part;
    newton_of_part.iterate(*problem_, found, norm_of_part, until, false);
    if (norm_of_part < norm_before) {
      for (std::size_t i = 0; i < part.rows.size(); ++i) trial_.segment<dofs>(dofs * part.rows[i]) = found.d.segment<dofs>(dofs * i);
      moved.insert(moved.end(), part.rows.begin(), part.rows.end());
    }
    part_counters_ += newton_of_part.tangent_.counters();
    note_memory(newton_of_part.present_memory() + solution.memory());
    ++solution.effort.parts;
    solution.effort.part_iterations += found.effort.iterations;
    rows += static_cast<long>(found.effort.iterations) * static_cast<long>(part.rows.size());
    if (rows > most_rows) break;
  }
  solution.effort.part_rows += rows;
  evaluate_moved(moved, trial_, solution.effort);
  const double norm_with_parts = residual_norm();
  if (norm_with_parts <= norm) {  // equal where the worst part could not be solved, the others of use all the same
    solution.d = trial_;
    return norm_with_parts;
  }
  evaluate_moved(moved, solution.d, solution.effort);
  return norm;
}

bool Newton::iterate_from_cold(StepSolution& solution, double& norm) {
  Eigen::VectorXd& d = solution.d;
  const double longest = d.lpNorm<Eigen::Infinity>();
  holds_.resize(contact_count_);
  for (int iteration = 1; iteration < most_cold_iterations && norm > 1.0 && std::isfinite(norm); ++iteration) {
    for (std::size_t c = 0; c < contact_count_; ++c) {
      const bool has_changed = branches_[c] != branches_before_[c];
      holds_[c] = !has_changed ? 0.0 : (status(branches_[c]) == ContactStatus::open ? hold_of_opened : hold_of_slid);
    }
    branches_before_ = branches_;
    hold_contacts(false);
    const Eigen::VectorXd step = direction(d, Tangent::exact, held_linear_reduction);
    ++solution.effort.iterations;
    const bool is_held = step.size() > 0 && step.lpNorm<Eigen::Infinity>() <= longest;
    if (is_held) evaluate(d += step);
    norm = is_held ? residual_norm() : std::numeric_limits<double>::infinity();
  }
  holds_.clear();
  return std::isfinite(norm);
}

Newton::Outcome Newton::iterate_holding(StepSolution& solution, double& norm, int done) {
  Eigen::VectorXd& d = solution.d;
  holds_.assign(contact_count_, 0.0);
  if (done > 0) hold_changed(norm);
  Outcome outcome = Outcome::ended;
  Headway headway(norm, only_if_few_change_ ? most_iterations_to_halve_if_few_change : most_iterations_to_halve_holding);
  double best = norm;
  for (int iteration = done; norm > 1.0 && std::isfinite(norm) && !headway.is_lost(best); ++iteration) {
    branches_before_ = branches_;
    // With the coupling, loose blocks fall from one side to the other; without it, single contacts go round between open and sliding.
    hold_contacts(iteration % 2 == 1);
    const Eigen::VectorXd step = direction(d, Tangent::exact, held_linear_reduction);
    ++solution.effort.iterations;
    if (step.size() == 0) {
      outcome = Outcome::singular;
      break;
    }
    d += step;
    evaluate(d);
    norm = residual_norm();
    best = std::min(best, norm);
    hold_changed(norm);
  }
  holds_.clear();
  return outcome;
}

struct Newton::Course {
  double norm = 0.0, value = 0.0, best = 0.0;  ///< [-] residual_norm(), merit(), and the smallest merit so far
  Tangent tangent = Tangent::exact;
  int refusals = 0;     ///< of the exact step since the merit was at its smallest
  int switches = 0;     ///< contacts whose state the last iteration has changed
  bool gets_on = true;  ///< the last iteration has halved the merit
};

bool Newton::help_by_parts(StepSolution& solution, Course& course) {
  const double norm_before = course.norm;
  course.norm = solve_parts(solution, norm_before);
  course.value = merit(course.norm);
  course.best = std::min(course.best, course.value);
  if (!(course.norm < norm_before)) return false;
  course.tangent = Tangent::exact;
  return true;
}

double Newton::try_step(const Eigen::VectorXd& d, const Eigen::VectorXd& step, const Course& course) {
  const double slope = work(residual_, step);
  if (course.tangent == Tangent::exact || slope <= 0.0) {
    evaluate(trial_ = d + step);
    return 1.0;
  }
  const double alpha = line_search(d, step, slope) / static_cast<double>(std::max(1, course.refusals - patience));
  if (course.refusals > patience + 1) evaluate(trial_ = d + alpha * step);
  return alpha;
}

void Newton::follow(Course& course, double norm) {
  const double value = merit(norm);
  course.switches = differences(branches_before_, branches_);
  course.gets_on = value <= 0.5 * course.value;
  if (value < course.best) course.refusals = 0;
  course.best = std::min(course.best, value);
  course.norm = norm;
  course.value = value;
}

void Newton::choose_tangent(Course& course) {
  const int few = static_cast<int>(few_switches * static_cast<double>(contact_count_));
  const bool held = course.norm > 1.0 && !course.gets_on && hold_reversed() > 0;  // a solution keeps the forces of the law
  const bool exact_works = held || course.switches <= few || (course.tangent == Tangent::exact && course.gets_on);
  course.tangent = exact_works ? Tangent::exact : Tangent::symmetric;
}

Newton::Outcome Newton::iterate(const StepProblem& problem, StepSolution& solution, double& norm, Until until, bool may_start_cold) {
  Eigen::VectorXd& d = solution.d;
  Course course;
  course.norm = norm;
  course.value = course.best = merit(norm);
  course.switches = static_cast<int>(contact_count_);  // any may be in another state than in the first tangent
  const int smallest_with_parts = averages_path() ? smallest_averaged_system_with_parts : smallest_system_with_parts;
  const bool may_help_by_parts =
      problem.method.skip_balanced && !problem.statics && !is_part_ && static_cast<int>(blocks_.size()) >= smallest_with_parts;
  const bool may_be_lost = !problem.statics && !is_part_;
  Headway headway(course.value, most_iterations_to_halve);
  // Parts that have not helped will not help in this step: with pauses in place of an end 40 m of a failing slope of 1,773 free blocks cost
  // `hard` 1.1 times as much.
  bool parts_help = may_help_by_parts;
  Outcome outcome = Outcome::ended;
  for (int iteration = 0; iteration < until.iterations && course.norm > until.norm; ++iteration) {
    if (parts_help && iteration > 0 && course.switches > 0) {
      parts_help = help_by_parts(solution, course);
      if (course.norm <= until.norm) break;
    }
    if (may_be_lost && headway.is_lost(course.best)) break;
    branches_before_ = branches_;
    const double end = end_to_spare * until.norm / course.norm;
    const double reduction = reduction_to(end, linear_reduction);
    const Eigen::VectorXd step = direction(d, course.tangent, reduction, std::min(end, loosest_reduction));
    ++solution.effort.iterations;
    if (step.size() == 0) {
      outcome = Outcome::singular;
      break;
    }
    double alpha = try_step(d, step, course);
    double next_norm = residual_norm();
    if (problem.statics && (alpha < shortest_common_step || !std::isfinite(next_norm))) {
      outcome = Outcome::no_common_step;
      break;
    }
    if (course.tangent == Tangent::exact && iteration > 0 && merit(next_norm) > course.value) {
      const int switches = differences(branches_before_, branches_);
      alpha = backtrack(d, step, course.value);
      if (alpha == 0.0) {
        evaluate(d);
        course.tangent = Tangent::symmetric;
        course.switches = switches;
        course.gets_on = false;
        ++course.refusals;
        continue;
      }
      next_norm = residual_norm();
    }
    d += alpha * step;
    follow(course, next_norm);
    if (may_start_cold && iteration == 0 && course.switches > cold_start_switches * static_cast<double>(contact_count_)) {
      outcome = Outcome::cold_start;
      break;
    }
    choose_tangent(course);
  }
  norm = course.norm;
  return outcome;
}

bool Newton::stands_still(const Eigen::VectorXd& d) const {
  if (problem_->statics || is_part_ || !d.isZero(0.0)) return false;
  for (int row = 0; row < static_cast<int>(blocks_.size()); ++row) {
    const StepBlock& block = blocks_[row];
    const double weight = problem_->external.weight(problem_->system, block.block).norm();
    if (!block.drift.isZero(0.0) || !(unbalanced(row) <= tolerance::rest * weight)) return false;
  }
  return true;
}

double Newton::begin(const Eigen::VectorXd& d, FirstTangent first) {
  evaluate(d);
  const double norm = stands_still(d) ? std::min(residual_norm(), 1.0) : residual_norm();
  if (norm > 1.0 && first == FirstTangent::last_step) take_last_states();
  if (norm > 1.0 && first == FirstTangent::last_solution) take_states_before();
  return norm;
}

void Newton::take_back(ContactOutcomes& outcomes) {
  outcomes.give_back(moves_, trials_, branches_);
  if (starts_.use_count() > 1) starts_ = std::make_shared<ContactStarts>(*starts_);
}

void Newton::solve(const StepProblem& problem, const SpringSource& springs, StepSolution& solution, FirstTangent first) {
  take_back(solution.contacts);
  branches_before_ = branches_;
  prepare(problem, springs);
  tangent_.fit(problem, contacts());
  solve_prepared(solution, first);
}

void Newton::solve_if_few_change(const StepProblem& problem, const SpringSource& springs, StepSolution& solution) {
  only_if_few_change_ = true;
  solve(problem, springs, solution);
  only_if_few_change_ = false;
}

void Newton::solve_again(const std::vector<ContactSprings>& springs, StepSolution& solution, FirstTangent first) {
  take_back(solution.contacts);
  branches_before_ = branches_;
  prepare_start(springs);
  solve_prepared(solution, first);
}

void Newton::solve_prepared(StepSolution& solution, FirstTangent first) {
  const StepProblem& problem = *problem_;
  move_blocks_alone(solution.d);
  if (problem.end_weight < 1.0) {
    sum_start_forces();
    solution.start_contacts.copy(starts_, moves_, trials_, branches_, elastic_parts());
  }
  const Eigen::VectorXd start = solution.d;
  double norm = begin(start, first);
  const auto is_open = [](const Contact& contact) { return contact.status == ContactStatus::open; };
  const bool may_start_cold = problem.statics && problem.method.max_iterations >= most_cold_iterations &&
                              std::all_of(problem.contacts.begin(), problem.contacts.end(), is_open);
  const Until until{1.0, problem.method.max_iterations};
  Outcome outcome = iterate(problem, solution, norm, until, may_start_cold);
  if (outcome == Outcome::cold_start) {
    const Eigen::VectorXd after_first = solution.d;
    const std::vector<Branch> before_first = branches_before_;
    if (iterate_from_cold(solution, norm)) outcome = iterate(problem, solution, norm, until, false);
    if (!(norm <= 1.0)) {
      evaluate(solution.d = after_first);
      norm = residual_norm();
      branches_before_ = before_first;
      outcome = iterate_holding(solution, norm, 1);
    }
  }
  if (outcome == Outcome::no_common_step) {
    solution.d = start;
    norm = begin(start, first);
    outcome = iterate_holding(solution, norm, 0);
  }
  solution.converged = norm <= 1.0;
  if (problem.statics) solution.unbalanced = largest_unbalanced();
  if (!solution.converged) solution.reason = outcome == Outcome::singular ? "singular matrix" : "Newton's method did not converge";
  lend(solution);
}

Memory Newton::present_memory() const {
  Memory of = tangent_.memory();
  of.blocks += bytes_of(blocks_, moves_, rows_);
  for (const Eigen::VectorXd* vector : {&trial_, &start_force_, &residual_}) of.blocks += sizeof(double) * static_cast<std::size_t>(vector->size());
  of.contacts += bytes_of(trials_, branches_, branches_before_, holds_) + starts_->bytes() + renewal_.bytes() + neighbourhood_.bytes();
  return of;
}

Eigen::MatrixXd Newton::stiffness(const StepProblem& problem, const std::vector<ContactSprings>& springs) {
  StepProblem static_problem = problem;
  static_problem.inertia = 0.0;
  static_problem.end_weight = 1.0;
  static_problem.scheme = nullptr;
  prepare(static_problem, GivenSprings(springs));
  tangent_.fit(static_problem, contacts());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(dofs * problem.system.free_count());
  evaluate(zero);
  assemble(zero, Tangent::exact);
  return tangent_.matrix().dense();
}

Eigen::VectorXd Newton::forces(const StepProblem& problem, const std::vector<ContactSprings>& springs) {
  prepare(problem, GivenSprings(springs));
  sum_start_forces();
  return start_force_;
}

void Newton::sum_start_forces() {
  const int blocks = problem_->system.free_count();
  start_force_.setZero(dofs * blocks);
  evaluate(Eigen::VectorXd::Zero(dofs * blocks));
  for (int i = 0; i < blocks; ++i) start_force_.segment<dofs>(dofs * i) << rows_[i].sums[0], rows_[i].sums[1], rows_[i].sums[2];
}

}  // namespace openclose
