#include "openclose/integrator/accelerated_relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/momentum.h"

namespace openclose {
namespace {

/// Thirty times what the first step of a slope of 100,000 blocks needs. What has no equilibrium ends here, if not by its displacement.
constexpr int most_relaxation_steps = 100000;
constexpr int steps_between_looks = 100;  ///< at the displacement
/// [m] At the start of the step contacts may be kept over gaps of twice the longest step. Closures are tenths of this.
constexpr double near_gap = 1e-3;
/// After so many steps the estimate may be renewed, which takes as long as three of them.
constexpr int steps_between_estimates = 50;
/// [-] In that time, part of the contacts: while more of them change their states, all that may come back are counted.
constexpr double few_changes = 1e-3;
/// [-] The estimate is renewed when the residual has fallen to this part.
constexpr double renewing_decrease = 0.1;
/// [m] A block goes no farther than this in a step for which its own unbalanced force is to blame: less than joints close under load, so that what
/// comes loose does not pass through what would stop it. Slopes of 20,100 blocks take as many steps with a tenth of it.
constexpr double longest_lone_way = 1e-4;
/// [-] Residual over the largest force at which what has slipped is known, if the relaxation does not end before: contacts that may slip carry a
/// hundredth of that force.
constexpr double residual_of_slip = 1e-6;
/// [-] Of the longest displacement: momentum carries blocks a few hundredths beyond their place.
constexpr double largest_overshoot = 1.1;

/// Which contacts have their springs in the estimate: all that are closed, so that its steps stay safe, and those that may close again. Without the
/// open ones it is right about blocks that few contacts hold.
class CountedContacts {
 public:
  CountedContacts(const std::vector<Contact>& contacts, const std::vector<Branch>& branches) : changed_(contacts.size()), last_(branches) {
    for (std::size_t c = 0; c < contacts.size(); ++c)
      counted_.push_back(contacts[c].stretch() <= near_gap || status(branches[c]) != ContactStatus::open);
  }
  /// After a step. True if one has closed that was not counted.
  bool follow(const std::vector<Branch>& branches) {
    bool are_more = false;
    const auto end = branches.begin() + static_cast<std::ptrdiff_t>(counted_.size());
    for (auto at = std::mismatch(branches.begin(), end, last_.begin()); at.first != end; at = std::mismatch(at.first, end, at.second)) {
      const auto c = static_cast<std::size_t>(at.first - branches.begin());
      changed_[c] = true;
      ++changes_;
      if (!counted_[c] && status(branches[c]) != ContactStatus::open) counted_[c] = are_more = true;
      *at.second = *at.first;
    }
    return are_more;
  }
  /// Leaves out those that are open and have been since the last call, if few have changed. True if there are any.
  bool leave_out() {
    bool are_fewer = false;
    const bool is_quiet = static_cast<double>(changes_) <= few_changes * static_cast<double>(counted_.size());
    for (std::size_t c = 0; is_quiet && c < counted_.size(); ++c) {
      if (!counted_[c] || changed_[c] || status(last_[c]) != ContactStatus::open) continue;
      counted_[c] = false;
      are_fewer = true;
    }
    changed_.assign(changed_.size(), false);
    changes_ = 0;
    return are_fewer;
  }
  const std::vector<bool>& counted() const { return counted_; }

