// Trials at small displacements: the geometry stays as drawn, and stable and failed are proved (statics/certificate.h).
#pragma once

#include <functional>
#include <memory>

#include "openclose/analysis/strength_search.h"
#include "openclose/statics/frozen_solver.h"

namespace openclose {

/// How far the blocks moved from one stable state to the next one that was found, in closures.
struct TravelOnPath {
  /// Two stable states between which the blocks moved to another place.
  struct Jump {
    double travel = 0.0;
    double before = 0.0, after = 0.0;  ///< [-] the factors of the two states
  };
  double largest = 0.0;  ///< between any two states, jumps or not
  Jump farthest, first;  ///< of the jumps; those of no travel are none

  bool has_jumped() const { return farthest.travel > 0.0; }

  void exchange(Archive& archive) {
    auto& [a, b, c] = *this;
    archive(a);
    for (Jump* jump : {&b, &c}) archive(jump->travel, jump->before, jump->after);
  }
};

/// [-] In closures: a travel that is no closure of joints any more, but a way to another place.
inline constexpr double jump_in_closures = 10.0;
/// [-] A load that grows moves the blocks on their joints, too: a jump is so many times as far, for the same growth, as on the stiffest part of the
/// path.
inline constexpr double jump_over_stiffest = 10.0;

/// [-] Of a live load: makes a thousandth of a block's weight, so that a bracket of 1e-4 of it is still seen in forces that balance to 1e-8 of a
/// weight.
double smallest_multiplier(const FrozenSystem& system);

class FrozenTrials : public StrengthTrials {
 public:
  /// The joint's own stiffnesses, solved as method.contact does. What a trial's factor changes is the strength, or the load of the system that the
  /// scene increases.
  FrozenTrials(const Scene& scene, FrozenSystem& system);

  TrialResult first(double srf) override;
  TrialResult next(double srf, OnBreak on_break) override;
  /// By limit analysis, if that is to be done.
  std::optional<double> proved_failure(double near) override { return limit_analysis_ ? limit_analysis_(near) : std::nullopt; }
  /// Another way to prove a failure: the smallest factor at which nothing can stand, found from one near it.
  void set_limit_analysis(std::function<std::optional<double>(double near)> f) { limit_analysis_ = std::move(f); }

  double smallest_multiplier() const override { return openclose::smallest_multiplier(system_); }
  void exchange(Archive& archive) override;

  /// From now on trials are worth less work before they stay undecided.
  void reduce_effort() { reduced_ = true; }

  FrozenStrength& strength() { return strength_; }
  FrozenSolver& solver() { return *solver_; }
  /// The search has ended. What it has found stays, whatever further trials, which begin at its stable state, do.
  void end_search();
  const std::optional<FrozenState>& stable() const { return found_ ? found_->stable : stable_; }
  /// Of the last trial that failed by a mechanism; empty if none did.
  const Eigen::VectorXd& mechanism() const { return found_ ? found_->mechanism : mechanism_; }
  const TravelOnPath& travel() const { return found_ ? found_->travel : travel_; }

 private:
  Effort effort() const;
  void apply(double srf);
  TrialResult result_of(RelaxationResult&& relaxed, double srf);
  bool has_broken(const FrozenState& before, const FrozenState& after) const;
  void follow(double travel, double srf);
  double displacement_of_points(const FrozenState& state) const;

  struct Found {
    std::optional<FrozenState> stable;
    Eigen::VectorXd mechanism;
    TravelOnPath travel;
    void exchange(Archive& archive) { archive(stable, mechanism, travel); }
  };

  struct Point {
    int row;
    Vec2 arm;  ///< in radii of the block
  };

  FrozenSystem& system_;
  FrozenStrength strength_;
  std::unique_ptr<FrozenSolver> solver_;
  std::vector<Point> points_;
  // The intact rock under its load: alike in all trials unless these change the load or what the joints bear in tension.
  std::optional<FrozenState> bonded_;
  bool bonded_failed_ = false;
  std::optional<FrozenState> first_stable_, stable_;
  double stable_factor_ = 0.0;
  std::optional<double> least_compliance_;  ///< travel over growth of the load, between any two stable states on the way
  std::function<std::optional<double>(double near)> limit_analysis_;
  Eigen::VectorXd mechanism_;
  bool reduced_ = false;
  int undecided_ = 0;  ///< trials from a stable state so far
  TravelOnPath travel_;
  std::optional<Found> found_;
};

}  // namespace openclose
