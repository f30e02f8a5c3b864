#include "openclose/integrator/step_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [-] Part of the shear stiffness that sliding contacts keep in the symmetric tangent of statics, where nothing else would hold them.
constexpr double static_slip_stiffness = 0.01;
/// [-] Part of the largest force at the start of the step that may count as balanced. The forces of a trial that has run away, of which rounding and
/// the tolerance are parts, would excuse any residual. Forces may grow by 1e9 in a step before the usual tolerance of 1e-12 comes here.
constexpr double loosest_balance = 1e-3;
constexpr double largest_force_growth = 1e9;  ///< [-] the same margin for a tolerance that the scene makes coarser

/// Whether the forces are already on the linear piece of their law that holds in this status; sliding has several.
bool is_on_piece(ContactStatus now, double normal_by_gap, ContactStatus wanted) {
  if (now != wanted) return false;
  return now == ContactStatus::open || (now == ContactStatus::sticking && normal_by_gap != 0.0);
}

}  // namespace

void StepEquations::prepare(const StepProblem& problem, const SpringsOf& springs, ContactTrial& contacts) {
  const BlockSystem& system = problem.system;
  problem_ = &problem;
  contacts_ = &contacts;
  contacts_->prepare(problem, springs);
  contact_scale_ = contacts_->largest_force_at_start();
  blocks_.clear();
  blocks_.reserve(system.free_count());
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    const Unknowns still = Unknowns::Zero();
    // What coordinates round is there before a static step, which moves the blocks until it is balanced; ways are as exact as they are short.
    const double rounding_of_coordinates = problem.statics ? 0.0 : problem.external.spring_scale(system, b);
    blocks_.push_back({b, problem.external.has_elements(b), block.rotation_locked, block.radius, problem.inertia * block.mass,
                       problem.external.force(system, b, still), problem.drift(b), problem.external.magnitude(system, b, still),
                       rounding_of_coordinates, problem.emphasis(b)});
  }
  find_blocks_alone();
  block_scale_ = 0.0;
  for (const StepBlock& block : blocks_) {
    if (block.is_alone) continue;
    block_scale_ = std::max({block_scale_, block.magnitude, Motion::largest_force(block.inertia.cwiseProduct(block.drift), block.radius)});
  }
}

void StepEquations::find_blocks_alone() {
  for (StepBlock& block : blocks_) block.is_alone = !block.has_elements;
  const auto touch = [&](int row) {
    if (row < rows()) blocks_[row].is_alone = false;
  };
  for (const ContactBatch& batch : contacts_->batches()) {
    for (int k = 0; k < batch_size; ++k) {
      touch(batch.vertex_place(k));
      touch(batch.edge_place(k));
    }
  }
}

void StepEquations::move_blocks_alone(Eigen::VectorXd& d) const {
  for (std::size_t row = 0; row < blocks_.size(); ++row) {
    const StepBlock& block = blocks_[row];
    if (!block.is_alone) continue;
    Unknowns by_force = block.force.cwiseQuotient(block.inertia);
    if (block.rotation_locked) by_force[Motion::rotation_index] = 0.0;
    d.segment<dofs>(dofs * static_cast<Eigen::Index>(row)) = block.drift + by_force;
  }
}

void StepEquations::prepare_again(const std::vector<ContactSprings>& springs, ContactTrial& contacts) {
  contacts_ = &contacts;
  contacts_->set_springs(springs);
  contact_scale_ = contacts_->largest_force_at_start();
}

