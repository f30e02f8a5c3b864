// D3: small vibration of a block that rests on its two corners: the tangent of the code, and a run in time.
#include <Eigen/Eigenvalues>
#include <cmath>

#include "harness.h"
#include "openclose/analytical/single_spring.h"
#include "openclose/analytical/two_spring_block.h"
#include "scenes.h"
#include "support/equations.h"

namespace openclose::verification {
namespace {

analytical::BlockOnPlane level_block() {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  data.friction_angle = 45.0 * analytical::degree;
  return data;
}

struct Modes {
  Eigen::Vector3d frequencies;  ///< [rad/s] ascending
  Eigen::Matrix3d shapes;
};

/// Modes of M x'' + K x = 0 with the code's own tangent at rest.
Modes modes_of(Simulation& simulation) {
  if (!settle(simulation).settled) return {Eigen::Vector3d::Constant(not_measured()), Eigen::Matrix3d::Constant(not_measured())};
  const auto problem = simulation.problem(1e-3, false);
  std::vector<ContactSprings> springs;
  for (const Contact& c : problem.contacts) springs.push_back(simulation.enforcement().springs(problem, c));
  const Eigen::Matrix3d k = test::stiffness_of(problem, springs);
  const Eigen::Matrix3d m = simulation.system().block(1).mass.asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> solver(k, m);
  return {solver.eigenvalues().cwiseMax(0.0).cwiseSqrt(), solver.eigenvectors()};
}

Scene scene_of(const Scheme& scheme, double dt) {
  Scene scene = block_on_plane(level_block());
  set_scheme(scene, scheme);
  scene.step.dt = dt;
  scene.settle.unbalanced_fraction = 1e-12;
  use_joint_springs_as_penalty(scene);
  return scene;
}

/// Share of the first displacement, along a mode, that is left after `steps` steps from rest.
double share_after(Simulation& simulation, int mode, int steps) {
  const Modes modes = modes_of(simulation);
  if (modes.shapes.hasNaN()) return not_measured();
  BlockSystem& system = simulation.change_system();
  const Eigen::Vector3d rest = system.displacement(1), shape = modes.shapes.col(mode);
  // Small against the closure of 5e-4 m, so that contacts stay closed and the change of geometry (amplitude over height) stays below the error.
  const double amplitude = 1e-6 / shape.cwiseAbs().maxCoeff();
  // The shear springs stretch with the corners.
  const Eigen::Vector3d still = Eigen::Vector3d::Zero();
  for (Contact& c : simulation.change_contacts()) {
    const ContactKinematics k(system, c, still, still);
    c.elastic_slip += amplitude * (c.vertex_block == 1 ? k.shear_vertex : k.shear_edge).dot(shape);
  }
  system.advance(1, amplitude * shape);
  simulation.positions_changed();
  simulation.restart_clock();
  const double dt = simulation.scene().step.dt;
  for (int i = 0; i < steps; ++i) {
    // Near the critical step advance() would cut what is asked for.
    if (!(simulation.is_explicit() ? simulation.step(dt, false).accepted : simulation.advance(dt))) return not_measured();
  }
  const Eigen::Vector3d mass = system.block(1).mass;
  return (system.displacement(1) - rest).dot(mass.cwiseProduct(shape)) / (amplitude * shape.dot(mass.cwiseProduct(shape)));
}

/// With an amplitude of 1e-6 m beside closures of 5e-4 m the energies that come and go are small against those that forces of the size of the weight
/// round: eps W times coordinates of a metre in each of 40 steps.
void check_small_ledger(Report& report, const std::string& name, const std::string& method, const Simulation& simulation, bool done) {
  const double bound = 40.0 * 2.2e-16 * level_block().weight();
  report.against(Reference::ledger)
      .near(name + ": energy ledger, imbalance", method, 0.0, done ? std::abs(simulation.ledger().imbalance()) : not_measured(), bound, "J",
            "work of the forces = change of kinetic energy; rounding of the weight's work in coordinates of a metre");
}

/// 2/w_max of the two corner springs, what the program says of it, and what happens on either side.
void critical(Report& report, double highest) {
  const double expected = 2.0 / highest;
  Simulation simulation = report.simulate(scene_of(scheme_named("dem"), 1e-3));
  const bool settled = settle(simulation).settled && simulation.is_explicit();
  // The closed form holds for the block under its weight, which the bound leaves out: W h/2 beside the stiffness against rotation, half for w.
  const analytical::BlockOnPlane data = level_block();
  const double against_rotation = 0.5 * (data.normal_stiffness * data.width * data.width + data.shear_stiffness * data.height * data.height);
  const double by_weight = 0.5 * data.weight() * 0.5 * data.height / against_rotation;
  report.relative("critical step", "dem", expected, settled ? simulation.explicit_stepper()->critical_step() : not_measured(), by_weight, "s",
                  "2/w_max; geometric stiffness of the weight is not counted");
  // At the fraction f of the critical step the mode is cos(n p) after n steps, sin(p/2) = f. An amplitude of 1e-6 m changes w by 1e-6 of it.
  const double f = 0.99, phase = 2.0 * std::asin(f), steps = 398.0;
  Simulation stable = report.simulate(scene_of(scheme_named("dem"), f * expected));
  report.near("share left after 398 steps at 0.99 of the critical step", "dem", std::cos(steps * phase), share_after(stable, 2, 398),
              steps * 2.0 * f / std::sqrt(1.0 - f * f) * 1e-6, "-", "cos(n p), sin(p/2) = 0.99: stable");
  // Beyond, the phase is imaginary. From 5e-4 m on contacts would open, which settles what they have gained: so few steps that it stays far below.
  const double beyond = 1.01, growth = std::cosh(2.0 * 16.0 * std::acosh(beyond));
  Simulation unstable = report.simulate(scene_of(scheme_named("dem"), beyond * expected));
  report.near("share after 16 steps at 1.01 of the critical step", "dem", growth, share_after(unstable, 2, 16),
              growth * 16.0 * 2.0 * beyond / std::sqrt(beyond * beyond - 1.0) * growth * 1e-6, "-",
              "cosh(2 n arcosh 1.01), 46 times the first: unstable; the amplitude changes w by itself over the height");
}

void small_vibration(Report& report) {
  const auto sway = analytical::sway_rock_frequencies(level_block());
  const std::array<double, 3> expected = {sway[0], analytical::bounce_frequency(level_block()), sway[1]};
  const std::array<const char*, 3> names = {"lower sway-rock", "bounce", "upper sway-rock"};
  Simulation simulation = report.simulate(scene_of(scheme_named("soft"), 1e-3));
  const Modes modes = modes_of(simulation);
  for (int i = 0; i < 3; ++i) {
    report.relative(std::string(names[i]) + ": eigenvalue of the tangent", "soft", expected[i], modes.frequencies[i], 1e-9, "rad/s",
                    "K of two corner springs; lengths taken on the bisector change by angle^2/8");
  }
  for (int i = 0; i < 3; ++i) {
    for (const Scheme& scheme : spring_schemes()) {
      const double end = 2.0 / expected[i];
      std::vector<double> steps, errors;
      for (const int n : {40, 80, 160, 320}) {
        steps.push_back(end / n);
        Simulation run = report.simulate(scene_of(scheme, end / n));
        errors.push_back(std::abs(share_after(run, i, n) - analytical::free_vibration(expected[i], end)));
        // A block that stands still has a share of 1, far from the cosine.
        if (n == 40) check_small_ledger(report, with_variant(names[i], scheme), scheme.contact, run, errors.back() < 0.5);
      }
      report.order(with_variant(std::string(names[i]) + ": run in time", scheme), scheme.contact, steps, errors, scheme.order - 0.1,
                   scheme.order + 0.1, "cos(w t); order of the scheme");
    }
  }
  critical(report, expected[2]);
  report.leave_out("eigenvalues of the tangent", "dem", "it has no tangent; its critical step is checked");
  report.leave_out("eigenvalues of the tangent", "shi", "its matrix is assembled and solved in one go; the run in time covers its springs");
  report.leave_out("small vibration", "hard", "rigid contacts do not vibrate");
}

const Registered<Case> registered{{"D3", "small vibration of a block on two springs", &small_vibration}};

}  // namespace
}  // namespace openclose::verification
