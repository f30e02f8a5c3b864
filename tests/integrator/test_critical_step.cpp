#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "openclose/analysis/run.h"
#include "openclose/integrator/critical_step.h"
#include "support/catch.h"
#include "support/equations.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

/// 2/w_max of the tangent itself, contacts closed and sticking.
double exact_step(Simulation& simulation) {
  StepProblem problem = simulation.problem(1e-3, false);
  problem.statics = true;  // no dashpots
  std::vector<ContactSprings> springs;
  for (const Contact& c : problem.contacts) springs.push_back(simulation.enforcement().springs(problem, c));
  const Eigen::MatrixXd k = test::stiffness_of(problem, springs);
  Eigen::VectorXd mass(k.rows());
  for (int b : problem.system.free_blocks()) mass.segment<3>(3 * problem.system.block(b).equation) = problem.system.block(b).mass;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (k + k.transpose()), mass.asDiagonal().toDenseMatrix());
  return 2.0 / std::sqrt(solver.eigenvalues().maxCoeff());
}

Scene pressed(Scene scene) {
  scene.method.contact = "dem";
  scene.joints[0].friction_angle = 80.0 * test::degree;
  return scene;
}

/// Largest eigenvalue of M^-1 A over the blocks' diagonal matrices A; those whose trace stays below what was found are not looked at.
double largest_eigenvalue(const BlockSystem& system, const std::vector<Motion::Matrix>& matrices) {
  double largest = 0.0;
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    const Motion::Unknowns scale = block.mass.cwiseSqrt().cwiseInverse();
    Motion::Matrix m = scale.asDiagonal() * matrices[block.equation] * scale.asDiagonal();
    if (block.rotation_locked) {
      m.row(Motion::rotation_index).setZero();
      m.col(Motion::rotation_index).setZero();
    }
    if (m.trace() <= largest) continue;
    const Eigen::SelfAdjointEigenSolver<Motion::Matrix> solver(m, Eigen::EigenvaluesOnly);
    largest = std::max(largest, solver.eigenvalues()[dofs - 1]);
  }
  return largest;
}

/// [s] The bound plainly, of all contacts that are closed or close when their blocks approach by `approach` [m], and of the supports; infinite
/// without any.
double critical_step(const StepProblem& problem, double approach) {
  using Unknowns = Motion::Unknowns;
  using Matrix = Motion::Matrix;
  const BlockSystem& system = problem.system;
  const Unknowns still = Unknowns::Zero();
  std::vector<Matrix> stiffness(system.free_count(), Matrix::Zero()), damping(system.free_count(), Matrix::Zero());
  for (int b : system.free_blocks()) stiffness[system.block(b).equation] = problem.external.symmetric_stiffness(system, b);
  bool damped = false;
  for (const Contact& c : problem.contacts) {
    const TabulatedJoint& joint = problem.joints.joint(c.joint);
    if (!may_close(ContactStrength(joint, c), JointSprings(joint, c.length).normal, c.gap, approach)) continue;
    const ContactKinematics k(system, c, still, still);
    const ContactDashpots dashpots(joint, c.length, system.reduced_mass(c.vertex_block, c.edge_block));
    damped |= joint.damping_ratio > 0.0;
    const auto add = [&](int b, int other, const Unknowns& normal, const Unknowns& shear) {
      const auto& block = system.block(b);
      if (block.equation < 0) return;
      const double share = system.block(other).equation < 0 ? 1.0 : 1.0 + block.mass[0] / system.block(other).mass[0];
      const Matrix nn = share * normal * normal.transpose(), ss = share * shear * shear.transpose();
      stiffness[block.equation] += c.length * (joint.normal_stiffness * nn + joint.shear_stiffness * ss);
      damping[block.equation] += dashpots.normal * nn + dashpots.shear * ss;
    };
    add(c.vertex_block, c.edge_block, k.normal_vertex, k.shear_vertex);
    add(c.edge_block, c.vertex_block, k.normal_edge, k.shear_edge);
  }
  const double a = largest_eigenvalue(system, stiffness), b = damped ? largest_eigenvalue(system, damping) : 0.0;
  return a > 0.0 ? 4.0 / (b + std::sqrt(b * b + 4.0 * a)) : std::numeric_limits<double>::infinity();
}

double bound_of(Simulation& simulation) {
  return simulation.explicit_stepper()->critical_step();
}

}  // namespace

