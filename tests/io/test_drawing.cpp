// The drawing shows the blocks as they lie.
#include <sstream>
#include <string>

#include "openclose/geometry/box.h"
#include "openclose/geometry/polygon.h"
#include "openclose/io/drawing.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

/// [px] The box of the polygon with this name, x to the right and y downwards.
Box box_of(const std::string& svg, const std::string& name) {
  const std::size_t title = svg.find("<title>" + name + "</title>");
  REQUIRE(title != std::string::npos);
  const std::string opening = "points=\"";
  const std::size_t begin = svg.rfind(opening, title) + opening.size();
  std::istringstream points(svg.substr(begin, svg.find('"', begin) - begin));
  Polygon polygon;
  char comma = 0;
  for (Vec2 p; points >> p.x() >> comma >> p.y();) polygon.push_back(p);
  REQUIRE(polygon.size() == 4);
  return Box::around(polygon);
}

}  // namespace

TEST_CASE("drawings have up above, right on the right and one scale", "[io][drawing]") {
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("base", test::rectangle(100.0, 50.0, 4.0, 1.0)),
                  test::free_block("tower", test::rectangle(103.0, 51.0, 1.0, 2.0))};
  const std::string svg = svg_drawing(picture_of(scene));
  const Box base = box_of(svg, "base"), tower = box_of(svg, "tower");
  // Coordinates are written with two decimals.
  constexpr double rounding = 0.011;
  const double scale = (base.high.x() - base.low.x()) / 4.0;
  CHECK(scale > 50.0);
  CHECK(tower.high.y() == Approx(base.low.y()).margin(rounding));
  CHECK(tower.high.x() == Approx(base.high.x()).margin(rounding));
  CHECK(tower.high.x() - tower.low.x() == Approx(scale).margin(2.0 * rounding));
  CHECK(tower.high.y() - tower.low.y() == Approx(2.0 * scale).margin(2.0 * rounding));
  CHECK(base.high.y() - base.low.y() == Approx(scale).margin(2.0 * rounding));
}
