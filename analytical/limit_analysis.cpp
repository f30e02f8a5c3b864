#include "openclose/analytical/limit_analysis.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace openclose::analytical {
namespace {

/// Two contact points for each interface, at its ends.
limit_analysis::Problem problem_of(const RigidBlockAssembly& assembly) {
  limit_analysis::Problem problem;
  for (const RigidBlock& block : assembly.blocks) {
    double radius = 0;
    for (const Point& vertex : block.vertices) radius = std::max(radius, (vertex - block.centroid).norm());
    problem.blocks.push_back({block.centroid, block.load, radius, {!block.fixed, !block.fixed, !block.fixed && !block.rotation_locked}});
  }
  for (const Interface& i : assembly.interfaces) {
    const double half = i.length() / 2;
    for (const Point& end : i.ends) {
      problem.contacts.push_back({i.a, i.b, end, i.normal, i.strength.cohesion * half, i.strength.friction, i.strength.tension * half});
    }
  }
  return problem;
}

/// \throws std::runtime_error if the programs are not solved
LimitState search(limit_analysis::LimitAnalysis& analysis, const LimitAnalysisOptions& options, const limit_analysis::Options& start) {
  limit_analysis::Options asked = start;
  asked.width = options.width;
  asked.upper_limit = options.upper_limit;
  const limit_analysis::Bracket bracket = analysis.largest_factor(asked);
  if (bracket.verdict == limit_analysis::Bracket::Verdict::undecided) throw std::runtime_error("limit analysis: " + bracket.reason);
  LimitState state;
  state.found = bracket.found();
  state.reason = bracket.reason;
  state.factor = bracket.factor;
  state.failed = bracket.failed;
  state.programs = bracket.programs;
  state.mechanism = bracket.mechanism;
  if (bracket.factor > 0) {
    for (std::size_t k = 0; k < bracket.forces.contacts.size(); k += 2)
      state.forces.push_back({bracket.forces.contacts[k], bracket.forces.contacts[k + 1]});
  }
  return state;
}

// Gilbert et al. take 0.6 for both.
constexpr double memory_of_normal_force = 0.4;  // [-] share of the normal forces of the repetition before the last
constexpr double fading = 0.6;                  // [-] of the dependence on n, from one repetition to the next
constexpr double faded = 1e-3;                  // [-] below which it is zero
constexpr double ratio_nearby = 1.01;           // between the factors tried first in a repetition
constexpr double slowest_slip = 1e-6;           // [m/s] where the fastest vertex has 1 m/s; above the tolerance of the program
constexpr int most_repetitions = 100;
constexpr int repetitions_that_agree = 3;

double excess_over(const RigidBlockAssembly& assembly, const limit_analysis::Problem& coulomb, const LimitState& state) {
  double worst = 0, heaviest = 0;
  for (const RigidBlock& block : assembly.blocks) heaviest = std::max(heaviest, block.fixed ? 0 : block.load.head<2>().norm());
  for (std::size_t p = 0; p < coulomb.contacts.size(); ++p) {
    const limit_analysis::Contact& c = coulomb.contacts[p];
    const EndForce& force = state.forces[p / 2][p % 2];
    worst = std::max(worst, std::abs(force.shear) - (c.cohesion + c.friction * force.normal) / state.factor);
  }
  return worst / heaviest;
}

/// Repeats with strengths that depend less and less on the present normal forces, at every end that slips in the mechanism of any repetition. The
/// others keep their own strength: where blocks stand, forces are not determined, and those of one repetition say nothing about the next.
class ConstantVolume {
 public:
  ConstantVolume(const RigidBlockAssembly& assembly, limit_analysis::LimitAnalysis& analysis, const LimitAnalysisOptions& options)
      : assembly_(assembly),
        analysis_(analysis),
        options_(options),
        coulomb_(analysis.problem()),
        present_(coulomb_.contacts),
        normal_(present_.size()) {}

  /// \param state  with the strengths as they are
  LimitState run(LimitState state) {
    double dependence = 1;
    int agreeing = 0;
    for (int repetition = 1; repetition <= most_repetitions; ++repetition) {
      dependence = dependence > faded ? dependence * fading : 0;
      const bool same_ends = !take_up(state, dependence);
      analysis_.replace_contacts(present_);
      LimitState next = search(analysis_, options_, {.first = state.factor, .ratio = ratio_nearby});
      next.programs += state.programs;
      if (!next.found) return next;
      next.excess = excess_over(assembly_, coulomb_, next);
      const bool agrees =
          dependence == 0 && same_ends && next.excess <= options_.excess && std::abs(next.factor - state.factor) <= 2 * options_.width;
      agreeing = agrees ? agreeing + 1 : 0;
      state = std::move(next);
      state.repetitions = repetition;
      if (agreeing == repetitions_that_agree) return state;
    }
    state.found = false;
    state.reason = "the repetitions of zero dilatancy do not converge";
    return state;
  }

 private:
  /// True if an end slips that has not slipped before.
  bool take_up(const LimitState& state, double dependence) {
    bool another = false;
    for (std::size_t p = 0; p < coulomb_.contacts.size(); ++p) {
      const double present = state.forces[p / 2][p % 2].normal;
      if (!normal_[p] && slips(assembly_.interfaces[p / 2], p % 2, state)) {
        another = true;
        normal_[p] = present;
      }
      if (!normal_[p]) continue;
      normal_[p] = memory_of_normal_force * *normal_[p] + (1 - memory_of_normal_force) * present;
      const limit_analysis::Contact& c = coulomb_.contacts[p];
      present_[p].friction = dependence * c.friction;
      present_[p].cohesion = std::max(0.0, c.cohesion + (1 - dependence) * c.friction * *normal_[p]);
    }
    return another;
  }

  bool slips(const Interface& i, std::size_t end, const LimitState& state) const {
    const auto velocity = [&](int block) { return velocity_at(assembly_.blocks[block], state.mechanism[block], i.ends[end]); };
    return std::abs((velocity(i.a) - velocity(i.b)).dot(i.tangent())) > slowest_slip;
  }

  const RigidBlockAssembly& assembly_;
  limit_analysis::LimitAnalysis& analysis_;
  const LimitAnalysisOptions& options_;
  const limit_analysis::Problem coulomb_;
  std::vector<limit_analysis::Contact> present_;
  std::vector<std::optional<double>> normal_;  // [N] n' of each end that has slipped
};

}  // namespace

LimitState limit_analysis(const RigidBlockAssembly& assembly, const LimitAnalysisOptions& options) {
  limit_analysis::LimitAnalysis analysis(problem_of(assembly));
  LimitState state = search(analysis, options, {});
  if (!options.zero_dilatancy || !state.found) return state;
  return ConstantVolume(assembly, analysis, options).run(std::move(state));
}

CriticalFriction critical_friction(RigidBlockAssembly assembly, const LimitAnalysisOptions& options) {
  for (Interface& i : assembly.interfaces) i.strength = {1.0, 0.0, 0.0};
  CriticalFriction result;
  result.state = limit_analysis(assembly, options);
  result.found = result.state.found;
  if (result.found) result.angle = std::atan(1 / result.state.factor);
  return result;
}

Point velocity_at(const RigidBlock& block, const BlockVelocity& motion, const Point& point) {
  return limit_analysis::velocity_at({.centroid = block.centroid}, motion, point);
}

}  // namespace openclose::analytical
