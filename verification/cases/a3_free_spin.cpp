// A3: a block that spins freely for one second. Exact rotation keeps its area; Shi's linear one makes it grow by (1 + omega^2 dt^2)^n.
#include <cmath>
#include <numbers>
#include <vector>

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
void check_kinetic_energy(Report& report, const std::string& rotation, const Scheme& scheme, const Simulation& simulation, double area) {
  const auto& system = simulation.system();
  const double spun = 0.5 * system.velocity(0).cwiseAbs2().dot(system.block(0).mass);
  report.against(Reference::ledger)
      .near(with_variant("energy ledger, imbalance over kinetic energy, " + rotation, scheme), scheme.contact, 0.0,
            std::isnan(area) ? not_measured() : std::abs(simulation.ledger().imbalance()) / spun, 1e-13, "-", "nothing acts; rounding of 100 steps");
}

/// [-] Parts of a step that each turn the block by themselves: the trapezoid of TR-BDF2 takes 2 - sqrt(2) of it, the other formula the rest.
std::vector<double> stages(const Scheme& scheme) {
  if (scheme.integrator != "tr_bdf2") return {1.0};
  const double first = 2.0 - std::numbers::sqrt2;
  return {first, 1.0 - first};
}

void spin(Report& report, const Scheme& scheme, RotationKind kind) {
  const double omega = 10.0, dt = 0.01;
  const int steps = 100;
  Scene scene = empty_scene();
  scene.gravity = Vec2::Zero();
  set_scheme(scene, scheme);
  scene.method.rotation = kind;
  scene.step = {dt, 1.0, 1e-6};
  scene.end_time = steps * dt;
  BlockInput block = free_block("spinner", rectangle(0.0, 0.0, 2.0, 1.0));
  block.angular_velocity = omega;
  scene.blocks = {block};
  Simulation simulation = report.simulate(scene);
  const double measured = area_ratio(simulation, omega * steps * dt);
  const std::string rotation = kind == RotationKind::exact ? "exact rotation" : "linear rotation";
  double expected = 1.0;
  if (kind == RotationKind::linear) {
    for (const double stage : stages(scheme)) expected *= analytical::linear_rotation_area_ratio(omega, stage * dt, steps);
  }
  report.against(kind == RotationKind::exact ? Reference::conservation : Reference::closed_form)
      .relative(with_variant("area ratio after 10 rad, " + rotation, scheme), scheme.contact, expected, measured, 1e-12, "-",
                kind == RotationKind::exact ? "rotation keeps areas" : "(1 + omega^2 dt^2)^n, for each stage of a step");
  check_kinetic_energy(report, rotation, scheme, simulation, measured);
}

void free_spin(Report& report) {
  for (const Scheme& scheme : schemes()) {
    spin(report, scheme, RotationKind::exact);
    if (scheme.contact == "dem") {
      report.leave_out("area ratio after 10 rad, linear rotation", scheme.contact, "Shi's rotation; the explicit method has the exact one only");
    } else if (scheme.integrator == "path_average") {
      report.leave_out(with_variant("area ratio after 10 rad, linear rotation", scheme), scheme.contact,
                       "refused: it has no path that could be averaged");
    } else {
      spin(report, scheme, RotationKind::linear);
    }
  }
}

const Registered<Case> registered{{"A3", "free spin", &free_spin}};

}  // namespace
}  // namespace openclose::verification
