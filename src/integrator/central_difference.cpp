#include "openclose/integrator/central_difference.h"

#include <algorithm>
#include <cmath>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [-] Automatic damping: power taken over the rate of change of kinetic energy, as in UDEC.
constexpr double power_ratio = 0.5;
/// [-] Factor on its coefficient from one step to the next, and the value it starts from times the step. A hundredfold change takes 47 steps, a
/// fraction of the slowest vibration of any system of many blocks.
constexpr double adaptation = 1.1;
constexpr double first_viscous = 0.01;

/// [-] Of the skin: with less of it used up the list is kept and the way counted anew from there.
constexpr double renew_fraction = 0.5;
/// [-] Contacts are left out as too far apart until a step is this much longer than the one before that was decided.
constexpr double more_speed = 1.5;

/// From where one way ends to where another one does that began at the same place.
ElementPath rest_of_way(const ElementPath& first, const ElementPath& whole) {
  ElementPath rest;
  rest.d = whole.d - first.d;
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    const PointPath &from = first.points[i], &to = whole.points[i];
    rest.points[i] = {to.position + from.moved, from.end_arm, to.moved - from.moved, to.end_arm};
  }
  return rest;
}

}  // namespace

void CentralDifference::load(const StepProblem& problem) {
  blocks_.load(problem);
  load_elements(problem);
  blocks_.begin_forces();
  add_element_forces(false);
  list_is_short_ = false;
  // By the skin when their pair is last passed over, by the skin until the pairs are looked at again, and by the step with which blocks leave it.
  links_.load(problem, 2.0 * skin_ + more_speed * step_ahead_);
  keep();
}

void CentralDifference::renew(const StepProblem& problem, const std::vector<DetectionChange>& changes) {
  links_.renew(problem, changes);
  keep();
}

void CentralDifference::keep() {
  moved_ = 0.0;
  blocks_.mark_way();
}

void CentralDifference::load_elements(const StepProblem& problem) {
  elements_.clear();
  external_ = &problem.external;
  const auto& all = external_->elements();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const int slot = problem.system.block(all[i]->block()).equation;
    if (slot >= 0) elements_.push_back({static_cast<int>(i), slot, all[i]->path(problem.system, Unknowns::Zero())});
  }
}

void CentralDifference::add_element_forces(bool step) {
  for (ElementWay& way : elements_) {
    const ForceElement& element = *external_->elements()[way.element];
    const ExplicitPose& pose = blocks_.pose(way.slot);
    const ElementPath before = way.path;
    way.path.d = {pose.x, pose.y, blocks_.rate(way.slot).angle};
    for (std::size_t i = 0; i < element.points().size(); ++i) {
      PointPath& p = way.path.points[i];
      const Vec2 turned = pose.cos_minus_1 * p.arm + pose.sin * perpendicular(p.arm);
      p.moved = Vec2(pose.x, pose.y) + turned;
      p.end_arm = p.arm + turned;
    }
    const Unknowns force = element.force(way.path);
    ExplicitRate& sum = blocks_.forces()[way.slot];
    sum.x += force[0];
    sum.y += force[1];
    sum.turn += force[2];
    if (!step) continue;
    const double change = element.energy_change(rest_of_way(before, way.path));
    (element.account() == ForceAccount::loads ? energies_.loads : energies_.support_springs) += change;
    energies_.scheme -= change;
    if (element.account() == ForceAccount::loads) energies_.turnover += std::abs(change);
  }
}

Move CentralDifference::move(double h, double span, const Vec2& base, double limit, double fast_step, MassDamping damping, double local_damping) {
  if (damping != MassDamping::automatic) motion_.viscous = 0.0;
  if (damping == MassDamping::automatic && motion_.viscous == 0.0) motion_.viscous = first_viscous / h;
  const ExplicitMotion motion{h, span, base, damping == MassDamping::local ? local_damping : 0.0, motion_.viscous};
  const ExplicitBlocks::Trial trial = blocks_.try_motion(motion);
  fastest_ = trial.farthest / h;
  if (!(trial.farthest <= limit)) return Move::too_far;
  step_ahead_ = 2.0 * trial.farthest;  // two blocks that move against each other
  list_is_short_ = 2.0 * skin_ + step_ahead_ > links_.approach();
  if (list_is_short_) return Move::past_list;
  if (is_fast() && h > fast_step) return Move::too_fast;
  const double before = 2.0 * span - h;
  const bool is_damped = motion.local_damping > 0.0 || motion.viscous > 0.0;
  if (!is_damped && std::abs(h - before) > tolerance::rounding_of_times * h) links_.book_step_change(before, h, base);
  moved_ += step_ahead_;
  links_.come_nearer(step_ahead_);
  unbalanced_square_ = trial.unbalanced_square;
  motion_ = motion;
  const ExplicitBlocks::Work work = blocks_.advance(motion, energies_);
  if (motion.viscous > 0.0) adapt(work);
  return Move::taken;
}

void CentralDifference::adapt(const ExplicitBlocks::Work& work) {
  motion_.viscous *= work.mass_damping < power_ratio * std::abs(work.kinetic_change) ? adaptation : 1.0 / adaptation;
  // Critical damping of the fastest motion a step can follow, and a trace from which it can grow again.
  motion_.viscous = std::clamp(motion_.viscous, 1e-3 * first_viscous / motion_.h, 1.0 / motion_.h);
}

void CentralDifference::follow_contacts() {
  blocks_.begin_forces();
  add_element_forces(true);
  links_.follow();
}

bool CentralDifference::moved_beyond_skin() {
  if (moved_ <= skin_) return false;
  // The way may have been longer than where it has led to.
  moved_ = 2.0 * blocks_.farthest_way();
  return moved_ > renew_fraction * skin_;
}

double CentralDifference::last_unbalanced_force() const {
  return std::sqrt(unbalanced_square_);
}

double CentralDifference::kinetic_ahead() const {
  return 0.5 * motion_.h * blocks_.power();
}

EnergyLedger CentralDifference::take_energies() {
  const EnergyLedger taken = energies_;
  energies_ = EnergyLedger();
  return taken;
}

void CentralDifference::exchange(Archive& archive, const JointTable& joints, const ExternalForces& external) {
  external_ = &external;
  archive(blocks_, elements_, energies_, motion_.h, motion_.span, motion_.base, motion_.local_damping, motion_.viscous, moved_, unbalanced_square_,
          step_ahead_, fastest_, list_is_short_);
  links_.exchange(archive, joints);
}

bool CentralDifference::fits(const BlockSystem& system, std::size_t contacts) const {
  const auto fits = [&](const ElementWay& way) {
    return blocks_.has_slot(way.slot) && way.element >= 0 && static_cast<std::size_t>(way.element) < external_->elements().size();
  };
  return blocks_.fits(system) && links_.fits(contacts) && std::ranges::all_of(elements_, fits);
}

Memory CentralDifference::memory() const {
  Memory of = links_.memory();
  of.blocks += blocks_.bytes() + bytes_of(elements_);
  return of;
}

}  // namespace openclose