void StepEquations::evaluate_block(int row, const Eigen::VectorXd& d) {
  const BlockSystem& system = problem_->system;
  const double theta = problem_->end_weight;
  const StepBlock& block = blocks_[row];
  const int at = dofs * row;
  const Unknowns db = d.segment<dofs>(at);
  Lanes& sums = rows_[row].sums;
  sums += rows_[row].of_odd_lanes;
  Unknowns force(sums[0], sums[1], sums[2]);
  if (block.has_elements) {
    force += contacts_->averages_path() ? problem_->external.mean_force(system, block.block, db) : problem_->external.force(system, block.block, db);
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
  sums[dofs] += tolerance::rounding_of_sums * (Motion::largest_force(moved, block.radius) + magnitude(block, db) + block.rounding_of_coordinates);
}

double StepEquations::magnitude(const StepBlock& block, const Unknowns& d) const {
  return block.has_elements ? problem_->external.magnitude(problem_->system, block.block, d) : block.magnitude;
}

void StepEquations::move_block(int row, const Eigen::VectorXd& d) {
  contacts_->moves()[static_cast<std::size_t>(row)] = BlockMove(d.segment<dofs>(dofs * row), problem_->system.rotation_kind(), blocks_[row].radius);
}

void StepEquations::find_force_scale(double of_contacts, const Eigen::VectorXd& d) {
  force_scale_ = of_contacts;
  for (int row = 0; row < rows(); ++row) {
    if (blocks_[row].is_alone) continue;
    force_scale_ = std::max(force_scale_, magnitude(blocks_[row], d.segment<dofs>(dofs * row)));
  }
}

void StepEquations::evaluate(const Eigen::VectorXd& d) {
  for (int row = 0; row < rows(); ++row) move_block(row, d);
  rows_.assign(contacts_->moves().size(), ForceRow());
  residual_.resize(dofs * static_cast<Eigen::Index>(blocks_.size()));
  const double largest = contacts_->evaluate(rows_);
  for (int row = 0; row < rows(); ++row) evaluate_block(row, d);
  find_force_scale(largest, d);
}

double StepEquations::tolerated(int row) const {
  return problem_->method.residual_tolerance * force_scale_ + rows_[row].sums[dofs];
}

double StepEquations::unbalanced(int row) const {
  return Motion::largest_force(residual_.segment<dofs>(dofs * row), blocks_[row].radius);
}

double StepEquations::residual_norm() const {
  double worst = 0.0, largest = 0.0;
  const double loosest = std::max(loosest_balance, largest_force_growth * problem_->method.residual_tolerance) * start_scale();
  for (int row = 0; row < rows(); ++row) {
    const double r = unbalanced(row);
    if (!(r <= std::numeric_limits<double>::max())) return std::numeric_limits<double>::infinity();
    if (r == 0.0) continue;
    if (tolerated(row) > loosest) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, r / tolerated(row));
    largest = std::max(largest, blocks_[row].emphasis * r);
  }
  return largest <= problem_->negligible_force ? std::min(worst, 1.0) : worst;
}

double StepEquations::largest_unbalanced() const {
  double largest = 0.0;
  for (int row = 0; row < rows(); ++row) largest = std::max(largest, blocks_[row].emphasis * unbalanced(row));
  return largest;
}

double StepEquations::merit(double norm) const {
  if (problem_->statics || !std::isfinite(norm)) return norm;
  double work = 0.0;  // [J]
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Unknowns residual = residual_.segment<dofs>(dofs * static_cast<int>(i));
    work += residual.dot(residual.cwiseQuotient(blocks_[i].inertia));
  }
  return std::sqrt(work);
}

void StepEquations::assemble(const Eigen::VectorXd& d, bool exact, bool open_ones_too, const MatrixSlots& slots, BlockMatrix& matrix) const {
  matrix.set_zero();
  const BatchTangent asked{contacts_->averages_path(), exact, problem_->end_weight, problem_->statics ? static_slip_stiffness : 0.0,
                           open_ones_too || contacts_->averages_path()};
  contacts_->add_stiffness(asked, slots, matrix);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const StepBlock& block = blocks_[i];
    const int row = static_cast<int>(i);
    auto& diagonal = matrix.value(matrix.diagonal(row));
    diagonal.diagonal() += block.inertia;
    if (!block.has_elements) continue;
    const Unknowns db = d.segment<dofs>(dofs * row);
    if (contacts_->averages_path()) {
      diagonal += problem_->external.mean_stiffness(problem_->system, block.block, db);
    } else {
      diagonal += problem_->end_weight * problem_->external.stiffness(problem_->system, block.block, db);
    }
  }
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].rotation_locked) matrix.eliminate(static_cast<int>(i), Motion::rotation_index);
  }
}

void StepEquations::replace_forces(std::size_t c, const ContactForces& forces) {
  const TrialBatch& batch = contacts_->trial(c);
  const int k = ContactTrial::lane(c);
  const ContactPose pose = contacts_->force_pose(c);
  const double normal = problem_->end_weight * (forces.normal - batch.normal[k]), shear = problem_->end_weight * (forces.shear - batch.shear[k]);
  const ContactPush<double> change(normal, shear, force_place(pose));
  const auto push = [&](int row, double x, double y, double moment) {
    if (row >= rows()) return;
    double* const residual = residual_.data() + static_cast<std::ptrdiff_t>(dofs) * row;
    residual[0] += x;
    residual[1] += y;
    residual[2] += moment;
    if (blocks_[row].rotation_locked) residual[Motion::rotation_index] = 0.0;
  };
  const auto [vertex, edge] = contacts_->places(c);
  push(vertex, change.x, change.y, change.on_vertex);
  push(edge, -change.x, -change.y, -change.on_edge);
  contacts_->replace_forces(c, forces);
}

