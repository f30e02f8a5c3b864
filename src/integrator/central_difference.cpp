#include "openclose/integrator/central_difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/crossing_energy.h"
#include "openclose/integrator/lane_operations.h"

namespace openclose {
namespace {

using namespace lanes;

/// [rad] Up to here the series below are exact to rounding: the first terms left out are angle^9/9! and angle^8/8!.
constexpr double small_angle = 0.01;
/// [-] Automatic damping: power taken over the rate of change of kinetic energy, as in UDEC.
constexpr double power_ratio = 0.5;
/// [-] Factor on its coefficient from one step to the next, and the value it starts from times the step. A hundredfold change takes 47 steps, a
/// fraction of the slowest vibration of any system of many blocks.
constexpr double adaptation = 1.1;
constexpr double first_viscous = 0.01;

/// [-] Of the skin: with less of it used up the list is kept and the way counted anew from there.
constexpr double renew_fraction = 0.5;
/// [-] Cleared links among all, a few per cent of a step, above which they are removed.
constexpr double most_cleared_share = 0.1;
/// In place of a contact's number.
constexpr int none = -1;
/// [-] Contacts are left out as too far apart until a step is this much longer than the one before that was decided.
constexpr double more_speed = 1.5;

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
  joints_ = &problem.joints;
  share_ = square(problem.method.step_fraction);
  if (depth_limits_.empty()) depth_limits_.begin(problem.system);
  room_ = 0.0;
  load_blocks(problem);
  load_elements(problem);
  load_contacts(problem);
  max_penetration_ = 0.0;
  keep();
}

void CentralDifference::renew(const StepProblem& problem, const std::vector<DetectionChange>& changes) {
  if (depth_limits_.empty()) depth_limits_.begin(problem.system);  // after a restart
  free_.clear();
  free_ends_.clear();
  for (const DetectionChange& change : changes) {
    for (int i = change.before.begin; i < change.before.end; ++i) {
      if (link_of_[i] < 0) continue;
      take_link(link_of_[i]);
      free_.push_back(link_of_[i]);
    }
    free_ends_.push_back(free_.size());
  }
  renumber(changes);
  for (std::size_t k = 0; k < changes.size(); ++k) {
    free_end_ = free_ends_[k];
    for (int i = changes[k].after.begin; i < changes[k].after.end; ++i) {
      energies_.redefinition -= problem.contacts[i].stored_energy;
      add_link(problem, i);
    }
    while (next_free_ < free_end_) clear_link(free_[next_free_++]);
  }
  next_free_ = free_end_ = 0;
  if (cleared_ > most_cleared_share * static_cast<double>(links_.size())) remove_cleared_links();
  room_ = 0.0;
  keep();
}

void CentralDifference::keep() {
  moved_ = 0.0;
  kept_at_.resize(inertia_.size());
  for (std::size_t i = 0; i < inertia_.size(); ++i) kept_at_[i] = {poses_[i].x, poses_[i].y, rates_[i].angle};
}

void CentralDifference::load_blocks(const StepProblem& problem) {
  const BlockSystem& system = problem.system;
  const std::size_t n = system.free_blocks().size();
  const std::size_t slots = n + 1 + system.resting_blocks().size();
  poses_.assign(slots, Pose());
  rates_.assign(slots, Rate());
  next_rates_.assign(slots, Rate());
  forces_.assign(slots, Rate());
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

void CentralDifference::load_elements(const StepProblem& problem) {
  elements_.clear();
  external_ = &problem.external;
  const auto& all = external_->elements();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const int slot = problem.system.block(all[i]->block()).equation;
    if (slot >= 0) elements_.push_back({static_cast<int>(i), slot, all[i]->path(problem.system, Unknowns::Zero())});
  }
}

void CentralDifference::load_contacts(const StepProblem& problem) {
  links_.clear();
  links_.reserve(problem.contacts.size());
  rest_.clear();
  rest_.reserve(problem.contacts.size());
  cleared_ = 0;
  link_of_.assign(problem.contacts.size(), -1);
  damped_ = false;
  begin_forces();
  add_element_forces(false);
  // By the skin when their pair is last passed over, by the skin until the pairs are looked at again, and by the step with which blocks leave it.
  approach_ = 2.0 * skin_ + more_speed * step_ahead_;
  list_is_short_ = false;
  critical_step_.begin(problem);
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) add_link(problem, static_cast<int>(i));
}

