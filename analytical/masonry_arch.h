// Semicircular arch of n equal voussoirs between radial joints on fixed springers, under its own weight: the smallest thickness t over the radius R
// of its centre line for which a line of thrust exists within it (Heyman's assumptions: no tension, no crushing, no sliding; case F1).
//
// By symmetry the thrust at the crown is horizontal, H at the height y0. On the part between crown and joint i act its weight w_i and H; the force
// that the joint carries passes between intrados and extrados if the moments of w_i and H about the joint's two ends have opposite signs. With
// K = H y0 both conditions are linear: for every joint, with S_i the moment of w_i about the axis of symmetry and (x, y) an end of the joint,
//   w_i x_in - S_i + y_in H <= K <= w_i x_ex - S_i + y_ex H.
// Some H must leave room for K. For odd n the keystone has no joint at the crown, and the cut through it asks for nothing.
#pragma once

#include <array>
#include <vector>

namespace openclose::analytical {

enum class VoussoirShape {
  straight,     // quadrilaterals: corners at R -+ t/2 on the joints
  ring_sector,  // between two circles
};

/// t/R. n >= 3. As n grows it tends to Milankovitch's 0.1075. \throws std::invalid_argument for fewer voussoirs
double smallest_arch_thickness(int voussoirs, VoussoirShape shape);

/// Corners [m] of the straight-edged voussoirs of an arch with R = 1 m, counter-clockwise, from the left springer to the right one. The joints at
/// the springers lie on y = 0.
std::vector<std::array<std::array<double, 2>, 4>> straight_voussoirs(int voussoirs, double thickness_over_radius);

}  // namespace openclose::analytical
