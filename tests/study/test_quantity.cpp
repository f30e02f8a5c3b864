// Numbers found in results.
#include "io/files.h"
#include "openclose/core/error.h"
#include "openclose/study/quantity.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("a quantity is the last value of its point", "[study]") {
  const test::TemporaryFolder place;
  place.write("history.csv",
              "time_s,point,displacement_x_m,displacement_y_m,rotation_rad,velocity_x_m_per_s,velocity_y_m_per_s,angular_velocity_rad_per_s\n"
              "0,top,0,0,0,0,0,0\n0,top.left,0,0,0,0,0,0\n1,top,3,-4,0.5,6,8,0.25\n1,top.left,9,12,1,0,0,2\n");
  place.write("energy.csv", "time_s,kinetic_j\n0,1\n1,7.5\n");
  place.write("block_states.csv", "state,displacement_x_m,displacement_y_m\nstart,100,0\nfinal,5,12\nfinal,1,1\n");
  place.write("summary.json", "{\"max_penetration_m\": 0.125}");
  const auto value = [&](const std::string& quantity) { return quantity_in(place.path(), quantity); };
  CHECK(value("top.displacement_m") == 5.0);
  CHECK(value("top.displacement_y_m") == -4.0);
  CHECK(value("top.velocity_m_per_s") == 10.0);
  CHECK(value("top.left.displacement_m") == 15.0);
  CHECK(value("top.left.angular_velocity_rad_per_s") == 2.0);
  CHECK(value("energy.kinetic_j") == 7.5);
  CHECK(value("largest_displacement_m") == 13.0);
  CHECK(value("max_penetration_m") == 0.125);
  place.write("summary.json", "{\"max_penetration_m\": null}");
  CHECK_FALSE(value("max_penetration_m"));
  CHECK_FALSE(value("energy.nothing_j"));
}

TEST_CASE("a quantity that a scene will not have is refused with what it has", "[study]") {
  Scene scene = test::block_on_base();
  CHECK(usual_quantity(scene) == "largest_displacement_m");
  CHECK_NOTHROW(require_quantity("block.displacement_m", scene));
  scene.measured_points.resize(1);
  scene.measured_points[0].name = "top";
  CHECK(usual_quantity(scene) == "top.displacement_m");
  CHECK_NOTHROW(require_quantity("top.rotation_rad", scene));
  CHECK_NOTHROW(require_quantity("energy.kinetic_j", scene));
  CHECK_THROWS_WITH(require_quantity("top.displacment_m", scene),
                    ContainsSubstring("\"top.displacment_m\" is no quantity") && ContainsSubstring("top.displacement_m"));
  CHECK_THROWS_AS(require_quantity("block.displacement_m", scene), InputError);
  CHECK_THROWS_WITH(require_quantity("energy.kinetc_j", scene), ContainsSubstring("energy.kinetic_j"));
  CHECK_THROWS_AS(require_quantity("factor_of_safety", scene), InputError);  // a run has none
}
