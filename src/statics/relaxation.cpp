#include "openclose/statics/relaxation.h"

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

/// [-] Viscosity of the last increments: what it holds of a block's weight when that has gone one closure is below negligible_share_of_weight.
constexpr double least_viscosity = 1e-9;
constexpr double first_viscosity = 1e-2;
constexpr double most_viscosity = 1e4;
constexpr long work_of_steady_motion = 2;   ///< [factorisations] of an increment that begins with the velocity of the one before
constexpr int increments_of_caution = 3;    ///< after one that was not found
constexpr long most_factorisations = 1500;  ///< of one relaxation by Newton's method; twice as many decide no more trials

/// [factorisations] of all states together: two seconds with 600 blocks. Of 400 random slopes all that were certified took fewer. Passes with known
/// friction take five times as many increments, see frozen_trials.cpp.
constexpr long most_work_of_newton = 10000, most_work_of_open_close = 5 * most_work_of_newton;

// Ways are in closures.
constexpr double least_travel_of_escape = 1e3;  ///< what has gone so far without rest is a motion, if an unsteady one
constexpr double least_travel_of_mechanism = 1.0;
constexpr double first_increment_of_motion = 10.0;
constexpr double growth_of_motion = 1.0;    ///< [-]
constexpr double most_over_longest = 10.0;  ///< [-] an increment longer than the longest by this is taken in shorter ones
constexpr double rounding_of_slip = 1e-9;   ///< sums of ways of up to least_travel_of_escape have digits of 1e-13
constexpr double worst_guess = 100.0;       ///< [-] over the residual at rest

/// What has slid on the way and sticks at rest has slipped.
void note_slip(FrozenState& state) {
  for (FrozenContactState& s : state.contacts) {
    if (s.status == ContactStatus::sticking && std::abs(s.slip) > rounding_of_slip) s.status = ContactStatus::sliding;
  }
}

}  // namespace

RelaxationResult Relaxation::bonded_state() {
  RelaxationResult result;
  result.state = FrozenState(system_);
  balance_.renew_strength(result.state);
  // At the least viscosity at once; where that does not converge, by falling ones (proximal point method: converges for every convex problem).
  double eps = least_viscosity;
  while (result.steps < most_steps_) {
    ++result.steps;
    balance_.start(result.state, eps);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(3 * system_.rows());
    if (!balance_.solve_bonded(x)) {
      if (eps >= most_viscosity) break;
      eps = std::max(first_viscosity, 10.0 * eps);
      continue;
    }
    if (Balance::size(x) > least_travel_of_escape && is_beyond_all_strength(system_, strength_, x)) {
      result.end = RelaxationEnd::mechanism;
      result.mechanism = x / Balance::size(x);
      break;
    }
    balance_.accept(x, result.state, ShearLaw::elastic);
    result.travel = std::max(result.travel, Balance::size(x));
    if (check_equilibrium(system_, strength_, result.state).in_balance()) {
      result.end = RelaxationEnd::stable;
      break;
    }
    eps = std::max(least_viscosity, 0.1 * eps);
  }
  return result;
}

bool Relaxation::is_exhausted() const {
  return linear_solves() >= (rule_ == IncrementRule::newton ? most_work_of_newton : most_work_of_open_close);
}

/// Where the first increment, which is to end it at once, is not found easily, shorter ones are.
bool Relaxation::solve(Eigen::VectorXd& x, bool is_first) {
  if (rule_ == IncrementRule::open_close) return balance_.solve_open_close(x);
  return is_first ? balance_.solve_quickly(x) : balance_.solve(x);
}

/// Strength that a joint loses for good is lost between increments. With known friction an increment may slide too far and the next one back: there,
/// what goes with the length of slip waits for rest.
void Relaxation::accept(const Eigen::VectorXd& x, FrozenState& state, double eps) {
  balance_.accept(x, state);
  if (rule_ == IncrementRule::newton) pace_.prolong(strength_, state, eps == least_viscosity);
  weaken(state, rule_ == IncrementRule::newton ? SlipOfState::counts : SlipOfState::waits);
}

double Relaxation::weaken(FrozenState& state, SlipOfState slip) {
  const double lost = lose_strength(strength_, state, slip);
  if (lost > 0.0) balance_.renew_strength(state);
  return lost;
}

