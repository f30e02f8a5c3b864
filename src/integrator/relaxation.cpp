// Newton::relax(): a static step without linear equations.
#include <algorithm>
#include <cmath>

#include "openclose/integrator/newton.h"

namespace openclose {
namespace {

/// [-] Of the way that the estimate gives: the longest step after which momentum never makes a vibration grow.
constexpr double safe_step = 1.0 / TwoLevelFlexibility::largest_eigenvalue;
/// Ten times what a slope of 50,000 blocks needs. What has no equilibrium ends here, if not by its displacement.
constexpr int most_relaxation_steps = 100000;
constexpr int steps_between_looks = 100;  ///< at the displacement
/// [-] Of the longest displacement: momentum carries blocks a few hundredths beyond their place.
constexpr double largest_overshoot = 1.1;

/// Momentum of Nesterov's method: grows while it helps, begins anew when the forces oppose it.
class Momentum {
 public:
  void restart() { age_ = 1.0; }
  /// [-] Of the last way that is gone once more.
  double next() {
    const double last = age_;
    age_ = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * last * last));
    return (last - 1.0) / age_;
  }

 private:
  double age_ = 1.0;
};

}  // namespace

template <int N>
TwoLevelFlexibility Newton<N>::flexibility(const Eigen::VectorXd& d) const {
  const int rows = static_cast<int>(blocks_.size());
  const auto row_of = [&](int row) { return row < rows ? row : -1; };
  std::vector<Vec2> centroids;
  for (const StepBlock& block : blocks_) centroids.push_back(problem_->system.centroid(block.block));
  std::vector<std::pair<int, int>> couplings;
  for (std::size_t c = 0; c < contact_count_; ++c) {
    const std::pair<int, int> pair = std::minmax(row_of(start(c).vertex_row[lane(c)]), row_of(start(c).edge_row[lane(c)]));
    if (pair.first >= 0 && (couplings.empty() || couplings.back() != pair)) couplings.push_back(pair);
  }
  TwoLevelFlexibility sum(centroids, couplings);
  const auto gradient = [&](int row, const Vec2& direction, const Vec2& arm) {
    const bool turns = row >= 0 && !blocks_[row].rotation_locked;
    return Unknowns(direction.x(), direction.y(), turns ? arm.x() * direction.y() - arm.y() * direction.x() : 0.0);
  };
  for (std::size_t c = 0; c < contact_count_; ++c) {
    const int k = lane(c), i = row_of(start(c).vertex_row[k]), j = row_of(start(c).edge_row[k]);
    const ContactPose<N> pose = trial(c).pose(k);
    const Vec2 tangent(-pose.normal.y(), pose.normal.x());
    for (const auto& [stiffness, way] : {std::pair(start(c).normal[k], pose.normal), std::pair(start(c).shear[k], tangent)})
      sum.add_spring(stiffness, i, gradient(i, way, pose.vertex_arm), j, -gradient(j, way, pose.edge_arm));
  }
  for (int i = 0; i < rows; ++i) {
    Eigen::Matrix<double, N, N> own = blocks_[i].inertia.asDiagonal();
    if (blocks_[i].has_point_forces) own += problem_->external.stiffness(problem_->system, blocks_[i].block, d.template segment<N>(N * i));
    sum.add_own(i, own);
  }
  return sum;
}

template <int N>
void Newton<N>::keep_slip() {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    ContactBatch& contact = contacts_[i];
    const TrialBatch& now = trials_[i];
    for (int k = 0; k < batch_size; ++k) {
      const bool slid = branches_[batch_size * i + static_cast<std::size_t>(k)] != static_cast<Branch>(ContactStatus::sticking);
      const double slack = now.elastic_shear[k] + contact.shear[k] * now.slip_change[k];
      contact.initial_shear[k] = slid ? slack : contact.initial_shear[k];
    }
  }
}

template <int N>
void Newton<N>::note_slip(const std::vector<ContactSprings>& springs) {
  for (std::size_t c = 0; c < contact_count_; ++c) {
    if (status(branches_[c]) != ContactStatus::sticking) continue;
    const ContactForces law = spring_slider(springs[c], start(c).strength(lane(c)), trial(c).gap_change[lane(c)], trial(c).slip_change[lane(c)]);
    if (law.status == ContactStatus::sliding) branches_[c] = branch(law);
  }
}

template <int N>
bool Newton<N>::has_left(const Eigen::VectorXd& d) const {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const double way = Motion<N>::displacement_bound(d.template segment<N>(N * static_cast<int>(i)), blocks_[i].radius);
    if (!(way <= largest_overshoot * problem_->longest_displacement)) return true;
  }
  return false;
}

template <int N>
void Newton<N>::relax(const StepProblem<N>& problem, const std::vector<ContactSprings>& springs, StepSolution<N>& solution) {
  solution.contacts.give_back(trials_, branches_);
  prepare(problem, springs);
  Eigen::VectorXd& d = solution.d;
  evaluate(d);
  TwoLevelFlexibility estimate = flexibility(d);
  if (!estimate.factor()) {
    solution.reason = "singular matrix";
    return;
  }
  double norm = residual_norm();
  Eigen::VectorXd place = d, next(d.size());
  Momentum momentum;
  int& steps = solution.effort.relaxation_steps;
  while (norm > 1.0 && steps < most_relaxation_steps && (steps % steps_between_looks != 0 || !has_left(d))) {
    keep_slip();
    next = d + safe_step * estimate.displacement(residual_);
    if (residual_.dot(next - place) < 0.0) momentum.restart();
    d = next + momentum.next() * (next - place);
    place.swap(next);
    evaluate(d);
    norm = residual_norm();
    ++steps;
  }
  solution.converged = norm <= 1.0;
  if (!solution.converged) solution.reason = "relaxation did not come to rest";
  note_slip(springs);
  solution.paths.clear();
  solution.contacts.borrow(trials_, branches_, springs);
}

template class Newton<3>;

}  // namespace openclose
