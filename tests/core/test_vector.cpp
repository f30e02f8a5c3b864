#include <cmath>

#include "openclose/core/vector.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("perpendicular turns counter-clockwise by a right angle", "[core][vector]") {
  CHECK(perpendicular({1.0, 0.0}) == Vec2(0.0, 1.0));
  CHECK(perpendicular({0.0, 1.0}) == Vec2(-1.0, 0.0));
  const Vec2 v(0.3, -1.7);
  CHECK(perpendicular(v).dot(v) == 0.0);
  CHECK(perpendicular(perpendicular(v)) == -v);
}

TEST_CASE("the cross product is the signed area of the parallelogram", "[core][vector]") {
  CHECK(cross({2.0, 0.0}, {0.0, 3.0}) == 6.0);
  CHECK(cross({2.0, 0.0}, {5.0, 3.0}) == 6.0);
  const Vec2 a(0.3, -1.7), b(2.1, 0.4);
  CHECK(cross(b, a) == -cross(a, b));
  CHECK(cross(a, a) == 0.0);
  CHECK(cross(a, b) == Approx(perpendicular(a).dot(b)).epsilon(1e-15));
}
