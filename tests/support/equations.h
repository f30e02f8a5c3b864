// The equations of a step at its start, for tests and verification cases that look at forces and stiffness themselves.
#pragma once

#include "openclose/integrator/step_equations.h"
#include "support/dense.h"

namespace openclose::test {

/// [N] Forces of contacts, gravity, loads and supports at the present position, three numbers per free block.
inline Eigen::VectorXd forces_of(const StepProblem& problem, const std::vector<ContactSprings>& springs) {
  ContactTrial contacts;
  StepEquations equations;
  equations.prepare(problem, springs_in(springs), contacts);
  equations.sum_start_forces();
  return equations.start_force();
}

/// Minus the derivative of all forces but inertia by the unknowns, at the start of the step, contacts in the status they have. Rows and columns of
/// locked rotations are those of the unit matrix.
inline Eigen::MatrixXd stiffness_of(const StepProblem& problem, const std::vector<ContactSprings>& springs) {
  StepProblem static_problem = problem;
  static_problem.inertia = 0.0;
  static_problem.end_weight = 1.0;
  static_problem.scheme = nullptr;
  ContactTrial contacts;
  StepEquations equations;
  TangentSystem tangent;
  equations.prepare(static_problem, springs_in(springs), contacts);
  tangent.fit(problem.method, equations.rows(), contacts);
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(dofs * equations.rows());
  equations.evaluate(start);
  equations.assemble(start, true, false, tangent.slots(), tangent.matrix());
  return dense(tangent.matrix());
}

}  // namespace openclose::test
