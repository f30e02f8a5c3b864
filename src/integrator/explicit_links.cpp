#include "openclose/integrator/explicit_links.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

double square(double x) {
  return x * x;
}

/// [-] No shear force of a contact that carries anything reaches this times its normal force, and no load makes so much of its tensile strength.
constexpr double endless = 1e9;

ContactStrength strength_of(const TabulatedJoint& joint, const Contact& contact, Bonds bonds) {
  ContactStrength strength(joint, contact);
  if (bonds == Bonds::last_without_slip) strength.friction = endless;
  if (bonds == Bonds::last_unparted) strength.tension *= endless;
  return strength;
}

/// As it was at the load.
Vec2 turned_back(const ExplicitPose& pose, const Vec2& r) {
  return r + (pose.cos_minus_1 * r - pose.sin * perpendicular(r));
}

}  // namespace

void ExplicitLinks::load(const StepProblem& problem, double approach) {
  joints_ = &problem.joints;
  share_ = square(problem.method.step_fraction);
  if (depth_limits_.empty()) depth_limits_.begin(problem.system);
  room_ = 0.0;
  approach_ = approach;
  links_.clear();
  links_.reserve(problem.contacts.size() + batch_size);
  rest_.clear();
  rest_.reserve(problem.contacts.size() + batch_size);
  link_of_.assign(problem.contacts.size(), -1);
  damped_ = false;
  critical_step_.begin(problem);
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) add(problem, static_cast<int>(i));
  close_ranks();
  max_penetration_ = 0.0;
}

void ExplicitLinks::renew(const StepProblem& problem, const std::vector<DetectionChange>& changes) {
  if (depth_limits_.empty()) depth_limits_.begin(problem.system);  // after a restart
  free_.clear();
  free_ends_.clear();
  for (const DetectionChange& change : changes) {
    for (int i = change.before.begin; i < change.before.end; ++i) {
      if (link_of_[i] < 0) continue;
      take(link_of_[i]);
      free_.push_back(link_of_[i]);
    }
    free_ends_.push_back(free_.size());
  }
  renumber(changes);
  for (std::size_t k = 0; k < changes.size(); ++k) {
    free_end_ = free_ends_[k];
    for (int i = changes[k].after.begin; i < changes[k].after.end; ++i) {
      energies_.redefinition -= problem.contacts[i].stored_energy;
      add(problem, i);
    }
    while (next_free_ < free_end_) rest_[free_[next_free_++]].contact = -1;
  }
  next_free_ = free_end_ = 0;
  close_ranks();
  room_ = 0.0;
}

