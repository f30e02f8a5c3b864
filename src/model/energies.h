// The entries of the energy ledger; analysis/energy_ledger.h has their formulas.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "openclose/core/archive.h"

namespace openclose {

/// Where the energy went, in joules per metre of thickness since the start, or since somebody asked.
struct EnergyLedger {
  double kinetic = 0.0;          ///< change
  double gravity = 0.0;          ///< change of potential energy
  double base_motion = 0.0;      ///< minus the work of the body forces -m a of a moving base, in the coordinates that move with it
  double contact_springs = 0.0;  ///< change of stored energy
  double support_springs = 0.0;  ///< change of stored energy: work at the fixed points
  double loads = 0.0;            ///< minus the work of point loads and surcharges
  double friction = 0.0;         ///< dissipated
  double contact_damping = 0.0;  ///< dissipated by the joints' dashpots
  double mass_damping = 0.0;     ///< dissipated by damping of the blocks' motion (`dem`)
  double impact = 0.0;           ///< dissipated by hard contacts that close
  double scheme = 0.0;           ///< dissipated by the time integration
  double redefinition = 0.0;     ///< released where contacts change their length, their gap's linearisation, or end while loaded, see history.h
  double turnover = 0.0;         ///< sum of the absolute changes of kinetic, gravity, base motion and loads: what an imbalance is compared with

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = *this;
    archive(a, b, c, d, e, f, g, h, i, j, k, l, m);
  }

  /// What falls by losses alone: the work of loads and base counts as energy that is given back.
  double mechanical() const { return kinetic + gravity + contact_springs + support_springs + loads + base_motion; }
  EnergyLedger& operator+=(const EnergyLedger& other) {
    kinetic += other.kinetic, gravity += other.gravity, base_motion += other.base_motion, contact_springs += other.contact_springs;
    support_springs += other.support_springs, loads += other.loads, friction += other.friction, contact_damping += other.contact_damping;
    mass_damping += other.mass_damping, impact += other.impact, scheme += other.scheme, redefinition += other.redefinition;
    turnover += other.turnover;
    return *this;
  }

  double imbalance() const {
    return kinetic + gravity + base_motion + contact_springs + support_springs + loads + friction + contact_damping + mass_damping + impact + scheme +
           redefinition;
  }

  /// Whether every entry is a number.
  bool is_finite() const {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = *this;
    return std::ranges::all_of(std::array{a, b, c, d, e, f, g, h, i, j, k, l, m}, [](double entry) { return std::isfinite(entry); });
  }

  /// [-] Share of the energy moved that the time integration took as if it were damping; below zero where it gave energy. Zero where nothing moved.
  double integrator_loss() const { return turnover > 0.0 ? scheme / turnover : 0.0; }
};

}  // namespace openclose
