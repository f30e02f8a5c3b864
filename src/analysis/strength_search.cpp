#include "openclose/analysis/strength_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/core/error.h"

namespace openclose {
namespace {

constexpr double bracket_ratio = 1.25;     ///< [-] between the factors tried first
constexpr std::size_t most_undecided = 4;  ///< trials: each may cost as much as all that are decided
constexpr double smallest_factor = 1e-3;   ///< [-] below which nothing is stable at any strength one could mean
/// [-] Of the factor: over longer strides joints may not break, but where the bracket is to be wider. All strengths divided by 1 to 1.37 change which
/// joints break together and should change nothing else: of 58 random scenes of brittle joints factors then differ by more than 0.5 % in 3, by at
/// most 5 % (of 29 scenes with tensile strength in one, by 15 %); without a limit in 15 of 53, by up to 19 %. Strides as short as the bracket, 1e-4,
/// leave 2 of 58, and took four times as long on a slope of 403 blocks that breaks from a factor of 1.5 up to 18.
constexpr double longest_breaking_stride = 2e-3;
constexpr double unbroken_ratio = 4.0;  ///< [-] between the factors tried below the first stable one, where joints have broken

constexpr double first_multiplier = 0.125;  ///< [-] of a load, after 0: an earthquake's, or some of what the user wrote
constexpr double multiplier_ratio = 2.0;    ///< [-] between the next ones

class Search {
 public:
  Search(StrengthTrials& trials, const StrengthReductionInput& input, const TrialObserver& done, const std::function<void(double)>& progress)
      : trials_(trials), input_(input), done_(done), progress_(progress) {}

  StrengthBracket run() {
    try {
      if (find_first()) {
        narrow();
        go_on_from_first();
      }
    } catch (const Stopped&) {
      bracket_.stopped = true;
    }
    if (!bracket_.stable) return std::move(bracket_);
    bracket_.is_narrow = bracket_.failed && *bracket_.failed - *bracket_.stable <= widest(*bracket_.stable);
    bracket_.undecided = static_cast<int>(undecided_.size());
    for (double srf : failures_) {
      if (srf < *bracket_.stable) bracket_.failed_below.push_back(srf);
    }
    return std::move(bracket_);
  }

 private:
  void narrow() {
    while (const std::optional<double> srf = choose()) {
      if (!attempt(*srf)) return;
    }
  }

  /// At factor 1, or at a smaller one if the scene fails with its own strength. Where that is not decided, also a little above: which factor is hard
  /// to decide is a matter of chance. Multipliers of a load begin at 0.
  bool find_first() {
    if (input_.increase) return begin_at(0.0) == TrialOutcome::stable;
    for (double srf = 1.0; srf >= smallest_factor; srf /= bracket_ratio * bracket_ratio) {
      const TrialOutcome outcome = begin_at(srf);
      if (outcome == TrialOutcome::stable) return begin_unbroken(srf);
      if (bracket_.at_every_strength) return false;
      if (outcome == TrialOutcome::undecided && srf == 1.0 && begin_at(bracket_ratio) == TrialOutcome::stable) return begin_unbroken(bracket_ratio);
    }
    return false;
  }

  /// If joints have broken in the first stable state: from a stronger one in which none has; from the first one if there is none.
  bool begin_unbroken(double first) {
    if (!first_broke_) return true;
    first_ = first;
    for (double srf = first / unbroken_ratio; srf >= smallest_factor; srf /= unbroken_ratio) {
      if (begin_at(srf) == TrialOutcome::stable && !first_broke_) return true;
    }
    begin_at(first);
    leave_other_paths();
    return true;
  }

  /// Where the way up from an unbroken state has come to an end below the factor that stands from the beginning, the answer is no smaller than that.
  void go_on_from_first() {
    if (bracket_.failed || !(first_ > *bracket_.stable)) return;
    undecided_.clear();
    breaks_at_.reset();
    stride_ = std::numeric_limits<double>::infinity();
    const StrengthBracket before = bracket_;
    if (begin_at(first_) == TrialOutcome::stable) {
      narrow();
    } else {
      bracket_ = before;
    }
  }

