#include "openclose/analysis/settling_method.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "openclose/core/error.h"
#include "openclose/integrator/integrators.h"
#include "openclose/integrator/registry.h"

namespace openclose {
namespace {

bool has_joint_springs(const std::string& contact) {
  return std::ranges::any_of(enforcements(), [&](const auto& entry) { return entry.name == contact && entry.make()->has_joint_springs(); });
}

}  // namespace

bool is_settled_by_another(const Scene& scene) {
  return scene.settled_by.value_or(scene.method.contact) != scene.method.contact;
}

MethodInput settling_method(const Scene& scene) {
  MethodInput settling = scene.method;
  if (!is_settled_by_another(scene)) return settling;
  settling.contact = *scene.settled_by;
  // These are of the motion's method, and some methods refuse them.
  forget_integrator(settling);
  settling.first_integrator.reset();
  settling.static_solver = StaticSolver::automatic;
  settling.statics = false;
  return settling;
}

void require_settling_method(const Scene& scene) {
  if (!is_settled_by_another(scene)) return;
  if (!has_joint_springs(scene.method.contact) || !has_joint_springs(*scene.settled_by))
    throw InputError(scene.settled_by_where, "run.settled_by",
                     fmt::format("no equilibrium of \"{}\" is one for method.contact = \"{}\"", *scene.settled_by, scene.method.contact),
                     "\"soft\" or \"dem\" where method.contact is one of these, or what method.contact is");
  const MethodInput settling = settling_method(scene);
  try {
    make_enforcement(settling)->make_time_scheme(settling);
  } catch (const InputError& error) {
    throw InputError(scene.settled_by_where, "run.settled_by", fmt::format("\"{}\" cannot settle this scene: {}", settling.contact, error.what()),
                     "");
  }
}

}  // namespace openclose
