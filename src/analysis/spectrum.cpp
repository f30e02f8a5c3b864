#include "openclose/analysis/spectrum.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/core/error.h"
#include "openclose/core/tolerance.h"
#include "openclose/integrator/critical_step.h"

namespace openclose {
namespace {

/// Stiffness of supports and of contacts that touch, in rows and columns of equations.
Eigen::MatrixXd stiffness(const StepProblem& problem, const Enforcement& enforcement) {
  using Unknowns = Motion::Unknowns;
  const BlockSystem& system = problem.system;
  const Unknowns still = Unknowns::Zero();
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(dofs * system.free_count(), dofs * system.free_count());
  const auto part = [&](int i, int j) { return k.block<dofs, dofs>(dofs * i, dofs * j); };
  for (int b : system.free_blocks()) part(system.block(b).equation, system.block(b).equation) += problem.external.symmetric_stiffness(system, b);
  for (const Contact& c : problem.contacts) {
    const ContactSprings springs = enforcement.springs(problem, c);
    if (!may_close(ContactStrength(problem.joints.joint(c.joint), c), springs.normal, c.gap, tolerance::touching_m)) continue;
    const ContactKinematics kinematics(system, c, still, still);
    const int equations[] = {system.block(c.vertex_block).equation, system.block(c.edge_block).equation};
    const Unknowns normals[] = {kinematics.normal_vertex, kinematics.normal_edge}, shears[] = {kinematics.shear_vertex, kinematics.shear_edge};
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        if (equations[i] < 0 || equations[j] < 0) continue;
        part(equations[i], equations[j]) += springs.normal * normals[i] * normals[j].transpose() + springs.shear * shears[i] * shears[j].transpose();
      }
    }
  }
  return k;
}

/// Masses of the unknowns; infinite where a rotation is locked, which leaves that unknown a frequency of 0 that is not counted.
Eigen::VectorXd masses(const BlockSystem& system) {
  Eigen::VectorXd m(dofs * system.free_count());
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    m.segment<dofs>(dofs * block.equation) = block.mass;
    if (block.rotation_locked) m[dofs * block.equation + Motion::rotation_index] = std::numeric_limits<double>::infinity();
  }
  return m;
}

}  // namespace

Spectrum spectrum(Simulation& simulation, double dt) {
  const Enforcement& enforcement = simulation.enforcement();
  const Scene& scene = simulation.scene();
  if (!enforcement.has_elastic_contacts())
    throw InputError(scene.method.contact_where, "method.contact", "\"" + scene.method.contact + "\" has no springs to vibrate on",
                     "soft, shi or dem");
  if (simulation.system().free_count() == 0) throw InputError(scene.where, "block", "none is free", "at least one block that can move");
  const StepProblem problem = simulation.problem(dt, false);
  const Eigen::VectorXd mass = masses(problem.system);
  const Eigen::VectorXd scale = mass.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * stiffness(problem, enforcement) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled, Eigen::EigenvaluesOnly);
  const long locked = std::count_if(mass.begin(), mass.end(), [](double m) { return std::isinf(m); });
  // The zeros of locked rotations come first: nothing is below them but rounding.
  const auto squared = [&](long i) { return std::max(0.0, solver.eigenvalues()[i]); };
  const double low = squared(locked), high = squared(mass.size() - 1);
  return {std::sqrt(low), std::sqrt(high), (problem.inertia + high) / (problem.inertia + low)};
}

}  // namespace openclose
