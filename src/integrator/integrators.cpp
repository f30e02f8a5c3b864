#include "openclose/integrator/integrators.h"

#include <fmt/format.h>

#include "openclose/core/error.h"

namespace openclose {

template <int N>
const std::vector<IntegratorEntry<N>>& integrators() {
  static const std::vector<IntegratorEntry<N>> list = {
      {"shi", "Newmark (1/2, 1), first order", [](const MethodInput&) { return make_theta_scheme<N>(1.0); }},
      {"theta", "weight method.theta on the forces at the end, trapezoid at 0.5",
       [](const MethodInput& method) { return make_theta_scheme<N>(method.theta.value_or(1.0)); }},
      {"generalized_alpha", "second order, damping of fast vibrations by method.rho_inf",
       [](const MethodInput& method) { return make_generalized_alpha<N>(method.rho_inf.value_or(default_rho_inf)); }},
      {"tr_bdf2", "trapezoid, then BDF2: second order, fast vibrations vanish", [](const MethodInput&) { return make_tr_bdf2<N>(); }},
      {"path_average", "contact forces averaged over the path of the step: second order, conserves energy",
       [](const MethodInput&) { return make_path_average<N>(); }},
  };
  return list;
}

std::string integrator_name(const MethodInput& method) {
  return method.integrator.value_or(method.theta ? "theta" : default_integrator);
}

MethodInput method_at_first(const MethodInput& method) {
  MethodInput first = method;
  first.integrator = method.first_integrator;
  first.theta.reset();
  first.rho_inf.reset();
  first.dissipation.reset();
  return first;
}

namespace {

template <int N>
const IntegratorEntry<N>& find_integrator(const MethodInput& method, const std::string& name, const char* key) {
  if (name == "path_average" && method.rotation != RotationKind::exact)
    throw InputError(method.contact_where, "method.rotation", "\"linear\" has no path that could be averaged", "\"exact\", or another integrator");
  std::string names;
  for (const auto& entry : integrators<N>()) {
    if (name == entry.name) return entry;
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", entry.name);
  }
  throw InputError(method.contact_where, key, fmt::format("\"{}\" is no known integrator", name), names);
}

}  // namespace

template <int N>
std::unique_ptr<TimeScheme<N>> make_integrator(const MethodInput& method) {
  const std::string name = integrator_name(method);
  const auto only_for = [&](bool given, const char* key, const char* owner) {
    if (!given || name == owner) return;
    throw InputError(method.contact_where, key, fmt::format("has no meaning for method.integrator = \"{}\"", name),
                     fmt::format("integrator = \"{}\"", owner));
  };
  only_for(method.theta.has_value(), "method.theta", "theta");
  only_for(method.rho_inf.has_value(), "method.rho_inf", "generalized_alpha");
  only_for(method.dissipation.has_value(), "method.dissipation", "path_average");
  if (method.first_integrator) find_integrator<N>(method, *method.first_integrator, "method.first_integrator");
  return find_integrator<N>(method, name, "method.integrator").make(method);
}

template const std::vector<IntegratorEntry<3>>& integrators<3>();
template std::unique_ptr<TimeScheme<3>> make_integrator<3>(const MethodInput&);

}  // namespace openclose