/// Takes a contact over, unless it is too far apart.
void ExplicitLinks::add(const StepProblem& problem, int contact) {
  const Contact& c = problem.contacts[contact];
  const TabulatedJoint& joint = problem.joints.joint(c.joint);
  const bool at_rest = c.status == ContactStatus::open && c.elastic_slip == 0.0 && c.normal_force == 0.0 && c.shear_force == 0.0;
  link_of_[contact] = -1;
  if (at_rest && !may_close(ContactStrength(joint, c), JointSprings(joint, c.length).normal, c.gap, approach_)) return;

  damped_ |= joint.damping_ratio > 0.0;
  const auto [link, rest] = make(problem, contact);
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

/// With its forces added to those of the blocks.
std::pair<ExplicitLinks::Link, ExplicitLinks::LinkRest> ExplicitLinks::make(const StepProblem& problem, int contact) {
  const BlockSystem& system = problem.system;
  const Contact& c = problem.contacts[contact];
  const TabulatedJoint& joint = problem.joints.joint(c.joint);
  const int at_vertex = blocks_.slot(system, c.vertex_block), at_edge = blocks_.slot(system, c.edge_block);
  const ExplicitPose &v = blocks_.pose(at_vertex), &e = blocks_.pose(at_edge);
  const Vec2 arm_now = system.arm(c.vertex), arm = turned_back(v, arm_now);
  const Vec2 normal_now = -perpendicular((system.arm(system.next(c.edge)) - system.arm(c.edge)).normalized()), normal = turned_back(e, normal_now);
  const Vec2 across_now = system.position(c.vertex_block, c.vertex) - system.centroid(c.edge_block);
  const Vec2 across = across_now - (arm_now - arm) - Vec2(v.x - e.x, v.y - e.y);
  const ContactDashpots dashpots =
      joint.damping_ratio > 0.0 ? ContactDashpots(joint, c.length, system.reduced_mass(c.vertex_block, c.edge_block)) : ContactDashpots();
  const JointSprings own(joint, c.length);
  Link link{.arm_x = arm.x(),
            .arm_y = arm.y(),
            .across_x = across.x(),
            .across_y = across.y(),
            .normal_x = normal.x(),
            .normal_y = normal.y(),
            .loaded_gap = 0.0,
            .normal_stiffness = own.normal,
            .shear_stiffness = own.shear,
            .per_shear_stiffness = 1.0 / own.shear,
            .normal_dashpot = dashpots.normal,
            .shear_dashpot = dashpots.shear,
            .strength = strength_of(joint, c, problem.bonds),
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
            .breakable = problem.bonds == Bonds::break_under_load && can_lose_strength(joint, c.joint_state)};
  begin_forces(link, c);

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
                      depth_limits_.of(c.vertex_block, c.edge),
                      c.length,
                      c.joint_state};
  return {link, rest};
}

/// What a contact carries now, from its memory.
void ExplicitLinks::begin_forces(Link& link, const Contact& contact) {
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
  if (link.status == ContactStatus::open && contact.status == ContactStatus::open) {
    link.normal = contact.normal_force;
    link.shear = contact.shear_force;
  }
  push(link, at);
}

void ExplicitLinks::add_parts(const Link& link, const LinkRest& rest, double sign) {
  const int fixed_slot = blocks_.fixed_slot();
  const auto part = [&](int slot, double share, const Vec2& normal, const Vec2& arm) {
    if (slot >= fixed_slot) return;
    critical_step_.add({slot, share, normal, arm, link.normal_stiffness, link.shear_stiffness, link.normal_dashpot, link.shear_dashpot}, sign);
  };
  part(link.vertex_slot, rest.vertex_share, {rest.normal_x, rest.normal_y}, {link.arm_x, link.arm_y});
  part(link.edge_slot, rest.edge_share, {link.normal_x, link.normal_y}, {rest.edge_arm_x, rest.edge_arm_y});
}

/// Takes a contact, with its force and energy, out of the sums.
void ExplicitLinks::take(int slot) {
  Link& link = links_[slot];
  energies_.redefinition += stored_energy(link);
  add_parts(link, rest_[slot], -1.0);
  const Place at = place(link);
  link.normal = -link.normal;
  link.shear = -link.shear;
  push(link, at);
}

void ExplicitLinks::renumber(const std::vector<DetectionChange>& changes) {
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

/// Takes out the links of contacts that are gone, and fills up the last four with open ones between fixed blocks. Links stay in their order: that in
/// which the forces on a block are added up depends on its own contacts alone, and so do its last digits.
void ExplicitLinks::close_ranks() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (rest_[i].contact < 0) continue;
    if (kept < i) {
      links_[kept] = links_[i];
      rest_[kept] = rest_[i];
      link_of_[rest_[kept].contact] = static_cast<int>(kept);
    }
    ++kept;
  }
  links_.resize(kept);
  rest_.resize(kept);
  const std::size_t filled = (kept + batch_size - 1) / batch_size * batch_size;
  Link filling{};
  filling.vertex_slot = filling.edge_slot = blocks_.fixed_slot();
  LinkRest of_filling{};
  of_filling.contact = -1;
  of_filling.depth_limit = std::numeric_limits<double>::infinity();
  links_.resize(filled, filling);
  rest_.resize(filled, of_filling);
}

