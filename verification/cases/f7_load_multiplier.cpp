// F7: the multiplier of a load that one block bears with its own strength: sliding down and up a plane, tipping, cohesion, lifting off.
#include <cmath>

#include "harness.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr const char* bracket = "; width of the bracket";
constexpr double width = 1e-4;  // [-] of the multiplier

Scene with_method(Scene scene, const std::string& method) {
  scene.method.contact = method;
  scene.strength_reduction.width = width;
  return scene;
}

/// tan(phi - alpha) downhill, tan(phi + alpha) uphill: the resultant of weight and body force leans by phi from the normal.
void sliding(Report& report, const std::string& method) {
  analytical::BlockOnPlane data;
  data.friction_angle = 38.0 * analytical::degree;
  for (const double slope : {0.0, 12.0, 30.0}) {
    data.slope_angle = slope * analytical::degree;
    const Scene scene = with_method(block_on_plane(data), method);
    report.relative(text("slides down {:g} degrees at a horizontal body force of", slope), method, std::tan(data.friction_angle - data.slope_angle),
                    load_multiplier(report, scene, "gravity_x"), width, "-", std::string("tan(phi - alpha)") + bracket);
    report.relative(text("slides up {:g} degrees at a horizontal body force of", slope), method, std::tan(data.friction_angle + data.slope_angle),
                    load_multiplier(report, scene, "-gravity_x"), width, "-", std::string("tan(phi + alpha)") + bracket);
  }
}

/// The drawn geometry does not tilt on its springs: b/h is right for soft joints, too.
void tipping(Report& report, const std::string& method) {
  analytical::BlockOnPlane data;
  data.width = 0.5;
  data.height = 2.0;
  data.slope_angle = 0.0;
  data.friction_angle = 60.0 * analytical::degree;
  Scene scene = with_method(block_on_plane(data), method);
  report.relative("tips at a horizontal body force of", method, data.width / data.height, load_multiplier(report, scene, "gravity_x"), width, "-",
                  std::string("b/h") + bracket);
  constexpr double height = 1.5;  // [m]
  scene.loads = {{1, {data.width, height}, {-1000.0, 0.0}, "push"}};
  report.relative("tips at a push, in kN", method, data.weight() * data.width / (2.0 * height) / 1000.0, load_multiplier(report, scene, "push"),
                  width, "kN", std::string("W b/(2 y)") + bracket);
}

/// mu (W cos alpha + p b) + c b - W sin alpha over s b.
void surcharged(Report& report, const std::string& method) {
  analytical::BlockOnPlane data;
  data.slope_angle = 20.0 * analytical::degree;
  data.friction_angle = 30.0 * analytical::degree;
  constexpr double pressure = 10e3, shear = 4e3, cohesion = 6e3;  // [Pa]
  Scene scene = with_method(block_on_plane(data), method);
  scene.joints[0].cohesion = cohesion;
  const auto& corners = scene.blocks[1].vertices;
  // The top's outline runs uphill.
  scene.surcharges = {{1, corners[2], corners[3], pressure, 0.0}, {1, corners[2], corners[3], 0.0, -shear, "drag"}};
  const double resisting = data.friction() * (data.normal_weight() + pressure * data.width) + cohesion * data.width;
  const double expected = (resisting - data.weight() * std::sin(data.slope_angle)) / (shear * data.width);
  report.relative("drag on the top, with a weight beside it", method, expected, load_multiplier(report, scene, "drag"), width, "-",
                  std::string("(mu (W cos alpha + p b) + c b - W sin alpha)/(s b)") + bracket);
}

/// Tensile strength on the whole base.
void lifting(Report& report, const std::string& method) {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  Scene scene = with_method(block_on_plane(data), method);
  constexpr double tension = 8e3;  // [Pa]
  scene.joints[0].tensile_strength = tension;
  scene.joints[0].cohesion = 50e3;
  report.relative("lifts off at a vertical body force of", method, 1.0 + tension * data.width / data.weight(),
                  load_multiplier(report, scene, "gravity_y"), width, "-", std::string("1 + f b/W") + bracket);
}

void multiplier(Report& report) {
  for (const std::string& method : all_methods) {
    sliding(report, method);
    tipping(report, method);
    surcharged(report, method);
    lifting(report, method);
  }
}

const Registered<Case> registered{{"F7", "the multiplier of a load on one block", &multiplier}};

}  // namespace
}  // namespace openclose::verification