 private:
  std::vector<bool> counted_, changed_;
  std::vector<Branch> last_;
  long changes_ = 0;
};

}  // namespace

TwoLevelFlexibility AcceleratedRelaxation::flexibility(const Eigen::VectorXd& d, const std::vector<bool>& counted, double longest_way) const {
  const int rows = equations_.rows();
  const auto row_of = [&](int row) { return row < rows ? row : -1; };
  std::vector<Vec2> centroids;
  for (const StepEquations::StepBlock& block : equations_.blocks()) centroids.push_back(equations_.problem().system.centroid(block.block));
  std::vector<std::pair<int, int>> couplings;
  for (std::size_t c = 0; c < contacts().size(); ++c) {
    if (!counted[c]) continue;
    const auto [vertex, edge] = contacts().places(c);
    if (vertex < rows && edge < rows) couplings.emplace_back(vertex, edge);
  }
  TwoLevelFlexibility sum(centroids, couplings);
  for (int row = 0; row < rows; ++row) {
    if (equations_.blocks()[row].rotation_locked) sum.lock_rotation(row);
  }
  for (std::size_t c = 0; c < contacts().size(); ++c) {
    if (!counted[c]) continue;
    const auto [vertex, edge] = contacts().places(c);
    const int k = ContactTrial::lane(c), i = row_of(vertex), j = row_of(edge);
    const ContactBatch& start = contacts().start(c);
    const ContactKinematics at(contacts().pose(c));
    sum.add_spring(start.normal[k], i, at.normal_vertex, j, at.normal_edge);
    sum.add_spring(start.shear[k], i, at.shear_vertex, j, at.shear_edge);
  }
  for (int i = 0; i < rows; ++i) {
    Eigen::Matrix<double, dofs, dofs> own = equations_.blocks()[i].inertia.asDiagonal();
    if (equations_.blocks()[i].has_elements)
      own += equations_.problem().external.stiffness(equations_.problem().system, equations_.blocks()[i].block, d.segment<dofs>(dofs * i));
    const double hold = equations_.unbalanced(i) / longest_way, radius = equations_.blocks()[i].radius;
    own.diagonal() += hold * Motion::Unknowns(1.0, 1.0, radius * radius);
    sum.add_own(i, own);
  }
  return sum;
}

void AcceleratedRelaxation::keep_slip() {  // all of the shear force is in the spring: nothing damps at rest
  const auto sticks = [](Branch b) { return status(b) == ContactStatus::sticking; };
  for (std::size_t i = 0; i < contacts().batches().size(); ++i) {
    const Branch* const branches = contacts().branches().data() + batch_size * i;
    if (std::all_of(branches, branches + batch_size, sticks)) continue;
    ContactBatch& contact = contacts().batches()[i];
    const TrialBatch& now = contacts().trials()[i];
    for (int k = 0; k < batch_size; ++k) {
      const bool slid = !sticks(branches[k]);
      const double slack = now.shear[k] + contact.shear[k] * now.slip_change[k];
      contact.initial_shear[k] = slid ? slack : contact.initial_shear[k];
    }
  }
}

ContactForces AcceleratedRelaxation::slipped_as_a_whole(const SpringsOf& springs, std::size_t c) const {
  const TrialBatch& now = contacts().trial(c);
  const int k = ContactTrial::lane(c);
  return spring_slider(springs(c), contacts().strength(c), now.gap_change[k], now.slip_change[k]);
}

bool AcceleratedRelaxation::break_slipped_bonds(const SpringsOf& springs) {
  bool any = false;
  for (std::size_t c = 0; c < contacts().size(); ++c) {
    const Contact& contact = equations_.problem().contacts[c];
    const TabulatedJoint& joint = equations_.problem().joints.joint(contact.joint);
    if (!can_lose_strength(joint, contact.joint_state) || !joint.weakens_by_slip() || contacts().status(c) == ContactStatus::open) continue;
    const ContactForces whole = slipped_as_a_whole(springs, c);
    if (whole.status != ContactStatus::sliding) continue;
    const ContactSprings from = springs(c);
    const double slip = contacts().trial(c).slip_change[ContactTrial::lane(c)] - (from.initial_shear - whole.elastic_shear) / from.shear;
    const JointState state = state_after(joint, contact.joint_state, ContactStatus::sliding, std::abs(slip));
    if (loss(joint, states_[c], state) <= 0.0) continue;
    any = true;
    states_[c] = state;
    contacts().start(c).set_strength(ContactTrial::lane(c), ContactStrength(joint, contact.length, state));
  }
  return any;
}

void AcceleratedRelaxation::note_slip(const SpringsOf& springs) {
  for (std::size_t c = 0; c < contacts().size(); ++c) {
    Branch& piece = contacts().branches()[c];
    if (status(piece) != ContactStatus::sticking) continue;
    const ContactForces law = slipped_as_a_whole(springs, c);
    if (law.status == ContactStatus::sliding) piece = branch(law);
    if (states_[c] != equations_.problem().contacts[c].joint_state)
      piece = branch(ContactStatus::sliding, contacts().trial(c).shear[ContactTrial::lane(c)] < 0.0);
  }
}

bool AcceleratedRelaxation::has_left(const Eigen::VectorXd& d) const {
  for (std::size_t i = 0; i < equations_.blocks().size(); ++i) {
    const double way = Motion::displacement_bound(d.segment<dofs>(dofs * static_cast<int>(i)), equations_.blocks()[i].radius);
    if (!(way <= largest_overshoot * equations_.problem().longest_displacement)) return true;
  }
  return false;
}

void AcceleratedRelaxation::solve(const StepProblem& problem, const SpringsOf& springs, StepSolution& solution) {
  equations_.prepare(problem, springs, solution.contacts);
  Eigen::VectorXd& d = solution.d;
  equations_.move_blocks_alone(d);
  equations_.evaluate(d);
  double norm = equations_.residual_norm(), norm_of_estimate = norm;
  CountedContacts counted(problem.contacts, contacts().branches());
  int& estimates = solution.effort.estimates;
  std::optional<TwoLevelFlexibility> estimate;
  const auto renew = [&](double longest_way) {
    estimate.reset();  // before there is another
    estimate.emplace(flexibility(d, counted.counted(), longest_way));
    norm_of_estimate = norm;
    ++estimates;
    const bool is_regular = estimate->factor();
    memory_.grow_to(equations_.memory() + estimate->memory() + solution.memory());
    return is_regular;
  };
  // At first, all that touch hold the blocks.
  bool is_regular = renew(std::numeric_limits<double>::infinity());
  Eigen::VectorXd place = d, next(d.size());
  Momentum momentum;
  states_.clear();
  for (const Contact& contact : problem.contacts) states_.push_back(contact.joint_state);
  bool bonds_are_known = false;
  int& steps = solution.effort.relaxation_steps;
  while (is_regular && norm > 1.0 && steps < most_relaxation_steps && (steps % steps_between_looks != 0 || !has_left(d))) {
    keep_slip();
    // Of the way that the estimate gives, the longest step after which momentum never makes a vibration grow.
    next = d + (1.0 / TwoLevelFlexibility::largest_eigenvalue) * estimate->displacement(equations_.residual());
    if (equations_.residual().dot(next - place) < 0.0) momentum.restart();
    d = next + momentum.next() * (next - place);
    place.swap(next);
    equations_.evaluate(d);
    norm = equations_.residual_norm();
    ++steps;
    const bool is_near = norm <= 1.0 || norm * problem.method.residual_tolerance <= residual_of_slip;
    if (is_near && !bonds_are_known && break_slipped_bonds(springs)) {
      equations_.evaluate(d);
      norm = equations_.residual_norm();
    }
    bonds_are_known = is_near;
    bool is_outdated = counted.follow(contacts().branches());
    if (steps % steps_between_estimates == 0) is_outdated |= counted.leave_out() || (estimates > 1 && norm < renewing_decrease * norm_of_estimate);
    if (is_outdated) is_regular = renew(longest_lone_way);
  }
  if (!is_regular) {
    solution.reason = "singular matrix";
    return;
  }
  solution.converged = norm <= 1.0;
  solution.unbalanced = equations_.largest_unbalanced();
  if (!solution.converged) solution.reason = "relaxation did not come to rest";
  note_slip(springs);
  contacts().finish();
}

}  // namespace openclose
