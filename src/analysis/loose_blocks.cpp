#include "openclose/analysis/loose_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "openclose/analysis/frozen_limit.h"
#include "openclose/analysis/loose_motion.h"
#include "openclose/analysis/named_states.h"
#include "openclose/scene/increased_load.h"
#include "openclose/statics/frozen_system.h"

namespace openclose {
namespace {

using limit_analysis::Problem;

/// Empty unless failure is proved.
limit_analysis::Mechanism mechanism_of(Problem problem) {
  limit_analysis::Trial trial = limit_analysis::LimitAnalysis(std::move(problem)).at(1.0);
  return trial.verdict == limit_analysis::Verdict::infeasible ? std::move(trial.mechanism) : limit_analysis::Mechanism();
}

/// The same blocks, each pushed by a part of its load and turned by it at the arm of its farthest vertex.
Problem pushed(Problem problem, double sideways, double turning) {
  for (limit_analysis::Block& block : problem.blocks) {
    const double load = block.load.head<2>().norm();
    block.load.x() += sideways * load;
    block.load[2] += turning * load * block.radius;
  }
  return problem;
}

std::vector<FailingBlock> moving(const FrozenSystem& system, const Problem& problem, const limit_analysis::Mechanism& mechanism) {
  double fastest = 0.0;
  const auto speed = [&](std::size_t row) { return limit_analysis::speed(problem.blocks[row], mechanism[row]); };
  for (std::size_t row = 0; row < mechanism.size(); ++row) fastest = std::max(fastest, speed(row));
  std::vector<FailingBlock> list;
  for (std::size_t row = 0; row < mechanism.size(); ++row) {
    if (speed(row) <= slowest_of_mechanism * fastest) continue;
    const FrozenBlock& block = system.blocks()[row];
    list.push_back({block.block, 0.0, block.centroid, mechanism[row].velocity / fastest, mechanism[row].rotation / fastest});
  }
  return list;
}

}  // namespace

std::string loose_blocks_in_words(const Scene& scene) {
  const auto free = std::count_if(scene.blocks.begin(), scene.blocks.end(), [](const BlockInput& block) { return !block.fixed; });
  if (scene.gravity.isZero(0.0) || free == 0 || free > most_blocks_to_try) return {};
  // `fos` begins without the load that it increases.
  Scene begin = with_increased_load(scene, 0.0);
  begin.strength_reduction.increase.reset();
  const FrozenSystem system(begin);
  const Problem problem = limit_problem(system, FrozenStrength(system, scene));
  try {
    if (const limit_analysis::Mechanism found = mechanism_of(problem); !found.empty())
      return "these blocks do not stand as they are drawn: " + motion_in_words(scene, moving(system, problem, found));
    for (const double push : {least_push, -least_push}) {
      for (const bool turns : {false, true}) {
        const limit_analysis::Mechanism found = mechanism_of(pushed(problem, turns ? 0.0 : push, turns ? push : 0.0));
        if (found.empty()) continue;
        return fmt::format("nothing holds these blocks against a push of {:g} of their weight: {}", least_push,
                           motion_in_words(scene, moving(system, problem, found)));
      }
    }
  } catch (const std::invalid_argument&) {
    // A block whose weight and loads cancel out is no problem of limit analysis.
  }
  return {};
}

}  // namespace openclose
