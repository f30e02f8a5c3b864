// F5 and F6: walls that are pushed sideways (Ferris and Tin-Loi 2001) and an arch on a tilting base, against the limits that other codes have printed
// and against limit analysis of the same blocks.
#include <cmath>
#include <optional>

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

Scene read(const System& system) {
  return read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES "/../blind/") + system.file + ".toml");
}

/// The largest load that limit analysis allows: gravity turned, or with a horizontal part, until strength has no room left.
double limit_of_analysis(const System& system) {
  const auto stands = [&](double load) {
    Scene scene = read(system);
    const double angle = load * analytical::degree;
    scene.gravity = system.tilts ? Vec2(gravity * std::sin(angle), -gravity * std::cos(angle)) : Vec2(gravity * load, -gravity);
    return limit_state(scene).factor >= 1.0 ? 1.0 : 0.0;
  };
  constexpr double reach = 0.1;  // [-] of the printed load on either side
  return threshold(system.printed * (1.0 + reach), system.printed * (1.0 - reach), width * system.printed, stands);
}

/// Without cohesion only the direction of gravity counts: the tangent of the tilt is a multiplier of horizontal gravity.
double load_of(const System& system, double multiplier) {
  return system.tilts ? std::atan(multiplier) / analytical::degree : multiplier;
}

/// What limit analysis of the same contacts has for the multiplier, its dead and live loads apart.
void second_opinion(Report& report, const System& system, Scene scene, double best) {
  scene.method.contact = "soft";
  scene.strength_reduction.increase = "gravity_x";
  std::optional<double> multiplier;
  if (!report.null_solver()) {
    Simulation simulation = report.simulate(scene);
    const FactorOfSafety found = factor_of_safety(simulation);
    if (found.limit_analysis) multiplier = found.limit_analysis->factor;
  }
  report.against(Reference::limit_analysis)
      .near(std::string(system.name) + ": second opinion", "soft", best, multiplier ? load_of(system, *multiplier) : not_measured(),
            width * system.printed, system.tilts ? "deg" : "g", "the same programs under gravity of the whole load, by bisection; its width");
}

void masonry(Report& report, const System& system) {
  const double best = limit_of_analysis(system);
  const char* unit = system.tilts ? "deg" : "g";
  Scene scene = read(system);
  scene.gravity = {0.0, -gravity};
  scene.strength_reduction.width = width;
  for (const std::string method : {"soft", "hard"}) {
    scene.method.contact = method;
    const double found = load_of(system, load_multiplier(report, scene, "gravity_x"));
    report.near(std::string(system.name) + ": limit", method, system.printed, found, system.rounding + width * system.printed, unit,
                "limit analysis of another code, as rounded there");
    report.against(Reference::limit_analysis)
        .near(std::string(system.name) + ": limit above limit analysis", method, 0.0, exceedance(found, best), width * system.printed, unit,
              text("limit analysis: {:.6g}", best));
  }
  second_opinion(report, system, scene, best);
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