/// Takes a contact over, unless it is too far apart.
void CentralDifference::add_link(const StepProblem& problem, int contact) {
  const BlockSystem& system = problem.system;
  const Contact& c = problem.contacts[contact];
  const TabulatedJoint& joint = problem.joints.joint(c.joint);
  const ContactStrength strength(joint, c);
  const double normal_stiffness = joint.normal_stiffness * c.length, shear_stiffness = joint.shear_stiffness * c.length;
  const bool at_rest = c.status == ContactStatus::open && c.elastic_slip == 0.0 && c.normal_force == 0.0 && c.shear_force == 0.0;
  link_of_[contact] = -1;
  if (at_rest && !may_close(strength, normal_stiffness, c.gap, approach_)) return;

  const auto slot = [&](int b) { return system.block(b).equation >= 0 ? system.block(b).equation : rest_slot_[b]; };
  const int at_vertex = slot(c.vertex_block), at_edge = slot(c.edge_block);
  const Pose &v = poses_[at_vertex], &e = poses_[at_edge];
  const auto turned_back = [](const Pose& pose, const Vec2& r) -> Vec2 { return r + (pose.cos_minus_1 * r - pose.sin * perpendicular(r)); };
  const Vec2 arm_now = system.arm(c.vertex), arm = turned_back(v, arm_now);
  const Vec2 normal_now = -perpendicular((system.arm(system.next(c.edge)) - system.arm(c.edge)).normalized()), normal = turned_back(e, normal_now);
  const Vec2 across_now = system.position(c.vertex_block, c.vertex) - system.centroid(c.edge_block);
  const Vec2 across = across_now - (arm_now - arm) - Vec2(v.x - e.x, v.y - e.y);
  const ContactDashpots dashpots =
      joint.damping_ratio > 0.0 ? ContactDashpots(joint, c.length, system.reduced_mass(c.vertex_block, c.edge_block)) : ContactDashpots();
  damped_ |= joint.damping_ratio > 0.0;
  Link link{.arm_x = arm.x(),
            .arm_y = arm.y(),
            .across_x = across.x(),
            .across_y = across.y(),
            .normal_x = normal.x(),
            .normal_y = normal.y(),
            .loaded_gap = 0.0,
            .normal_stiffness = normal_stiffness,
            .shear_stiffness = shear_stiffness,
            .per_shear_stiffness = 1.0 / shear_stiffness,
            .normal_dashpot = dashpots.normal,
            .shear_dashpot = dashpots.shear,
            .strength = strength,
            .gap = c.stretch(),
            .slip = 0.0,
            .stretch = c.elastic_slip,
            .normal = 0.0,
            .shear = 0.0,
            .viscous_shear = 0.0,
            .crossing_energy = c.crossing_energy,
            .vertex_slot = at_vertex,
            .edge_slot = at_edge,
            .rest_gap = static_cast<float>(c.rest_gap),
            .status = c.status,
            .bonded = c.bonded,
            .breakable = !problem.keep_bonds && can_lose_strength(joint, c.bonded)};
  Place at = place(link);
  link.loaded_gap = link.gap - at.gap;
  at.gap = link.gap;
  link.slip = at.slip;
  const double elastic_normal = carry_now(link, at);
  // What the list has moved apart is open before anything moves.
  if (link.gap > link.strength.tension / link.normal_stiffness) link.status = ContactStatus::open;
  // What is found closed carries from now on, as the ledger of its renewal says, even where its dashpot outweighs the spring.
  if (link.status == ContactStatus::open && elastic_normal != 0.0) link.status = ContactStatus::sticking;
  // What its opening has shown is still to be settled.
  if (link.status == ContactStatus::open && c.status == ContactStatus::open) {
    link.normal = c.normal_force;
    link.shear = c.shear_force;
  }
  push(link, at);

  const auto share = [&](int b, int other) {
    const bool free = system.block(b).equation >= 0 && system.block(other).equation >= 0;
    return free ? 1.0 + system.block(b).mass[0] / system.block(other).mass[0] : 1.0;
  };
  const Vec2 normal_at_vertex = turned_back(v, normal_now), edge_arm = turned_back(e, across_now);
  const LinkRest rest{c.joint,
                      contact,
                      normal_at_vertex.x(),
                      normal_at_vertex.y(),
                      edge_arm.x(),
                      edge_arm.y(),
                      share(c.vertex_block, c.edge_block),
                      share(c.edge_block, c.vertex_block),
                      c.rest_gap,
                      depth_limits_.of(c.vertex_block, c.edge)};
  add_parts(link, rest, 1.0);
  if (next_free_ == free_end_) {
    link_of_[contact] = static_cast<int>(links_.size());
    links_.push_back(link);
    rest_.push_back(rest);
  } else {
    const int entry = free_[next_free_++];
    link_of_[contact] = entry;
    links_[entry] = link;
    rest_[entry] = rest;
  }
}

void CentralDifference::add_parts(const Link& link, const LinkRest& rest, double sign) {
  const int fixed_slot = static_cast<int>(inertia_.size());
  const auto part = [&](int slot, double share, const Vec2& normal, const Vec2& arm) {
    if (slot >= fixed_slot) return;
    critical_step_.add({slot, share, normal, arm, link.normal_stiffness, link.shear_stiffness, link.normal_dashpot, link.shear_dashpot}, sign);
  };
  part(link.vertex_slot, rest.vertex_share, {rest.normal_x, rest.normal_y}, {link.arm_x, link.arm_y});
  part(link.edge_slot, rest.edge_share, {link.normal_x, link.normal_y}, {rest.edge_arm_x, rest.edge_arm_y});
}

/// Takes a contact, with its force and energy, out of the sums.
void CentralDifference::take_link(int slot) {
  Link& link = links_[slot];
  energies_.redefinition += stored_energy(link);
  add_parts(link, rest_[slot], -1.0);
  const Place at = place(link);
  link.normal = -link.normal;
  link.shear = -link.shear;
  push(link, at);
}

