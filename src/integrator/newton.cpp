#include "openclose/integrator/newton.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [-] Rounding errors of this many units in the last place may meet in one residual: a dozen products and sums per contact.
constexpr double rounding_units = 16.0;
/// [-] Share of contacts that may change state in an iteration with the exact tangent still being the better one.
constexpr double few_switches = 0.02;
/// [-] Part of the shear stiffness that sliding contacts keep in the symmetric tangent of statics, where nothing else would hold them.
constexpr double static_slip_stiffness = 0.01;
/// [-] A line search is good enough when the energy's slope has fallen to this part.
constexpr double line_search_slope = 0.9;
constexpr int line_search_steps = 8;
/// Sliding contacts are on this branch of their law or, the other way, on minus it.
constexpr int sliding_branch = static_cast<int>(ContactStatus::sliding);
/// [-] Backtracking along the exact step: decrease of the residual asked for, as a part of what the linear model promises, and the shortest part of
/// the step worth taking (6 halvings; below, the symmetric tangent gets on better).
constexpr double sufficient_decrease = 0.1;
constexpr double shortest_backtrack = 0.01;
/// After so many refusals of the exact step without gain the symmetric steps in between get shorter, so that the two do not go round in a circle.
constexpr int patience = 1;

int differences(const std::vector<int>& a, const std::vector<int>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0, std::plus<>(), std::not_equal_to<>());
}

}  // namespace

template <int N>
void Newton<N>::prepare(const StepProblem<N>& problem, const std::vector<ContactSprings>& springs) {
  problem_ = &problem;
  springs_ = &springs;
  strength_.clear();
  for (const Contact& c : problem.contacts) strength_.emplace_back(problem.joints.joint(c.joint), c);
  tangent_.fit(problem);
}

template <int N>
void Newton<N>::evaluate(const Eigen::VectorXd& d) {
  const BlockSystem<N>& system = problem_->system;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const auto of = [&](int b) -> Unknowns {
    const int i = system.block(b).equation;
    return i < 0 ? Unknowns(Unknowns::Zero()) : Unknowns(d.template segment<N>(N * i));
  };
  force_.setZero(N * system.free_count());
  residual_.resize(N * system.free_count());
  rounding_.setZero(system.free_count());
  force_scale_ = 0.0;

  outcome_.clear();
  outcome_.reserve(problem_->contacts.size());
  for (std::size_t c = 0; c < problem_->contacts.size(); ++c) {
    const Contact& contact = problem_->contacts[c];
    const Unknowns dv = of(contact.vertex_block), de = of(contact.edge_block);
    ContactKinematics<N> kinematics(system, contact, dv, de);
    const ContactSprings& springs = (*springs_)[c];
    const ContactForces f = spring_slider(springs, strength_[c], kinematics.gap_change, kinematics.slip_change);
    if (f.status != ContactStatus::open) {
      const double moved =
          Motion<N>::displacement_bound(dv, kinematics.vertex_arm.norm()) + Motion<N>::displacement_bound(de, kinematics.edge_arm.norm());
      const double stiffness = springs.normal + springs.normal_damping + springs.shear + springs.shear_damping;
      const double rounding = rounding_units * eps * (stiffness * moved + std::abs(f.normal) + std::abs(f.shear));
      const auto push = [&](int b, const Unknowns& normal, const Unknowns& shear) {
        const int i = system.block(b).equation;
        if (i < 0) return;
        force_.template segment<N>(N * i) += f.normal * normal + f.shear * shear;
        rounding_[i] += rounding;
      };
      push(contact.vertex_block, kinematics.normal_vertex, kinematics.shear_vertex);
      push(contact.edge_block, kinematics.normal_edge, kinematics.shear_edge);
      force_scale_ = std::max({force_scale_, std::abs(f.normal), std::abs(f.shear)});
    }
    outcome_.push_back({springs, f, kinematics});
  }

  const double theta = problem_->end_weight;
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    const int at = N * block.equation;
    const Unknowns db = of(b);
    const Unknowns external = problem_->external.force(system, b, db);
    force_.template segment<N>(at) += external;
    const Unknowns drift = problem_->dt * problem_->velocity(b);
    Unknowns r = problem_->inertia * block.mass.cwiseProduct(drift - db) + theta * force_.template segment<N>(at);
    if (theta < 1.0) r += (1.0 - theta) * start_force_.template segment<N>(at);
    if (block.rotation_locked) r[Motion<N>::rotation_index] = 0.0;
    residual_.template segment<N>(at) = r;
    const Unknowns moved = problem_->inertia * block.mass.cwiseProduct(drift.cwiseAbs() + db.cwiseAbs());
    const double magnitude = problem_->external.magnitude(system, b, db);
    rounding_[block.equation] +=
        rounding_units * eps * (Motion<N>::largest_force(moved, block.radius) + magnitude + problem_->external.spring_scale(system, b));
    force_scale_ = std::max(force_scale_, magnitude);
  }
}

