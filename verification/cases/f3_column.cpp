// F3: a column of equal blocks: what each joint carries, and how the column bounces, by the tangent of the code and by a run in time.
#include <Eigen/Eigenvalues>
#include <cmath>

#include "harness.h"
#include "openclose/analytical/single_spring.h"
#include "openclose/analytical/stacked_blocks.h"
#include "scenes.h"
#include "support/equations.h"

namespace openclose::verification {
namespace {

constexpr int blocks = 6;
/// [m] A fifth of what the uppermost joint has closed, so that it stays closed.
constexpr double amplitude = 1e-4;

analytical::BlockOnPlane level_block() {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  return data;
}

Scene scene_of(const std::string& method, double theta, double dt) {
  Scene scene = empty_scene(level_block());
  scene.blocks.push_back(fixed_block("base", rectangle(-2.0, -1.0, 6.0, 1.0)));
  for (int i = 0; i < blocks; ++i) scene.blocks.push_back(free_block("block " + std::to_string(i + 1), rectangle(0.0, i, 2.0, 1.0)));
  scene.method.contact = method;
  scene.method.theta = theta;
  scene.step.dt = dt;
  scene.settle.unbalanced_fraction = 1e-12;
  use_joint_springs_as_penalty(scene);
  return scene;
}

void forces(Report& report, const std::string& method) {
  Simulation simulation = report.simulate(scene_of(method, 1.0, 1e-3));
  const bool settled = settle(simulation).settled;
  std::vector<double> carried(blocks, 0.0);  // by the joint under each block
  for (const Contact& c : simulation.change_contacts()) {
    const int upper = std::max(c.vertex_block, c.edge_block), lower = std::min(c.vertex_block, c.edge_block);
    if (upper == lower + 1) carried[lower] += c.normal_force;
  }
  for (int i = 0; i < blocks; ++i) {
    report.relative("force in joint " + std::to_string(i + 1) + " from below", method, (blocks - i) * level_block().weight(),
                    settled ? carried[i] : not_measured(), 1e-10, "N", "weight above; settled to 1e-12 of a block's weight");
  }
}

void eigenvalues(Report& report, const std::vector<double>& expected) {
  Simulation simulation = report.simulate(scene_of("soft", 1.0, 1e-3));
  std::vector<double> found(expected.size(), not_measured());
  if (settle(simulation).settled) {
    const auto problem = simulation.problem(1e-3, false);
    std::vector<ContactSprings> springs;
    Eigen::VectorXd mass(dofs * blocks);
    for (const Contact& c : problem.contacts) springs.push_back(simulation.enforcement().springs(problem, c));
    for (const int b : problem.system.free_blocks()) mass.segment<dofs>(dofs * problem.system.block(b).equation) = problem.system.block(b).mass;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(test::stiffness_of(problem, springs), mass.asDiagonal().toDenseMatrix());
    // Bouncing does not mix with swaying: a mode is wholly vertical or not at all.
    std::vector<double> bouncing;
    for (int i = 0; i < mass.size(); ++i) {
      const Eigen::VectorXd shape = mass.cwiseSqrt().cwiseProduct(solver.eigenvectors().col(i));
      double vertical = 0.0;
      for (int b = 0; b < blocks; ++b) vertical += shape[dofs * b + 1] * shape[dofs * b + 1];
      if (vertical > 0.5 * shape.squaredNorm()) bouncing.push_back(std::sqrt(larger(0.0, solver.eigenvalues()[i])));
    }
    if (bouncing.size() == found.size()) found = bouncing;
  }
  for (int i = 0; i < blocks; ++i) {
    report.relative("mode " + std::to_string(i + 1) + ": eigenvalue of the tangent", "soft", expected[i], found[i], 1e-9, "rad/s",
                    "2 sqrt(k/m) sin((2j-1) pi/(2(2n+1))); lengths taken on the bisector change by angle^2/8");
  }
}

/// Share of the first displacement along a mode that is left after `steps` steps from rest.
double share_after(const Report& report, const Scene& scene, int mode, int steps) {
  Simulation simulation = report.simulate(scene);
  if (!settle(simulation).settled) return not_measured();
  BlockSystem& system = simulation.change_system();
  const auto shape = analytical::column_shape(blocks, mode);
  std::vector<double> rest;
  for (int b = 1; b <= blocks; ++b) {
    rest.push_back(system.displacement(b)[1]);
    system.advance(b, {0.0, amplitude * shape[b - 1], 0.0});
  }
  simulation.positions_changed();
  simulation.restart_clock();
  for (int i = 0; i < steps; ++i) {
    if (!simulation.step(scene.step.dt, false).accepted) return not_measured();
  }
  double moved = 0.0, whole = 0.0;
  for (int b = 1; b <= blocks; ++b) {
    moved += shape[b - 1] * (simulation.system().displacement(b)[1] - rest[b - 1]);
    whole += amplitude * shape[b - 1] * shape[b - 1];
  }
  return moved / whole;
}

/// The same for one mass on a spring, by the scheme's own amplification.
double stepped_share(const std::string& method, double theta, double frequency, double dt, int steps) {
  if (method == "dem") return std::cos(steps * 2.0 * std::asin(0.5 * frequency * dt));
  const auto a = analytical::amplification_matrix({theta, frequency, dt});
  double u = 1.0, v = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double next = a[0][0] * u + a[0][1] * v;
    v = a[1][0] * u + a[1][1] * v;
    u = next;
  }
  return u;
}

void run_in_time(Report& report, const std::string& method, double theta, const std::vector<double>& frequencies) {
  const double dt = 0.5 / frequencies.back();
  constexpr int steps = 40;
  for (int mode = 1; mode <= blocks; ++mode) {
    report.near("mode " + std::to_string(mode) + text(": share left after 40 steps, theta = {}", theta), method,
                stepped_share(method, theta, frequencies[mode - 1], dt, steps), share_after(report, scene_of(method, theta, dt), mode, steps), 1e-8,
                "-", "the scheme's own motion of one mass on a spring; residual of 1e-12 of the weights over k times the amplitude, 40 times");
  }
}

void column(Report& report) {
  for (const std::string& method : all_methods) forces(report, method);
  const auto frequencies = analytical::column_frequencies(blocks, level_block().mass(), 2.0 * level_block().normal_stiffness);
  eigenvalues(report, frequencies);
  run_in_time(report, "soft", 1.0, frequencies);
  run_in_time(report, "soft", 0.5, frequencies);
  run_in_time(report, "shi", 1.0, frequencies);
  run_in_time(report, "dem", 1.0, frequencies);
  report.leave_out("eigenvalues of the tangent", "dem", "it has no tangent; the run in time covers its springs");
  report.leave_out("eigenvalues of the tangent", "shi", "its matrix is assembled and solved in one go; the run in time covers its springs");
  report.leave_out("modes", "hard", "rigid contacts do not vibrate");
}

const Registered<Case> registered{{"F3", "forces and modes of a column", &column}};

}  // namespace
}  // namespace openclose::verification