void CentralDifference::renumber(const std::vector<DetectionChange>& changes) {
  const bool moved = std::any_of(changes.begin(), changes.end(),
                                 [](const DetectionChange& c) { return c.before.begin != c.after.begin || c.before.end != c.after.end; });
  if (!moved) return;
  renumbered_.clear();
  int done = 0;
  const auto carry_on_to = [&](int end) { renumbered_.insert(renumbered_.end(), link_of_.begin() + done, link_of_.begin() + end); };
  for (const DetectionChange& change : changes) {
    carry_on_to(change.before.begin);
    renumbered_.resize(renumbered_.size() + change.after.size(), -1);
    done = change.before.end;
  }
  carry_on_to(static_cast<int>(link_of_.size()));
  link_of_.swap(renumbered_);
  for (std::size_t i = 0; i < link_of_.size(); ++i) {
    if (link_of_[i] >= 0) rest_[link_of_[i]].contact = static_cast<int>(i);
  }
}

/// Leaves an open contact between fixed blocks there. Links are never moved into what others leave: the order in which the forces on a block are
/// added up depends on its own contacts alone, and so do its last digits.
void CentralDifference::clear_link(int entry) {
  const int fixed_slot = static_cast<int>(inertia_.size());
  Link& link = links_[entry];
  link.vertex_slot = link.edge_slot = fixed_slot;
  link.loaded_gap = link.gap = 1.0;
  link.slip = link.stretch = link.normal = link.shear = link.viscous_shear = link.crossing_energy = 0.0;
  link.strength = ContactStrength();
  link.status = ContactStatus::open;
  link.breakable = false;
  rest_[entry].contact = none;
  ++cleared_;
}

void CentralDifference::remove_cleared_links() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (rest_[i].contact == none) continue;
    links_[kept] = links_[i];
    rest_[kept] = rest_[i];
    link_of_[rest_[kept].contact] = static_cast<int>(kept);
    ++kept;
  }
  links_.resize(kept);
  rest_.resize(kept);
  cleared_ = 0;
}

/// [J] In the springs of a contact; the shear spring of one that has just opened lets go in the next step.
double CentralDifference::stored_energy(const Link& link) {
  const double closure = link.status == ContactStatus::open ? 0.0 : link.gap;
  return 0.5 * (link.normal_stiffness * closure * closure + link.shear_stiffness * link.stretch * link.stretch) - link.crossing_energy;
}

CentralDifference::Place CentralDifference::place(const Link& link) const {
  const Pose& v = poses_[link.vertex_slot];
  const Pose& e = poses_[link.edge_slot];
  const double turned_x = v.cos_minus_1 * link.arm_x - v.sin * link.arm_y, turned_y = v.cos_minus_1 * link.arm_y + v.sin * link.arm_x;
  const double dx = v.x - e.x + turned_x, dy = v.y - e.y + turned_y;
  const double change_x = e.cos_minus_1 * link.normal_x - e.sin * link.normal_y, change_y = e.cos_minus_1 * link.normal_y + e.sin * link.normal_x;
  const double nx = link.normal_x + change_x, ny = link.normal_y + change_y;
  return {link.loaded_gap + (change_x * link.across_x + change_y * link.across_y + (nx * dx + ny * dy)),
          change_x * link.across_y - change_y * link.across_x + (nx * dy - ny * dx),
          nx,
          ny,
          link.arm_x + turned_x,
          link.arm_y + turned_y,
          link.across_x + dx,
          link.across_y + dy};
}

ForceTrials CentralDifference::trials(const Link& link, const Place& at, double elastic_shear) const {
  const Rate& v = rates_[link.vertex_slot];
  const Rate& e = rates_[link.edge_slot];
  const double x = (v.x - v.turn * at.arm_y) - (e.x - e.turn * at.across_y), y = (v.y + v.turn * at.arm_x) - (e.y + e.turn * at.across_x);
  return {-link.normal_stiffness * at.gap, -link.normal_dashpot * (at.normal_x * x + at.normal_y * y), elastic_shear,
          -link.shear_dashpot * (at.normal_x * y - at.normal_y * x)};
}

/// The forces with which the next step starts, from the memory of the contact; the memory stays.
double CentralDifference::carry_now(Link& link, const Place& at) {
  const CarriedForces f = carry(link.strength, trials(link, at, -link.shear_stiffness * link.stretch));
  link.normal = f.normal;
  link.shear = f.shear;
  link.viscous_shear = f.shear - f.elastic_shear;
  return f.elastic_normal;
}

void CentralDifference::push(const Link& link, const Place& at) {
  const double x = link.normal * at.normal_x - link.shear * at.normal_y, y = link.normal * at.normal_y + link.shear * at.normal_x;
  Rate& v = forces_[link.vertex_slot];
  v.x += x;
  v.y += y;
  v.turn += at.arm_x * y - at.arm_y * x;
  Rate& e = forces_[link.edge_slot];
  e.x -= x;
  e.y -= y;
  e.turn -= at.across_x * y - at.across_y * x;
}

void CentralDifference::begin_forces() {
  for (std::size_t i = 0; i < inertia_.size(); ++i) forces_[i] = {inertia_[i].weight_x, inertia_[i].weight_y, 0.0, 0.0};
  std::fill(forces_.begin() + static_cast<std::ptrdiff_t>(inertia_.size()), forces_.end(), Rate());
}

