#include "openclose/analysis/strength_reduction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/analysis/bent_joints.h"
#include "openclose/analysis/frozen_trials.h"
#include "openclose/analysis/loose_blocks.h"
#include "openclose/analysis/named_states.h"
#include "openclose/analysis/reservations.h"
#include "openclose/analysis/search_journal.h"
#include "openclose/analysis/settling_trials.h"
#include "openclose/core/error.h"

namespace openclose {
namespace {

constexpr double noticeable_share_of_corner = 0.1;  ///< [-] of the weight of what fails
constexpr double share_of_main_reason = 0.5;        ///< [-] of the distance to limit analysis that one reason accounts for
constexpr double far_below_limit_analysis = 0.98;   ///< [-] of its factor: below it the reason for the distance is given
constexpr double rounding_of_areas = 1e-9;          ///< [-] equal blocks are not smaller than each other

class StrengthReduction {
 public:
  StrengthReduction(Simulation& simulation, const SearchObserver& observer)
      : simulation_(simulation), scene_(simulation.scene()), input_(scene_.strength_reduction), observer_(observer), journal_([this] { save(); }) {}

  FactorOfSafety resume(std::string state) {
    saved_.emplace(std::move(state));
    (*saved_)(journal_);
    return run();
  }

  FactorOfSafety run() {
    if (input_.definition == FactorDefinition::large_displacements) {
      at_large_displacements();
    } else if (input_.definition == FactorDefinition::small_displacements) {
      at_small_displacements(scene_);
    } else if (const std::optional<Scene> settled = settled_scene()) {
      at_small_displacements(*settled);
    }
    return std::move(result_);
  }

 private:
  void at_large_displacements() {
    simulation_.solved_stepper().book_steps(false);
    SettlingTrials trials(simulation_, shown());
    if (saved_) (*saved_)(simulation_);
    begin(trials);
    result_.bracket = search(trials);
    judge();
    if (const std::string words = trials.search().unseen(); !words.empty()) result_.warnings.push_back(words);
    warn_of_failure_displacement();
    if (trials.settled()) {
      add_state("settled", *trials.settled());
      if (const std::string words = bent_joints_in_words(simulation_); !words.empty()) result_.warnings.push_back(words);
    }
    warn_of_loose_blocks(scene_);
    if (trials.failed()) add_state("failed", *trials.failed());
    if (!result_.bracket.stopped) curve(trials);
  }

  void at_small_displacements(const Scene& scene) {
    FrozenSystem system(scene);
    FrozenTrials trials(scene, system);
    begin(trials);
    trials.solver().set_interruption(observer_.interruption);
    if (input_.limit_analysis) trials.set_limit_analysis([&](double near) { return limit_near(scene, system, near).failed; });
    result_.bracket = search(trials);
    if (input_.limit_analysis) unless_stopped([&] { limit_near(scene, system, result_.bracket.stable.value_or(1.0)); });
    judge();
    if (trials.stable()) {
      result_.states.push_back(stable_state(scene_, system, *trials.stable()));
      result_.largest_travel = trials.travel().largest * system.closure_unit();
      warn_of_travel(trials.travel(), system.closure_unit());
    }
    add_mechanism(system, failing_motion(system, trials));
    // Of the last trial, if that has failed: the weakest reduction of all. Others may have stayed undecided.
    const bool has_failed_last = !result_.trials.empty() && result_.trials.back().outcome == TrialOutcome::failed;
    const bool is_known =
        result_.verdict == FactorVerdict::no_equilibrium || (!result_.bracket.stable && !result_.bracket.stopped && has_failed_last);
    if (is_known && !result_.mechanism.empty()) result_.reason += ": " + motion_in_words(scene, result_.mechanism);
    warn_of_interval();
    warn_of_geometry();
    if (input_.limit_analysis) unless_stopped([&] { compare(scene, system, trials); });
    warn_of_loose_blocks(scene);
    trials.end_search();
    unless_stopped([&] {
      for (double srf : input_.curve) {
        if (trials.stable()) record(srf, "curve", JournalledTrials(trials, journal_).next(srf, OnBreak::go_on));
      }
    });
    result_.linear_solves = trials.solver().linear_solves();
  }

  /// What comes after the search; where that is stopped, what is known of the factor is told as of a search that was.
  template <typename F>
  void unless_stopped(const F& f) {
    if (result_.bracket.stopped) return;
    try {
      f();
    } catch (const Stopped&) {
      result_.bracket.stopped = true;
      judge();
    }
  }

