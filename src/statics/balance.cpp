#include "openclose/statics/balance.h"

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

/// [-] |R| that counts as zero: forces of the order of one, four digits above their rounding. A long increment brings rounding of its own, a tenth of
/// its length in closures of which every digit counts.
constexpr double balanced = 1e-12;
constexpr double share_of_length = 0.1;
constexpr int most_newton_iterations = 25;
constexpr int patience = 6;                    ///< iterations in which the residual must have fallen by `progress`
constexpr double progress = 0.9;               ///< [-]
constexpr double shortest_part = 1.0 / 512.0;  ///< [-] of a Newton step
constexpr int most_passes = 6;                 ///< with friction bounds held fixed
constexpr int most_open_close_passes = 6;      ///< as in Shi's program
constexpr int most_convex_iterations = 60;
constexpr int most_searches = 60;           ///< along one step of it
constexpr double search_reduction = 1e-2;   ///< [-] slope at the end of a search over that at its start
constexpr double convex_reduction = 1e-10;  ///< [-] residual of a pass over that at its start

}  // namespace

Balance::Balance(const FrozenSystem& system, const FrozenStrength& strength)
    : system_(system), strength_(strength), solver_(make_solver()), contacts_(system) {
  std::vector<std::pair<int, int>> couplings;
  for (const FrozenContact& c : system.contacts()) {
    if (c.a >= 0 && c.b >= 0) couplings.emplace_back(c.a, c.b);
  }
  matrix_.set_pattern(system.rows(), couplings);
  list_shares();
  padded_ = forces_ = Eigen::VectorXd::Zero(3 * (system.rows() + 1));
  residual_.resize(3 * system.rows());
}

void Balance::start(const FrozenState& state, double eps) {
  eps_ = eps;
  support_forces_ = state.supports;
  for (std::size_t i = 0; i < state.contacts.size(); ++i) contacts_.start(i, state.contacts[i]);
}

void Balance::renew_strength(const FrozenState& state) {
  for (std::size_t i = 0; i < state.contacts.size(); ++i) contacts_.set_strength(i, strength_.of(i, state.contacts[i].joint_state));
}

const double* Balance::padded(const Increment& x) {
  padded_.head(x.size()) = x;
  return padded_.data();
}

void Balance::evaluate(const Increment& x, ShearLaw law) {
  forces_.setZero();
  contacts_.evaluate(padded(x), law, forces_.data());
  const auto& supports = system_.supports();
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const double stretch = supports[i].direction.dot(x.segment<3>(3 * supports[i].row));
    forces_.segment<3>(3 * supports[i].row) += (support_forces_[i] - supports[i].stiffness * stretch) * supports[i].direction;
  }
  const auto& blocks = system_.blocks();
  for (int b = 0; b < system_.rows(); ++b) {
    residual_.segment<3>(3 * b) = eps_ * blocks[b].mass.cwiseProduct(x.segment<3>(3 * b)) - blocks[b].load - forces_.segment<3>(3 * b);
  }
}

/// Which contacts add to which blocks of the matrix.
void Balance::list_shares() {
  std::vector<std::pair<int, Share>> all;
  slots_of_contact_.resize(system_.contacts().size());
  for (int i = 0; i < static_cast<int>(system_.contacts().size()); ++i) {
    const FrozenContact& c = system_.contacts()[i];
    const auto add = [&](int slot, bool force_on_b, bool motion_of_b) {
      all.push_back({slot, {i, force_on_b, motion_of_b}});
      slots_of_contact_[i].push_back(slot);
    };
    if (c.a >= 0) add(matrix_.diagonal(c.a), false, false);
    if (c.b >= 0) add(matrix_.diagonal(c.b), true, true);
    if (c.a >= 0 && c.b >= 0) {
      add(matrix_.find(c.a, c.b), false, true);
      add(matrix_.find(c.b, c.a), true, false);
    }
  }
  std::ranges::stable_sort(all, {}, &std::pair<int, Share>::first);
  const int slots = matrix_.row_start(system_.rows());
  share_start_.assign(slots + 1, 0);
  for (const auto& [slot, share] : all) {
    ++share_start_[slot + 1];
    shares_.push_back(share);
  }
  for (int slot = 0; slot < slots; ++slot) share_start_[slot + 1] += share_start_[slot];
  is_stale_.assign(slots, 0);
  assembled_.resize(system_.contacts().size());
}

void Balance::mark_stale(int slot) {
  if (is_stale_[slot]) return;
  is_stale_[slot] = 1;
  stale_.push_back(slot);
}