void CentralDifference::add_element_forces(bool step) {
  for (ElementWay& way : elements_) {
    const ForceElement& element = *external_->elements()[way.element];
    const Pose& pose = poses_[way.slot];
    const ElementPath before = way.path;
    way.path.d = {pose.x, pose.y, rates_[way.slot].angle};
    for (std::size_t i = 0; i < element.points().size(); ++i) {
      PointPath& p = way.path.points[i];
      const Vec2 turned = pose.cos_minus_1 * p.arm + pose.sin * perpendicular(p.arm);
      p.moved = Vec2(pose.x, pose.y) + turned;
      p.end_arm = p.arm + turned;
    }
    const Unknowns force = element.force(way.path);
    forces_[way.slot].x += force[0];
    forces_[way.slot].y += force[1];
    forces_[way.slot].turn += force[2];
    if (!step) continue;
    const double change = element.energy_change(rest_of_way(before, way.path));
    (element.account() == ForceAccount::loads ? energies_.loads : energies_.support_springs) += change;
    energies_.scheme -= change;
    if (element.account() == ForceAccount::loads) energies_.turnover += std::abs(change);
  }
}

Move CentralDifference::move(double h, double span, const Vec2& base, double limit, double fast_step, MassDamping damping, double local_damping) {
  const std::size_t n = inertia_.size();
  const double alpha = damping == MassDamping::local ? local_damping : 0.0;
  if (damping != MassDamping::automatic) viscous_ = 0.0;
  if (damping == MassDamping::automatic && viscous_ == 0.0) viscous_ = first_viscous / h;
  const double keep = 1.0 - 0.5 * viscous_ * span, per_viscous = 1.0 / (1.0 + 0.5 * viscous_ * span);
  const auto damped = [alpha](double force, double velocity) { return locally_damped(force, velocity, alpha); };
  double fastest = 0.0, unbalanced = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Inertia& m = inertia_[i];
    const Rate &f = forces_[i], &v = rates_[i];
    Rate& next = next_rates_[i];
    next.x = (keep * v.x + span * (damped(f.x - m.mass * base.x(), v.x) * m.per_mass)) * per_viscous;
    next.y = (keep * v.y + span * (damped(f.y - m.mass * base.y(), v.y) * m.per_mass)) * per_viscous;
    next.turn = m.turns * (keep * v.turn + span * (damped(f.turn, v.turn) * m.per_moment)) * per_viscous;
    // (a + b)^2 <= 2 (a^2 + b^2) for the speed of the centroid and of the farthest point around it.
    fastest = larger_or_nan(fastest, next.x * next.x + next.y * next.y + square(next.turn * m.radius));
    unbalanced = std::max(unbalanced, force_squared(i));
  }
  const double farthest = h * std::sqrt(2.0 * fastest);
  if (!(farthest <= limit)) return Move::too_far;
  step_ahead_ = 2.0 * farthest;  // two blocks that move against each other
  list_is_short_ = 2.0 * skin_ + step_ahead_ > approach_;
  if (list_is_short_) return Move::past_list;
  if (is_fast() && h > fast_step) return Move::too_fast;
  const double before = 2.0 * span - h;
  if (alpha == 0.0 && viscous_ == 0.0 && std::abs(h - before) > tolerance::rounding_of_times * h) book_step_change(before, h, base);
  moved_ += step_ahead_;
  room_ -= step_ahead_;
  unbalanced_ = unbalanced;

  ExplicitEnergies sum;
  double kinetic_change = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Inertia& m = inertia_[i];
    const Rate &force = forces_[i], &v = rates_[i];
    const Rate f{force.x - m.mass * base.x(), force.y - m.mass * base.y(), force.turn, 0.0};
    Rate& next = next_rates_[i];
    const double mean_x = 0.5 * (v.x + next.x), mean_y = 0.5 * (v.y + next.y), mean_turn = 0.5 * (v.turn + next.turn);
    const double gravity = span * (m.weight_x * mean_x + m.weight_y * mean_y);
    const double by_base = -span * m.mass * (base.x() * mean_x + base.y() * mean_y);
    const double work = span * (f.x * mean_x + f.y * mean_y + f.turn * mean_turn);
    const double kinetic = m.mass * ((next.x - v.x) * mean_x + (next.y - v.y) * mean_y) + m.moment * (next.turn - v.turn) * mean_turn;
    if (alpha > 0.0) {
      sum.mass_damping +=
          span * alpha * (std::abs(f.x) * sign(v.x) * mean_x + std::abs(f.y) * sign(v.y) * mean_y + std::abs(f.turn) * sign(v.turn) * mean_turn);
    } else if (viscous_ > 0.0) {
      sum.mass_damping += span * viscous_ * (m.mass * (mean_x * mean_x + mean_y * mean_y) + m.moment * mean_turn * mean_turn);
    }
    sum.gravity -= gravity;
    sum.base_motion -= by_base;
    sum.scheme -= work - gravity - by_base;
    sum.turnover += std::abs(kinetic) + std::abs(gravity) + std::abs(by_base);
    kinetic_change += kinetic;
    Pose& pose = poses_[i];
    pose.x += h * next.x;
    pose.y += h * next.y;
    next.angle = v.angle + h * next.turn;
    const double a = next.angle, q = a * a;
    if (std::abs(a) < small_angle) {
      pose.sin = a * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0)));
      pose.cos_minus_1 = -0.5 * q * (1.0 - q / 12.0 * (1.0 - q / 30.0));
    } else {
      pose.sin = std::sin(a);
      pose.cos_minus_1 = -2.0 * square(std::sin(0.5 * a));
    }
  }
  energies_.gravity += sum.gravity;
  energies_.base_motion += sum.base_motion;
  energies_.scheme += sum.scheme;
  energies_.mass_damping += sum.mass_damping;
  energies_.turnover += sum.turnover;
  if (viscous_ > 0.0) adapt(sum.mass_damping, kinetic_change, h);
  rates_.swap(next_rates_);
  h_ = h;
  base_ = base;
  local_damping_ = alpha;
  return Move::taken;
}

