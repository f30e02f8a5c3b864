#include "openclose/statics/frozen_state.h"

#include <cmath>

namespace openclose {

FrozenStrength::FrozenStrength(const FrozenSystem& system, const Scene& scene) : system_(system), joints_(scene) {}

void FrozenStrength::reduce(double factor) {
  factor_ = factor;
  joints_.reduce_strength(factor);
}

ContactStrength FrozenStrength::of(std::size_t i, bool bonded) const {
  Contact contact = system_.contacts()[i].source;
  contact.bonded = bonded;
  contact.length = system_.contacts()[i].joined_length;
  ContactStrength strength(joints_.joint(contact.joint), contact);
  strength.cohesion /= system_.force_unit();
  strength.tension /= system_.force_unit();
  return strength;
}

bool FrozenStrength::stays_bonded(std::size_t i, const FrozenContactState& state) const {
  return openclose::stays_bonded(joints_.joint(system_.contacts()[i].source.joint), state.bonded, state.status);
}

bool FrozenStrength::can_break(std::size_t i, bool bonded) const {
  return can_lose_strength(joints_.joint(system_.contacts()[i].source.joint), bonded);
}

bool FrozenStrength::has_tension() const {
  for (int j = 0; j < joints_.count(); ++j) {
    if (joints_.joint(j).tensile_strength > 0.0) return true;
  }
  return false;
}

bool lose_bonds(const FrozenStrength& strength, FrozenState& state) {
  bool lost = false;
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    FrozenContactState& s = state.contacts[i];
    if (!s.bonded || !strength.can_break(i, true) || strength.stays_bonded(i, s)) continue;
    s.bonded = false;
    lost = true;
  }
  return lost;
}

double farthest_between(const FrozenState& a, const FrozenState& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.displacement.size(); ++i) {
    const double way = (a.displacement[i] - b.displacement[i]).cwiseAbs().maxCoeff();
    if (!(way <= largest)) largest = way;  // a number that is none, too
  }
  return largest;
}

std::vector<BlockVector> unbalanced_forces(const FrozenSystem& system, const FrozenState& state) {
  std::vector<BlockVector> force;
  force.reserve(system.blocks().size());
  for (const FrozenBlock& block : system.blocks()) force.push_back(block.load);
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const FrozenContact& c = system.contacts()[i];
    const FrozenContactState& s = state.contacts[i];
    if (c.a >= 0) force[c.a] += s.normal * c.normal_a + s.shear * c.shear_a;
    if (c.b >= 0) force[c.b] += s.normal * c.normal_b + s.shear * c.shear_b;
  }
  for (std::size_t i = 0; i < state.supports.size(); ++i) force[system.supports()[i].row] += state.supports[i] * system.supports()[i].direction;
  return force;
}

std::vector<double> force_magnitudes(const FrozenSystem& system, const FrozenState& state) {
  std::vector<double> sum;
  sum.reserve(system.blocks().size());
  for (const FrozenBlock& block : system.blocks()) sum.push_back(block.load.norm());
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const FrozenContact& c = system.contacts()[i];
    const double size = std::abs(state.contacts[i].normal) + std::abs(state.contacts[i].shear);
    if (c.a >= 0) sum[c.a] += size;
    if (c.b >= 0) sum[c.b] += size;
  }
  for (std::size_t i = 0; i < state.supports.size(); ++i) sum[system.supports()[i].row] += std::abs(state.supports[i]);
  return sum;
}

}  // namespace openclose
