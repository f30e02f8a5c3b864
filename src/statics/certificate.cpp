#include "openclose/statics/certificate.h"

#include <algorithm>
#include <cmath>

namespace openclose {

bool is_within_strength(const ContactStrength& strength, const FrozenContactState& s) {
  const double room = rounding_of_strength * (std::abs(s.normal) * (1.0 + strength.friction) + strength.cohesion + strength.tension);
  return s.normal >= -strength.tension - room && std::abs(s.shear) <= strength.largest_shear(std::max(s.normal, -strength.tension)) + room;
}

namespace {

struct RelativeMotion {
  double opening = 0.0, slip = 0.0;
};

RelativeMotion relative_motion(const FrozenContact& c, const Eigen::VectorXd& direction) {
  RelativeMotion m;
  if (c.a >= 0) m.opening += c.normal_a.dot(direction.segment<3>(3 * c.a)), m.slip += c.shear_a.dot(direction.segment<3>(3 * c.a));
  if (c.b >= 0) m.opening += c.normal_b.dot(direction.segment<3>(3 * c.b)), m.slip += c.shear_b.dot(direction.segment<3>(3 * c.b));
  return m;
}

/// The springs of supports have no strength: whether one could bring a motion to an end within farthest_way_of().
/// \param velocity  over the fastest
/// \param acceleration  [-] of the fastest; 0 for a motion that no support may resist at all
bool may_be_stopped(const FrozenSystem& system, const Eigen::VectorXd& velocity, double acceleration) {
  const double way = farthest_way_of(system);
  return std::ranges::any_of(system.supports(), [&](const FrozenSupport& s) {
    const double stretching = std::abs(s.direction.dot(velocity.segment<3>(3 * s.row)));
    return stretching > mechanism_tolerance && s.stiffness * stretching * way > acceleration * system.blocks()[s.row].weight;
  });
}

}  // namespace

double farthest_way_of(const FrozenSystem& system) {
  return system.supports().empty() ? farthest_way : std::max(farthest_way, system.length_unit() / system.closure_unit());
}

EquilibriumCheck check_equilibrium(const FrozenSystem& system, const FrozenStrength& strength, const FrozenState& state) {
  EquilibriumCheck check;
  const std::vector<BlockVector> unbalanced = unbalanced_forces(system, state);
  const std::vector<double> magnitudes = force_magnitudes(system, state);
  for (std::size_t b = 0; b < unbalanced.size(); ++b) {
    const double negligible = negligible_share_of_weight * system.blocks()[b].weight + rounding_of_forces * magnitudes[b];
    const double ratio = unbalanced[b].norm() / negligible;
    if (!(ratio <= check.unbalanced)) check.unbalanced = ratio, check.block = static_cast<int>(b);
  }
  for (std::size_t i = 0; i < state.contacts.size() && check.within_strength; ++i) {
    check.within_strength = is_within_strength(strength.of(i, state.contacts[i].joint_state), state.contacts[i]);
  }
  return check;
}

bool is_mechanism(const FrozenSystem& system, const FrozenStrength& strength, const FrozenState& state, const Eigen::VectorXd& direction) {
  const double fastest = direction.cwiseAbs().maxCoeff();
  if (!(fastest > 0.0) || !direction.allFinite()) return false;
  const std::vector<BlockVector> unbalanced = unbalanced_forces(system, state);
  // The direction is that of the accelerations: one number relates them for all blocks.
  double along = 0.0, square = 0.0;
  for (std::size_t b = 0; b < unbalanced.size(); ++b) {
    const BlockVector momentum = system.blocks()[b].mass.cwiseProduct(direction.segment<3>(3 * static_cast<Eigen::Index>(b)) / fastest);
    along += momentum.dot(unbalanced[b]);
    square += momentum.squaredNorm();
  }
  const double acceleration = along / square;
  if (!(acceleration > 0.0)) return false;
  const std::vector<double> magnitudes = force_magnitudes(system, state);
  for (std::size_t b = 0; b < unbalanced.size(); ++b) {
    const BlockVector expected =
        acceleration * system.blocks()[b].mass.cwiseProduct(direction.segment<3>(3 * static_cast<Eigen::Index>(b)) / fastest);
    const double room = mechanism_tolerance * acceleration * system.blocks()[b].weight + rounding_of_forces * magnitudes[b];
    if (!((unbalanced[b] - expected).norm() <= room)) return false;
  }
  if (may_be_stopped(system, direction / fastest, acceleration)) return false;
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const FrozenContact& c = system.contacts()[i];
    const FrozenContactState& s = state.contacts[i];
    const ContactStrength bounds = strength.of(i, s.joint_state);
    if (!is_within_strength(bounds, s)) return false;
    const auto [way_apart, way_along] = relative_motion(c, direction);
    const double opening = way_apart / fastest, slip = way_along / fastest;
    const double carried = std::abs(s.normal) + std::abs(s.shear);
    if (opening < -mechanism_tolerance) return false;
    // What opens carries nothing.
    if (opening > mechanism_tolerance && carried > mechanism_tolerance) return false;
    if (std::abs(slip) <= mechanism_tolerance || opening > mechanism_tolerance) continue;
    // What slips does so at its bound and against its friction.
    const double bound = bounds.largest_shear(std::max(s.normal, -bounds.tension));
    if (s.shear * slip > mechanism_tolerance * std::abs(slip) || bound - std::abs(s.shear) > mechanism_tolerance) return false;
  }
  return true;
}

bool is_beyond_all_strength(const FrozenSystem& system, const FrozenStrength& strength, const Eigen::VectorXd& direction) {
  const double fastest = direction.cwiseAbs().maxCoeff();
  if (!(fastest > 0.0) || !direction.allFinite()) return false;
  double work = 0.0, scale = 0.0;
  for (std::size_t b = 0; b < system.blocks().size(); ++b) {
    const auto motion = direction.segment<3>(3 * static_cast<Eigen::Index>(b)) / fastest;
    work += system.blocks()[b].load.dot(motion);
    scale += system.blocks()[b].load.norm() * motion.norm();
  }
  if (may_be_stopped(system, direction / fastest, 0.0)) return false;
  for (std::size_t i = 0; i < system.contacts().size(); ++i) {
    const auto [opening, slip] = relative_motion(system.contacts()[i], direction / fastest);
    if (opening < -mechanism_tolerance || std::abs(slip) > mechanism_tolerance) return false;
    if (strength.of(i, {}).tension > 0.0 && opening > mechanism_tolerance) return false;
  }
  return work > mechanism_tolerance * scale;
}

}  // namespace openclose