template <int N>
double Newton<N>::residual_norm() const {
  double worst = 0.0;
  for (int b : problem_->system.free_blocks()) {
    const auto& block = problem_->system.block(b);
    const double tolerated = problem_->method.residual_tolerance * force_scale_ + rounding_[block.equation];
    const double r = Motion<N>::largest_force(residual_.template segment<N>(N * block.equation), block.radius);
    if (!(r <= std::numeric_limits<double>::max())) return std::numeric_limits<double>::infinity();
    if (r > 0.0) worst = std::max(worst, r / tolerated);
  }
  return worst;
}

template <int N>
void Newton<N>::add_contact_stiffness(std::size_t c, Tangent tangent) {
  const Contact& contact = problem_->contacts[c];
  const ContactOutcome<N>& o = outcome_[c];
  if (o.forces.status == ContactStatus::open) return;
  const ContactKinematics<N>& k = o.kinematics;
  const ContactForces& f = o.forces;
  const bool exact = tangent == Tangent::exact;
  const double theta = problem_->end_weight;
  const double nn = -theta * f.normal_by_gap, tn = exact ? -theta * f.shear_by_gap : 0.0;
  double tt = -theta * f.shear_by_slip;
  if (!exact && problem_->statics && f.status == ContactStatus::sliding) tt = static_slip_stiffness * o.springs.shear;

  const int i = problem_->system.block(contact.vertex_block).equation, j = problem_->system.block(contact.edge_block).equation;
  const auto block = [&](const Unknowns& n1, const Unknowns& t1, const Unknowns& n2, const Unknowns& t2) {
    return typename Motion<N>::Matrix(nn * n1 * n2.transpose() + tn * t1 * n2.transpose() + tt * t1 * t2.transpose());
  };
  if (i >= 0) tangent_.matrix().add(i, i, block(k.normal_vertex, k.shear_vertex, k.normal_vertex, k.shear_vertex));
  if (j >= 0) tangent_.matrix().add(j, j, block(k.normal_edge, k.shear_edge, k.normal_edge, k.shear_edge));
  if (i >= 0 && j >= 0) {
    tangent_.matrix().add(i, j, block(k.normal_vertex, k.shear_vertex, k.normal_edge, k.shear_edge));
    tangent_.matrix().add(j, i, block(k.normal_edge, k.shear_edge, k.normal_vertex, k.shear_vertex));
  }
  if (!exact) return;  // the geometric part can make the symmetric tangent indefinite
  const auto h = k.hessian(theta * (f.normal * k.normal + f.shear * k.tangent));
  if (i >= 0) tangent_.matrix().add(i, i, -h.vertex_vertex);
  if (j >= 0) tangent_.matrix().add(j, j, -h.edge_edge);
  if (i >= 0 && j >= 0) {
    tangent_.matrix().add(i, j, -h.vertex_edge);
    tangent_.matrix().add(j, i, -h.vertex_edge.transpose());
  }
}