/// One block of the matrix: minus the derivative of the forces, all contacts that add to it summed up anew, so that nothing is left of those that
/// have opened.
void Balance::renew(int slot) {
  auto& block = matrix_.value(slot);
  block.setZero();
  for (int k = share_start_[slot]; k < share_start_[slot + 1]; ++k) {
    const Share& share = shares_[k];
    const ContactResponse& r = assembled_[share.contact];
    if (r.normal_by_gap == 0.0 && r.shear_by_slip == 0.0) continue;
    const FrozenContact& c = system_.contacts()[share.contact];
    const BlockVector &force_n = share.force_on_b ? c.normal_b : c.normal_a, &force_t = share.force_on_b ? c.shear_b : c.shear_a;
    const BlockVector &way_n = share.motion_of_b ? c.normal_b : c.normal_a, &way_t = share.motion_of_b ? c.shear_b : c.shear_a;
    for (int i = 0; i < 3; ++i) {
      const double by_gap = -(r.normal_by_gap * force_n[i] + r.shear_by_gap * force_t[i]), by_slip = -r.shear_by_slip * force_t[i];
      for (int j = 0; j < 3; ++j) block(i, j) += by_gap * way_n[j] + by_slip * way_t[j];
    }
  }
}

/// The tangent at the last evaluation; what has not changed since the last one stays.
void Balance::assemble(Friction friction) {
  const auto differ = [](const ContactResponse& a, const ContactResponse& b) {
    return a.normal_by_gap != b.normal_by_gap || a.shear_by_gap != b.shear_by_gap || a.shear_by_slip != b.shear_by_slip;
  };
  const bool first = assembled_eps_ < 0.0;
  for (std::size_t i = 0; i < assembled_.size(); ++i) {
    ContactResponse r = contacts_.response(i);
    if (friction == Friction::known) r.shear_by_gap = 0.0;
    if (!first && !differ(r, assembled_[i])) continue;
    assembled_[i] = r;
    for (const int slot : slots_of_contact_[i]) mark_stale(slot);
  }
  if (eps_ != assembled_eps_) {
    for (int b = 0; b < system_.rows(); ++b) mark_stale(matrix_.diagonal(b));
  }
  for (const FrozenSupport& s : system_.supports()) mark_stale(matrix_.diagonal(s.row));
  assembled_eps_ = eps_;
  const auto& blocks = system_.blocks();
  for (const int slot : stale_) renew(slot);
  for (int b = 0; b < system_.rows(); ++b) {
    const int slot = matrix_.diagonal(b);
    if (is_stale_[slot]) matrix_.value(slot).diagonal() += eps_ * blocks[b].mass;
  }
  for (const FrozenSupport& s : system_.supports()) matrix_.value(matrix_.diagonal(s.row)) += s.stiffness * s.direction * s.direction.transpose();
  for (const int slot : stale_) is_stale_[slot] = 0;
  stale_.clear();
}

double Balance::tolerance_at(const Increment& x) const {
  return balanced * std::max(1.0, share_of_length * size(x));
}

double Balance::residual_norm(const Increment& x) {
  evaluate(x, ShearLaw::coulomb);
  return residual_.norm();
}

bool Balance::factor() {
  if (interruption_) interruption_();
  ++counters_.factorisations;
  return solver_->factor(matrix_);
}

/// Newton's method with the full tangent; the residual's norm decides how much of a step is taken.
bool Balance::newton(Increment& x, int most_iterations) {
  evaluate(x, ShearLaw::coulomb);
  double norm = residual_.norm(), norm_before = norm;
  int since = 0;
  for (int k = 0; k < most_iterations; ++k) {
    if (!std::isfinite(norm)) return false;
    if (norm <= tolerance_at(x)) return true;
    assemble();
    if (!factor()) return false;
    const Increment step = solver_->solve(residual_);
    if (step.size() == 0 || !step.allFinite()) return false;
    double part = 1.0;
    Increment trial;
    double trial_norm;
    for (;; part *= 0.5) {
      trial = x - part * step;
      evaluate(trial, ShearLaw::coulomb);
      trial_norm = residual_.norm();
      if (trial_norm < norm || part <= shortest_part) break;
    }
    x.swap(trial);
    norm = trial_norm;
    if (++since == patience) {
      if (!(norm < progress * norm_before)) return norm <= tolerance_at(x);
      since = 0;
      norm_before = norm;
    }
  }
  return norm <= tolerance_at(x);
}

void Balance::begin_search(const Increment& x, const Increment& way) {
  const Eigen::VectorXd start = Eigen::Map<const Eigen::VectorXd>(padded(x), padded_.size());
  contacts_.begin_search(start.data(), padded(way));
  linear_slope_ = curvature_ = 0.0;
  for (int b = 0; b < system_.rows(); ++b) {
    const FrozenBlock& block = system_.blocks()[b];
    const auto along = way.segment<3>(3 * b);
    const BlockVector inertia = eps_ * block.mass.cwiseProduct(along);
    linear_slope_ += inertia.dot(x.segment<3>(3 * b)) - block.load.dot(along);
    curvature_ += inertia.dot(along);
  }
  for (std::size_t i = 0; i < system_.supports().size(); ++i) {
    const FrozenSupport& s = system_.supports()[i];
    const double stretch = s.direction.dot(x.segment<3>(3 * s.row)), stretching = s.direction.dot(way.segment<3>(3 * s.row));
    linear_slope_ -= (support_forces_[i] - s.stiffness * stretch) * stretching;
    curvature_ += s.stiffness * stretching * stretching;
  }
}

/// Derivative of the energy of a convex problem along the way of the search.
double Balance::slope_at(double part, ShearLaw law) const {
  return contacts_.subtract_power(linear_slope_ + part * curvature_, part, law);
}