  /// Done once, at the latest when the search has ended.
  const LimitAnalysisResult& limit_near(const Scene& scene, const FrozenSystem& system, double near) {
    if (!result_.limit_analysis) {
      result_.limit_analysis = journal_.once([&] { return limit_analysis_of(scene, system, input_.upper_limit, near, observer_.interruption); });
      const auto& mechanism = result_.limit_analysis->mechanism;
      if (!mechanism.empty() && static_cast<int>(mechanism.size()) != system.rows())
        throw DamagedState("the saved state has a mechanism of blocks that are not there");
    }
    return *result_.limit_analysis;
  }

  /// The scene with its blocks where gravity has brought them with their full strength; nothing if they do not come to rest.
  std::optional<Scene> settled_scene() {
    simulation_.solved_stepper().book_steps(false);
    if (saved_) (*saved_)(simulation_);
    const SettleResult settled = journal_.once([&] { return make_equilibrium_search(simulation_)->settle_first(shown()); });
    if (!settled.settled) {
      result_.reason = "the joints' closures are not known, since the scene does not settle with its own strength (" + settled.verdict() + ")";
      return std::nullopt;
    }
    add_state("settled", simulation_.save());
    Scene moved = scene_;
    const BlockSystem& system = simulation_.system();
    for (int b = 0; b < system.block_count(); ++b) {
      const auto& block = system.block(b);
      for (int i = 0; i < block.vertex_count; ++i) moved.blocks[b].vertices[i] = system.position(b, block.first_vertex + i) + system.origin();
    }
    const auto carried = [&](int b, const Vec2& point) {
      const auto& d = system.displacement(b);
      const Vec2 arm = point - system.origin() - system.block(b).reference_centroid;
      return Vec2(point + Motion::displacement(d, arm, system.rotation_kind()));
    };
    for_each_force(moved, [&](auto& force) { force.visit_points(force, [&](Vec2& point) { point = carried(force.block, point); }); });
    for (MeasuredPoint& p : moved.measured_points) p.point = carried(p.block, p.point);
    return moved;
  }

  /// From now on these trials are what has led to all that is known.
  void begin(StrengthTrials& trials) {
    trials_ = &trials;
    bool has_trials = false;
    if (saved_) (*saved_)(has_trials);
    if (has_trials) trials.exchange(*saved_);
  }

  /// The work that is done, the blocks where they are moved, and the trials with the states that the next ones start from.
  void save() {
    if (!observer_.done) return;
    Archive state;
    state(journal_);
    if (input_.definition != FactorDefinition::small_displacements) state(simulation_);
    bool has_trials = trials_ != nullptr;
    state(has_trials);
    if (has_trials) trials_->exchange(state);
    observer_.done(state.take());
  }

  StrengthBracket search(StrengthTrials& trials) {
    JournalledTrials journalled(trials, journal_);
    return search_strength(
        journalled, input_,
        [this](const StrengthTrial& trial) {
          result_.trials.push_back(trial);
          if (observer_.trial) observer_.trial(trial);
        },
        observer_.progress ? [this](double share) { observer_.progress(share_done_ = share); } : std::function<void(double)>());
  }

  /// What the bracket is worth, in a word and in a sentence.
  void judge() {
    const StrengthBracket& b = result_.bracket;
    if (b.stopped) {
      result_.verdict = b.stable ? FactorVerdict::interval : FactorVerdict::undecided;
      result_.reason = !b.stable  ? "stopped before any stable state was found"
                       : b.failed ? fmt::format("stopped between {:.6g} and {:.6g}", *b.stable, *b.failed)
                                  : fmt::format("stopped above {:.6g}", *b.stable);
      return;
    }
    if (!b.stable) {
      const bool proved = result_.limit_analysis && result_.limit_analysis->no_equilibrium;
      const bool none = proved || b.at_every_strength || (b.failed && b.undecided == 0);
      result_.verdict = none ? FactorVerdict::no_equilibrium : FactorVerdict::undecided;
      const char* known = none ? "not stable" : "neither equilibrium nor failure found";
      result_.reason = b.at_every_strength ? "no strength of the joints could hold the blocks: " + b.first_verdict
                       : input_.increase   ? fmt::format("{} before {} grows ({})", known, *input_.increase, b.first_verdict)
                                           : fmt::format("{} {} a strength reduction factor of {:.3g} ({})", known, none ? "even at" : "down to",
                                                         smallest_tried(), b.first_verdict);
      return;
    }
    if (b.at_limit) {
      result_.verdict = FactorVerdict::no_failure;
      result_.reason = "still stable at strength_reduction.upper_limit";
      return;
    }
    if (b.is_narrow) {
      result_.verdict = FactorVerdict::certified;
    } else {
      result_.verdict = FactorVerdict::interval;
      result_.reason =
          b.failed ? fmt::format("undecided between {:.6g} and {:.6g}", *b.stable, *b.failed) : fmt::format("undecided above {:.6g}", *b.stable);
      if (b.undecided > 0) result_.reason += fmt::format(": {} trials found neither equilibrium nor failure", b.undecided);
    }
    for (double srf : b.failed_below) result_.warnings.push_back(fmt::format("failed at {:.6g}, and stands again at {:.6g}", srf, *b.stable));
  }