  /// Trials from the beginning that have failed below what stands have done so on another path.
  void leave_other_paths() {
    if (!bracket_.failed || *bracket_.failed > *bracket_.stable) return;
    bracket_.failed.reset();
    bracket_.failed_by.clear();
  }

  TrialOutcome begin_at(double srf) {
    if (progress_) progress_(0.0);
    const TrialResult result = record(srf, "bracket", trials_.first(srf));
    first_broke_ = result.broke;
    if (result.outcome == TrialOutcome::stable) {
      bracket_.stable = srf;
      bracket_.failed.reset();
      bracket_.failed_by.clear();
      return result.outcome;
    }
    bracket_.failed_by = result.criterion;
    if (result.outcome == TrialOutcome::undecided || bracket_.undecided == 0) bracket_.first_verdict = result.criterion;
    bracket_.at_every_strength = result.at_every_strength;
    if (result.outcome == TrialOutcome::failed) bracket_.failed = srf;
    if (result.outcome == TrialOutcome::undecided) ++bracket_.undecided;
    return result.outcome;
  }

  /// The next factor to try; nothing when the bracket is as narrow as asked for, or cannot become narrower.
  std::optional<double> choose() {
    const double stable = *bracket_.stable;
    std::erase_if(undecided_, [&](double srf) { return srf <= stable || (bracket_.failed && srf >= *bracket_.failed); });
    if (undecided_.empty()) return bracket_.failed ? middle(stable, *bracket_.failed) : above(stable);
    if (exhausted_) return std::nullopt;
    std::ranges::sort(undecided_);
    const double lowest = undecided_.front(), highest = undecided_.back();
    if (undecided_.size() < most_undecided) {
      if (lowest - stable > 0.5 * widest(stable)) return 0.5 * (stable + lowest);
      if (retried_ != lowest) return retried_ = lowest;
    }
    if (bracket_.failed) {
      if (undecided_.size() >= most_undecided) return std::nullopt;
      return middle(highest, *bracket_.failed);
    }
    if (undecided_.size() >= 2 * most_undecided) return std::nullopt;
    return above(highest);
  }

  double widest(double factor) const { return widest_bracket(input_, factor, trials_.smallest_multiplier()); }

  std::optional<double> middle(double low, double high) const {
    const double between = 0.5 * (low + high);
    if (high - low <= widest(low) || between <= low || between >= high) return std::nullopt;
    return between;
  }

  std::optional<double> above(double srf) {
    if (srf >= input_.upper_limit) {
      bracket_.at_limit = srf == *bracket_.stable;
      return std::nullopt;
    }
    return std::min(input_.increase ? std::max(first_multiplier, srf * multiplier_ratio) : srf * bracket_ratio, input_.upper_limit);
  }

  /// In which joints may break.
  double finest_stride() const { return std::max(widest(*bracket_.stable), longest_breaking_stride * *bracket_.stable); }

  /// Not past the factor at which joints break from the last stable state: half way to it, until that is a stride in which they may. After a break
  /// strides grow from the finest one.
  double within_stride(double target) {
    const double stable = *bracket_.stable, finest = finest_stride();
    if (breaks_at_ && *breaks_at_ <= stable) breaks_at_.reset();
    const double end = std::min(target, breaks_at_.value_or(target)), stride = end - stable;
    if (breaks_at_ && end == *breaks_at_ && stride > finest) return stable + 0.5 * stride;
    return stride_ < stride ? stable + stride_ : end;
  }

  bool is_undecided(double srf) const { return std::ranges::find(undecided_, srf) != undecided_.end(); }

