#include "openclose/statics/weakening_pace.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace openclose {
namespace {

constexpr double slowest_of_slips = 1e-3;  ///< [-] of the largest slip: smaller ones decide nothing
/// [-] Of the largest ratio of two slips: where the smallest is below it, the slips are not yet those of a geometric series, and prolonging them by
/// the smallest saves little.
constexpr double alike = 0.7;
constexpr double shortest_prolongation = 1.0;  ///< [-] of the slips: less saves not even one increment

}  // namespace

void WeakeningPace::restart(std::size_t contacts) {
  last_.clear();
  ahead_.assign(contacts, 0.0);
}

void WeakeningPace::prolong(const FrozenStrength& strength, FrozenState& state, bool is_balanced) {
  std::vector<double> slips(state.contacts.size(), 0.0);
  for (std::size_t i = 0; i < slips.size(); ++i) {
    FrozenContactState& s = state.contacts[i];
    if (s.status != ContactStatus::sliding || !strength.weakens_along_slip(i, s.joint_state)) continue;
    const double counted_before = std::min(ahead_[i], std::abs(s.slip));
    ahead_[i] -= counted_before;
    s.slip = slips[i] = std::abs(s.slip) - counted_before;
  }
  const double largest = slips.empty() ? 0.0 : *std::ranges::max_element(slips);
  if (!is_balanced || largest == 0.0) {
    last_.clear();
    return;
  }
  double least_ratio = std::numeric_limits<double>::infinity(), largest_ratio = 0.0;
  for (std::size_t i = 0; i < slips.size() && !last_.empty(); ++i) {
    if (slips[i] < slowest_of_slips * largest) continue;
    const double ratio = last_[i] > 0.0 ? slips[i] / last_[i] : std::numeric_limits<double>::infinity();
    least_ratio = std::min(least_ratio, ratio);
    largest_ratio = std::max(largest_ratio, ratio);
  }
  if (last_.empty() || !(least_ratio < 1.0) || !(least_ratio > alike * largest_ratio)) {
    last_ = std::move(slips);
    return;
  }
  // Where a joint loses its last strength the series is another one: no farther than to where the first one would.
  double pace = least_ratio / (1.0 - least_ratio);
  while (pace >= shortest_prolongation && breaks_any(strength, state, slips, pace)) pace *= 0.5;
  if (pace < shortest_prolongation) {
    last_ = std::move(slips);
    return;
  }
  for (std::size_t i = 0; i < slips.size(); ++i) {
    state.contacts[i].slip += pace * slips[i];
    ahead_[i] += pace * slips[i];
  }
  last_.clear();
}

bool WeakeningPace::breaks_any(const FrozenStrength& strength, const FrozenState& state, const std::vector<double>& slips, double pace) {
  for (std::size_t i = 0; i < slips.size(); ++i) {
    if (slips[i] > 0.0 && !strength.joint_after(i, state.contacts[i], (1.0 + pace) * slips[i]).bonded) return true;
  }
  return false;
}

void WeakeningPace::give_back(double closure_unit, FrozenState& state) {
  for (std::size_t i = 0; i < ahead_.size(); ++i) {
    JointState& joint = state.contacts[i].joint_state;
    if (joint.bonded) joint.slip = std::max(0.0, joint.slip - std::max(0.0, ahead_[i]) * closure_unit);
    ahead_[i] = 0.0;
  }
}

}  // namespace openclose
