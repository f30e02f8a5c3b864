// E3: plane failure on parallel joints, the paper's example 3.3 in three sizes of model. The whole wedge has a closed form; the two whose back wall
// cuts the wedge, with the 28 blocks that the paper counts, have the limit analysis.
#include <string>

#include "harness.h"
#include "openclose/analytical/planar_wedge.h"
#include "openclose/scene/reader.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

// The joints close by less than (26.1 kN/m3 x 70 m)/(1 GPa/m) = 1.8 mm each, ten of them lie below the sliding plane of 450 m: it turns by less than
// 4e-5 rad. F changes by 3.5 per radian.
constexpr double tilt = 1.5e-4;

analytical::PlanarWedge whole_wedge() {
  constexpr double degree = analytical::degree;
  return {260, 55 * degree, 35.2 * degree, 0.1e6, 40 * degree, 26.1e3};
}

void parallel_planes(Report& report) {
  struct Model {
    const char* file;
    const char* name;
    bool whole;
  };
  const Model models[] = {
      {"wedge", "whole wedge", true}, {"toe", "back wall 100 m, joint through the toe", false}, {"shifted", "back wall 95 m, joints shifted", false}};
  for (const Model& model : models) {
    Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES "/example_3_3_") + model.file + ".toml");
    const analytical::LimitState limit = limit_state(scene);
    const double tolerance = scene.strength_reduction.width + tilt;
    for (const std::string& method : all_methods) {
      scene.method.contact = method;
      const double factor = strength_reduction_factor(report, scene);
      report.against(Reference::limit_analysis)
          .near(std::string(model.name) + ": factor of safety", method, limit.factor, factor, tolerance, "-",
                "limit analysis; width of the bracket and tilt by closure");
      if (model.whole) {
        report.near(std::string(model.name) + ": factor of safety", method, analytical::factor_of_safety(whole_wedge()), factor, tolerance, "-",
                    "Hoek & Bray; width of the bracket and tilt by closure");
      } else {
        // Counted in what has been solved, so that a solver that does nothing fails.
        const double blocks = factor > 0 ? static_cast<double>(scene.blocks.size()) : not_measured();
        report.near(std::string(model.name) + ": blocks", method, 28, blocks, 0, "-", "the paper's section 3.3");
      }
    }
  }
}

const Registered<Case> registered{{"E3", "plane failure on parallel joints", &parallel_planes}};

}  // namespace
}  // namespace openclose::verification