  /// False if there is no way to the target: joints break before it, and what becomes of that has stayed open in a stride in which they may.
  bool attempt(double target) {
    if (progress_) progress_(share_done());
    const double stable = *bracket_.stable, finest = finest_stride(), srf = within_stride(target);
    if (srf != target && is_undecided(srf)) return false;
    const bool may_break = srf - stable <= finest;
    const TrialResult result = record(srf, bracket_.failed ? "bisect" : "bracket", trials_.next(srf, may_break ? OnBreak::go_on : OnBreak::go_back));
    if (result.broke && !may_break) {
      breaks_at_ = srf;
      return true;
    }
    if (result.broke) stride_ = finest;
    switch (result.outcome) {
      case TrialOutcome::stable:
        bracket_.stable = std::max(*bracket_.stable, srf);
        if (!result.broke) stride_ *= 2.0;
        break;
      case TrialOutcome::failed:
        add_failure(srf, result.criterion);
        break;
      case TrialOutcome::undecided:
        if (!is_undecided(srf)) undecided_.push_back(srf);
        look_for_proof();
        break;
    }
    return true;
  }

  /// Where a trial leaves open what happens, there may be a proof without one.
  void look_for_proof() {
    if (has_looked_for_proof_) return;
    has_looked_for_proof_ = true;
    const std::optional<double> proved = trials_.proved_failure(*bracket_.stable);
    if (!proved || *proved <= *bracket_.stable || (bracket_.failed && *proved >= *bracket_.failed)) return;
    TrialResult result;
    result.outcome = TrialOutcome::failed;
    result.criterion = by_limit_analysis;
    add_failure(*proved, record(*proved, bracket_.failed ? "bisect" : "bracket", result).criterion);
  }

  void add_failure(double srf, const std::string& criterion) {
    failures_.push_back(srf);
    if (!bracket_.failed || srf < *bracket_.failed) {
      bracket_.failed = srf;
      bracket_.failed_by = criterion;
    }
    if (first_width_ == 0.0) first_width_ = *bracket_.failed - *bracket_.stable;
    std::erase(undecided_, srf);
  }

  TrialResult record(double srf, const char* stage, const TrialResult& result) {
    StrengthTrial trial;
    static_cast<TrialResult&>(trial) = result;
    trial.srf = srf;
    trial.stage = stage;
    exhausted_ = exhausted_ || result.exhausted;
    done_(trial);
    return result;
  }

  /// Of the bisection, on a logarithmic scale; it never falls back.
  double share_done() {
    if (!bracket_.failed) return share_;
    const double final_width = widest(*bracket_.stable);
    if (first_width_ <= final_width) return share_;
    const double width = std::max(*bracket_.failed - *bracket_.stable, final_width);
    return share_ = std::clamp(std::log(first_width_ / width) / std::log(first_width_ / final_width), share_, 1.0);
  }

  StrengthTrials& trials_;
  const StrengthReductionInput& input_;
  const TrialObserver& done_;
  const std::function<void(double)>& progress_;
  StrengthBracket bracket_;
  double first_ = 0.0;                                       ///< [-] stable from the beginning, with joints broken
  bool first_broke_ = false;                                 ///< in the last trial from the beginning
  double stride_ = std::numeric_limits<double>::infinity();  ///< [-] the longest from a stable factor to the next one
  std::optional<double> breaks_at_;                          ///< [-] by a stride from the last stable factor that was too long for it
  std::vector<double> undecided_;                            ///< factors between the two ends
  double retried_ = 0.0;
  bool exhausted_ = false;
  bool has_looked_for_proof_ = false;
  std::vector<double> failures_;
  double first_width_ = 0.0, share_ = 0.0;
};

}  // namespace

double widest_bracket(const StrengthReductionInput& input, double factor, double smallest_multiplier) {
  return input.width * (input.increase ? std::max(factor, smallest_multiplier) : std::min(1.0, factor));
}

StrengthBracket search_strength(StrengthTrials& trials, const StrengthReductionInput& input, const TrialObserver& done,
                                const std::function<void(double share)>& progress) {
  return Search(trials, input, done, progress).run();
}

}  // namespace openclose
