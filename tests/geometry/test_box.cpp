#include "openclose/geometry/box.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("a box is the smallest one around its points", "[geometry][box]") {
  const Box box = Box::around({{1.0, 5.0}, {-2.0, 3.0}, {0.0, 7.0}});
  CHECK(box.low == Vec2(-2.0, 3.0));
  CHECK(box.high == Vec2(1.0, 7.0));
  CHECK(box.contains({1.0, 7.0}));
  CHECK_FALSE(box.contains({1.0, 7.1}));
  CHECK(Box::around(std::vector<Vec2>{}).empty());
}

TEST_CASE("boxes overlap when they touch, and a margin decides how near is near", "[geometry][box]") {
  const Box left{{0.0, 0.0}, {1.0, 1.0}};
  const Box right{{1.0, 0.0}, {2.0, 1.0}};
  const Box far{{1.5, 0.0}, {2.0, 1.0}};
  CHECK(left.overlaps(right));
  CHECK_FALSE(left.inflated(-0.1).overlaps(right));
  CHECK_FALSE(left.overlaps(far));
  CHECK_FALSE(left.inflated(0.4).overlaps(far));
  CHECK(left.inflated(0.5).overlaps(far));
  CHECK(left.inflated(-0.6).empty());
  CHECK_FALSE(left.inflated(-0.6).overlaps(left));
}
