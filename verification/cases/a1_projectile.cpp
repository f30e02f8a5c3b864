// A1: a block thrown into the air. All schemes are exact for constant acceleration; what is left is the rounding of some hundred sums.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/projectile.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

void projectile(Report& report) {
  const analytical::Projectile thrown;
  const double end = 2.0;
  const auto expected = analytical::projectile_position(thrown, end);
  for (const Scheme& scheme : schemes()) {
    const std::string& method = scheme.contact;
    for (const double dt : {0.1, 0.01}) {
      Scene scene = empty_scene();
      set_scheme(scene, scheme);
      scene.step = {dt, 10.0, 1e-6};
      scene.end_time = end;
      BlockInput block = free_block("stone", rectangle(0.0, 0.0, 1.0, 1.0));
      block.velocity = thrown.speed * Vec2(std::cos(thrown.elevation), std::sin(thrown.elevation));
      scene.blocks = {block};
      Simulation simulation = report.simulate(scene);
      const auto samples = history(simulation);
      const Vec2 moved = samples.empty() ? Vec2::Constant(not_measured()) : samples.back().motion.displacement;
      const std::string source = "parabola; scheme exact, rounding of t/dt sums";
      report.relative(with_variant(text("x after 2 s, dt = {} s", dt), scheme), method, expected[0], moved.x(), 1e-13, "m", source);
      report.relative(with_variant(text("y after 2 s, dt = {} s", dt), scheme), method, expected[1], moved.y(), 1e-13, "m", source);
      const double horizontal = samples.empty() || moved.x() == 0.0 ? not_measured() : samples.back().motion.velocity.x();
      report.against(Reference::conservation)
          .relative(with_variant(text("horizontal velocity after 2 s, dt = {} s", dt), scheme), method, block.velocity.x(), horizontal, 1e-13, "m/s",
                    "nothing acts that way: momentum is conserved; rounding of t/dt sums");
      check_ledger(report, with_variant(text("flight, dt = {} s", dt), scheme), method, simulation, !samples.empty());
    }
  }
}

const Registered<Case> registered{{"A1", "projectile", &projectile}};

}  // namespace
}  // namespace openclose::verification
