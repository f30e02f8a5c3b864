// A joint plane in space and its line in the section.
#include <cmath>

#include "openclose/scene/angle.h"
#include "openclose/scene/section.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("a plane that strikes across the section has its own dip there", "[scene][section]") {
  for (const double dip : {0.0, 25.0, 60.0}) {
    const auto to_the_right = plane_in_section(radians(dip), radians(130.0), radians(130.0));
    const auto to_the_left = plane_in_section(radians(dip), radians(310.0), radians(130.0));
    REQUIRE(to_the_right);
    REQUIRE(to_the_left);
    CHECK(to_the_right->dip == Approx(-radians(dip)).margin(1e-15));
    CHECK(to_the_left->dip == Approx(radians(dip)).margin(1e-15));
    CHECK(to_the_right->spacing == Approx(1.0));
    CHECK(to_the_right->oblique == Approx(0.0).margin(1e-15));
  }
}

TEST_CASE("the dip in the section is the apparent dip", "[scene][section]") {
  for (const double dip : {10.0, 45.0, 80.0}) {
    for (const double across : {20.0, 70.0, 110.0, 200.0, 340.0}) {
      INFO(dip << " deg towards " << across << " deg off the section");
      const auto line = plane_in_section(radians(dip), radians(across + 15.0), radians(15.0));
      REQUIRE(line);
      CHECK(std::tan(line->dip) == Approx(-std::tan(radians(dip)) * std::cos(radians(across))));
      // Planes of spacing 1 are 1/cos(dip) above each other, and so are their lines.
      CHECK(line->spacing / std::cos(line->dip) == Approx(1.0 / std::cos(radians(dip))));
      CHECK(line->oblique == Approx(std::abs(std::sin(radians(dip)) * std::sin(radians(across)))));
    }
  }
}

TEST_CASE("an upright plane is an upright line, if it crosses the section", "[scene][section]") {
  for (const double across : {0.0, 60.0, 180.0, 250.0}) {
    const auto line = plane_in_section(radians(90.0), radians(across), 0.0);
    REQUIRE(line);
    CHECK(std::abs(line->dip) == Approx(radians(90.0)));
    CHECK(line->spacing == Approx(1.0 / std::abs(std::cos(radians(across)))));
  }
  CHECK_FALSE(plane_in_section(radians(90.0), radians(90.0), 0.0));
  CHECK_FALSE(plane_in_section(radians(90.0), radians(269.5), 0.0));
}
