// What a step of the explicit loop does to a contact, for one link (Real = double) and for four (Real = Lanes, in source files that are compiled
// without the warning about how vectors are passed); in both by the same operations in the same order.
#pragma once

#include <algorithm>

#include "openclose/contact/kinematics.h"
#include "openclose/core/packs.h"

namespace openclose {

/// Where a link is: gap and slip as in explicit_links.h, normal and arms now.
template <class Real>
struct LinkPlace {
  Real gap, slip;       ///< [m]
  ForcePlace<Real> at;  ///< arms from the two centroids to the corner
};

/// \param v, e  poses of the blocks of vertex and edge, with the members of ExplicitPose
/// \param link  with the members of a link that stay: arm, across and normal at the load, and loaded_gap
template <class Real, class Pose, class Link>
OPENCLOSE_KERNEL LinkPlace<Real> link_place(const Pose& v, const Pose& e, const Link& link) {
  const Real turned_x = v.cos_minus_1 * link.arm_x - v.sin * link.arm_y, turned_y = v.cos_minus_1 * link.arm_y + v.sin * link.arm_x;
  const Real dx = v.x - e.x + turned_x, dy = v.y - e.y + turned_y;
  const Real change_x = e.cos_minus_1 * link.normal_x - e.sin * link.normal_y, change_y = e.cos_minus_1 * link.normal_y + e.sin * link.normal_x;
  const Real nx = link.normal_x + change_x, ny = link.normal_y + change_y;
  return {link.loaded_gap + (change_x * link.across_x + change_y * link.across_y + (nx * dx + ny * dy)),
          change_x * link.across_y - change_y * link.across_x + (nx * dy - ny * dx),
          {nx, ny, link.arm_x + turned_x, link.arm_y + turned_y, link.across_x + dx, link.across_y + dy}};
}

/// A rate of the corner against the edge, along the edge's normal and along the edge.
template <class Real>
struct LinkRate {
  Real normal, shear;
};

/// \param v, e  rates of the two blocks, with the members of ExplicitRate
template <class Real, class Rate>
OPENCLOSE_KERNEL LinkRate<Real> link_rate(const Rate& v, const Rate& e, const ForcePlace<Real>& at) {
  const Real x = (v.x - v.turn * at.vertex_arm_y) - (e.x - e.turn * at.edge_arm_y),
             y = (v.y + v.turn * at.vertex_arm_x) - (e.y + e.turn * at.edge_arm_x);
  return {at.normal_x * x + at.normal_y * y, at.normal_x * y - at.normal_y * x};
}

/// A step of a link for the ledger. The forces of the step are those at its start, but for what settles an opening, which is no joint's force.
template <class Real>
struct LinkStep {
  Real normal_stiffness, shear_stiffness;                  ///< [N/m]
  Real closure_before, opening_before;                     ///< [m] gap before the step where it was closed and where it was open, else zero
  Real stretch_before;                                     ///< [m]
  Real normal_before, shear_before, viscous_shear_before;  ///< [N] the first two zero if it was open
  Real gap_change, slip;                                   ///< [m] in the step
  Real opening;                                            ///< [m] gap after the step, zero if it is closed
  Real stretch, shear;                                     ///< [m], [N] after it
};

/// [J] What the step adds to the ledger, see there for the formulas, with theta = 0.
template <class Real>
struct LinkEnergies {
  Real scheme;
  Real rubbed;   ///< friction: what rubs is the mean force, so that the work of central difference is summed by parts
  Real not_yet;  ///< to be taken from `scheme`
  Real damping;

  OPENCLOSE_KERNEL explicit LinkEnergies(const LinkStep<Real>& s) {
    const Real stretched = s.stretch - s.stretch_before, closing = -s.gap_change + (s.opening - s.opening_before), zero{};
    scheme = s.normal_before * s.gap_change + s.shear_before * s.slip - s.normal_before * s.opening -
             0.5 * (s.normal_stiffness * closing * closing + s.shear_stiffness * stretched * stretched) -
             (s.shear_before - s.viscous_shear_before + s.shear_stiffness * s.stretch_before) * stretched;
    const Real of_mean = -0.5 * (s.shear_before + s.shear) * (s.slip - stretched);
    rubbed = zero < of_mean ? of_mean : zero;
    not_yet = rubbed + s.shear_before * (s.slip - stretched);
    damping = (s.normal_before + s.normal_stiffness * s.closure_before) * closing - s.viscous_shear_before * stretched;
  }
};

}  // namespace openclose