  double smallest_tried() const { return std::ranges::min(result_.trials, {}, &StrengthTrial::srf).srf; }

  void curve(SettlingTrials& trials) {
    if (!trials.settled()) return;
    for (double srf : input_.curve) {
      record(srf, "curve", JournalledTrials(trials, journal_).next(srf, OnBreak::go_on));
      if (!input_.curve_time) continue;
      const CurveMotion motion = journal_.once([&] { return motion_for_curve(trials, srf); });
      result_.curve.insert(result_.curve.end(), motion.points.begin(), motion.points.end());
      if (!motion.failure.empty()) result_.warnings.push_back(fmt::format("no displacement for the curve at factor {:g}: {}", srf, motion.failure));
    }
  }

  struct CurveMotion {
    std::vector<CurvePoint> points;
    std::string failure;  ///< why there are none

    void exchange(Archive& archive) {
      auto& [a, b] = *this;
      archive(a, b);
    }
  };

  CurveMotion motion_for_curve(SettlingTrials& trials, double srf) {
    simulation_.restore(*trials.settled());
    trials.points().restart();
    CurveMotion motion;
    if (!move(*input_.curve_time)) {
      motion.failure = simulation_.reason();
      return motion;
    }
    for (const PointMotion& m : trials.points().motions()) motion.points.push_back({srf, m.name, m.displacement.norm()});
    return motion;
  }

  bool move(double time) {
    const double dt = scene_.step.dt;
    for (long i = 0, steps = std::lround(time / dt); i < steps; ++i) {
      if (!simulation_.advance(dt)) return false;
    }
    return true;
  }

  /// While a trial settles the share stands still, but the bar is there.
  SettleProgress shown() const {
    if (!observer_.progress) return {};
    return [this](double) { observer_.progress(share_done_); };
  }

  void record(double srf, const char* stage, const TrialResult& trial_result) {
    StrengthTrial trial;
    static_cast<TrialResult&>(trial) = trial_result;
    trial.srf = srf;
    trial.stage = stage;
    result_.trials.push_back(trial);
  }

  void add_state(const char* name, const Simulation::Snapshot& snapshot) {
    simulation_.restore(snapshot);
    result_.states.push_back({name, simulation_.system(), simulation_.change_contacts()});
  }

  /// Of the failed end of the bracket: accelerations where the blocks start to move, the motion of limit analysis where that has proved the failure.
  Eigen::VectorXd failing_motion(const FrozenSystem& system, const FrozenTrials& trials) const {
    const std::optional<LimitAnalysisResult>& limit = result_.limit_analysis;
    const bool by_limit = result_.bracket.failed_by == by_limit_analysis && limit && !limit->mechanism.empty();
    if (!by_limit) return trials.mechanism();
    Eigen::VectorXd motion(3 * system.rows());
    for (int row = 0; row < system.rows(); ++row) {
      const limit_analysis::BlockVelocity& v = limit->mechanism[row];
      motion.segment<3>(3 * row) << v.velocity, v.rotation * system.blocks()[row].radius * system.length_unit();
    }
    return motion;
  }

  void add_mechanism(const FrozenSystem& system, const Eigen::VectorXd& direction) {
    if (direction.size() == 0) return;
    Mechanism mechanism = mechanism_of(scene_, system, direction);
    result_.mechanism = std::move(mechanism.blocks);
    result_.states.push_back(std::move(mechanism.state));
  }