void CentralDifference::adapt(double taken, double kinetic_change, double h) {
  viscous_ *= taken < power_ratio * std::abs(kinetic_change) ? adaptation : 1.0 / adaptation;
  // Critical damping of the fastest motion a step can follow, and a trace from which it can grow again.
  viscous_ = std::clamp(viscous_, 1e-3 * first_viscous / h, 1.0 / h);
}

void CentralDifference::follow_contacts() {
  begin_forces();
  add_element_forces(true);
  lost_strength_ = false;
  follow_links(damped_);
}

template <bool damped>
void CentralDifference::follow_link(Link& link, LinkSums& sums) {
  const Place at = place(link);
  if (rests(link) && openclose::is_open(link.strength, -link.normal_stiffness * at.gap)) {
    link.gap = at.gap;
    link.slip = at.slip;
    return;
  }
  const double gap_change = at.gap - link.gap, slip = at.slip - link.slip;
  const double memory = -link.shear_stiffness * (link.stretch + slip);
  CarriedForces f;
  if constexpr (damped) {
    f = carry(link.strength, trials(link, at, memory));
  } else {
    f = carry(link.strength, {-link.normal_stiffness * at.gap, 0.0, memory, 0.0});
  }
  const bool was_open = link.status == ContactStatus::open, opened = f.status == ContactStatus::open;
  const double normal_before = was_open ? 0.0 : link.normal,
               shear_before = was_open ? 0.0 : link.shear;  // what settles an opening is no joint's force
  double settled_shear = f.shear;
  if (was_open != opened || (was_open && (link.normal != 0.0 || link.shear != 0.0))) {
    settle_crossing(link, {normal_before, shear_before, at.gap, slip, opened}, f.normal, settled_shear, sums.scheme);
  }
  // The step's forces were those at its start, but for what settles an opening; see the ledger for the formulas, with theta = 0.
  const double stretch = -f.elastic_shear * link.per_shear_stiffness;
  const double stretched = stretch - link.stretch, opening = opened ? at.gap : 0.0;
  const double closing = -gap_change + (opening - (was_open ? link.gap : 0.0));
  sums.scheme += normal_before * gap_change + shear_before * slip - normal_before * opening -
                 0.5 * (link.normal_stiffness * closing * closing + link.shear_stiffness * stretched * stretched) -
                 (shear_before - link.viscous_shear + link.shear_stiffness * link.stretch) * stretched;
  // What rubs in the step is the mean force: so the work of central difference is summed by parts.
  const double rubbed = std::max(0.0, -0.5 * (shear_before + f.shear) * (slip - stretched));
  sums.friction += rubbed;
  sums.scheme -= rubbed + shear_before * (slip - stretched);
  if constexpr (damped)
    sums.damping += (normal_before - (was_open ? 0.0 : -link.normal_stiffness * link.gap)) * closing - link.viscous_shear * stretched;
  link.gap = at.gap;
  link.slip = at.slip;
  link.stretch = stretch;
  link.status = f.status;
  link.normal = f.normal;
  link.shear = settled_shear;
  if constexpr (damped) link.viscous_shear = f.shear - f.elastic_shear;
  if (f.status != ContactStatus::open) sums.deepest = std::max(sums.deepest, -at.gap - link.rest_gap);
  if (link.breakable) lose_strength(link, joints_->joint(rest_[&link - links_.data()].joint), at);
  push(link, at);
}

