// E1: planar failure, the paper's example 3.2, by strength reduction on the paper's scene.
#include <cmath>

#include "harness.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/analytical/planar_wedge.h"
#include "openclose/scene/reader.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

Scene scene_of(const std::string& method, double stiffness_factor) {
  Scene scene = read_scene(OPENCLOSE_PAPER_SCENES "/example_3_2.toml");
  scene.method.contact = method;
  scene.joints[0].normal_stiffness *= stiffness_factor;
  scene.joints[0].shear_stiffness *= stiffness_factor;
  scene.strength_reduction.curve.clear();
  return scene;
}

struct Safety {
  double factor = not_measured();
  double penetration = not_measured();
};

Safety safety_of(const Report& report, const Scene& scene) {
  Simulation simulation = report.simulate(scene);
  const auto result = factor_of_safety(simulation);
  if (!result.found() || !result.bracket.failed) return {};
  double deepest = 0.0;
  for (const Contact& c : result.states.front().contacts) {
    if (c.status != ContactStatus::open) deepest = larger(deepest, -c.gap);
  }
  return {result.stable(), deepest};
}

void planar_wedge(Report& report) {
  const double expected = analytical::factor_of_safety(analytical::PlanarWedge{});
  // Forces along and normal to one plane decide, so nothing but the width of the bracket is left; the elastic tilt of the wedge turns the plane by
  // less than (closure 0.3 mm)/(length 105 m) = 3e-6 rad, which changes F by less than 1e-5.
  for (const std::string& method : all_methods) {
    const Scene scene = scene_of(method, 1.0);
    const Safety s = safety_of(report, scene);
    report.near("factor of safety", method, expected, s.factor, scene.strength_reduction.width + 1e-5, "-", "Hoek & Bray; width of the bracket");
  }
  for (const double factor : {1.0, 0.5}) {
    const Scene scene = scene_of("hard", factor);
    const Safety s = safety_of(report, scene);
    report.near(text("factor of safety with {} times the joint stiffness", factor), "hard", expected, s.factor, scene.strength_reduction.width + 1e-5,
                "-", "rigid contact does not know the stiffness");
    report.near(text("penetration with {} times the joint stiffness", factor), "hard", 0.0, s.penetration, 1e-11, "m", "tolerance of the gap");
  }
}

const Registered<Case> registered{{"E1", "planar wedge", &planar_wedge}};

}  // namespace
}  // namespace openclose::verification
