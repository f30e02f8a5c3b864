// E4: sixteen toppling columns on a stepped base: the friction angle at which they fall, by strength reduction, between limit analysis and recursion.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/goodman_bray.h"
#include "openclose/analytical/limit_analysis.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double trial_friction_deg = 40.0;

/// How the method is run: an explicit one needs softer springs for its step, and its time.
struct Setting {
  const char* method;
  double stiffness;  ///< [Pa/m]
  double width;      ///< [-] of the bracket of the factor
};
constexpr Setting settings[] = {{"soft", 1e10, 1e-4}, {"hard", 1e10, 1e-4}, {"dem", 1e9, 1e-3}};

Scene columns(const Setting& setting) {
  const analytical::GoodmanBray data;
  analytical::BlockOnPlane joint;
  joint.friction_angle = trial_friction_deg * analytical::degree;
  joint.density = data.unit_weight / data.gravity;
  Scene scene = empty_scene(joint);
  scene.gravity = {-data.gravity * std::sin(data.dip), -data.gravity * std::cos(data.dip)};
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = setting.stiffness;
  for (const analytical::RigidBlock& b : analytical::assembly_of(data, 1.0).blocks) {
    BlockInput block = free_block(b.name, b.vertices);
    block.fixed = b.fixed;
    scene.blocks.push_back(block);
  }
  scene.method.contact = setting.method;
  scene.method.penalty = setting.stiffness;
  scene.method.penalty_shear_ratio = 1.0;
  scene.strength_reduction.width = setting.width;
  scene.step.max_displacement = 0.1;
  return scene;
}

/// [rad] By how much the joints' closures may turn a column: all of them, under the tallest column, over its height.
double turned_by_closures(const Setting& setting) {
  const analytical::GoodmanBray data;
  const double tallest = data.height(data.crest);
  return data.count * data.unit_weight * tallest / setting.stiffness / tallest;
}

double degrees(double radians) {
  return radians / analytical::degree;
}

/// The recursion is where the columns fall: as they lean over, each turns about its lower corner, presses on its neighbour with the upper end of
/// their common side and slides there, which is what the recursion assumes. Limit analysis chooses its forces so that the columns hold best; with
/// forces that dilatancy does not tie to the motion neither is wrong, but what comes to rest from slack or settled joints finds the state of the
/// recursion (from friction angles of 40 to 60 degrees and joints of 1e9 to 1e11 Pa/m alike), at the limit with its forces between the columns to
/// 1e-4.
void goodman_bray(Report& report) {
  const analytical::GoodmanBray data;
  const auto assembly = analytical::assembly_of(data, 1.0);
  const double recursion = std::atan(analytical::limiting_friction(data));
  const double associated = analytical::critical_friction(assembly).angle;
  analytical::LimitAnalysisOptions constant_volume;
  constant_volume.zero_dilatancy = true;
  const double other = analytical::critical_friction(assembly, constant_volume).angle;
  for (const Setting& setting : settings) {
    const double trial = std::tan(trial_friction_deg * analytical::degree);
    const double angle = std::atan(trial / strength_reduction_factor(report, columns(setting)));
    // d(phi) = sin(phi) cos(phi) dF/F.
    const double tolerance = 0.5 * std::sin(2.0 * recursion) * setting.width + turned_by_closures(setting);
    report.against(Reference::limit_analysis)
        .between(
            "critical friction angle between the limits", setting.method, degrees(associated), degrees(recursion + tolerance), degrees(angle), "deg",
            "limit analysis with dilatancy, an upper bound of strength (at constant volume, by Gilbert et al.: " + text("{:.2f}", degrees(other)) +
                "); recursion");
    report.near("critical friction angle", setting.method, degrees(recursion), degrees(angle), degrees(tolerance), "deg",
                "recursion; width of the bracket and what closures turn");
  }
  report.leave_out(
      "critical friction angle", "shi",
      "its passes, with the friction of the pass before, do not come to an end in the last 0.4 % before the limit: it answers with an interval");
}

const Registered<Case> registered{{"E4", "toppling columns of Goodman and Bray", &goodman_bray}};

}  // namespace
}  // namespace openclose::verification