  /// What speaks for a factor and what against it: limit analysis, and joints of other ratios of stiffness.
  void compare(const Scene& scene, const FrozenSystem& system, const FrozenTrials& trials) {
    const LimitAnalysisResult& limit = *result_.limit_analysis;
    if (!limit.is_conclusive) {
      const std::string known = limit.factor
                                    ? fmt::format("limit analysis is undecided below {:.6g}, so that its bound may lie too high: ", *limit.factor)
                                    : "limit analysis has no factor: ";
      result_.warnings.push_back(known + limit.verdict);
    }
    // Without a factor, or at a multiplier of 0, there is nothing to compare with.
    if (!(result_.bracket.stable > 0.0) || result_.bracket.at_limit) return;
    for (const double ratio : stiffness_ratios) {
      const auto effect = [&] {
        return has_stiffness_ratio(scene, ratio) ? StiffnessEffect{ratio, result_.bracket.stable, result_.bracket.failed}
                                                 : stiffness_effect(scene, ratio, *result_.bracket.stable, limit.failed, observer_.interruption);
      };
      result_.stiffness_effects.push_back(journal_.once(effect));
    }
    const double low = *result_.bracket.stable, high = result_.bracket.failed.value_or(std::numeric_limits<double>::infinity());
    double largest = low;
    std::string others;
    for (const StiffnessEffect& effect : result_.stiffness_effects) {
      largest = std::max(largest, effect.stable.value_or(0.0));
      const double clear = 0.5 * width_of_stiffness_effect * low;
      if (is_unknown(effect, low))
        result_.warnings.push_back(
            fmt::format("what the {} is at a ratio of shear to normal stiffness of {:g} is not known: the short search for it ended "
                        "undecided above {:.4g}; fos with joints of that ratio searches longer",
                        noun(), effect.ratio, *effect.stable));
      const bool differs = !effect.stable || *effect.stable > high + clear || (effect.failed && *effect.failed < low - clear);
      if (!differs) continue;
      const std::string factor = in_words(effect);
      others += fmt::format("{}{} at a ratio of {:g}", others.empty() ? "" : ", ", factor, effect.ratio);
    }
    if (!others.empty())
      result_.warnings.push_back(
          fmt::format("the {} depends on the ratio of shear to normal stiffness: {}, where the scene's own give {:.4g}", noun(), others, low));
    // A wide bracket that has the limit within it needs no other reason.
    if (result_.verdict == FactorVerdict::certified && limit.factor && result_.bracket.failed < far_below_limit_analysis * *limit.factor)
      warn_of_distance(*limit.factor, largest, scene, system, trials);
    warn_of_corner(scene, system, trials);
  }

  /// A factor that rests on one corner is worth what the rock there is.
  void warn_of_corner(const Scene& scene, const FrozenSystem& system, const FrozenTrials& trials) {
    const std::optional<CornerLoad> corner = heaviest_lone_corner(system, *trials.stable(), rows_of(system, result_.mechanism));
    if (!corner || corner->share < noticeable_share_of_corner) return;
    const LimitAnalysisResult without = journal_.once(
        [&] { return limit_analysis_of(scene, system, input_.upper_limit, *result_.bracket.stable, observer_.interruption, LoneCorners::left_out); });
    if (!without.factor || *without.factor >= far_below_limit_analysis * *result_.bracket.stable) return;
    result_.warnings.push_back(fmt::format("{}: where the rock crushes there, the {} is at most {:.4g} (limit analysis without such corners)",
                                           in_words(scene, system, *corner), noun(), *without.factor));
  }

  const char* noun() const { return input_.increase ? "multiplier" : "factor"; }

  void warn_of_distance(double limit, double largest, const Scene& scene, const FrozenSystem& system, const FrozenTrials& trials) {
    result_.warnings.push_back(fmt::format("limit analysis has {:.4g}, {:.2g} % above: {}", limit, 100.0 * (limit / *result_.bracket.stable - 1.0),
                                           reason_of_distance(limit, largest, scene, system, trials)));
  }

