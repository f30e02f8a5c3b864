#include "openclose/integrator/newton.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [-] Share of contacts that may change state in an iteration with the exact tangent still being the better one.
constexpr double few_switches = 0.02;
/// [-] A line search is good enough when the energy's slope has fallen to this part.
constexpr double line_search_slope = 0.9;
constexpr int line_search_steps = 8;
/// [-] Backtracking along the exact step: decrease of the residual asked for, as a part of what the linear model promises, and the shortest part of
/// the step worth taking (6 halvings; below, the symmetric tangent gets on better).
constexpr double sufficient_decrease = 0.1;
constexpr double shortest_backtrack = 0.01;
/// [-] Of rows of the tangent that a factor may be left with, see LinearSolver::factor(): the turning of blocks that only tremble. 40 m of a failing
/// slope of 387 free blocks: with 0 all rows are factored anew in 2,427 iterations, with 1e-8 117 of them in 2,439, with 1e-7 88 in 2,522, with
/// 1e-5 68 in 2,622, with 1e-4 40 in 3,178.
constexpr double kept_change = 1e-8;
/// [-] A static step of which the line search takes less is begun again with held contacts.
constexpr double shortest_common_step = 1e-3;
/// [-] Held contacts keep this part of their hold from iteration to iteration, so that what they let go at a time is about twice what they have
/// tried.
constexpr double hold_decay = 0.5;
/// [-] A smaller part of the springs holds nothing.
constexpr double weakest_hold = 1e-4;
/// [-] Residual, over the largest force, from which on contacts are held with all of their springs; below in proportion, so that the end is Newton's.
constexpr double residual_of_full_hold = 1e-2;
/// [-] A static step from blocks that nothing has loaded yet, in whose first iteration more than this part of the contacts open or slide, has a cold
/// start: which ones will do so in the end is not known at all.
constexpr double cold_start_switches = 0.1;
/// [-] There, contacts that have just opened or begun to slide keep this part of their springs for one iteration.
constexpr double hold_of_opened = 0.1, hold_of_slid = 0.3;
/// After so many iterations a cold start that has not ended goes round in a circle with few contacts, which the line searches are for.
constexpr int most_cold_iterations = 15;

/// Below, the plan of a part's factorisation costs what it saves (387 rows: work 1.04 to 1.08, 850 rows: 0.82 to 0.94).
constexpr int smallest_system_with_parts = 600;
/// Whether an iteration still gets somewhere.
class Headway {
 public:
  /// \param most_iterations  in which the value must be halved
  Headway(double value, int most_iterations) : reached_(value), most_iterations_(most_iterations) {}

  /// To be asked once an iteration.
  /// \param best  the smallest value of what it must reduce, so far
  bool is_lost(double best) {
    if (best > 0.5 * reached_) return ++iterations_ > most_iterations_;
    reached_ = best;
    iterations_ = 0;
    return false;
  }

 private:
  double reached_;
  int most_iterations_;
  int iterations_ = 0;  ///< since then
};

int differences(const std::vector<Branch>& a, const std::vector<Branch>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0, std::plus<>(), std::not_equal_to<>());
}

/// [J] Of forces along a way, summed in the order of the blocks: zeros of further blocks change no bit of it.
double work(const Eigen::VectorXd& forces, const Eigen::VectorXd& way) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < forces.size(); ++i) sum += forces[i] * way[i];
  return sum;
}

}  // namespace

void Newton::assemble(const Eigen::VectorXd& d, Tangent tangent) {
  equations_.assemble(d, tangent == Tangent::exact, !holds_.empty(), tangent_.slots(), tangent_.matrix());
}

Eigen::VectorXd Newton::direction(const Eigen::VectorXd& d, Tangent tangent, double reduction) {
  assemble(d, tangent);
  Eigen::VectorXd step;
  if (tangent_.factor(kept_change)) step = tangent_.solve(equations_.residual(), reduction);
  return step;
}