template <int N>
void Newton<N>::assemble(const Eigen::VectorXd& d, Tangent tangent) {
  const BlockSystem<N>& system = problem_->system;
  tangent_.matrix().set_zero();
  for (std::size_t c = 0; c < outcome_.size(); ++c) add_contact_stiffness(c, tangent);
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    typename Motion<N>::Matrix diagonal = problem_->end_weight * problem_->external.stiffness(system, b, d.template segment<N>(N * block.equation));
    diagonal += (problem_->inertia * block.mass).asDiagonal();
    tangent_.matrix().add(block.equation, block.equation, diagonal);
  }
  for (int b : system.free_blocks()) {
    if (system.block(b).rotation_locked) tangent_.matrix().eliminate(system.block(b).equation, Motion<N>::rotation_index);
  }
}

template <int N>
Eigen::VectorXd Newton<N>::direction(const Eigen::VectorXd& d, Tangent tangent) {
  assemble(d, tangent);
  Eigen::VectorXd step;
  if (tangent_.solver().factor(tangent_.matrix())) step = tangent_.solver().solve(residual_);
  return step;
}

template <int N>
double Newton<N>::line_search(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double slope) {
  // Root of the energy's slope along the step by regula falsi; the slope falls along the step because the symmetric tangent is positive definite.
  double low = 0.0, slope_low = slope, high = 1.0;
  evaluate(d + step);
  double slope_high = residual_.dot(step);
  if (std::abs(slope_high) <= line_search_slope * std::abs(slope) || slope_high > 0.0) return high;
  double alpha = high;
  for (int i = 0; i < line_search_steps; ++i) {
    alpha = low + (high - low) * std::clamp(slope_low / (slope_low - slope_high), 0.1, 0.9);
    evaluate(d + alpha * step);
    const double s = residual_.dot(step);
    if (std::abs(s) <= line_search_slope * std::abs(slope)) break;
    if (s > 0.0) {
      low = alpha;
      slope_low = s;
    } else {
      high = alpha;
      slope_high = s;
    }
  }
  return alpha;
}

template <int N>
double Newton<N>::backtrack(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double norm) {
  for (double alpha = 0.5; alpha > shortest_backtrack; alpha *= 0.5) {
    evaluate(d + alpha * step);
    if (residual_norm() <= (1.0 - sufficient_decrease * alpha) * norm) return alpha;
  }
  return 0.0;
}

template <int N>
std::vector<int> Newton<N>::branches() const {
  std::vector<int> list;
  for (const auto& o : outcome_) {
    const bool backward = o.forces.status == ContactStatus::sliding && o.forces.shear < 0.0;
    list.push_back(backward ? -sliding_branch : static_cast<int>(o.forces.status));
  }
  return list;
}

template <int N>
void Newton<N>::replace_forces(std::size_t c, const ContactForces& forces) {
  ContactOutcome<N>& o = outcome_[c];
  const double normal = problem_->end_weight * (forces.normal - o.forces.normal), shear = problem_->end_weight * (forces.shear - o.forces.shear);
  const auto push = [&](int b, const Unknowns& by_normal, const Unknowns& by_shear) {
    const auto& block = problem_->system.block(b);
    if (block.equation < 0) return;
    residual_.template segment<N>(N * block.equation) += normal * by_normal + shear * by_shear;
    if (block.rotation_locked) residual_[N * block.equation + Motion<N>::rotation_index] = 0.0;
  };
  push(problem_->contacts[c].vertex_block, o.kinematics.normal_vertex, o.kinematics.shear_vertex);
  push(problem_->contacts[c].edge_block, o.kinematics.normal_edge, o.kinematics.shear_edge);
  o.forces = forces;
}

template <int N>
int Newton<N>::hold_reversed(const std::vector<int>& before, const std::vector<int>& after) {
  int held = 0;
  for (std::size_t c = 0; c < outcome_.size(); ++c) {
    const ContactOutcome<N>& o = outcome_[c];
    const bool reversed = std::abs(before[c]) == sliding_branch && before[c] == -after[c];
    if (!reversed) continue;
    ++held;
    ContactForces stuck = tangent_for_status(o.springs, strength_[c], ContactStatus::sticking, o.forces.normal, o.forces.shear);
    stuck.normal = o.forces.normal;
    stuck.shear = o.springs.initial_shear - (o.springs.shear + o.springs.shear_damping) * o.kinematics.slip_change;
    replace_forces(c, stuck);
  }
  return held;
}

