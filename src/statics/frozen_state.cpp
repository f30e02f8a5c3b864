#include "openclose/statics/frozen_state.h"

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

constexpr double rounding_of_pull = 1e-9;  ///< [-] of the strength

}  // namespace

FrozenStrength::FrozenStrength(const FrozenSystem& system, const Scene& scene) : system_(system), joints_(scene) {}

void FrozenStrength::reduce(double factor) {
  factor_ = factor;
  joints_.reduce_strength(factor);
}

ContactStrength FrozenStrength::of(std::size_t i, const JointState& state) const {
  const FrozenContact& contact = system_.contacts()[i];
  ContactStrength strength(joints_.joint(contact.source.joint), contact.joined_length, state);
  strength.cohesion /= system_.force_unit();
  strength.tension /= system_.force_unit();
  return strength;
}

JointState FrozenStrength::joint_after(std::size_t i, const FrozenContactState& state, double slip) const {
  return state_after(joints_.joint(system_.contacts()[i].source.joint), state.joint_state, state.status, std::abs(slip) * system_.closure_unit());
}

bool FrozenStrength::weakens_along_slip(std::size_t i, const JointState& state) const {
  return openclose::weakens_along_slip(joints_.joint(system_.contacts()[i].source.joint), state);
}

double FrozenStrength::loss(std::size_t i, const JointState& before, const JointState& after) const {
  return openclose::loss(joints_.joint(system_.contacts()[i].source.joint), before, after);
}

bool FrozenStrength::can_lose(std::size_t i, const JointState& state) const {
  const FrozenContact& contact = system_.contacts()[i];
  const JointProperties& joint = joints_.joint(contact.source.joint);
  return can_lose_strength(joint, state) && (joint.softens() || contact.joined_length > 0.0);  // a lone corner has neither cohesion nor tension
}

std::vector<double> FrozenStrength::pulls_at_edges(const FrozenState& state) const {
  if (!has_tension()) return std::vector<double>(state.contacts.size(), 0.0);
  return openclose::pulls_at_edges(system_.sections(), state.contacts.size(), [&](int i) -> EndOfJoint {
    const FrozenContactState& s = state.contacts[i];
    const double tension = s.status == ContactStatus::open ? 0.0 : of(i, s.joint_state).tension;
    return {s.normal, tension, system_.contacts()[i].joined_length / system_.length_unit()};
  });
}

double lose_strength(const FrozenStrength& strength, FrozenState& state, SlipOfState slip) {
  const std::vector<double> pulls = strength.pulls_at_edges(state);
  double largest = 0.0;
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    FrozenContactState& s = state.contacts[i];
    const bool counts = slip == SlipOfState::counts;
    if (strength.can_lose(i, s.joint_state)) {
      JointState after = strength.joint_after(i, s, counts ? s.slip : 0.0);
      if (pulls[i] > 1.0 + rounding_of_pull) after.bonded = false;
      largest = std::max(largest, strength.loss(i, s.joint_state, after));
      s.joint_state = after;
    }
    if (counts) s.slip = 0.0;
  }
  return largest;
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