double Newton::line_search(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double slope) {
  // Root of the energy's slope along the step by regula falsi; the slope falls along the step because the symmetric tangent is positive definite.
  double low = 0.0, slope_low = slope, high = 1.0;
  equations_.evaluate(trial_ = d + step);
  double slope_high = work(equations_.residual(), step);
  if (std::abs(slope_high) <= line_search_slope * std::abs(slope) || slope_high > 0.0) return high;
  double alpha = high;
  for (int i = 0; i < line_search_steps; ++i) {
    alpha = low + (high - low) * std::clamp(slope_low / (slope_low - slope_high), 0.1, 0.9);
    equations_.evaluate(trial_ = d + alpha * step);
    const double s = work(equations_.residual(), step);
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

double Newton::backtrack(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double merit_before) {
  for (double alpha = 0.5; alpha > shortest_backtrack; alpha *= 0.5) {
    equations_.evaluate(trial_ = d + alpha * step);
    if (equations_.merit(equations_.residual_norm()) <= (1.0 - sufficient_decrease * alpha) * merit_before) return alpha;
  }
  return 0.0;
}

void Newton::hold_changed(double norm) {
  const double residual = norm * equations_.problem().method.residual_tolerance;
  const double fullest = std::min(1.0, residual / residual_of_full_hold);
  for (std::size_t c = 0; c < holds_.size(); ++c) {
    double& hold = holds_[c];
    hold = std::min(branches()[c] != branches_before_[c] ? 1.0 : hold_decay * hold, fullest);
    if (hold < weakest_hold) hold = 0.0;
  }
}

bool Newton::take_whole_step(StepSolution& solution, double longest, double& norm) {
  const Eigen::VectorXd step = direction(solution.d, Tangent::exact, full_reduction);
  ++solution.effort.iterations;
  if (step.size() == 0 || !(step.lpNorm<Eigen::Infinity>() <= longest)) return false;
  equations_.evaluate(solution.d += step);
  norm = equations_.residual_norm();
  return true;
}

bool Newton::iterate_from_cold(StepSolution& solution, double& norm) {
  const double longest = solution.d.lpNorm<Eigen::Infinity>();
  holds_.resize(contacts().size());
  for (int iteration = 1; iteration < most_cold_iterations && norm > 1.0 && std::isfinite(norm); ++iteration) {
    for (std::size_t c = 0; c < contacts().size(); ++c) {
      const bool has_changed = branches()[c] != branches_before_[c];
      holds_[c] = !has_changed ? 0.0 : (contacts().status(c) == ContactStatus::open ? hold_of_opened : hold_of_slid);
    }
    branches_before_ = branches();
    contacts().hold(holds_, false);
    if (!take_whole_step(solution, longest, norm)) norm = std::numeric_limits<double>::infinity();
  }
  holds_.clear();
  return std::isfinite(norm);
}

Newton::Outcome Newton::iterate_holding(StepSolution& solution, double& norm, int done) {
  holds_.assign(contacts().size(), 0.0);
  if (done > 0) hold_changed(norm);
  Outcome outcome = Outcome::ended;
  Headway headway(norm, has_another_way_ ? most_iterations_to_halve_beside_another_way : most_iterations_to_halve_holding);
  double best = norm;
  for (int iteration = done; norm > 1.0 && std::isfinite(norm) && !headway.is_lost(best); ++iteration) {
    branches_before_ = branches();
    // With the coupling, loose blocks fall from one side to the other; without it, single contacts go round between open and sliding.
    contacts().hold(holds_, iteration % 2 == 1);
    if (!take_whole_step(solution, std::numeric_limits<double>::infinity(), norm)) {
      outcome = Outcome::singular;
      break;
    }
    best = std::min(best, norm);
    hold_changed(norm);
  }
  holds_.clear();
  return outcome;
}

struct Newton::Course {
  double norm = 0.0, value = 0.0, best = 0.0;  ///< [-] equations_.residual_norm(), equations_.merit(), and the smallest merit so far
  Tangent tangent = Tangent::exact;
  int switches = 0;     ///< contacts whose state the last iteration has changed
  bool gets_on = true;  ///< the last iteration has halved the merit
};

bool Newton::help_by_parts(StepSolution& solution, Course& course) {
  const double norm_before = course.norm;
  course.norm = subdomains_.solve(equations_, solution, norm_before);
  note_memory(subdomains_.memory_of_parts() + solution.memory());
  course.value = equations_.merit(course.norm);
  course.best = std::min(course.best, course.value);
  if (!(course.norm < norm_before)) return false;
  course.tangent = Tangent::exact;
  return true;
}

double Newton::try_step(const Eigen::VectorXd& d, const Eigen::VectorXd& step, const Course& course) {
  const double slope = work(equations_.residual(), step);
  if (course.tangent == Tangent::exact || slope <= 0.0) {
    equations_.evaluate(trial_ = d + step);
    return 1.0;
  }
  return line_search(d, step, slope);
}

void Newton::follow(Course& course, double norm) {
  const double value = equations_.merit(norm);
  course.switches = differences(branches_before_, branches());
  course.gets_on = value <= 0.5 * course.value;
  course.best = std::min(course.best, value);
  course.norm = norm;
  course.value = value;
}

void Newton::choose_tangent(Course& course) {
  const int few = static_cast<int>(few_switches * static_cast<double>(contacts().size()));
  const bool held = course.norm > 1.0 && !course.gets_on && equations_.hold_reversed(branches_before_) > 0;  // a solution keeps the forces of the law
  const bool exact_works = held || course.switches <= few || (course.tangent == Tangent::exact && course.gets_on);
  course.tangent = exact_works ? Tangent::exact : Tangent::symmetric;
}

Newton::Outcome Newton::iterate(const StepProblem& problem, StepSolution& solution, double& norm, NewtonEnd until, bool may_start_cold) {
  Eigen::VectorXd& d = solution.d;
  Course course;
  course.norm = norm;
  course.value = course.best = equations_.merit(norm);
  course.switches = static_cast<int>(contacts().size());  // any may be in another state than in the first tangent
  const bool may_help_by_parts = problem.method.skip_balanced && !problem.statics && !is_part_ && equations_.rows() >= smallest_system_with_parts;
  const bool may_be_lost = !problem.statics && !is_part_;
  Headway headway(course.value, has_another_way_ ? most_iterations_to_halve_beside_another_way : most_iterations_to_halve);
  // Parts that have not helped will not help in this step: with pauses in place of an end 40 m of a failing slope of 1,773 free blocks cost
  // `hard` 1.1 times as much.
  bool parts_help = may_help_by_parts;
  Outcome outcome = Outcome::ended;
  for (int iteration = 0; iteration < until.iterations && course.norm > until.norm; ++iteration) {
    if (parts_help && iteration > 0 && course.switches > 0) {
      parts_help = help_by_parts(solution, course);
      if (course.norm <= until.norm) break;
    }
    if (may_be_lost && headway.is_lost(course.best)) break;
    branches_before_ = branches();
    const Eigen::VectorXd step = direction(d, course.tangent, linear_reduction);
    ++solution.effort.iterations;
    if (step.size() == 0) {
      outcome = Outcome::singular;
      break;
    }
    double alpha = try_step(d, step, course);
    double next_norm = equations_.residual_norm();
    if (problem.statics && (alpha < shortest_common_step || !std::isfinite(next_norm))) {
      outcome = Outcome::no_common_step;
      break;
    }
    if (course.tangent == Tangent::exact && iteration > 0 && equations_.merit(next_norm) > course.value) {
      const int switches = differences(branches_before_, branches());
      alpha = backtrack(d, step, course.value);
      if (alpha == 0.0) {
        equations_.evaluate(d);
        course.tangent = Tangent::symmetric;
        course.switches = switches;
        course.gets_on = false;
        continue;
      }
      next_norm = equations_.residual_norm();
    }
    d += alpha * step;
    follow(course, next_norm);
    if (may_start_cold && iteration == 0 && course.switches > cold_start_switches * static_cast<double>(contacts().size())) {
      outcome = Outcome::cold_start;
      break;
    }
    choose_tangent(course);
  }
  norm = course.norm;
  return outcome;
}

bool Newton::stands_still(const Eigen::VectorXd& d) const {
  return !equations_.problem().statics && !is_part_ && d.isZero(0.0) && equations_.stands_still();
}

double Newton::begin(const Eigen::VectorXd& d, FirstTangent first) {
  equations_.evaluate(d);
  const double norm = stands_still(d) ? std::min(equations_.residual_norm(), 1.0) : equations_.residual_norm();
  if (norm > 1.0 && first == FirstTangent::last_step) equations_.take_last_states();
  if (norm > 1.0 && first == FirstTangent::last_solution) equations_.take_states(branches_before_);
  return norm;
}

bool Newton::solve_part(const StepEquations& whole, const Part& part, NewtonEnd end, StepSolution& found) {
  is_part_ = true;
  equations_.take_part(whole, part, found.contacts);
  tangent_.forget();
  tangent_.fit(whole.problem().method, equations_.rows(), contacts());
  equations_.evaluate(found.d);
  double norm = equations_.residual_norm();
  const double norm_before = norm;
  iterate(whole.problem(), found, norm, end, false);
  return norm < norm_before;
}

void Newton::solve(const StepProblem& problem, const SpringsOf& springs, StepSolution& solution, FirstTangent first) {
  branches_before_ = solution.contacts.branches();
  subdomains_.begin_step();
  equations_.prepare(problem, springs, solution.contacts);
  tangent_.fit(problem.method, equations_.rows(), contacts());
  solve_prepared(solution, first);
}

void Newton::solve_again(const std::vector<ContactSprings>& springs, StepSolution& solution, FirstTangent first) {
  branches_before_ = solution.contacts.branches();
  equations_.prepare_again(springs, solution.contacts);
  solve_prepared(solution, first);
}

void Newton::solve_prepared(StepSolution& solution, FirstTangent first) {
  const StepProblem& problem = equations_.problem();
  equations_.move_blocks_alone(solution.d);
  if (problem.end_weight < 1.0) {
    equations_.sum_start_forces();
    contacts().find_elastic();
    contacts().keep_start_forces();
  }
  const Eigen::VectorXd start = solution.d;
  double norm = begin(start, first);
  const auto is_open = [](const Contact& contact) { return contact.status == ContactStatus::open; };
  const bool may_start_cold = problem.statics && problem.method.max_iterations >= most_cold_iterations &&
                              std::all_of(problem.contacts.begin(), problem.contacts.end(), is_open);
  const NewtonEnd until{1.0, problem.method.max_iterations};
  Outcome outcome = iterate(problem, solution, norm, until, may_start_cold);
  if (outcome == Outcome::cold_start) {
    const Eigen::VectorXd after_first = solution.d;
    const std::vector<Branch> before_first = branches_before_;
    if (iterate_from_cold(solution, norm)) outcome = iterate(problem, solution, norm, until, false);
    if (!(norm <= 1.0)) {
      equations_.evaluate(solution.d = after_first);
      norm = equations_.residual_norm();
      branches_before_ = before_first;
      outcome = iterate_holding(solution, norm, 1);
    }
  }
  if (outcome == Outcome::no_common_step) {
    solution.d = start;
    norm = begin(start, first);
    outcome = iterate_holding(solution, norm, 0);
  }
  solution.converged = norm <= 1.0;
  if (problem.statics) solution.unbalanced = equations_.largest_unbalanced();
  if (!solution.converged) solution.reason = outcome == Outcome::singular ? "singular matrix" : "Newton's method did not converge";
  contacts().finish();
  note_memory(solution.memory());
}

Memory Newton::present_memory() const {
  Memory of = tangent_.memory() + equations_.memory();
  of.blocks += sizeof(double) * static_cast<std::size_t>(trial_.size());
  of.contacts += bytes_of(branches_before_, holds_) + subdomains_.bytes();
  return of;
}

}  // namespace openclose
