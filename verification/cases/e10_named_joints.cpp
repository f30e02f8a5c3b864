// E10: slabs on parallel planes that have strengths of their own, given by the joint set or by the single line: the plane with the least factor
// decides. The joint of the materials, which no contact here has, is the strongest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness.h"
#include "openclose/scene/reader.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double dip_deg = 30.0, length = 10.0;                 // [deg], [m]
constexpr double lower_thickness = 2.0, upper_thickness = 1.0;  // [m] of the slabs
constexpr double density = 2700.0, gravity = 9.81;

struct Strength {
  double friction_deg;
  double cohesion;  // [Pa]
};
struct Slabs {
  const char* name;
  Strength lower, upper;
  bool by_set;  ///< both planes are of one joint set
};
constexpr Slabs all_slabs[] = {{"weak below", {36.0, 0.0}, {40.0, 0.0}, false},
                               {"weak above", {40.0, 0.0}, {36.0, 0.0}, false},
                               {"cohesion below", {25.0, 2e4}, {45.0, 0.0}, false},
                               {"one set", {35.0, 0.0}, {35.0, 0.0}, true}};

std::string point(double along, double above) {
  const Vec2 at = on_slope(dip_deg * analytical::degree, along, above);
  return fmt::format("[{:.17g}, {:.17g}]", at.x(), at.y());
}

std::string joint_of(const char* naming, const Strength& strength) {
  return fmt::format("[[joint]]\n{}\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 4e8\nfriction_angle_deg = {}\ncohesion_pa = {}\n",
                     naming, strength.friction_deg, strength.cohesion);
}

Scene scene_of(const Slabs& slabs, const std::string& method) {
  constexpr double top = lower_thickness + upper_thickness;
  std::string text = fmt::format("[[material]]\nname = 'rock'\ndensity_kg_per_m3 = {}\n", density);
  text += joint_of("materials = ['rock', 'rock']", {60.0, 1e6}) + joint_of("name = 'lower'", slabs.lower) + joint_of("name = 'upper'", slabs.upper);
  text += fmt::format("[domain]\nmaterial = 'rock'\nvertices_m = [{}, {}, {}, {}]\n", point(0.0, -1.0), point(length, -1.0), point(length, top),
                      point(0.0, top));
  if (slabs.by_set) {
    text += fmt::format("[[joint_set]]\ndip_deg = {}\nspacing_m = {}\norigin_m = {}\njoint = 'lower'\nregion_m = [{}, {}, {}, {}]\n", -dip_deg,
                        lower_thickness, point(0.0, 0.0), point(-1.0, -0.5), point(length + 1.0, -0.5), point(length + 1.0, top), point(-1.0, top));
  } else {
    text += fmt::format("[[joint_line]]\nfrom_m = {}\nto_m = {}\njoint = 'lower'\n", point(-1.0, 0.0), point(length + 1.0, 0.0));
    text +=
        fmt::format("[[joint_line]]\nfrom_m = {}\nto_m = {}\njoint = 'upper'\n", point(-1.0, lower_thickness), point(length + 1.0, lower_thickness));
  }
  text += fmt::format("[[fixed_line]]\nfrom_m = {}\nto_m = {}\n", point(0.0, -1.0), point(length, -1.0));
  Scene scene = scene_of_text(text, slabs.name);
  scene.method.contact = method;
  scene.step.dt = 0.01;
  scene.strength_reduction.width = 1e-4;
  use_joint_springs_as_penalty(scene);
  return scene;
}

/// Of everything above a plane.
double factor_on(const Strength& strength, double thickness) {
  const double weight = density * gravity * length * thickness, dip = dip_deg * analytical::degree;
  const double friction = std::tan(strength.friction_deg * analytical::degree);
  return (strength.cohesion * length + weight * std::cos(dip) * friction) / (weight * std::sin(dip));
}

void named_joints(Report& report) {
  for (const Slabs& slabs : all_slabs) {
    const double expected = std::min(factor_on(slabs.lower, lower_thickness + upper_thickness), factor_on(slabs.upper, upper_thickness));
    for (const std::string& method : all_methods) {
      const Scene scene = scene_of(slabs, method);
      report.near(std::string(slabs.name) + ": factor of safety", method, expected, strength_reduction_factor(report, scene),
                  scene.strength_reduction.width, "-", "least of (c L + W cos psi tan phi)/(W sin psi); width of the bracket");
    }
  }
}

const Registered<Case> registered{{"E10", "joints that sets and lines name", &named_joints}};

}  // namespace
}  // namespace openclose::verification
