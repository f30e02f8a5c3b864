// A symmetric wedge in the roof of a tunnel between two planes that meet above it (Bray; Goodman and others, Proc. 23rd US Symp. Rock Mech., 1982;
// case E7). a half the angle at its tip, phi the friction angle of the planes, r = ks/kn. The rock is rigid and stays; before the wedge is let go
// each plane carries the horizontal force H. The wedge comes down by u: a plane's normal force falls by kn u sin(a), its shear force rises by ks u
// cos(a), until T = N tan(phi) on both. It bears then
//   P = 2 H (r cos^2 a + sin^2 a) sin(phi - a)/(r cos a cos phi + sin a sin phi).
#pragma once

namespace openclose::analytical {

struct RoofWedge {
  double half_angle = 0;       // a [rad]
  double friction_angle = 0;   // phi [rad] > a
  double stiffness_ratio = 1;  // r [-]
  double squeeze = 0;          // H [N] on each plane
};

/// P [N], weight included; of a wedge that only friction holds. \throws std::domain_error unless 0 < a < phi < pi/2
double roof_wedge_load(const RoofWedge& wedge);
/// [N] Normal force on each plane, without shear, from which the wedge without weight lifts itself until the planes carry H:
/// H (r cos^2 a + sin^2 a)/(r cos a). Valid while the planes stick.
double pressed_normal_force(const RoofWedge& wedge);

}  // namespace openclose::analytical
