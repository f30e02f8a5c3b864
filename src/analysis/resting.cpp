#include "openclose/analysis/resting.h"

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

/// [-] A step is done again when it changes the mean of the forces on a block at rest by this many times what wakes it: below, what the block misses
/// in one step is of the size of what it may miss anyhow, and repeating costs a whole step.
constexpr double haste = 3.0;
/// [-] Blocks with this part of the change that wakes a block are woken along with one that has all of it: soon they would wake by themselves, and
/// each change of who rests costs about as much as an iteration (40 m of a failing slope: 230 changes, 400 with 1; with 0.5 200, but more blocks
/// awake).
constexpr double nearly = 0.7;

/// Adds, or takes away with sign -1, what contacts do to blocks at rest.
void add_forces(const BlockSystem& system, const std::vector<Contact>& contacts, double sign, std::vector<Motion::Unknowns>& per_block) {
  for (const Contact& c : contacts) {
    if (c.status == ContactStatus::open || !(system.is_at_rest(c.vertex_block) || system.is_at_rest(c.edge_block))) continue;
    const ContactPose pose(ContactStart(system, c), {}, {});
    push_apart(c, pose, sign * c.normal_force, sign * c.shear_force, [&](int b, const Motion::Unknowns& force) { per_block[b] += force; });
  }
}

}  // namespace

Resting::Resting(const RestInput& input, const BlockSystem& system)
    : input_(input),
      anchor_(system.block_count(), Unknowns::Zero()),
      velocity_(system.block_count(), Unknowns::Zero()),
      quiet_(system.block_count(), 0.0),
      held_(system.block_count(), Unknowns::Zero()),
      change_(system.block_count(), Unknowns::Zero()) {}

void Resting::follow(const BlockSystem& system, const std::vector<Unknowns>& velocities, double dt) {
  since_ += dt;
  for (const int b : system.free_blocks()) {
    const double radius = system.block(b).radius;
    const Unknowns moved = system.displacement(b) - anchor_[b], faster = velocities[b] - velocity_[b];
    velocity_[b] = velocities[b];
    const bool quiet =
        Motion::displacement_bound(moved, radius) <= input_.displacement && Motion::displacement_bound(faster, radius) <= input_.acceleration * dt;
    quiet_[b] = quiet ? quiet_[b] + dt : 0.0;
    if (!quiet) anchor_[b] = system.displacement(b);
  }
}

bool Resting::fits(const BlockSystem& system) const {
  const std::size_t blocks = system.blocks().size();
  const bool same_blocks =
      anchor_.size() == blocks && velocity_.size() == blocks && quiet_.size() == blocks && held_.size() == blocks && change_.size() == blocks;
  return same_blocks && awaited_.size() == system.resting_blocks().size() && layers_ >= 1 && layers_ <= std::max(1, system.block_count());
}

void Resting::disturb(const BlockSystem& system) {
  for (const int b : system.free_blocks()) quiet_[b] = 0.0;
}

std::vector<int> Resting::quiet_blocks(const BlockSystem& system, const std::vector<Contact>& contacts) {
  std::vector<int> list;
  if (since_ < input_.time) return list;
  const auto is_quiet = [&](int b) { return system.block(b).equation < 0 || quiet_[b] >= input_.time; };
  std::vector<char> touches(system.block_count(), 0), is_disturbed(system.block_count(), 0);
  for (const Contact& c : contacts) {
    if (c.status == ContactStatus::open) continue;
    touches[c.vertex_block] = touches[c.edge_block] = 1;
    if (!is_quiet(c.edge_block)) is_disturbed[c.vertex_block] = 1;
    if (!is_quiet(c.vertex_block)) is_disturbed[c.edge_block] = 1;
  }
  for (const int b : system.free_blocks()) {
    if (is_quiet(b) && touches[b] && !is_disturbed[b]) list.push_back(b);
  }
  if (!list.empty()) since_ = 0.0;
  return list;
}

void Resting::keep_forces(const BlockSystem& system, const std::vector<int>& blocks, const ContactSet& contacts) {
  std::vector<Unknowns> forces(system.block_count(), Unknowns::Zero());
  add_forces(system, contacts.moving, 1.0, forces);
  add_forces(system, contacts.resting, 1.0, forces);
  for (const int b : blocks) {
    held_[b] = forces[b];
    change_[b].setZero();
    // Once it is woken it has to be quiet anew.
    quiet_[b] = 0.0;
    velocity_[b].setZero();
  }
}

void Resting::divide(const BlockSystem& system, const std::vector<Contact>& resting_contacts) {
  std::vector<Unknowns> forces = held_;
  add_forces(system, resting_contacts, -1.0, forces);
  awaited_.clear();
  for (const int b : system.resting_blocks()) awaited_.push_back(forces[b]);
}

std::vector<Resting::Unknowns>& Resting::pushes(const BlockSystem& system) {
  pushes_.assign(system.resting_blocks().size(), Unknowns::Zero());
  return pushes_;
}

void Resting::judge(const BlockSystem& system, double dt) {
  const double share = -std::expm1(-dt / input_.time);
  judged_.resize(pushes_.size());
  for (std::size_t i = 0; i < pushes_.size(); ++i) {
    const Unknowns& before = change_[system.resting_blocks()[i]];
    judged_[i] = before + share * ((pushes_[i] - awaited_[i]) - before);
  }
}

std::vector<int> Resting::woken(const BlockSystem& system, const ContactSet& contacts, Urgency urgency) {
  const double limit = input_.acceleration * (urgency == Urgency::in_haste ? haste : 1.0);
  std::vector<int> list, nearly_woken;
  for (std::size_t i = 0; i < judged_.size(); ++i) {
    const int b = system.resting_blocks()[i];
    const auto& block = system.block(b);
    Unknowns change = judged_[i];
    if (block.rotation_locked) change[Motion::rotation_index] = 0.0;
    const double force = Motion::largest_force(change, block.radius);
    if (force > limit * block.mass[0]) list.push_back(b);
    if (force > nearly * limit * block.mass[0]) nearly_woken.push_back(b);
  }
  if (list.empty()) return list;
  list = nearly_woken;

  std::vector<int> layer(system.block_count(), 0);
  for (const int b : list) layer[b] = 1;
  const auto spread = [&](int k) {
    contacts.for_each([&](const Contact& c) {
      if (c.status == ContactStatus::open) return;
      for (const auto& [from, to] : {std::pair(c.vertex_block, c.edge_block), std::pair(c.edge_block, c.vertex_block)}) {
        if (layer[from] != k || layer[to] != 0 || system.block(to).equation == BlockSystem::fixed) continue;
        layer[to] = k + 1;
        if (system.is_at_rest(to)) list.push_back(to);
      }
    });
  };
  for (int k = 1; k <= layers_; ++k) spread(k);
  layers_ = std::min(2 * layers_, system.block_count());
  return list;
}

void Resting::accept(const BlockSystem& system) {
  layers_ = 1;
  for (std::size_t i = 0; i < judged_.size(); ++i) change_[system.resting_blocks()[i]] = judged_[i];
}

}  // namespace openclose