  std::string reason_of_distance(double limit, double largest, const Scene& scene, const FrozenSystem& system, const FrozenTrials& trials) const {
    const auto broken = std::ranges::count_if(trials.stable()->contacts, [](const FrozenContactState& s) { return s.joint_state != JointState{}; });
    if (broken > 0) return fmt::format("joints have lost strength for good at {} contacts, which it does not know", broken);
    FrozenStrength strength(system, scene);
    if (!input_.increase) strength.reduce(*result_.bracket.stable);
    const std::vector<int> failing = rows_of(system, result_.mechanism);
    if (is_about_to_crack(system, strength, *trials.stable(), failing))
      return "it lets joints pull with their tensile strength along their whole length; here one that is bent cracks from its edge";
    const double withheld = withheld_strength(system, strength, *trials.stable(), failing);
    if (withheld > share_of_main_reason * (1.0 - *result_.bracket.stable / limit)) return withheld_in_words(withheld);
    if (std::ranges::any_of(scene_.joints, [](const JointProperties& joint) { return can_lose_strength(joint, {}); }))
      return "joints that slip or open lose strength for good, one contact after the other, which it does not know";
    if (largest >= far_below_limit_analysis * limit) return "with another ratio of stiffness the joints carry nearly as much";
    return "it lets joints open by their friction angle as they slide, which jams blocks; here they slide without opening";
  }

  void warn_of_travel(const TravelOnPath& travel, double closure) {
    if (!travel.has_jumped()) return;
    const TravelOnPath::Jump &farthest = travel.farthest, &first = travel.first;
    const bool is_first = farthest.before == first.before && farthest.after == first.after;
    const std::string only_below = is_first ? "" : fmt::format(", the first time above {:.6g}", first.before);
    result_.warnings.push_back(
        fmt::format("the blocks moved by up to {:.3g} mm, {:.3g} joint closures, to another equilibrium between the {}s {:.6g} and {:.6g}{}; up to "
                    "{:.6g} they stand where they are drawn",
                    1e3 * farthest.travel * closure, farthest.travel, noun(), farthest.before, farthest.after, only_below, first.before));
  }

  void warn_of_failure_displacement() {
    const double size = simulation_.system().median_size(), asked = scene_.settle.failure_displacement;
    if (size > 0.0 && asked > size)
      result_.warnings.push_back(fmt::format(
          "a block is failing once it has moved by settle.failure_displacement_m = {:g} m, more than the median block's size of {:.3g} m: what fails "
          "may come to rest before",
          asked, size));
  }

  /// What stands whatever its strength may stand on a point.
  void warn_of_loose_blocks(const Scene& scene) {
    if (!input_.limit_analysis || result_.verdict != FactorVerdict::no_failure) return;
    if (const std::string words = loose_blocks_in_words(scene); !words.empty()) result_.warnings.push_back(words);
  }

  void warn_of_interval() {
    if (result_.verdict != FactorVerdict::interval || result_.bracket.stopped) return;
    if (const std::string words = interval_in_words(result_.bracket, result_.trials); !words.empty()) result_.warnings.push_back(words);
  }

  void warn_of_geometry() {
    const BlockSystem& system = simulation_.system();
    const double median = system.median_size() * system.median_size();
    double failing = 0.0;
    for (const FailingBlock& block : result_.mechanism) failing += block.area;
    if (!result_.mechanism.empty() && system.free_count() > 1 && failing < (1.0 - rounding_of_areas) * median) {
      result_.warnings.push_back(fmt::format("what fails is small: {} of {} free blocks with {:.3g} m2, the median block has {:.3g} m2",
                                             result_.mechanism.size(), system.free_count(), failing, median));
    }
  }

  Simulation& simulation_;
  const Scene& scene_;
  const StrengthReductionInput& input_;
  const SearchObserver& observer_;
  SearchJournal journal_;
  std::optional<Archive> saved_;      ///< read as far as it was needed
  StrengthTrials* trials_ = nullptr;  ///< those of the search, once they have begun
  double share_done_ = 0.0;           ///< of the bisection
  FactorOfSafety result_;
};

}  // namespace

FactorOfSafety factor_of_safety(Simulation& simulation, const SearchObserver& observer) {
  return StrengthReduction(simulation, observer).run();
}

FactorOfSafety factor_of_safety(Simulation& simulation, const std::function<void(double)>& progress) {
  return factor_of_safety(simulation, SearchObserver{progress, {}});
}

FactorOfSafety resume_search(Simulation& simulation, const SearchObserver& observer, std::string state) {
  return StrengthReduction(simulation, observer).resume(std::move(state));
}

}  // namespace openclose