int StepEquations::hold_reversed(const std::vector<Branch>& branches_before) {
  int held = 0;
  for (std::size_t c = 0; c < contacts_->size(); ++c) {
    const Branch before = branches_before[c];
    const bool reversed = status(before) == ContactStatus::sliding && before == -contacts_->branches()[c];
    if (!reversed) continue;
    ++held;
    const ContactSprings springs = contacts_->seen_springs(c);
    const TrialBatch& now = contacts_->trial(c);
    const int k = ContactTrial::lane(c);
    ContactForces stuck = tangent_for_status(springs, contacts_->strength(c), ContactStatus::sticking, now.normal[k], now.shear[k]);
    stuck.normal = now.normal[k];
    stuck.shear = springs.initial_shear - (springs.shear + springs.shear_damping) * contacts_->slip_change(c);
    replace_forces(c, stuck);
  }
  return held;
}

void StepEquations::take_state(std::size_t c, ContactStatus wanted, double normal, double shear) {
  const TrialBatch& now = contacts_->trial(c);
  const int k = ContactTrial::lane(c);
  if (!contacts_->averages_path() && is_on_piece(contacts_->status(c), now.normal_by_gap[k], wanted)) return;
  replace_forces(c, prolonged(contacts_->seen_springs(c), contacts_->strength(c), wanted, normal, shear, now.gap_change[k], now.slip_change[k]));
}

void StepEquations::take_last_states() {
  // Statics begins with the drawing, whose rounding is in the gaps; a motion knows which of its contacts are open.
  const double touching_gap = problem_->statics ? tolerance::rounding_of_ways_m : 0.0;
  for (std::size_t c = 0; c < contacts_->size(); ++c) {
    const Contact& contact = problem_->contacts[c];
    const ContactBatch& start = contacts_->start(c);
    const int k = ContactTrial::lane(c);
    const bool touching = contact.status == ContactStatus::open && start.gap_off_target[k] <= touching_gap && start.shift[k] >= 0.0;
    take_state(c, touching ? ContactStatus::sticking : contact.status, contact.normal_force, contact.shear_force);
  }
}

void StepEquations::take_states(const std::vector<Branch>& branches) {
  for (std::size_t c = 0; c < contacts_->size(); ++c) {
    const ContactBatch& start = contacts_->start(c);
    const int k = ContactTrial::lane(c);
    take_state(c, status(branches[c]), start.shift[k], start.initial_shear[k]);
  }
}

void StepEquations::take_part(const StepEquations& whole, const Part& part, ContactTrial& contacts) {
  problem_ = whole.problem_;
  contacts_ = &contacts;
  contact_scale_ = whole.contact_scale_;
  block_scale_ = whole.block_scale_;
  blocks_.clear();
  std::vector<BlockMove>& moves = contacts_->moves();
  moves.clear();
  if (problem_->end_weight < 1.0) start_force_ = rows_of(whole.start_force_, part.rows);
  std::unordered_map<int, int> places;  // by those in the whole
  const auto place = [&](int of_whole) {
    const auto [at, is_new] = places.try_emplace(of_whole, static_cast<int>(moves.size()));
    if (is_new) moves.push_back(whole.contacts().moves()[static_cast<std::size_t>(of_whole)]);
    return at->second;
  };
  for (int row : part.rows) {
    blocks_.push_back(whole.blocks_[row]);
    place(row);
  }
  contacts_->take_part(*whole.contacts_, part, place);
}

bool StepEquations::stands_still() const {
  for (int row = 0; row < rows(); ++row) {
    const StepBlock& block = blocks_[row];
    const double weight = problem_->external.weight(problem_->system, block.block).norm();
    if (!block.drift.isZero(0.0) || !(unbalanced(row) <= tolerance::rest * weight)) return false;
  }
  return true;
}

void StepEquations::sum_start_forces() {
  const int blocks = problem_->system.free_count();
  start_force_.setZero(dofs * blocks);
  evaluate(Eigen::VectorXd::Zero(dofs * blocks));
  for (int i = 0; i < blocks; ++i) start_force_.segment<dofs>(dofs * i) << rows_[i].sums[0], rows_[i].sums[1], rows_[i].sums[2];
}

double StepEquations::start_scale() const {
  return std::max(contact_scale_, block_scale_);
}

Memory StepEquations::memory() const {
  Memory of;
  of.blocks = bytes_of(blocks_, rows_);
  for (const Eigen::VectorXd* vector : {&start_force_, &residual_}) of.blocks += sizeof(double) * static_cast<std::size_t>(vector->size());
  return of;
}

}  // namespace openclose
