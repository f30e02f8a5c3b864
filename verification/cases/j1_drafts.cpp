// J1: the scenes that `openclose new` writes, read as a user's would be, with the answers that theory has for their dimensions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness.h"
#include "openclose/analytical/masonry_arch.h"
#include "openclose/analytical/planar_wedge.h"
#include "openclose/draft/drafts.h"
#include "openclose/scene/reader.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

using Asked = std::map<std::string, double>;

Scene drafted(std::string_view name, const Asked& asked, const std::string& method) {
  const auto draft = std::ranges::find(drafts(), name, &Draft::name);
  Scene scene = scene_of_text(scene_from(*draft, asked), std::string(name));
  scene.method.contact = method;
  return scene;
}

/// Without tension or crushing, and with friction enough, an arch stands as long as a line of thrust fits into it.
void arch(Report& report) {
  constexpr double reach = 1e-3;  // [-] of the thickness
  for (const int voussoirs : {7, 10}) {
    const double limit = analytical::smallest_arch_thickness(voussoirs, analytical::VoussoirShape::straight);
    for (const double change : {-reach, reach}) {
      Scene scene =
          drafted("arch", {{"voussoirs", voussoirs}, {"radius_m", 1.0}, {"thickness_m", (1.0 + change) * limit}, {"springing_deg", 0.0}}, "hard");
      // The thrust leans by less than 30 degrees; only a mechanism moves by 1 cm.
      scene.joints[0].friction_angle = 60.0 * analytical::degree;
      scene.settle.failure_displacement = 1e-2;
      report.near(fmt::format("semicircle of {} voussoirs, {:+} of the smallest thickness: stands", voussoirs, change), "hard", change > 0.0 ? 1.0 : 0.0,
                  stands(report, scene), 0.0, "-", "line of thrust, as in F1");
    }
  }
}

/// Every brick that slides, on whichever bed, has the same ratio of friction to driving force.
void wall(Report& report) {
  for (const double tilt : {10.0, 15.0}) {
    for (const double door : {0.0, 2.0}) {
      for (const std::string method : {"soft", "hard"}) {
        const Scene scene = drafted("wall", {{"courses", 5.0}, {"tilt_deg", tilt}, {"door_bricks", door}, {"door_courses", 2.0}}, method);
        const double expected = std::tan(35.0 * analytical::degree) / std::tan(tilt * analytical::degree);
        report.near(fmt::format("wall tilted by {} degrees, door of {} bricks: factor of safety", tilt, door), method, expected,
                    strength_reduction_factor(report, scene), scene.strength_reduction.width * expected, "-",
                    "tan(friction angle)/tan(tilt); width of the bracket");
      }
    }
  }
}

/// One joint through the toe is left where the spacings are wider than the slope.
void slope(Report& report) {
  for (const double face : {50.0, 75.0}) {
    analytical::PlanarWedge wedge;
    wedge.height = 40.0;
    wedge.face_angle = face * analytical::degree;
    wedge.plane_angle = 32.0 * analytical::degree;
    wedge.cohesion = 25e3;
    wedge.friction_angle = 35.0 * analytical::degree;
    wedge.unit_weight = 2600.0 * 9.81;
    for (const std::string& method : all_methods) {
      const Scene scene = drafted(
          "slope",
          {{"face_angle_deg", face}, {"bedding_dip_deg", 32.0}, {"bedding_spacing_m", 1000.0}, {"cross_spacing_m", 1000.0}, {"behind_m", 80.0}},
          method);
      report.near(fmt::format("slope of {} degrees with one joint: factor of safety", face), method, analytical::factor_of_safety(wedge),
                  strength_reduction_factor(report, scene), scene.strength_reduction.width + 1e-5, "-",
                  "Hoek & Bray; width of the bracket, and the tilt of the wedge as in E1");
    }
  }
}

void scenes_to_begin_with(Report& report) {
  arch(report);
  wall(report);
  slope(report);
}

const Registered<Case> registered{{"J1", "scenes to begin with", &scenes_to_begin_with}};

}  // namespace
}  // namespace openclose::verification