template <bool damped>
bool CentralDifference::follow_four(Link* links, LinkSums& sums) {
  const Lanes zero{};
  const auto fetch = [](const double*(&from)[batch_size], Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
    a = lanes::load(from[0]);
    b = lanes::load(from[1]);
    c = lanes::load(from[2]);
    d = lanes::load(from[3]);
    transpose(a, b, c, d);
  };
  const auto fetch_links = [&](double Link::*first, Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
    const double* from[] = {&(links[0].*first), &(links[1].*first), &(links[2].*first), &(links[3].*first)};
    fetch(from, a, b, c, d);
  };
  const auto fetch_blocks = [&](const auto& list, auto first, int Link::*slot, Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
    const double* from[] = {&(list[links[0].*slot].*first), &(list[links[1].*slot].*first), &(list[links[2].*slot].*first),
                            &(list[links[3].*slot].*first)};
    fetch(from, a, b, c, d);
  };
  Lanes arm_x, arm_y, across_x, across_y, normal_x, normal_y, loaded_gap, kn, ks, per_ks, normal_dashpot, shear_dashpot;
  fetch_links(&Link::arm_x, arm_x, arm_y, across_x, across_y);
  fetch_links(&Link::normal_x, normal_x, normal_y, loaded_gap, kn);
  fetch_links(&Link::shear_stiffness, ks, per_ks, normal_dashpot, shear_dashpot);
  Lanes vx, vy, v_cos_minus_1, v_sin, ex, ey, e_cos_minus_1, e_sin;
  fetch_blocks(poses_, &Pose::x, &Link::vertex_slot, vx, vy, v_cos_minus_1, v_sin);
  fetch_blocks(poses_, &Pose::x, &Link::edge_slot, ex, ey, e_cos_minus_1, e_sin);

  // As place().
  const Lanes turned_x = v_cos_minus_1 * arm_x - v_sin * arm_y, turned_y = v_cos_minus_1 * arm_y + v_sin * arm_x;
  const Lanes dx = vx - ex + turned_x, dy = vy - ey + turned_y;
  const Lanes change_x = e_cos_minus_1 * normal_x - e_sin * normal_y, change_y = e_cos_minus_1 * normal_y + e_sin * normal_x;
  const Lanes nx = normal_x + change_x, ny = normal_y + change_y;
  const Lanes gap = loaded_gap + (change_x * across_x + change_y * across_y + (nx * dx + ny * dy));
  const Lanes all_slip = change_x * across_y - change_y * across_x + (nx * dy - ny * dx);
  const Lanes now_arm_x = arm_x + turned_x, now_arm_y = arm_y + turned_y, now_across_x = across_x + dx, now_across_y = across_y + dy;

  Lanes friction, cohesion, tension, gap_before, slip_before, stretch_before, normal_before, shear_before;
  const double* strength[] = {&links[0].strength.friction, &links[1].strength.friction, &links[2].strength.friction, &links[3].strength.friction};
  fetch(strength, friction, cohesion, tension, gap_before);
  fetch_links(&Link::slip, slip_before, stretch_before, normal_before, shear_before);
  const Lanes viscous_shear_before{links[0].viscous_shear, links[1].viscous_shear, links[2].viscous_shear, links[3].viscous_shear};
  Mask was_open{}, breakable{};
  for (int k = 0; k < batch_size; ++k) {
    was_open[k] = links[k].status == ContactStatus::open ? -1 : 0;
    breakable[k] = links[k].breakable ? -1 : 0;
  }

  const Mask settles = was_open & ((normal_before != 0.0) | (shear_before != 0.0));
  normal_before = was_open ? zero : normal_before;  // what settles an opening is no joint's force
  shear_before = was_open ? zero : shear_before;

  // As trials(), and carry() for four.
  const Lanes gap_change = gap - gap_before, slip = all_slip - slip_before;
  const Lanes elastic_normal = -kn * gap, memory = -ks * (stretch_before + slip);
  Lanes viscous_normal = zero, viscous_shear = zero;
  if constexpr (damped) {
    Lanes v_rate_x, v_rate_y, v_turn, e_rate_x, e_rate_y, e_turn, angle;
    fetch_blocks(rates_, &Rate::x, &Link::vertex_slot, v_rate_x, v_rate_y, v_turn, angle);
    fetch_blocks(rates_, &Rate::x, &Link::edge_slot, e_rate_x, e_rate_y, e_turn, angle);
    const Lanes x = (v_rate_x - v_turn * now_arm_y) - (e_rate_x - e_turn * now_across_y),
                y = (v_rate_y + v_turn * now_arm_x) - (e_rate_y + e_turn * now_across_x);
    viscous_normal = -normal_dashpot * (nx * x + ny * y);
    viscous_shear = -shear_dashpot * (nx * y - ny * x);
  }
  const Mask closed = ~spring_is_open(tension, elastic_normal);
  const MohrCoulomb carried(friction, cohesion, tension, elastic_normal + viscous_normal, memory + viscous_shear, tolerance::cohesion_ramp);
  const Mask sticking = closed & carried.is_sticking;
  if (any(breakable & ~sticking)) return false;
  Lanes normal = closed ? carried.normal : zero;
  const Lanes shear = closed ? carried.shear : zero;
  const Lanes elastic_shear = closed ? carried.limit.of(memory) : zero;

  // Few do so in a step: one by one.
  const Mask crosses = (was_open ^ ~closed) | settles;
  Lanes settled_shear = shear;
  double settled[batch_size] = {};
  if (any(crosses)) {
    for (int k = 0; k < batch_size; ++k) {
      if (!crosses[k]) continue;
      double n = normal[k], t = settled_shear[k];
      settle_crossing(links[k], {normal_before[k], shear_before[k], gap[k], slip[k], !closed[k]}, n, t, settled[k]);
      normal[k] = n;
      settled_shear[k] = t;
    }
  }

  // The step's forces were those at its start; see follow_link().
  const Lanes stretch = -elastic_shear * per_ks;
  const Lanes stretched = stretch - stretch_before, opening = closed ? zero : gap;
  const Lanes closing = -gap_change + (opening - (was_open ? gap_before : zero));
  const Lanes scheme = normal_before * gap_change + shear_before * slip - normal_before * opening -
                       0.5 * (kn * closing * closing + ks * stretched * stretched) -
                       (shear_before - viscous_shear_before + ks * stretch_before) * stretched;
  const Lanes rubbed = larger(zero, -0.5 * (shear_before + shear) * (slip - stretched)), not_yet = rubbed + shear_before * (slip - stretched);
  const Lanes rest_gap{links[0].rest_gap, links[1].rest_gap, links[2].rest_gap, links[3].rest_gap}, depth = closed ? -gap - rest_gap : zero;
  for (int k = 0; k < batch_size; ++k) {
    sums.friction += rubbed[k];
    sums.scheme += settled[k];
    sums.scheme += scheme[k];
    sums.scheme -= not_yet[k];
    sums.deepest = std::max(sums.deepest, depth[k]);
  }
  if constexpr (damped) {
    const Lanes elastic_before = was_open ? zero : -kn * gap_before;
    const Lanes damping = (normal_before - elastic_before) * closing - viscous_shear_before * stretched;
    const Lanes kept_shear = shear - elastic_shear;
    for (int k = 0; k < batch_size; ++k) {
      sums.damping += damping[k];
      links[k].viscous_shear = kept_shear[k];
    }
  }

  const Lanes x = normal * nx - settled_shear * ny, y = normal * ny + settled_shear * nx;
  const Lanes on_vertex = now_arm_x * y - now_arm_y * x, on_edge = now_across_x * y - now_across_y * x;
  Lanes history[] = {all_slip, stretch, normal, settled_shear}, forward[] = {x, y, on_vertex, zero}, back[] = {x, y, on_edge, zero};
  transpose(history[0], history[1], history[2], history[3]);
  transpose(forward[0], forward[1], forward[2], forward[3]);
  transpose(back[0], back[1], back[2], back[3]);
  for (int k = 0; k < batch_size; ++k) {
    Link& link = links[k];
    link.gap = gap[k];
    store(&link.slip, history[k]);
    link.status = !closed[k] ? ContactStatus::open : (sticking[k] ? ContactStatus::sticking : ContactStatus::sliding);
    double* const v = &forces_[link.vertex_slot].x;
    store(v, lanes::load(v) + forward[k]);
    double* const e = &forces_[link.edge_slot].x;
    store(e, lanes::load(e) - back[k]);
  }
  return true;
}

