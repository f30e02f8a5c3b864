#include "openclose/integrator/integrators.h"

#include <fmt/format.h>

namespace openclose {

const std::vector<IntegratorEntry>& integrators() {
  static const std::vector<IntegratorEntry> list = {
      {"shi", "Newmark (1/2, 1), first order", [](const MethodInput&) { return make_theta_scheme(1.0); }},
      {"theta", "weight method.theta on the forces at the end, trapezoid at 0.5",
       [](const MethodInput& method) { return make_theta_scheme(method.theta.value_or(1.0)); }},
      {"generalized_alpha", "second order, damping of fast vibrations by method.rho_inf",
       [](const MethodInput& method) { return make_generalized_alpha(method.rho_inf.value_or(default_rho_inf)); }},
      {"tr_bdf2", "trapezoid, then BDF2: second order, fast vibrations vanish", [](const MethodInput&) { return make_tr_bdf2(); }},
      {"path_average", "contact forces averaged over the path of the step: second order, conserves energy",
       [](const MethodInput&) { return make_path_average(); }},
  };
  return list;
}

std::string integrator_name(const MethodInput& method) {
  return method.integrator.value_or(method.theta ? "theta" : default_integrator);
}

void forget_integrator(MethodInput& method) {
  method.integrator.reset();
  method.theta.reset();
  method.rho_inf.reset();
  method.dissipation.reset();
}

MethodInput method_at_first(const MethodInput& method) {
  MethodInput first = method;
  forget_integrator(first);
  first.integrator = method.first_integrator;
  return first;
}

namespace {

const IntegratorEntry& find_integrator(const MethodInput& method, const std::string& name, const char* key) {
  if (name == "path_average" && method.rotation != RotationKind::exact)
    throw InputError(method.contact_where, "method.rotation", "\"linear\" has no path that could be averaged", "\"exact\", or another integrator");
  return find_named(integrators(), name, method, key, "integrator");
}

}  // namespace

std::unique_ptr<TimeScheme> make_integrator(const MethodInput& method) {
  const std::string name = integrator_name(method);
  const auto only_for = [&](bool given, const char* key, const char* owner) {
    if (!given || name == owner) return;
    throw InputError(method.contact_where, key, fmt::format("has no meaning for method.integrator = \"{}\"", name),
                     fmt::format("integrator = \"{}\"", owner));
  };
  only_for(method.theta.has_value(), "method.theta", "theta");
  only_for(method.rho_inf.has_value(), "method.rho_inf", "generalized_alpha");
  only_for(method.dissipation.has_value(), "method.dissipation", "path_average");
  if (method.first_integrator) find_integrator(method, *method.first_integrator, "method.first_integrator");
  return find_integrator(method, name, "method.integrator").make(method);
}

}  // namespace openclose
