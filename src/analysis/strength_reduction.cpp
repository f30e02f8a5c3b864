#include "openclose/analysis/strength_reduction.h"

#include <algorithm>
#include <cmath>

#include "openclose/analysis/equilibrium.h"

namespace openclose {
namespace {

constexpr double bracket_ratio = 1.25;               ///< [-] between the factors tried first
const std::string by_displacement = "displacement";  ///< see SettleResult::criterion
constexpr double smallest_factor = 1e-3;             ///< [-] below which nothing is stable at any strength one could mean

template <int N>
class StrengthReduction {
 public:
  StrengthReduction(Simulation<N>& simulation, const std::function<void(double)>& progress)
      : simulation_(simulation),
        search_(make_equilibrium_search(simulation)),
        points_(simulation),
        input_(simulation.scene().strength_reduction),
        progress_(progress) {}

  FactorOfSafety<N> run() {
    simulation_.book_steps(false);
    if (!settle_first()) {
      result_.reason = "not stable even at a strength reduction factor of 0.001 (" + verdict_ + ")";
      return std::move(result_);
    }
    if (!bracket()) {
      result_.reason = "still stable at strength_reduction.upper_limit";
      return std::move(result_);
    }
    bisect();
    result_.found = true;
    // The paper's criterion knows no other failure than too many steps.
    if (result_.criterion != by_displacement && simulation_.scene().settle.criterion != SettleCriterion::paper) {
      result_.warnings.push_back("the smallest factor counted as failed did not settle (" + result_.criterion +
                                 "), but no block moved beyond settle.failure_displacement_m");
    }
    curve();
    return std::move(result_);
  }

 private:
  /// The settled state is reached at factor 1, or at a smaller one if the scene fails with its own strength.
  bool settle_first() {
    const auto initial = simulation_.save();
    for (double srf = 1.0; srf >= smallest_factor; srf /= bracket_ratio * bracket_ratio) {
      simulation_.restore(initial);
      simulation_.joints().reduce_strength(srf);
      const SettleResult settled = search_->settle_first(shown());
      record(srf, "bracket", settled);
      if (settled.settled) {
        result_.stable = srf;
        result_.settled_state = simulation_.save();
        points_.restart();
        result_.trials.back().displacement = 0.0;
        return true;
      }
      result_.failed = srf;
      result_.criterion = settled.criterion;
      verdict_ = settled.verdict();
      result_.failed_state = simulation_.save();
    }
    return false;
  }

  bool bracket() {
    double srf = result_.stable;
    while (result_.failed == 0.0) {
      if (srf >= input_.upper_limit) return false;
      srf = std::min(srf * bracket_ratio, input_.upper_limit);
      attempt(srf, "bracket");
    }
    return true;
  }

  void bisect() {
    const double first_width = result_.failed - result_.stable;
    while (result_.failed - result_.stable > input_.width) {
      const double middle = 0.5 * (result_.stable + result_.failed);
      if (middle <= result_.stable || middle >= result_.failed) return;  // no number in between
      attempt(middle, "bisect");
      const double width = result_.failed - result_.stable;
      share_done_ = std::min(1.0, std::log(first_width / width) / std::log(first_width / input_.width));
    }
  }

  /// While a trial settles the share stands still, but the bar is there.
  SettleProgress shown() const {
    if (!progress_) return {};
    return [this](double) { progress_(share_done_); };
  }

  void attempt(double srf, const char* stage) {
    if (progress_) progress_(share_done_);
    simulation_.restore(result_.settled_state);
    simulation_.joints().reduce_strength(srf);
    const SettleResult settled = search_->settle_trial(shown());
    record(srf, stage, settled);
    if (settled.settled) {
      result_.stable = std::max(result_.stable, srf);
    } else {
      result_.failed = srf;
      result_.criterion = settled.criterion;
      result_.failed_state = simulation_.save();
    }
  }

  void curve() {
    for (double srf : input_.curve) {
      if (progress_) progress_(share_done_);
      simulation_.restore(result_.settled_state);
      simulation_.joints().reduce_strength(srf);
      record(srf, "curve", search_->settle_trial(shown()));
      if (!input_.curve_time) continue;
      simulation_.restore(result_.settled_state);
      const double dt = simulation_.scene().step.dt;
      const long steps = std::lround(*input_.curve_time / dt);
      bool arrived = true;
      for (long i = 0; i < steps && arrived; ++i) arrived = simulation_.advance(dt);
      if (!arrived) {
        result_.warnings.push_back("no displacement for the curve at factor " + std::to_string(srf) + ": " + simulation_.reason());
        continue;
      }
      for (const PointMotion& m : points_.motions()) result_.curve.push_back({srf, m.name, m.displacement.norm()});
    }
  }

  void record(double srf, const char* stage, const SettleResult& settled) {
    result_.trials.push_back({srf, stage, settled.settled, settled.criterion, settled.steps, points_.largest_displacement()});
  }

  Simulation<N>& simulation_;
  std::unique_ptr<EquilibriumSearch<N>> search_;
  MeasuredPoints<N> points_;
  const StrengthReductionInput& input_;
  std::function<void(double)> progress_;
  double share_done_ = 0.0;  ///< of the bisection
  std::string verdict_;      ///< of the last search for the first state, with the key that limited it
  FactorOfSafety<N> result_;
};

}  // namespace

template <int N>
FactorOfSafety<N> factor_of_safety(Simulation<N>& simulation, const std::function<void(double)>& progress) {
  return StrengthReduction<N>(simulation, progress).run();
}

template FactorOfSafety<3> factor_of_safety<3>(Simulation<3>&, const std::function<void(double)>&);

}  // namespace openclose
