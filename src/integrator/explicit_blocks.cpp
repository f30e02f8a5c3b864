#include "openclose/integrator/explicit_blocks.h"

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

/// [rad] Up to here the series below are exact to rounding: the first terms left out are angle^9/9! and angle^8/8!.
constexpr double small_angle = 0.01;

double square(double x) {
  return x * x;
}

double sign(double x) {
  return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0);
}

/// [N] What Cundall's local damping of this share leaves of an unbalanced force.
double locally_damped(double force, double velocity, double share) {
  return force - share * std::abs(force) * sign(velocity);
}

/// Unlike std::max() no number, once there has been one that is none.
double larger_or_nan(double largest, double next) {
  return largest >= next || std::isnan(largest) ? largest : next;
}

void turn_to(ExplicitPose& pose, double angle) {
  const double q = angle * angle;
  if (std::abs(angle) < small_angle) {
    pose.sin = angle * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0)));
    pose.cos_minus_1 = -0.5 * q * (1.0 - q / 12.0 * (1.0 - q / 30.0));
  } else {
    pose.sin = std::sin(angle);
    pose.cos_minus_1 = -2.0 * square(std::sin(0.5 * angle));
  }
}

}  // namespace

void ExplicitBlocks::load(const StepProblem& problem) {
  const BlockSystem& system = problem.system;
  const std::size_t n = system.free_blocks().size();
  const std::size_t slots = n + 1 + system.resting_blocks().size();
  poses_.assign(slots, ExplicitPose());
  rates_.assign(slots, ExplicitRate());
  next_rates_.assign(slots, ExplicitRate());
  forces_.assign(slots, ExplicitRate());
  rest_slot_.assign(system.block_count(), static_cast<int>(n));
  for (std::size_t i = 0; i < system.resting_blocks().size(); ++i) rest_slot_[system.resting_blocks()[i]] = static_cast<int>(n + 1 + i);
  inertia_.clear();
  loaded_at_.clear();
  blocks_ = system.free_blocks();
  for (int b : blocks_) {
    const auto& block = system.block(b);
    const Unknowns v = system.velocity(b), weight = problem.external.weight(system, b);
    rates_[block.equation] = {v[0], v[1], v[2], 0.0};
    loaded_at_.push_back(system.displacement(b));
    inertia_.push_back({block.mass[0], block.mass[2], 1.0 / block.mass[0], 1.0 / block.mass[2], block.rotation_locked ? 0.0 : 1.0, weight[0],
                        weight[1], block.radius});
  }
}

bool ExplicitBlocks::fits(const BlockSystem& system) const {
  const std::size_t free = system.free_blocks().size(), slots = free + 1 + system.resting_blocks().size();
  const bool same_slots = poses_.size() == slots && rates_.size() == slots && next_rates_.size() == slots && forces_.size() == slots;
  const bool same_blocks = inertia_.size() == free && blocks_ == system.free_blocks() && loaded_at_.size() == free && marked_at_.size() == free;
  const auto is_motion = [](const ExplicitRate& r) { return std::isfinite(r.x + r.y + r.turn + r.angle); };
  return same_slots && same_blocks && rest_slot_.size() == system.blocks().size() &&
         std::ranges::all_of(rest_slot_, [&](int s) { return has_slot(s); }) &&
         std::ranges::all_of(poses_, [](const ExplicitPose& p) { return std::isfinite(p.x + p.y + p.cos_minus_1 + p.sin); }) &&
         std::ranges::all_of(rates_, is_motion) && std::ranges::all_of(forces_, is_motion) &&
         std::ranges::all_of(loaded_at_, [](const Unknowns& d) { return d.allFinite(); });
}

void ExplicitBlocks::begin_forces() {
  for (std::size_t i = 0; i < inertia_.size(); ++i) forces_[i] = {inertia_[i].weight_x, inertia_[i].weight_y, 0.0, 0.0};
  std::fill(forces_.begin() + static_cast<std::ptrdiff_t>(inertia_.size()), forces_.end(), ExplicitRate());
}

ExplicitBlocks::Trial ExplicitBlocks::try_motion(const ExplicitMotion& motion) {
  const double span = motion.span, alpha = motion.local_damping;
  const double keep = 1.0 - 0.5 * motion.viscous * span, per_viscous = 1.0 / (1.0 + 0.5 * motion.viscous * span);
  const auto damped = [alpha](double force, double velocity) { return locally_damped(force, velocity, alpha); };
  const Vec2 base = motion.base;
  double fastest = 0.0, unbalanced = 0.0;
  for (std::size_t i = 0; i < inertia_.size(); ++i) {
    const ExplicitInertia& m = inertia_[i];
    const ExplicitRate &f = forces_[i], &v = rates_[i];
    ExplicitRate& next = next_rates_[i];
    next.x = (keep * v.x + span * (damped(f.x - m.mass * base.x(), v.x) * m.per_mass)) * per_viscous;
    next.y = (keep * v.y + span * (damped(f.y - m.mass * base.y(), v.y) * m.per_mass)) * per_viscous;
    next.turn = m.turns * (keep * v.turn + span * (damped(f.turn, v.turn) * m.per_moment)) * per_viscous;
    // (a + b)^2 <= 2 (a^2 + b^2) for the speed of the centroid and of the farthest point around it.
    fastest = larger_or_nan(fastest, next.x * next.x + next.y * next.y + square(next.turn * m.radius));
    unbalanced = std::max(unbalanced, force_squared(i));
  }
  return {motion.h * std::sqrt(2.0 * fastest), unbalanced};
}

