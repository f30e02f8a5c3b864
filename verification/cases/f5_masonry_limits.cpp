// F5 and F6: walls that are pushed sideways (Ferris and Tin-Loi 2001) and an arch on a tilting base, against the limits that other codes have printed
// and against limit analysis of the same blocks.
#include <cmath>
#include <functional>

#include "harness.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/scene/reader.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

struct System {
  const char* file;
  const char* name;
  bool tilts;       ///< the load is a tilt [deg]; else a horizontal acceleration [g]
  double printed;   ///< by another code
  double rounding;  ///< of that
};
constexpr double gravity = 9.81;  // [m/s2]
constexpr double width = 2e-4;    // [-] of the load

Scene under(const System& system, double load, const std::string& method) {
  Scene scene = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES "/../blind/") + system.file + ".toml");
  const double angle = load * analytical::degree;
  scene.gravity = system.tilts ? Vec2(gravity * std::sin(angle), -gravity * std::cos(angle)) : Vec2(gravity * load, -gravity);
  scene.method.contact = method;
  scene.strength_reduction.limit_analysis = false;
  return scene;
}

/// Whether the system stands with its own strength: 1 or 0. Arches and walls that are to turn over do so with any strength: such a factor is 0.
double stands_under(const Report& report, Scene scene) {
  if (report.null_solver()) scene.strength_reduction.definition = FactorDefinition::large_displacements;  // see strength_reduction_factor()
  Simulation simulation = report.simulate(scene);
  const FactorOfSafety result = factor_of_safety(simulation);
  if (result.verdict == FactorVerdict::no_equilibrium) return 0.0;
  if (result.verdict != FactorVerdict::certified) return not_measured();
  return result.stable() >= 1.0 ? 1.0 : 0.0;
}

/// The largest load that it bears.
double limit(const System& system, const std::function<double(double)>& stands) {
  constexpr double reach = 0.1;  // [-] of the printed load on either side
  return threshold(system.printed * (1.0 + reach), system.printed * (1.0 - reach), width * system.printed, stands);
}

void masonry(Report& report, const System& system) {
  const double best = limit(system, [&](double load) { return limit_state(under(system, load, "soft")).factor >= 1.0 ? 1.0 : 0.0; });
  const char* unit = system.tilts ? "deg" : "g";
  for (const std::string method : {"soft", "hard"}) {
    const double found = limit(system, [&](double load) { return stands_under(report, under(system, load, method)); });
    report.near(std::string(system.name) + ": limit", method, system.printed, found, system.rounding + width * system.printed, unit,
                "limit analysis of another code, as rounded there");
    report.against(Reference::limit_analysis)
        .near(std::string(system.name) + ": limit above limit analysis", method, 0.0, exceedance(found, best), width * system.printed, unit,
              text("limit analysis: {:.6g}", best));
  }
}

void walls(Report& report) {
  masonry(report, {"ferris_tin_loi_wall_1", "wall 1, friction 0.65", false, 0.64, 0.005});
  masonry(report, {"grid_4_by_4", "wall of four courses, friction 0.58", false, 0.58, 0.005});
}

void tilted_arch(Report& report) {
  masonry(report, {"lact3_arch", "arch of 25 voussoirs", true, 17.10, 0.005});
}

const Registered<Case> walls_registered{{"F5", "walls under a horizontal acceleration", &walls, Reference::limit_analysis}};
const Registered<Case> arch_registered{{"F6", "arch on a tilting base", &tilted_arch, Reference::limit_analysis}};

}  // namespace
}  // namespace openclose::verification
