// The search for the largest strength reduction factor at which a system stands, or for the largest multiplier of a load (both are called factor
// here). It knows trials by their outcome only: stable, failed, or undecided, and an undecided trial never counts as failed.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "openclose/core/archive.h"
#include "openclose/scene/scene.h"

namespace openclose {

enum class TrialOutcome {
  stable,     ///< equilibrium within the strength
  failed,     ///< as the definition of the factor has it: proved, or moved too far
  undecided,  ///< neither: did not converge
};

/// TrialResult::criterion of a failure that StrengthTrials::proved_failure() has proved.
inline constexpr const char* by_limit_analysis = "limit analysis";
inline constexpr const char* by_breaking_joints = "joints broke on too long a stride";  ///< says nothing of the factor

struct TrialResult {
  TrialOutcome outcome = TrialOutcome::undecided;
  std::string criterion;  ///< what decided
  int steps = 0;
  double displacement = 0.0;       ///< [m] largest of a measured point since the first stable state
  bool at_every_strength = false;  ///< failed, and no strength whatever would help
  bool exhausted = false;          ///< so much work has been done by then that what is undecided stays so
  bool broke = false;              ///< joints have lost strength for good on the way

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g] = *this;
    archive(a, b, c, d, e, f, g);
    archive.require(outcome <= TrialOutcome::undecided, "the saved state has a trial with an end that there is not");
  }
};

struct StrengthTrial : TrialResult {
  double srf = 1.0;   ///< [-] strength reduction factor, or multiplier of the load
  std::string stage;  ///< bracket, bisect or curve
};

/// What becomes of a trial in which joints have lost strength for good.
enum class OnBreak {
  go_on,    ///< it counts as any other
  go_back,  ///< it decides nothing and leaves the last stable state as it was
};

/// One way to find out whether a system stands at a factor.
class StrengthTrials {
 public:
  virtual ~StrengthTrials() = default;
  /// From the beginning: gravity on the scene as it starts. A stable state becomes the one that next() starts from.
  virtual TrialResult first(double srf) = 0;
  /// From the last stable state, which is replaced if this one is stable, too.
  virtual TrialResult next(double srf, OnBreak on_break) = 0;
  /// The smallest factor whose failure is proved without a trial; none if no proof is to be had. Asked for once a trial has stayed undecided.
  /// \param near  [-] a factor near which it may lie
  virtual std::optional<double> proved_failure(double /*near*/) { return std::nullopt; }
  /// [-] Below it brackets of multipliers become no narrower.
  virtual double smallest_multiplier() const { return 0.0; }
  /// What the next trials depend on, and the states that they have led to.
  virtual void exchange(Archive&) {}
};

/// What is known of the factor.
struct StrengthBracket {
  std::optional<double> stable;      ///< [-] largest stable factor on the path
  std::optional<double> failed;      ///< [-] smallest failed factor above it
  std::string failed_by;             ///< what decided there
  bool at_limit = false;             ///< stable at the upper limit
  bool is_narrow = false;            ///< failed and stable are as near to each other as was asked for
  bool stopped = false;              ///< the observer has stopped the search, see core/error.h
  bool at_every_strength = false;    ///< no strength whatever holds the system
  int undecided = 0;                 ///< trials between the two ends that stayed undecided
  std::vector<double> failed_below;  ///< [-] failed factors below the largest stable one
  std::string first_verdict;         ///< of the last trial from the beginning that was not stable; of the undecided ones if there are any
};

/// Told about every trial.
using TrialObserver = std::function<void(const StrengthTrial&)>;

/// [-] Between the ends of a bracket that is narrow enough: strength_reduction.width, and below a factor of 1 that part of the factor, since an error
/// of 5e-4 is nothing at 1.3 and nearly one per cent at 0.06. Multipliers have the unit of their load, so that of them it is always a part.
/// \param smallest_multiplier  [-] see StrengthTrials
double widest_bracket(const StrengthReductionInput& input, double factor, double smallest_multiplier);

/// Each trial starts from the last stable state. Where one stays undecided, the search comes near it from below with smaller increments, tries again,
/// and then looks above it for the smallest factor at which failure is certain. Where `progress` throws Stopped, before a trial or in it, what is
/// known by then is the answer.
///
/// Which joints lose strength for good depends on the way: over a long stride many reach their strength at once that would have reached it one after
/// the other, each passing its load on. So joints may break only in short strides, and the way begins at a factor at which none has broken, if
/// there is one.
StrengthBracket search_strength(StrengthTrials& trials, const StrengthReductionInput& input, const TrialObserver& done,
                                const std::function<void(double share)>& progress = {});

}  // namespace openclose