/// A steady motion goes on with its velocity; where that is far from balance, nothing is guessed.
Eigen::VectorXd Relaxation::guess(const Eigen::VectorXd& velocity, double eps) {
  Eigen::VectorXd still = Eigen::VectorXd::Zero(3 * system_.rows());
  if (velocity.size() == 0) return still;
  const Eigen::VectorXd steady = velocity / eps;
  return balance_.residual_norm(steady) < worst_guess * balance_.residual_norm(still) ? steady : still;
}

bool Relaxation::ended(RelaxationResult& result, const Eigen::VectorXd& x) {
  const auto stands = [&] { return check_equilibrium(system_, strength_, result.state).holds(); };
  if (rule_ == IncrementRule::open_close && stands()) {
    note_slip(result.state);
    pace_.prolong(strength_, result.state, true);
  }
  if (stands() && (weaken(result.state, SlipOfState::counts) == 0.0 || stands())) {
    result.end = RelaxationEnd::stable;
    pace_.give_back(system_.closure_unit(), result.state);
    return true;
  }
  if (Balance::size(x) > least_travel_of_mechanism && is_mechanism(system_, strength_, result.state, x)) {
    result.end = RelaxationEnd::mechanism;
    result.mechanism = x / Balance::size(x);
    return true;
  }
  return false;
}

/// A long increment of a steady motion hides in its rounding that it is steady; the next short one shows it.
bool Relaxation::ends_in_a_short_increment(const Eigen::VectorXd& velocity, RelaxationResult& result) {
  const double eps = Balance::size(velocity) / first_increment_of_motion;
  balance_.start(result.state, eps);
  Eigen::VectorXd x = velocity / eps;
  if (!balance_.solve_quickly(x)) return false;
  accept(x, result.state, eps);
  return ended(result, x);
}

RelaxationResult Relaxation::relax(const FrozenState& from, Effort effort) {
  // Passes with known friction are counted by increments, since each takes a few; Newton's method by factorisations.
  const bool is_newton = rule_ == IncrementRule::newton;
  const long most_work = share_of(effort, most_factorisations), most_steps = is_newton ? most_steps_ : share_of(effort, most_steps_);
  RelaxationResult result;
  result.state = from;
  balance_.renew_strength(result.state);
  pace_.restart(from.contacts.size());
  Eigen::VectorXd velocity;                     // of the last increment: its length times its viscosity
  double eps = least_viscosity, stalled = 0.0;  // the latter of the last increment that was not found
  int found_since = 0;
  const long begin = balance_.counters().factorisations;
  while (result.steps < most_steps && (!is_newton || balance_.counters().factorisations - begin < most_work)) {
    ++result.steps;
    const long before = balance_.counters().factorisations;
    balance_.start(result.state, eps);
    Eigen::VectorXd x = guess(velocity, eps);

    if (!solve(x, result.steps == 1)) {
      stalled = eps;
      found_since = 0;
      eps = result.steps == 1 ? first_viscosity : 10.0 * eps;
      if (eps > most_viscosity) break;
      continue;
    }
    ++found_since;
    velocity = eps * x;
    // Increments of a motion grow with the way that lies behind: a motion that begins at rest changes with the logarithm of its way.
    const double longest = std::max(first_increment_of_motion, growth_of_motion * result.travel);
    const double length = Balance::size(x);
    if (length > most_over_longest * longest) {
      eps *= length / longest;
      continue;
    }
    accept(x, result.state, eps);
    result.travel = std::max(result.travel, farthest_between(result.state, from));
    if (ended(result, x)) return result;
    if (result.travel > std::min(farthest_way_of(system_), farthest_way_with_digits)) break;
    const long work = balance_.counters().factorisations - before;
    if (work <= work_of_steady_motion && length > first_increment_of_motion && ends_in_a_short_increment(velocity, result)) return result;
    // What was too much a moment ago is not tried again at once.
    const double bearable = found_since < increments_of_caution ? std::min(eps, 2.0 * stalled) : 0.0;
    eps = std::max({least_viscosity, bearable, eps / (work <= 6 ? 10.0 : work <= 15 ? 4.0 : 2.0), Balance::size(velocity) / longest});
  }
  result.end = result.travel > least_travel_of_escape ? RelaxationEnd::escaped : RelaxationEnd::undecided;
  return result;
}

}  // namespace openclose
