// Mohr-Coulomb with tension cut-off: what a contact carries of what its springs and dashpots try to. Its only place but for increments at rest
// (increment_packs.cpp, by the same ShearLimit), for one contact (Number = double) and four (Number = Lanes, in sources that are compiled without the
// warning about how vectors are passed), by the same operations in the same order.
#pragma once

#include "openclose/core/packs.h"
#include "openclose/core/tolerance.h"

namespace openclose {

/// Largest shear force at normal force n >= -tension, max(0, min(mu n + C, (mu + 1/eps)(n + tension))): the cohesion comes in over a ramp, because a
/// jump from C to 0 at opening leaves steps without any solution.
/// \param friction  [-] mu, \param cohesion, tension, normal [N], \param ramp [-] eps
template <class Number>
struct ShearLimit {
  Number steep;              ///< [-] slope of the ramp
  Number on_ramp, on_slope;  ///< [N]
  Number value;              ///< [N]
  Number slope;              ///< [-] its derivative by the normal force

  OPENCLOSE_KERNEL ShearLimit(Number friction, Number cohesion, Number tension, Number normal, double ramp)
      : steep(friction + 1.0 / ramp), on_ramp(steep * (normal + tension)), on_slope(friction * normal + cohesion) {
    const Number least = on_ramp < on_slope ? on_ramp : on_slope, zero{};
    value = zero < least ? least : zero;
    slope = zero < value ? (on_ramp < on_slope ? steep : friction) : zero;
  }
  /// A shear force cut off at the limit.
  OPENCLOSE_KERNEL Number of(Number shear) const {
    const Number upper = value < shear ? value : shear;
    return upper < -value ? -value : upper;
  }
};

/// [N] The normal force at which the shear bound changes its slope; none lies below -tension.
template <class Number>
OPENCLOSE_KERNEL Number kink_of_bound(Number friction, Number cohesion, Number tension, double ramp) {
  const Number lowest = friction * tension, on_ramp = (cohesion - lowest) * ramp - tension;
  const Number divisor = friction > 0.0 ? friction : friction + 1.0;  // of what is not taken, and may not trap either
  return cohesion > lowest ? on_ramp : (friction > 0.0 ? -cohesion / divisor : -tension);
}

/// Whether the normal spring carries nothing.
template <class Number>
OPENCLOSE_KERNEL auto spring_is_open(Number tension, Number elastic_normal) {
  return tension > 0.0 ? elastic_normal < -tension : elastic_normal <= 0.0;
}

/// Of a contact that is not open: a contact is so when its spring is; while the dashpot outweighs the spring it carries nothing but is not open.
template <class Number>
struct MohrCoulomb {
  Number normal;  ///< [N]
  ShearLimit<Number> limit;
  Number shear;                               ///< [N]
  decltype(Number{} < Number{}) is_sticking;  ///< or sliding

  /// \param trial_normal, trial_shear  [N] springs and dashpots, bounded by nothing
  OPENCLOSE_KERNEL MohrCoulomb(Number friction, Number cohesion, Number tension, Number trial_normal, Number trial_shear, double ramp)
      : normal(-tension < trial_normal ? trial_normal : -tension), limit(friction, cohesion, tension, normal, ramp), shear(limit.of(trial_shear)) {
    is_sticking = (trial_shear <= limit.value) & (-limit.value <= trial_shear);
  }
};

/// A path on which gap and slip change while the contact sticks all the way, at a shear bound without a kink: what most contacts do in most steps,
/// and linear. With the usual ramp.
template <class Number>
struct StickingPath {
  Number normal_0, normal_1;                ///< [N] at its start and its end, with the dashpot
  Number elastic_shear_0, elastic_shear_1;  ///< [N] of the spring
  Number shear_0, shear_1;                  ///< [N] with the dashpot
  Number normal_by_gap, shear_by_slip;      ///< [N/m] of the means of the path
  decltype(Number{} < Number{}) is_one;     ///< or the contact does something else, and the numbers mean nothing

  /// \param springs, strength  with the members of ContactSprings and ContactStrength
  /// \param start, end  [N] of the normal spring
  template <class Springs, class Strength>
  OPENCLOSE_KERNEL StickingPath(const Springs& springs, const Strength& strength, Number start, Number end, Number gap_change, Number slip_change) {
    const Number viscous = springs.normal_damping * gap_change, viscous_shear = -springs.shear_damping * slip_change;
    normal_0 = start - viscous;
    normal_1 = end - viscous;
    elastic_shear_0 = springs.initial_shear;
    elastic_shear_1 = elastic_shear_0 - springs.shear * slip_change;
    shear_0 = elastic_shear_0 + viscous_shear;
    shear_1 = elastic_shear_1 + viscous_shear;
    normal_by_gap = 0.5 * (-springs.normal_damping + (-springs.normal - springs.normal_damping));
    shear_by_slip = 0.5 * (-springs.shear_damping + (-springs.shear - springs.shear_damping));
    const auto within = [&](Number normal, Number elastic, Number total) {
      const Number bound = ShearLimit<Number>(strength.friction, strength.cohesion, strength.tension, normal, tolerance::cohesion_ramp).value;
      return (-strength.tension < normal) & (elastic <= bound) & (-bound <= elastic) & (total <= bound) & (-bound <= total);
    };
    const Number kink = kink_of_bound(strength.friction, strength.cohesion, strength.tension, tolerance::cohesion_ramp);
    // What starts and ends within a bound that is linear in between stays within it.
    is_one = within(normal_0, elastic_shear_0, shear_0) & within(normal_1, elastic_shear_1, shear_1) & ((kink - normal_0) * (kink - normal_1) >= 0.0);
  }
};

}  // namespace openclose
