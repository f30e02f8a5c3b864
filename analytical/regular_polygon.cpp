#include "openclose/analytical/regular_polygon.h"

#include <cmath>
#include <numbers>

namespace openclose::analytical {

using std::numbers::pi;

double RegularPolygon::side() const {
  return 2 * circumradius * std::sin(pi / sides);
}
double RegularPolygon::area() const {
  return sides * circumradius * circumradius * std::sin(2 * pi / sides) / 2;
}
double RegularPolygon::mass() const {
  return density * area();
}

double RegularPolygon::moment_of_inertia() const {
  const double c = std::cos(pi / sides);
  return mass() * circumradius * circumradius * (1 + 2 * c * c) / 6;
}

std::vector<std::array<double, 2>> RegularPolygon::vertices(std::array<double, 2> centre, double first_angle) const {
  std::vector<std::array<double, 2>> corners;
  for (int i = 0; i < sides; ++i) {
    const double angle = first_angle + 2 * pi * i / sides;
    corners.push_back({centre[0] + circumradius * std::cos(angle), centre[1] + circumradius * std::sin(angle)});
  }
  return corners;
}

}  // namespace openclose::analytical