/// The part of a Newton step at which the slope of the energy has nearly vanished. The slope never falls along the step. Where it is still negative
/// at the whole step, that is taken: it does not overshoot. Else the root is found by the regula falsi with halving of the end that stays (Illinois).
double Balance::search(const Increment& x, const Increment& way, ShearLaw law) {
  begin_search(x, way);
  double low = 0.0, low_slope = slope_at(0.0, law), high = 1.0, high_slope = slope_at(1.0, law);
  const double small = search_reduction * std::abs(low_slope);
  if (high_slope <= small || low_slope >= 0.0) return high;
  double part = high;
  for (int i = 0; i < most_searches; ++i) {
    part = low + (high - low) * (-low_slope) / (high_slope - low_slope);
    const double slope = slope_at(part, law);
    if (std::abs(slope) <= small) break;
    if (slope > 0.0) {
      high = part, high_slope = slope;
      low_slope *= 0.5;
    } else {
      low = part, low_slope = slope;
      high_slope *= 0.5;
    }
  }
  return part;
}

/// A convex problem: Newton's method with an exact search along each step, which ends for a piecewise quadratic energy.
bool Balance::convex(Increment& x, ShearLaw law) {
  evaluate(x, law);
  const double first = residual_.norm();
  for (int k = 0; k < most_convex_iterations; ++k) {
    const double norm = residual_.norm();
    if (norm <= std::max(tolerance_at(x), convex_reduction * first)) return true;
    assemble();
    if (!factor()) return false;
    const Increment way = -solver_->solve(residual_);
    if (way.size() == 0 || !way.allFinite()) return false;
    x += search(x, way, law) * way;
    evaluate(x, law);
  }
  return residual_.norm() <= std::max(tolerance_at(x), convex_reduction * first);
}

/// Where Newton's method stalls: problems with the friction bounds held fixed, the bounds being those of mean normal forces, and from every second
/// Newton's method anew.
bool Balance::restart(Increment& x) {
  std::vector<double> mean(system_.contacts().size());
  evaluate(x, ShearLaw::coulomb);
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = contacts_.response(i).normal;
  Increment y = Increment::Zero(x.size());
  for (int pass = 1; pass <= most_passes; ++pass) {
    for (std::size_t i = 0; i < mean.size(); ++i) contacts_.set_bound_of(i, mean[i]);
    if (!convex(y, ShearLaw::fixed)) return false;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = 0.5 * (mean[i] + contacts_.response(i).normal);
    if (pass % 2 != 0) continue;
    Increment trial = y;
    if (newton(trial, most_newton_iterations)) {
      x.swap(trial);
      return true;
    }
  }
  return false;
}

bool Balance::solve_quickly(Increment& x) {
  return newton(x, most_newton_iterations);
}

bool Balance::solve(Increment& x) {
  return newton(x, most_newton_iterations) || restart(x);
}

bool Balance::solve_open_close(Increment& x) {
  const auto states = [&] {
    std::vector<char> of(system_.contacts().size());
    for (std::size_t i = 0; i < of.size(); ++i) of[i] = static_cast<char>(contacts_.response(i).status());
    return of;
  };
  evaluate(x, ShearLaw::coulomb);
  for (int pass = 0; pass < most_open_close_passes; ++pass) {
    const std::vector<char> before = states();
    assemble(Friction::known);
    if (!factor()) return false;
    const Increment step = solver_->solve(residual_);
    if (step.size() == 0 || !step.allFinite()) return false;
    x -= step;
    evaluate(x, ShearLaw::coulomb);
    if (states() == before) return true;
  }
  return false;
}

bool Balance::solve_bonded(Increment& x) {
  return convex(x, ShearLaw::elastic);
}

void Balance::accept(const Increment& x, FrozenState& state, ShearLaw law) {
  evaluate(x, law);
  const auto& contacts = system_.contacts();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const FrozenContact& c = contacts[i];
    double gap = 0.0, slip = 0.0;
    if (c.a >= 0) gap += c.normal_a.dot(x.segment<3>(3 * c.a)), slip += c.shear_a.dot(x.segment<3>(3 * c.a));
    if (c.b >= 0) gap += c.normal_b.dot(x.segment<3>(3 * c.b)), slip += c.shear_b.dot(x.segment<3>(3 * c.b));
    const ContactResponse r = contacts_.response(i);
    FrozenContactState& s = state.contacts[i];
    s.gap += gap;
    s.slip += slip - (s.shear - r.shear) / c.shear_stiffness;
    s.normal = r.normal;
    s.shear = r.shear;
    s.status = r.status();
  }
  for (std::size_t i = 0; i < state.supports.size(); ++i) {
    const FrozenSupport& s = system_.supports()[i];
    state.supports[i] -= s.stiffness * s.direction.dot(x.segment<3>(3 * s.row));
  }
  for (std::size_t b = 0; b < state.displacement.size(); ++b) state.displacement[b] += x.segment<3>(3 * static_cast<Eigen::Index>(b));
}

}  // namespace openclose