/// [J] In the springs of a contact; the shear spring of one that has just opened lets go in the next step.
double ExplicitLinks::stored_energy(const Link& link) {
  const double closure = link.status == ContactStatus::open ? 0.0 : link.gap;
  return 0.5 * (link.normal_stiffness * closure * closure + link.shear_stiffness * link.stretch * link.stretch) - link.crossing_energy;
}

/// The forces with which the next step starts, from the memory of the contact; the memory stays.
double ExplicitLinks::carry_now(Link& link, const Place& at) {
  const CarriedForces f = carry(link.strength, trials(link, at, -link.shear_stiffness * link.stretch));
  link.normal = f.normal;
  link.shear = f.shear;
  link.viscous_shear = f.shear - f.elastic_shear;
  return f.elastic_normal;
}

std::optional<ExplicitLinks::TooDeep> ExplicitLinks::too_deep() {
  if (room_ > 0.0) return std::nullopt;
  room_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const double depth = links_[i].status == ContactStatus::open ? 0.0 : -links_[i].gap - rest_[i].rest_gap, limit = rest_[i].depth_limit;
    if (depth > limit) return TooDeep{rest_[i].contact, depth, limit};
    room_ = std::min(room_, limit - depth);
  }
  return std::nullopt;
}

void ExplicitLinks::store(std::vector<Contact>& contacts) const {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (rest_[i].contact < 0) continue;
    const Link& link = links_[i];
    Contact& c = contacts[rest_[i].contact];
    c.gap = link.gap + rest_[i].rest_gap;
    c.status = link.status;
    c.joint_state = rest_[i].joint_state;
    c.elastic_slip = link.stretch;
    c.normal_force = link.normal;
    c.shear_force = link.shear;
    c.crossing_energy = link.crossing_energy;
    c.stored_energy = stored_energy(link);
  }
}

void ExplicitLinks::store_far_gaps(const BlockSystem& system, std::vector<Contact>& contacts) const {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (link_of_[i] >= 0) continue;
    Contact& c = contacts[i];
    const Vec2 normal = -perpendicular((system.arm(system.next(c.edge)) - system.arm(c.edge)).normalized());
    c.gap = normal.dot(system.position(c.vertex_block, c.vertex) - system.position(c.edge_block, c.edge));
    c.rest_gap = std::min(c.rest_gap, c.gap);  // it has carried nothing
  }
}

void ExplicitLinks::exchange(Archive& archive, const JointTable& joints) {
  joints_ = &joints;
  archive(links_, rest_, link_of_, damped_, lost_strength_, critical_step_, approach_, max_penetration_, share_, room_);
}

bool ExplicitLinks::fits(std::size_t contacts) const {
  if (rest_.size() != links_.size() || links_.size() % batch_size != 0 || link_of_.size() != contacts) return false;
  if (!critical_step_.fits(static_cast<std::size_t>(blocks_.count()))) return false;
  const auto is_below = [](int number, std::size_t count) { return number >= 0 && static_cast<std::size_t>(number) < count; };
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    const LinkRest& rest = rest_[i];
    if (!blocks_.has_slot(link.vertex_slot) || !blocks_.has_slot(link.edge_slot) || link.status > ContactStatus::sliding) return false;
    if (!is_below(rest.joint, static_cast<std::size_t>(joints_->count()))) return false;
    if (rest.contact >= 0 && (!is_below(rest.contact, contacts) || link_of_[rest.contact] != static_cast<int>(i))) return false;
  }
  for (std::size_t i = 0; i < contacts; ++i) {
    const int link = link_of_[i];
    if (link >= 0 && (!is_below(link, links_.size()) || rest_[link].contact != static_cast<int>(i))) return false;
  }
  return true;
}

Memory ExplicitLinks::memory() const {
  Memory of;
  of.blocks = critical_step_.bytes() + depth_limits_.bytes();
  of.contacts = bytes_of(links_, rest_, link_of_, renumbered_);
  return of;
}

}  // namespace openclose
