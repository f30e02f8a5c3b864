#include "openclose/analysis/strength_search.h"
#include "support/catch.h"

using namespace openclose;

namespace {

/// Stands below a factor. From there on joints break on any stride, and nothing is found; only limit analysis has a proof, far above.
class BreakingTrials : public StrengthTrials {
 public:
  BreakingTrials(double breaks, double proof) : breaks_(breaks), proof_(proof) {}
  TrialResult first(double srf) override { return at(srf, OnBreak::go_on); }
  TrialResult next(double srf, OnBreak on_break) override { return at(srf, on_break); }
  std::optional<double> proved_failure(double) override { return proof_; }
  int count() const { return count_; }

 private:
  TrialResult at(double srf, OnBreak) {
    if (++count_ > most) FAIL("more than " << most << " trials");
    TrialResult result;
    result.outcome = srf < breaks_ ? TrialOutcome::stable : TrialOutcome::undecided;
    result.broke = srf >= breaks_;
    result.steps = 1;
    return result;
  }
  static constexpr int most = 200;
  double breaks_, proof_;
  int count_ = 0;
};

}  // namespace

TEST_CASE("a trial that stays undecided where joints break is not made over and over again", "[analysis][search]") {
  for (const double breaks : {1.003, 1.37, 7.1}) {
    BreakingTrials trials(breaks, 1.4 * breaks);
    StrengthReductionInput input;
    input.increase = "load";
    input.width = 1e-3;  // half of the stride in which joints may break: the bracket is narrow before many trials are undecided
    const StrengthBracket found = search_strength(trials, input, [](const StrengthTrial&) {}, {});
    INFO(breaks << ", " << trials.count() << " trials");
    REQUIRE(found.stable);
    REQUIRE(found.failed);
    CHECK(*found.stable < breaks);
    CHECK(*found.stable >
          breaks - 3.0 * std::max(widest_bracket(input, breaks, 0.0), 2e-3 * breaks));  // half a stride that joints may break in, or two
    CHECK(*found.failed == 1.4 * breaks);
  }
}

namespace {

/// Stands from the beginning up to a factor of 3, above 0.2 with joints broken; on the way up from below nothing is found beyond 0.3.
class LostWay : public StrengthTrials {
 public:
  TrialResult first(double srf) override {
    is_on_the_way_up_ = srf < 0.2;
    TrialResult result;
    result.outcome = srf < 3.0 ? TrialOutcome::stable : TrialOutcome::failed;
    result.broke = srf >= 0.2;
    return result;
  }
  TrialResult next(double srf, OnBreak) override {
    TrialResult result;
    result.outcome = srf >= 3.0 ? TrialOutcome::failed : is_on_the_way_up_ && srf > 0.3 ? TrialOutcome::undecided : TrialOutcome::stable;
    return result;
  }

 private:
  bool is_on_the_way_up_ = false;
};

}  // namespace

TEST_CASE("a factor is no smaller than one that stands from the beginning", "[analysis][search]") {
  LostWay trials;
  const StrengthBracket found = search_strength(trials, {}, [](const StrengthTrial&) {}, {});
  REQUIRE(found.stable);
  REQUIRE(found.failed);
  CHECK(*found.stable < 3.0);
  CHECK(*found.failed >= 3.0);
  CHECK(*found.failed - *found.stable <= widest_bracket({}, 3.0, 0.0));
}

TEST_CASE("trials that fail from the beginning below what stands are no end of the bracket", "[analysis][search]") {
  /// Stands at 1 the first time it is asked, with joints broken, and nowhere from the beginning after that; on from there up to 2.
  class OnceOnly : public StrengthTrials {
   public:
    TrialResult first(double) override {
      TrialResult result;
      result.outcome = count_++ == 0 ? TrialOutcome::stable : TrialOutcome::failed;
      result.broke = true;
      return result;
    }
    TrialResult next(double srf, OnBreak) override {
      TrialResult result;
      result.outcome = srf < 2.0 ? TrialOutcome::stable : TrialOutcome::failed;
      return result;
    }

   private:
    int count_ = 0;
  } trials;
  const StrengthBracket found = search_strength(trials, {}, [](const StrengthTrial&) {}, {});
  REQUIRE(found.stable);
  REQUIRE(found.failed);
  CHECK(*found.failed > *found.stable);
  CHECK(*found.stable == Approx(2.0).margin(2.0 * widest_bracket({}, 2.0, 0.0)));
}
