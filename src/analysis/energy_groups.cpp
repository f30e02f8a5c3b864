#include "openclose/analysis/energy_groups.h"

#include <algorithm>
#include <utility>

namespace openclose {
namespace {

double kinetic(const BlockSystem& system, int b, const Motion::Unknowns& velocity) {
  return 0.5 * velocity.dot(system.block(b).mass.cwiseProduct(velocity));
}

template <typename F>
void for_each_free_block(const BlockSystem& system, const F& f) {
  for (int b : system.free_blocks()) f(b);
  for (int b : system.resting_blocks()) f(b);
}

bool is_fixed(const BlockSystem& system, int b) {
  return system.block(b).equation == BlockSystem::fixed;
}

}  // namespace

void EnergyGroups::begin(const Simulation& simulation, double undetermined_length) {
  const BlockSystem& system = simulation.system();
  const auto count = static_cast<std::size_t>(system.block_count());
  undetermined_length_ = undetermined_length;
  searches_ = -1;
  group_.resize(count);
  for (std::size_t b = 0; b < count; ++b) group_[b] = static_cast<int>(b);
  groups_.assign(count, {});
  start_.assign(count, Vec2::Zero());
  count_ = 0;
  for_each_free_block(system, [&](int b) {
    ++count_;
    start_[b] = Motion::translation(system.displacement(b));
    groups_[b].weight = simulation.external().weight(system, b).norm();
  });
  for (const auto& element : simulation.external().elements()) {
    if (element->account() == ForceAccount::loads) groups_[element->block()].has_loads = true;
  }
  sum(simulation);
  for_each_free_block(system, [&](int b) {
    groups_[b].lowest = energies_[b];
    groups_[b].start = energies_[b].of_output;
  });
  unite_candidates(simulation);
}

void EnergyGroups::follow(const Simulation& simulation) {
  if (simulation.is_explicit()) return;
  if (simulation.state().detector.counters().searches != searches_) unite_candidates(simulation);
}

void EnergyGroups::unite_candidates(const Simulation& simulation) {
  const Detector& detector = simulation.state().detector;
  searches_ = detector.counters().searches;
  for (const auto& [a, b] : detector.candidate_pairs()) {
    if (!is_fixed(simulation.system(), a) && !is_fixed(simulation.system(), b)) unite(a, b);
  }
}

int EnergyGroups::root(int block) {
  while (group_[block] != block) block = group_[block] = group_[group_[block]];
  return block;
}

/// What each has created so far, both have.
void EnergyGroups::unite(int a, int b) {
  a = root(a);
  b = root(b);
  if (a == b) return;
  --count_;
  group_[std::max(a, b)] = std::min(a, b);
  Group &kept = groups_[std::min(a, b)], &other = groups_[std::max(a, b)];
  kept.lowest += other.lowest;
  kept.start += other.start;
  kept.released += other.released;
  kept.weight += other.weight;
  kept.has_loads = kept.has_loads || other.has_loads;
  other = {};
}

void EnergyGroups::sum(const Simulation& simulation) {
  const BlockSystem& system = simulation.system();
  energies_.assign(group_.size(), {});
  released_.assign(group_.size(), 0.0);
  kinetic_.assign(group_.size(), 0.0);
  for_each_free_block(system, [&](int b) {
    const double fall = system.block(b).mass[0] * simulation.external().gravity().dot(Motion::translation(system.displacement(b)) - start_[b]);
    kinetic_[b] = kinetic(system, b, simulation.velocity(b));
    energies_[root(b)] += {kinetic_[b] - fall, kinetic(system, b, system.velocity(b)) - fall};
    released_[root(b)] += std::max(0.0, fall);
  });
  simulation.state().contacts.for_each([&](const Contact& c) {
    if (c.stored_energy == 0.0) return;
    const int b = is_fixed(system, c.vertex_block) ? c.edge_block : c.vertex_block;
    energies_[root(b)] += {c.stored_energy, c.stored_energy};
  });
  for (const auto& element : simulation.external().elements()) {
    if (is_fixed(system, element->block()) || element->account() == ForceAccount::loads) continue;
    const double stored = element->stored_energy(element->path(system, Motion::Unknowns::Zero()));
    energies_[root(element->block())] += {stored, stored};
  }
}

EnergyGroups::Worst EnergyGroups::worst(const Simulation& simulation, double most) {
  Worst worst;
  if (count_ < 2 || simulation.is_explicit() || simulation.scene().base_motion) return worst;
  sum(simulation);
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    Group& group = groups_[i];
    if (group_[i] != static_cast<int>(i) || group.has_loads) continue;
    group.released = std::max(group.released, released_[i]);
    group.lowest.of_output = std::min(group.lowest.of_output, energies_[i].of_output);
    group.lowest.of_scheme = std::min(group.lowest.of_scheme, energies_[i].of_scheme);
    const double rise = std::min(energies_[i].of_output - group.lowest.of_output, energies_[i].of_scheme - group.lowest.of_scheme);
    const double scale = group.start + group.released + group.weight * undetermined_length_ / most;
    if (scale > 0.0 && rise > worst.part * scale) worst = {rise, scale, rise / scale, static_cast<int>(i), 0};
  }
  if (worst.block < 0) return worst;
  const int group = worst.block;
  for (int b = 0; b < static_cast<int>(group_.size()); ++b) {
    if (root(b) != group) continue;
    ++worst.blocks;
    if (kinetic_[b] > kinetic_[worst.block]) worst.block = b;
  }
  return worst;
}

void EnergyGroups::exchange(Archive& archive) {
  archive(group_, groups_, start_, searches_, count_, undetermined_length_);
  if (!archive.reading()) return;
  const auto is_before = [&](std::size_t b) { return group_[b] >= 0 && group_[b] <= static_cast<int>(b); };
  bool sound = groups_.size() == group_.size() && start_.size() == group_.size();
  for (std::size_t b = 0; b < group_.size(); ++b) sound = sound && is_before(b);
  archive.require(sound, "the saved state has groups of blocks that are not there");
}

}  // namespace openclose
