// E6: the smallest friction angle at which slopes of two joint sets stand without cohesion, by strength reduction and by limit analysis.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/limit_analysis.h"
#include "openclose/scene/reader.h"
#include "openclose/scene/writer.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

struct Slope {
  const char* file;
  const char* name;
  /// What slides on planes does so with the normal forces that equilibrium gives. Between columns that turn together equilibrium leaves them open:
  /// limit analysis chooses those that hold best, springs choose others (with ks/kn from 0.1 to 10 the columns here fall at 21.7 to 21.3 degrees, the
  /// limit is 21.0), and without dilatancy all are right.
  bool forces_determined;
};
constexpr Slope slopes[] = {
    {"slope_face_70_joints_0_m70", "face 70, joints 0 and -70 deg", true},   {"slope_face_50_joints_5_50", "face 50, joints 5 and 50 deg", true},
    {"slope_face_55_joints_0_55", "face 55, joints 0 and 55 deg", true},     {"slope_face_60_joints_20_m70", "face 60, joints 20 and -70 deg", true},
    {"slope_face_70_joints_20_m60", "face 70, joints 20 and -60 deg", true}, {"slope_face_60_joints_5_55", "face 60, joints 5 and 55 deg", true},
    {"slope_face_60_columns_m70", "face 60, columns at -70 deg", false}};
/// A load that comes on at once, as reduced strength does for an explicit method, moves a spring twice as far as one that is put on slowly.
constexpr double sudden_load = 2.0;
/// Friction of the pass before lets static steps of `shi` leave a fixed part of the unbalanced force of the last one.
constexpr int linear_steps = 400;
constexpr double tolerance_deg = 0.1;  // displacement before failure turns blocks by up to 0.07 deg, the rest is the bracket and closure

double degrees(double radians) {
  return radians / analytical::degree;
}

void critical_friction(Report& report) {
  for (const Slope& slope : slopes) {
    Scene scene = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES "/") + slope.file + ".toml");
    const double expected = degrees(analytical::critical_friction(analytical::parse_rigid_blocks(write_scene(scene))).angle);
    const double failure_displacement = scene.settle.failure_displacement;
    const auto max_steps = scene.settle.max_steps;
    for (const std::string& method : all_methods) {
      scene.method.contact = method;
      scene.settle.failure_displacement = method == "dem" ? sudden_load * failure_displacement : failure_displacement;
      scene.settle.max_steps = method == "shi" ? linear_steps : max_steps;
      const SlidingLimit sliding = sliding_limit(report, scene);
      const double angle = degrees(std::atan(std::tan(scene.joints[0].friction_angle) / sliding.factor));
      const std::string name = slope.name;
      if (slope.forces_determined) {
        report.near(name + ": critical friction angle", method, expected, angle, tolerance_deg, "deg", "limit analysis");
      } else {
        report.near(name + ": critical friction angle below the limit", method, 0.0, exceedance(expected, angle), tolerance_deg, "deg",
                    "limit analysis: " + text("{:.4g} deg", expected));
        const double own = degrees(std::atan(std::tan(scene.joints[0].friction_angle) / sliding.limit));
        report.near(name + ": critical friction angle, sliding with its normal forces", method, own, angle, tolerance_deg, "deg",
                    "limit analysis with shear strengths that do not depend on the normal forces");
      }
    }
  }
}

const Registered<Case> registered{{"E6", "critical friction angle of jointed slopes", &critical_friction, Reference::limit_analysis}};

}  // namespace
}  // namespace openclose::verification
