#include <cmath>
#include <numbers>

#include "openclose/analytical/regular_polygon.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

struct Sums {
  double area = 0;
  double polar = 0;  // about the origin, of unit density
};

// Fan of triangles from the origin: an independent way to both integrals.
Sums fan_of_triangles(const std::vector<std::array<double, 2>>& corners) {
  Sums sums;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& a = corners[i];
    const auto& b = corners[(i + 1) % corners.size()];
    const double area = (a[0] * b[1] - a[1] * b[0]) / 2;
    sums.area += area;
    sums.polar += area / 6 * (a[0] * a[0] + a[1] * a[1] + b[0] * b[0] + b[1] * b[1] + a[0] * b[0] + a[1] * b[1]);
  }
  return sums;
}

}  // namespace

TEST_CASE("regular polygon: square and triangle by hand") {
  const RegularPolygon square{4, std::sqrt(2.0), 3.0};  // side 2
  CHECK(std::abs(square.side() - 2) < 1e-14);
  CHECK(std::abs(square.area() - 4) < 1e-14);
  CHECK(std::abs(square.moment_of_inertia() - 12 * 4 / 6.0) < 1e-13);               // m l^2/6
  const RegularPolygon triangle{3, 1 / std::sqrt(3.0), 1.0};                        // side 1
  CHECK(std::abs(triangle.moment_of_inertia() - std::sqrt(3.0) / 4 / 12) < 1e-15);  // m l^2/12
}

TEST_CASE("regular polygon: closed forms against a fan of triangles, and the form in the side length") {
  for (const int n : {3, 4, 5, 6, 7, 12, 101}) {
    const RegularPolygon polygon{n, 0.7, 2300.0};
    const Sums sums = fan_of_triangles(polygon.vertices({0, 0}, 0.3));
    CHECK(std::abs(sums.area / polygon.area() - 1) < 1e-13);
    CHECK(std::abs(2300.0 * sums.polar / polygon.moment_of_inertia() - 1) < 1e-13);
    const double cotangent = 1 / std::tan(std::numbers::pi / n);
    const double by_side = polygon.mass() * polygon.side() * polygon.side() / 24 * (1 + 3 * cotangent * cotangent);
    CHECK(std::abs(by_side / polygon.moment_of_inertia() - 1) < 1e-12);
  }
}

TEST_CASE("regular polygon: tends to the disc as 1/n^2") {
  const auto excess = [](int n) {
    const RegularPolygon polygon{n, 1.0, 1.0};
    return 1 - polygon.moment_of_inertia() / (std::numbers::pi / 2);
  };
  CHECK(excess(100) > 1e-4);
  CHECK(std::abs(excess(100) / excess(200) - 4) < 0.01);
}

TEST_CASE("regular polygon: vertices lie on the circle about the centre, the first at the angle asked for") {
  const RegularPolygon polygon{5, 2.0, 1.0};
  const auto corners = polygon.vertices({3, -1}, 0.25);
  REQUIRE(corners.size() == 5);
  for (const auto& corner : corners) CHECK(std::abs(std::hypot(corner[0] - 3, corner[1] + 1) - 2) < 1e-14);
  CHECK(std::abs(std::atan2(corners[0][1] + 1, corners[0][0] - 3) - 0.25) < 1e-14);
}