ExplicitBlocks::Work ExplicitBlocks::advance(const ExplicitMotion& motion, EnergyLedger& energies) {
  const double h = motion.h, span = motion.span, alpha = motion.local_damping, viscous = motion.viscous;
  const Vec2 base = motion.base;
  EnergyLedger sum;
  double kinetic_change = 0.0;
  for (std::size_t i = 0; i < inertia_.size(); ++i) {
    const ExplicitInertia& m = inertia_[i];
    const ExplicitRate &force = forces_[i], &v = rates_[i];
    const ExplicitRate f{force.x - m.mass * base.x(), force.y - m.mass * base.y(), force.turn, 0.0};
    ExplicitRate& next = next_rates_[i];
    const double mean_x = 0.5 * (v.x + next.x), mean_y = 0.5 * (v.y + next.y), mean_turn = 0.5 * (v.turn + next.turn);
    const double gravity = span * (m.weight_x * mean_x + m.weight_y * mean_y);
    const double by_base = -span * m.mass * (base.x() * mean_x + base.y() * mean_y);
    const double work = span * (f.x * mean_x + f.y * mean_y + f.turn * mean_turn);
    const double kinetic = m.mass * ((next.x - v.x) * mean_x + (next.y - v.y) * mean_y) + m.moment * (next.turn - v.turn) * mean_turn;
    if (alpha > 0.0) {
      sum.mass_damping +=
          span * alpha * (std::abs(f.x) * sign(v.x) * mean_x + std::abs(f.y) * sign(v.y) * mean_y + std::abs(f.turn) * sign(v.turn) * mean_turn);
    } else if (viscous > 0.0) {
      sum.mass_damping += span * viscous * (m.mass * (mean_x * mean_x + mean_y * mean_y) + m.moment * mean_turn * mean_turn);
    }
    sum.gravity -= gravity;
    sum.base_motion -= by_base;
    sum.scheme -= work - gravity - by_base;
    sum.turnover += std::abs(kinetic) + std::abs(gravity) + std::abs(by_base);
    kinetic_change += kinetic;
    ExplicitPose& pose = poses_[i];
    pose.x += h * next.x;
    pose.y += h * next.y;
    next.angle = v.angle + h * next.turn;
    turn_to(pose, next.angle);
  }
  energies += sum;
  rates_.swap(next_rates_);
  return {kinetic_change, sum.mass_damping};
}

ExplicitRate ExplicitBlocks::acceleration(int slot, const Vec2& base) const {
  if (slot >= count()) return {};
  const ExplicitInertia& m = inertia_[slot];
  const ExplicitRate& f = forces_[slot];
  return {f.x * m.per_mass - base.x(), f.y * m.per_mass - base.y(), m.turns * f.turn * m.per_moment, 0.0};
}

void ExplicitBlocks::mark_way() {
  marked_at_.resize(inertia_.size());
  for (std::size_t i = 0; i < inertia_.size(); ++i) marked_at_[i] = {poses_[i].x, poses_[i].y, rates_[i].angle};
}

double ExplicitBlocks::farthest_way() const {
  double farthest = 0.0;
  for (std::size_t i = 0; i < inertia_.size(); ++i) {
    const Way& from = marked_at_[i];
    farthest = std::max(farthest, std::sqrt(square(poses_[i].x - from.x) + square(poses_[i].y - from.y)) +
                                      inertia_[i].radius * std::abs(rates_[i].angle - from.angle));
  }
  return farthest;
}

double ExplicitBlocks::unbalanced_force(double heaviest) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < inertia_.size(); ++i) {
    const double weight = std::hypot(inertia_[i].weight_x, inertia_[i].weight_y);
    largest = std::max(largest, emphasis_at_rest(heaviest, weight) * std::sqrt(force_squared(i)));
  }
  return largest;
}

double ExplicitBlocks::force_squared(std::size_t i) const {
  const ExplicitRate& f = forces_[i];
  return std::max(f.x * f.x + f.y * f.y, square(inertia_[i].turns * f.turn / inertia_[i].radius));
}

ExplicitBlocks::Unknowns ExplicitBlocks::velocity_at_end(int equation, const ExplicitMotion& motion) const {
  const ExplicitInertia& m = inertia_[equation];
  const ExplicitRate &f = forces_[equation], &v = rates_[equation];
  const double half = 0.5 * motion.h;
  const auto ahead = [&](double force, double velocity, double per_mass) {
    return velocity + half * (locally_damped(force, velocity, motion.local_damping) * per_mass - motion.viscous * velocity);
  };
  return {ahead(f.x - m.mass * motion.base.x(), v.x, m.per_mass), ahead(f.y - m.mass * motion.base.y(), v.y, m.per_mass),
          m.turns * ahead(f.turn, v.turn, m.per_moment)};
}

double ExplicitBlocks::power() const {
  double power = 0.0;
  for (std::size_t i = 0; i < inertia_.size(); ++i) {
    const ExplicitInertia& m = inertia_[i];
    const ExplicitRate &f = forces_[i], &v = rates_[i];
    power += (f.x - m.weight_x) * v.x + (f.y - m.weight_y) * v.y + f.turn * v.turn;
  }
  return power;
}

void ExplicitBlocks::rest_forces(std::vector<Unknowns>& forces) const {
  const std::size_t first = inertia_.size() + 1;
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = {forces_[first + i].x, forces_[first + i].y, forces_[first + i].turn};
}

void ExplicitBlocks::store(BlockSystem& system) const {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const ExplicitPose& pose = poses_[i];
    const ExplicitRate& v = rates_[i];
    system.move_to(blocks_[i], loaded_at_[i] + Unknowns(pose.x, pose.y, v.angle));
    system.set_velocity(blocks_[i], {v.x, v.y, v.turn});
  }
}

}  // namespace openclose