template <bool damped>
void CentralDifference::follow_all(LinkSums& sums) {
  const std::size_t fours = fours_ ? links_.size() / batch_size * batch_size : 0;
  for (std::size_t i = 0; i < links_.size(); i += batch_size) {
    if (i < fours && follow_four<damped>(&links_[i], sums)) continue;
    for (std::size_t k = i; k < std::min(i + batch_size, links_.size()); ++k) follow_link<damped>(links_[k], sums);
  }
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void CentralDifference::follow_damped(LinkSums& sums) {
  follow_all<true>(sums);
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void CentralDifference::follow_undamped(LinkSums& sums) {
  follow_all<false>(sums);
}

void CentralDifference::follow_links(bool damped) {
  LinkSums sums{0.0, 0.0, 0.0, max_penetration_};
  damped ? follow_damped(sums) : follow_undamped(sums);
  energies_.friction += sums.friction;
  energies_.contact_damping += sums.damping;
  energies_.scheme += sums.scheme;
  max_penetration_ = sums.deepest;
}

/// Of a contact that closes or opens, or has opened in the last step: the forces that settle its crossing, see crossing_energy.h, instead of none.
/// What a dashpot takes is not given back.
[[gnu::noinline]] void CentralDifference::settle_crossing(Link& link, const Crossing& crossing, double& normal, double& shear, double& scheme) {
  const double before = link.crossing_energy;
  const bool was_open = link.status == ContactStatus::open;
  link.crossing_energy = 0.0;
  if (link.strength.tension == 0.0 && was_open && !crossing.is_open) {
    link.crossing_energy = closing_energy(link.normal_stiffness, link.gap, crossing.gap);
  } else if (link.strength.tension == 0.0 && !was_open && crossing.is_open) {
    const double energy = before + 0.5 * std::min(crossing.normal_before, -link.normal_stiffness * link.gap) * crossing.gap;
    const Opening opening = settled(energy, link.normal_stiffness, crossing.gap - link.gap, link.shear_stiffness, crossing.slip, link.stretch,
                                    crossing.shear_before, share_);
    normal = opening.normal;
    shear = opening.shear;
    link.crossing_energy = opening.energy;
  }
  scheme += link.crossing_energy - before;
}

void CentralDifference::book_step_change(double before, double now, const Vec2& base) {
  const double factor = 0.125 * (before * before - now * now);
  const auto acceleration = [&](int slot) -> Rate {
    if (slot >= static_cast<int>(inertia_.size())) return {};
    const Inertia& m = inertia_[slot];
    const Rate& f = forces_[slot];
    return {f.x * m.per_mass - base.x(), f.y * m.per_mass - base.y(), m.turns * f.turn * m.per_moment, 0.0};
  };
  for (Link& link : links_) {
    if (link.status == ContactStatus::open || link.strength.tension > 0.0) continue;
    const Place at = place(link);
    const Rate v = acceleration(link.vertex_slot), e = acceleration(link.edge_slot);
    const double x = (v.x - v.turn * at.arm_y) - (e.x - e.turn * at.across_y), y = (v.y + v.turn * at.arm_x) - (e.y + e.turn * at.across_x);
    const double gained = factor * (link.normal * (at.normal_x * x + at.normal_y * y) + link.shear * (at.normal_x * y - at.normal_y * x));
    link.crossing_energy += gained;
    energies_.scheme += gained;
  }
}

void CentralDifference::lose_strength(Link& link, const TabulatedJoint& joint, const Place& at) {
  if (stays_bonded(joint, true, link.status)) return;
  lost_strength_ = true;
  link.bonded = link.breakable = false;
  link.strength.break_bond(joint);
  carry_now(link, at);
  if (at.gap <= 0.0 || link.status == ContactStatus::open) return;
  // It slipped while it was pulling: nothing pulls any more.
  link.status = ContactStatus::open;
  energies_.redefinition += 0.5 * link.normal_stiffness * square(at.gap);
}

std::optional<CentralDifference::TooDeep> CentralDifference::too_deep() {
  if (room_ > 0.0) return std::nullopt;
  room_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const double depth = links_[i].status == ContactStatus::open ? 0.0 : -links_[i].gap - rest_[i].rest_gap, limit = rest_[i].depth_limit;
    if (depth > limit) return TooDeep{rest_[i].contact, depth, limit};
    room_ = std::min(room_, limit - depth);
  }
  return std::nullopt;
}

bool CentralDifference::moved_beyond_skin() {
  if (moved_ <= skin_) return false;
  // The way may have been longer than where it has led to.
  double farthest = 0.0;
  for (std::size_t i = 0; i < inertia_.size(); ++i) {
    const Way& from = kept_at_[i];
    farthest = std::max(farthest, std::sqrt(square(poses_[i].x - from.x) + square(poses_[i].y - from.y)) +
                                      inertia_[i].radius * std::abs(rates_[i].angle - from.angle));
  }
  moved_ = 2.0 * farthest;
  return moved_ > renew_fraction * skin_;
}

double CentralDifference::last_unbalanced_force() const {
  return std::sqrt(unbalanced_);
}

double CentralDifference::unbalanced_force() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < inertia_.size(); ++i) largest = std::max(largest, force_squared(i));
  return std::sqrt(largest);
}

