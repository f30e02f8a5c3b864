// Regular n-gon of circumradius R and density rho, unit thickness (case A2). With side l = 2 R sin(pi/n):
//   area = (n/2) R^2 sin(2 pi/n)
//   polar second moment about the centroid: I = (m R^2/6)(1 + 2 cos^2(pi/n)) = (m l^2/24)(1 + 3 cot^2(pi/n))
// n >= 3; n -> infinity gives the disc, pi R^2 and m R^2/2.
#pragma once

#include <array>
#include <vector>

namespace openclose::analytical {

struct RegularPolygon {
  int sides = 6;
  double circumradius = 1.0;  // [m]
  double density = 2700.0;    // [kg/m3]

  double side() const;               // [m]
  double area() const;               // [m2]
  double mass() const;               // [kg/m]
  double moment_of_inertia() const;  // about the centroid [kg m2/m]
  /// Corners [m], counter-clockwise, the first at angle first_angle [rad] from the x axis; centroid at centre.
  std::vector<std::array<double, 2>> vertices(std::array<double, 2> centre = {0, 0}, double first_angle = 0) const;
};

}  // namespace openclose::analytical