template <int N>
void Newton<N>::take_last_states() {
  for (std::size_t c = 0; c < outcome_.size(); ++c) {
    const Contact& contact = problem_->contacts[c];
    const ContactOutcome<N>& o = outcome_[c];
    const bool touching = contact.status == ContactStatus::open && o.springs.gap <= 0.0;
    replace_forces(c, prolonged(o.springs, strength_[c], touching ? ContactStatus::sticking : contact.status, contact.normal_force,
                                contact.shear_force, o.kinematics.gap_change, o.kinematics.slip_change));
  }
}

template <int N>
void Newton<N>::solve(const StepProblem<N>& problem, const std::vector<ContactSprings>& springs, StepSolution<N>& solution, FirstTangent first) {
  prepare(problem, springs);
  Eigen::VectorXd& d = solution.d;
  if (problem.end_weight < 1.0) {
    start_force_ = forces(problem, springs);
    solution.start_contacts = outcome_;
  }
  evaluate(d);
  double norm = residual_norm();
  if (norm > 1.0 && first == FirstTangent::last_step) take_last_states();

  Tangent tangent = Tangent::exact;
  int refusals = 0;  // of the exact step since the residual was at its smallest
  double best = norm;
  const int few = static_cast<int>(few_switches * static_cast<double>(outcome_.size()));
  for (int iteration = 0; iteration < problem.method.max_iterations && norm > 1.0; ++iteration) {
    const std::vector<int> before = branches();
    const Eigen::VectorXd step = direction(d, tangent);
    ++solution.iterations;
    if (step.size() == 0) {
      solution.reason = "singular matrix";
      return;
    }
    const double slope = residual_.dot(step);
    double alpha = 1.0;
    if (tangent == Tangent::symmetric && slope > 0.0) {
      alpha = line_search(d, step, slope) / static_cast<double>(std::max(1, refusals - patience));
      if (refusals > patience + 1) evaluate(d + alpha * step);
    } else {
      evaluate(d + step);
    }
    double next_norm = residual_norm();
    std::vector<int> after = branches();
    int switches = differences(before, after);
    if (tangent == Tangent::exact && iteration > 0 && next_norm > norm) {
      alpha = backtrack(d, step, norm);
      if (alpha == 0.0) {
        evaluate(d);
        tangent = Tangent::symmetric;
        ++refusals;
        continue;
      }
      next_norm = residual_norm();
      after = branches();
      switches = differences(before, after);
    }
    if (next_norm < best) refusals = 0;
    best = std::min(best, next_norm);
    const bool halved = next_norm <= 0.5 * norm;
    d += alpha * step;
    norm = next_norm;
    const bool held = !halved && hold_reversed(before, after) > 0;
    const bool exact_works = held || switches <= few || (tangent == Tangent::exact && halved);
    tangent = exact_works ? Tangent::exact : Tangent::symmetric;
  }
  solution.converged = norm <= 1.0;
  if (!solution.converged) solution.reason = "Newton's method did not converge";
  solution.contacts = outcome_;
}

template <int N>
Eigen::MatrixXd Newton<N>::stiffness(const StepProblem<N>& problem, const std::vector<ContactSprings>& springs) {
  StepProblem<N> static_problem = problem;
  static_problem.inertia = 0.0;
  static_problem.end_weight = 1.0;
  prepare(static_problem, springs);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(N * problem.system.free_count());
  evaluate(zero);
  assemble(zero, Tangent::exact);
  return tangent_.matrix().dense();
}

template <int N>
Eigen::VectorXd Newton<N>::forces(const StepProblem<N>& problem, const std::vector<ContactSprings>& springs) {
  prepare(problem, springs);
  start_force_.setZero(N * problem.system.free_count());
  const Eigen::VectorXd still = start_force_;
  evaluate(still);
  return force_;
}

template class Newton<3>;

}  // namespace openclose