double CentralDifference::force_squared(std::size_t i) const {
  const Rate& f = forces_[i];
  return std::max(f.x * f.x + f.y * f.y, square(inertia_[i].turns * f.turn / inertia_[i].radius));
}

CentralDifference::Unknowns CentralDifference::velocity_at_end(int equation) const {
  const Inertia& m = inertia_[equation];
  const Rate &f = forces_[equation], &v = rates_[equation];
  const double half = 0.5 * h_;
  const auto ahead = [&](double force, double velocity, double per_mass) {
    return velocity + half * (locally_damped(force, velocity, local_damping_) * per_mass - viscous_ * velocity);
  };
  return {ahead(f.x - m.mass * base_.x(), v.x, m.per_mass), ahead(f.y - m.mass * base_.y(), v.y, m.per_mass),
          m.turns * ahead(f.turn, v.turn, m.per_moment)};
}

void CentralDifference::rest_forces(std::vector<Unknowns>& forces) const {
  const std::size_t first = inertia_.size() + 1;
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = {forces_[first + i].x, forces_[first + i].y, forces_[first + i].turn};
}

void CentralDifference::store_blocks(BlockSystem& system) const {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Pose& pose = poses_[i];
    const Rate& v = rates_[i];
    system.move_to(blocks_[i], loaded_at_[i] + Unknowns(pose.x, pose.y, v.angle));
    system.set_velocity(blocks_[i], {v.x, v.y, v.turn});
  }
}

void CentralDifference::store_contacts(std::vector<Contact>& contacts) const {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (rest_[i].contact == none) continue;
    const Link& link = links_[i];
    Contact& c = contacts[rest_[i].contact];
    c.gap = link.gap + rest_[i].rest_gap;
    c.status = link.status;
    c.bonded = link.bonded;
    c.elastic_slip = link.stretch;
    c.normal_force = link.normal;
    c.shear_force = link.shear;
    c.crossing_energy = link.crossing_energy;
    c.stored_energy = stored_energy(link);
  }
}

void CentralDifference::store_far_gaps(const BlockSystem& system, std::vector<Contact>& contacts) const {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (link_of_[i] >= 0) continue;
    Contact& c = contacts[i];
    const Vec2 normal = -perpendicular((system.arm(system.next(c.edge)) - system.arm(c.edge)).normalized());
    c.gap = normal.dot(system.position(c.vertex_block, c.vertex) - system.position(c.edge_block, c.edge));
    c.rest_gap = std::min(c.rest_gap, c.gap);  // it has carried nothing
  }
}

double CentralDifference::kinetic_ahead() const {
  double power = 0.0;
  for (std::size_t i = 0; i < inertia_.size(); ++i) {
    const Inertia& m = inertia_[i];
    const Rate &f = forces_[i], &v = rates_[i];
    power += (f.x - m.weight_x) * v.x + (f.y - m.weight_y) * v.y + f.turn * v.turn;
  }
  return 0.5 * h_ * power;
}

ExplicitEnergies CentralDifference::take_energies() {
  const ExplicitEnergies taken = energies_;
  energies_ = ExplicitEnergies();
  return taken;
}

void CentralDifference::exchange(Archive& archive, const JointTable& joints, const ExternalForces& external) {
  joints_ = &joints;
  external_ = &external;
  archive(poses_, rates_, next_rates_, forces_, inertia_, blocks_, rest_slot_, loaded_at_, links_, rest_, link_of_, cleared_, kept_at_, elements_,
          energies_, damped_, lost_strength_, critical_step_, approach_, moved_, unbalanced_, max_penetration_, step_ahead_, list_is_short_, share_,
          room_, h_, base_, local_damping_, viscous_);
}

Memory CentralDifference::memory() const {
  Memory of;
  of.blocks = bytes_of(poses_, rates_, next_rates_, forces_, inertia_, blocks_, rest_slot_, loaded_at_, kept_at_, elements_) +
              critical_step_.bytes() + depth_limits_.bytes();
  of.contacts = bytes_of(links_, rest_, link_of_, renumbered_);
  return of;
}

}  // namespace openclose
