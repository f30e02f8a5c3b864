// A3: a block that spins freely for one second. Exact rotation keeps its area; Shi's linear one makes it grow by (1 + omega^2 dt^2)^n.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/linear_rotation.h"
#include "openclose/geometry/polygon.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

/// Area after the spin over the area before; NaN if the block has not turned by the angle it should.
double area_ratio(Simulation& simulation, double angle) {
  const auto current = [&] {
    Polygon p;
    for (int v = 0; v < simulation.system().block(0).vertex_count; ++v) p.push_back(simulation.system().position(0, v));
    return signed_area(p);
  };
  const double before = current();
  if (history(simulation).empty()) return not_measured();
  const double turned = Motion::rotation(simulation.system().displacement(0));
  return std::abs(turned - angle) < 1e-9 ? current() / before : not_measured();
}

/// Nothing acts: the kinetic energy stays, and with it the ledger's only entry, which has no turnover to be compared with.
void check_kinetic_energy(Report& report, RotationKind kind, const std::string& method, const Simulation& simulation, double area) {
  const auto& system = simulation.system();
  const double spun = 0.5 * system.velocity(0).cwiseAbs2().dot(system.block(0).mass);
  report.near(std::string("energy ledger, imbalance over kinetic energy, ") + (kind == RotationKind::exact ? "exact" : "linear") + " rotation",
              method, 0.0, std::isnan(area) ? not_measured() : std::abs(simulation.ledger().imbalance()) / spun, 1e-13, "-",
              "nothing acts; rounding of 100 steps");
}

void free_spin(Report& report) {
  const double omega = 10.0, dt = 0.01;
  const int steps = 100;
  for (const std::string& method : all_methods) {
    for (const RotationKind kind : {RotationKind::exact, RotationKind::linear}) {
      if (method == "dem" && kind == RotationKind::linear) {
        report.leave_out("area ratio after 10 rad, linear rotation", method, "Shi's rotation; the explicit method has the exact one only");
        continue;
      }
      Scene scene = empty_scene();
      scene.gravity = Vec2::Zero();
      scene.method.contact = method;
      scene.method.rotation = kind;
      scene.step = {dt, 1.0, 1e-6};
      scene.end_time = steps * dt;
      BlockInput block = free_block("spinner", rectangle(0.0, 0.0, 2.0, 1.0));
      block.angular_velocity = omega;
      scene.blocks = {block};
      Simulation simulation = report.simulate(scene);
      const double measured = area_ratio(simulation, omega * steps * dt);
      if (kind == RotationKind::exact) {
        report.relative("area ratio after 10 rad, exact rotation", method, 1.0, measured, 1e-12, "-", "rotation keeps areas");
      } else {
        report.relative("area ratio after 10 rad, linear rotation", method, analytical::linear_rotation_area_ratio(omega, dt, steps), measured, 1e-12,
                        "-", "(1 + omega^2 dt^2)^n");
      }
      check_kinetic_energy(report, kind, method, simulation, measured);
    }
  }
}

const Registered<Case> registered{{"A3", "free spin", &free_spin}};

}  // namespace
}  // namespace openclose::verification
