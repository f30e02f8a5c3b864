#include "openclose/analysis/equilibrium.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "openclose/analysis/farthest.h"

namespace openclose {
namespace {

constexpr const char* max_time_steps_key = "settle.max_time_steps";

class ByUnbalancedForce : public EquilibriumSearch {
 public:
  explicit ByUnbalancedForce(Simulation& simulation) : simulation_(simulation) {}
  SettleResult settle_first(const SettleProgress& progress) override {
    const SettleResult result = settle(simulation_, progress, SettleFrom::anywhere, &course_);
    course_ = {};
    return result;
  }
  SettleResult settle_trial(const SettleProgress& progress) override { return settle(simulation_, progress, SettleFrom::rest); }
  SettleCourse* course() override { return simulation_.is_explicit() ? nullptr : &course_; }

 private:
  Simulation& simulation_;
  SettleCourse course_;
};

/// Half the height [m] of all blocks together.
double half_height(const BlockSystem& system) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int b = 0; b < system.block_count(); ++b) {
    const auto& block = system.block(b);
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) {
      low = std::min(low, system.position(b, v).y());
      high = std::max(high, system.position(b, v).y());
    }
  }
  return 0.5 * (high - low);
}

class ByRelativeDisplacement : public EquilibriumSearch {
 public:
  explicit ByRelativeDisplacement(Simulation& simulation)
      : simulation_(simulation), input_(simulation.scene().settle), half_height_(half_height(simulation.system())) {}

  SettleResult settle_first(const SettleProgress& progress) override {
    for (int b : simulation_.system().free_blocks()) simulation_.set_velocity(b, Motion::Unknowns::Zero());
    simulation_.restart_clock();
    SettleResult result = follow(input_.max_time_steps, true, progress);
    first_steps_ = result.steps;
    return result;
  }
  SettleResult settle_trial(const SettleProgress& progress) override { return follow(steps_of_trial(), false, progress); }
  void exchange(Archive& archive) override {
    archive(first_steps_);
    archive.require(first_steps_ >= 0 && first_steps_ <= input_.max_time_steps, "the saved search took other steps than it may take");
  }

  /// What accelerates from rest by a goes a T dt in the last step of a trial of the time T.
  std::string unseen() const override {
    const double dt = simulation_.scene().step.dt, gravity = simulation_.scene().gravity.norm();
    const int steps = steps_of_trial();
    if (steps == 0) return {};
    const double acceleration = input_.relative_displacement * half_height_ / (steps * dt * dt);
    const std::string part = gravity > 0.0 ? fmt::format(" ({:.2g} % of gravity)", 100.0 * acceleration / gravity) : "";
    return fmt::format(
        "settle.criterion = \"paper\" takes for resting what accelerates by up to {:.2g} m/s2{}: in the {} steps of {:g} s of a trial it "
        "goes no farther in a step than settle.relative_displacement allows. The factor may be too high",
        acceleration, part, steps, dt);
  }

 private:
  using Displacements = std::vector<Motion::Unknowns>;

  int steps_of_trial() const { return 2 * first_steps_; }

  double farthest(const Displacements& from) const { return farthest_displacement(simulation_.system(), from); }

  SettleResult follow(int most_steps, bool stop_when_steady, const SettleProgress& progress) {
    const Displacements start = simulation_.system().state().displacement;
    SettleResult result;
    int steady = 0;
    while (result.steps < most_steps && !(stop_when_steady && steady >= input_.steady_steps)) {
      const Displacements before = simulation_.system().state().displacement;
      if (!simulation_.advance(simulation_.scene().step.dt)) {
        result.criterion = simulation_.reason();
        return result;
      }
      ++result.steps;
      result.relative_displacement = farthest(before) / half_height_;
      result.displacement = std::max(result.displacement, farthest(start));
      steady = *result.relative_displacement < input_.relative_displacement ? steady + 1 : 0;
      if (progress)
        progress(stop_when_steady ? settled_share(*result.relative_displacement, input_.relative_displacement)
                                  : static_cast<double>(result.steps) / most_steps);
    }
    result.settled = steady >= input_.steady_steps;
    result.criterion = result.settled ? "relative displacement" : "steps";
    if (!result.settled) result.limit = max_time_steps_key;
    return result;
  }

  Simulation& simulation_;
  const SettleInput& input_;
  double half_height_;   ///< [m]
  int first_steps_ = 0;  ///< that the first settling took
};

class ByForceInTime : public EquilibriumSearch {
 public:
  explicit ByForceInTime(Simulation& simulation) : simulation_(simulation) {}
  SettleResult settle_first(const SettleProgress& progress) override { return settle_trial(progress); }
  SettleResult settle_trial(const SettleProgress& progress) override {
    const SettleInput& input = simulation_.scene().settle;
    return settle_explicitly(
        simulation_, {input.unbalanced_force, input.max_time_steps, max_time_steps_key, std::numeric_limits<double>::infinity(), false, false, false},
        progress);
  }

  std::string unseen() const override {
    const auto& system = simulation_.system();
    if (system.free_count() == 0) return {};
    std::vector<double> weights;
    for (int b : system.free_blocks()) weights.push_back(system.block(b).mass[0] * simulation_.scene().gravity.norm());
    const auto middle = weights.begin() + static_cast<std::ptrdiff_t>(weights.size() / 2);
    std::ranges::nth_element(weights, middle);
    const double force = simulation_.scene().settle.unbalanced_force;
    const std::string part = *middle > 0.0 ? fmt::format(", {:.2g} % of the weight of the median free block", 100.0 * force / *middle) : "";
    return fmt::format(
        "settle.criterion = \"paper\" takes for resting what is moved by up to settle.unbalanced_force_n = {:g} N{}. The factor may be too high",
        force, part);
  }

 private:
  Simulation& simulation_;
};

}  // namespace

std::unique_ptr<EquilibriumSearch> make_equilibrium_search(Simulation& simulation) {
  switch (simulation.scene().settle.criterion) {
    case SettleCriterion::unbalanced_force:
      return std::make_unique<ByUnbalancedForce>(simulation);
    case SettleCriterion::paper:
      if (simulation.is_explicit()) return std::make_unique<ByForceInTime>(simulation);
      return std::make_unique<ByRelativeDisplacement>(simulation);
  }
  return nullptr;
}

}  // namespace openclose
