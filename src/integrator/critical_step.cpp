#include "openclose/integrator/critical_step.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace openclose {
namespace {

/// Largest eigenvalue of M^-1 A over the blocks' diagonal matrices A; those whose trace stays below what was found are not looked at.
template <int N>
double largest_eigenvalue(const BlockSystem<N>& system, const std::vector<typename Motion<N>::Matrix>& matrices) {
  double largest = 0.0;
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    const typename Motion<N>::Unknowns scale = block.mass.cwiseSqrt().cwiseInverse();
    typename Motion<N>::Matrix m = scale.asDiagonal() * matrices[block.equation] * scale.asDiagonal();
    if (block.rotation_locked) {
      m.row(Motion<N>::rotation_index).setZero();
      m.col(Motion<N>::rotation_index).setZero();
    }
    if (m.trace() <= largest) continue;
    const Eigen::SelfAdjointEigenSolver<typename Motion<N>::Matrix> solver(m, Eigen::EigenvaluesOnly);
    largest = std::max(largest, solver.eigenvalues()[N - 1]);
  }
  return largest;
}

}  // namespace

template <int N>
double critical_step(const StepProblem<N>& problem, double approach) {
  using Unknowns = typename Motion<N>::Unknowns;
  using Matrix = typename Motion<N>::Matrix;
  const BlockSystem<N>& system = problem.system;
  const Unknowns still = Unknowns::Zero();
  std::vector<Matrix> stiffness(system.free_count(), Matrix::Zero()), damping(system.free_count(), Matrix::Zero());
  for (int b : system.free_blocks()) stiffness[system.block(b).equation] = problem.external.stiffness(system, b, still);
  bool damped = false;
  for (const Contact& c : problem.contacts) {
    const TabulatedJoint& joint = problem.joints.joint(c.joint);
    if (!may_close(ContactStrength(joint, c), joint.normal_stiffness * c.length, c.gap, approach)) continue;
    const ContactKinematics<N> k(system, c, still, still);
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
  const double a = largest_eigenvalue<N>(system, stiffness), b = damped ? largest_eigenvalue<N>(system, damping) : 0.0;
  return a > 0.0 ? 4.0 / (b + std::sqrt(b * b + 4.0 * a)) : std::numeric_limits<double>::infinity();
}

template double critical_step<3>(const StepProblem<3>&, double);

}  // namespace openclose
