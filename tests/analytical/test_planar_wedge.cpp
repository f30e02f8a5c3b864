#include <cmath>
#include <stdexcept>

#include "openclose/analytical/planar_wedge.h"
#include "openclose_traps.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

double polygon_area(const std::array<std::array<double, 2>, 3>& v) {
  return ((v[1][0] - v[0][0]) * (v[2][1] - v[0][1]) - (v[2][0] - v[0][0]) * (v[1][1] - v[0][1])) / 2;
}

}  // namespace

TEST_CASE("planar wedge: case E1, section 3.2 of the paper") {
  CHECK(std::abs(factor_of_safety({}) - 1.83542) < 5e-6);
}

TEST_CASE("planar wedge: closed form against force balance on the drawn triangle") {
  const PlanarWedge wedges[] = {{}, {25, 70 * degree, 41 * degree, 40e3, 28 * degree, 24e3}, {100, 90 * degree, 30 * degree, 0, 35 * degree, 26e3}};
  for (const PlanarWedge& wedge : wedges) {
    const auto vertices = wedge_vertices(wedge);
    const double weight = wedge.unit_weight * polygon_area(vertices);
    const double length = std::hypot(vertices[1][0], vertices[1][1]);
    const double resisting = wedge.cohesion * length + weight * std::cos(wedge.plane_angle) * std::tan(wedge.friction_angle);
    CHECK(std::abs(wedge_weight(wedge) / weight - 1) < 1e-13);
    CHECK(std::abs(plane_length(wedge) / length - 1) < 1e-14);
    CHECK(std::abs(factor_of_safety(wedge) / (resisting / (weight * std::sin(wedge.plane_angle))) - 1) < 1e-13);
  }
}

TEST_CASE("planar wedge: limits") {
  PlanarWedge wedge;
  wedge.cohesion = 0;
  wedge.friction_angle = wedge.plane_angle;
  CHECK(std::abs(factor_of_safety(wedge) - 1) < 1e-15);
  PlanarWedge bonded;
  bonded.friction_angle = 0;
  const double factor = factor_of_safety(bonded);
  bonded.height *= 2;
  CHECK(std::abs(factor_of_safety(bonded) / factor - 0.5) < 1e-15);
}

TEST_CASE("planar wedge: data out of range are refused") {
  const openclose::NonStop non_stop;  // one of them is no number
  PlanarWedge wedge;
  CHECK_NOTHROW(require_valid(wedge));
  wedge.plane_angle = wedge.face_angle;
  CHECK_THROWS_AS(require_valid(wedge), std::invalid_argument);
  wedge = {};
  wedge.cohesion = -1;
  CHECK_THROWS_AS(require_valid(wedge), std::invalid_argument);
  wedge = {};
  wedge.height = std::nan("");
  CHECK_THROWS_AS(require_valid(wedge), std::invalid_argument);
}