TEST_CASE("the bound is the critical step of one block on a fixed base", "[integrator][critical_step]") {
  Simulation simulation(pressed(test::block_on_base()));
  REQUIRE(settle(simulation).settled);
  // Geometric stiffness, which the bound leaves out: 5e4 N * 0.5 m beside 2e9 N m.
  CHECK(bound_of(simulation) == Approx(exact_step(simulation)).epsilon(2e-5));
}

TEST_CASE("in a column the bound lies below the critical step, not far", "[integrator][critical_step]") {
  Scene scene = pressed(test::column_of_blocks(GENERATE(2, 3, 8)));
  Simulation simulation(scene);
  REQUIRE(settle(simulation).settled);
  const double exact = exact_step(simulation), bound = bound_of(simulation);
  CHECK(bound <= exact);
  CHECK(bound >= 0.8 * exact);
}

TEST_CASE("dashpots shorten the critical step: 2 (sqrt(1 + xi^2) - xi)/w for one mass on one contact", "[integrator][critical_step]") {
  Scene scene = pressed(test::block_on_base());
  scene.blocks[1].vertices = {{0.0, 0.0}, {1.0, 1.0}, {0.0, 2.0}, {-1.0, 1.0}};
  scene.blocks[1].rotation_locked = true;
  Simulation plain(scene);
  const double xi = GENERATE(0.1, 1.0, 3.0);
  scene.joints[0].damping_ratio = xi;
  Simulation damped(scene);
  CHECK(bound_of(damped) == Approx(bound_of(plain) * (std::sqrt(1.0 + xi * xi) - xi)).epsilon(1e-12));
}

TEST_CASE("contacts out of reach do not count, supports do", "[integrator][critical_step]") {
  Scene scene = pressed(test::falling_block());
  Simulation falling(scene);
  CHECK(std::isinf(bound_of(falling)));
  scene.supports = {{0, {1.0, 0.5}, {0.0, 2e6}}};
  Simulation held(scene);
  CHECK(bound_of(held) == Approx(2.0 / std::sqrt(2e6 / test::block_mass)).epsilon(1e-12));
}

TEST_CASE("the bound kept contact by contact is the one of all contacts", "[integrator][critical_step]") {
  Scene scene = pressed(test::column_of_blocks(4));
  scene.joints[0].damping_ratio = GENERATE(0.0, 0.3);
  scene.blocks[2].rotation_locked = GENERATE(false, true);
  scene.supports = {{1, {0.0, 1.0}, {3e6, 1e6}}};
  Simulation simulation(scene);
  REQUIRE(simulation.advance(1e-3));
  StepProblem problem = simulation.problem(1e-3, false);
  REQUIRE(problem.contacts.size() >= 4);
  CriticalStepBound bound;
  bound.begin(problem);
  const auto put = [&](const Contact& c, double sign) {
    const JointProperties& joint = problem.joints.joint(c.joint);
    const Motion::Unknowns still = Motion::Unknowns::Zero();
    const ContactKinematics k(problem.system, c, still, still);
    const ContactDashpots dashpots(joint, c.length, problem.system.reduced_mass(c.vertex_block, c.edge_block));
    const auto part = [&](int block, int other, const Vec2& arm) {
      const auto &b = problem.system.block(block), &o = problem.system.block(other);
      if (b.equation < 0) return;
      // In a frame of the block's own; the one with the support keeps the support's.
      const Motion::Turn frame(0.1 * (block - 1), RotationKind::exact);
      bound.add({b.equation, o.equation < 0 ? 1.0 : 1.0 + b.mass[0] / o.mass[0], k.normal + frame.of(k.normal), arm + frame.of(arm),
                 joint.normal_stiffness * c.length, joint.shear_stiffness * c.length, dashpots.normal, dashpots.shear},
                sign);
    };
    part(c.vertex_block, c.edge_block, k.vertex_arm);
    part(c.edge_block, c.vertex_block, k.edge_arm);
  };
  // One by one, then without the stiffest ones again, which takes the last digits of what is left with it.
  std::vector<Contact> some;
  const StepProblem few{problem.system, problem.external, problem.joints, some, problem.method};
  for (const Contact& c : problem.contacts) {
    put(c, 1.0);
    some.push_back(c);
    CHECK(bound.step() == Approx(critical_step(few, 1.0)).epsilon(1e-9));
  }
  while (!some.empty()) {
    put(some.back(), -1.0);
    some.pop_back();
    if (!some.empty()) CHECK(bound.step() == Approx(critical_step(few, 1.0)).epsilon(1e-6));
  }
}
