#include "openclose/scene/increased_load.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "openclose/scene/nearest.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

constexpr const char* key = "strength_reduction.increase";
constexpr std::array<std::string_view, 2> gravity_names{"gravity_x", "gravity_y"};

/// What the key says: a name, and the sense in which its load grows.
struct Named {
  std::string name;
  double sense = 1.0;

  explicit Named(const std::string& text) : name(text) {
    if (!name.starts_with('-')) return;
    name.erase(0, 1);
    sense = -1.0;
  }
};

/// f(force) for every load and surcharge of this name.
template <class Inputs, class F>
void for_each_load_named(Inputs& inputs, const std::string& name, F f) {
  for_each_force(inputs, [&](auto& force) {
    if constexpr (!std::decay_t<decltype(force)>::holds) {
      if (force.name == name) f(force);
    }
  });
}

std::vector<std::string> names_of_loads(const Scene& scene) {
  std::vector<std::string> names;
  for (const std::string_view name : gravity_names) names.push_back(in_quotes(name));
  for_each_force(scene, [&](const auto& force) {
    if (force.holds || force.name.empty()) return;
    const std::string name = in_quotes(force.name);
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  });
  return names;
}

}  // namespace

bool names_gravity(std::string_view name) {
  return std::ranges::find(gravity_names, name) != gravity_names.end();
}

Scene with_increased_load(Scene scene, double multiplier) {
  if (!scene.strength_reduction.increase) return scene;
  const Named named(*scene.strength_reduction.increase);
  const auto direction = std::ranges::find(gravity_names, named.name);
  if (direction != gravity_names.end()) {
    scene.gravity[direction - gravity_names.begin()] += named.sense * multiplier * scene.gravity.norm();
  } else {
    for_each_load_named(scene, named.name, [&](auto& load) { load.multiply(named.sense * multiplier); });
  }
  return scene;
}

void require_increased_load(const Scene& scene) {
  const StrengthReductionInput& input = scene.strength_reduction;
  if (!input.increase) {
    constexpr double first_factor = 1.0;
    if (input.upper_limit > first_factor) return;
    throw InputError(input.upper_limit_where, "strength_reduction.upper_limit", fmt::format("{:g} is out of range", input.upper_limit),
                     "a number > 1, or with strength_reduction.increase a number > 0");
  }
  const Named named(*input.increase);
  if (names_gravity(named.name)) {
    if (!scene.gravity.isZero(0.0)) return;
    throw_input_error(input.increase_where, key, in_quotes(named.name) + " is a multiple of gravity, which is 0", "the name of a load or surcharge");
  }
  int found = 0;
  for_each_load_named(scene, named.name, [&](const auto&) { ++found; });
  if (found > 0) return;
  const std::string name = in_quotes(named.name);
  const std::vector<std::string> accepted = names_of_loads(scene);
  throw_input_error(input.increase_where, key, fmt::format("no load or surcharge has the name {}{}", name, did_you_mean(name, accepted)),
                    suggestions(name, accepted) + ", with a minus before it or without");
}

}  // namespace openclose
