// The time integrators a scene can choose for `soft` by method.integrator. A new one is a class in time_scheme.cpp, its declaration in time_scheme.h,
// a word on it here and a line in integrators.cpp.
//
//   shi                Newmark (1/2, 1): forces at the end of the step. Order 1, dissipative.
//   theta              end forces with weight method.theta. 1/2 is the trapezoid, order 2; more is of order 1 and dissipates.
//   generalized_alpha  Chung and Hulbert 1993, by the spectral radius at infinite frequency, method.rho_inf. Order 2.
//   tr_bdf2            Bank et al. 1985: trapezoid over (2 - sqrt(2)) dt, then BDF2. Two solutions a step with the same ratio of inertia to
//                      stiffness. Order 2, infinitely fast vibrations are gone after one step.
//   path_average       contact forces averaged over the path of the step, see law/path_average.h. Order 2, conserves energy, linear and angular
//                      momentum.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "openclose/core/error.h"
#include "openclose/integrator/time_scheme.h"
#include "openclose/scene/nearest.h"

namespace openclose {

/// What `soft` steps with if the scene does not say.
inline constexpr const char* default_integrator = "shi";

struct IntegratorEntry {
  const char* name;
  const char* summary;
  std::unique_ptr<TimeScheme> (*make)(const MethodInput&);
};

const std::vector<IntegratorEntry>& integrators();

/// method.integrator; where it is absent "theta" if there is a method.theta, else the default.
std::string integrator_name(const MethodInput& method);

/// Takes the integrator and its parameters out of a method: what then steps is the default.
void forget_integrator(MethodInput& method);

/// With the first integrator of the method, and what it takes where the scene does not say, instead of the other one.
MethodInput method_at_first(const MethodInput& method);

/// Throws InputError for an unknown name, also of the first integrator, and for parameters of another integrator.
std::unique_ptr<TimeScheme> make_integrator(const MethodInput& method);

/// The entry of that name; throws InputError, naming the accepted ones, if there is none.
/// \param noun  what the entries are
template <class Entry>
const Entry& find_named(const std::vector<Entry>& list, const std::string& name, const MethodInput& method, const char* key, const char* noun) {
  std::string names;
  std::vector<std::string> words;
  for (const Entry& entry : list) {
    if (name == entry.name) return entry;
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", entry.name);
    words.emplace_back(entry.name);
  }
  throw InputError(method.contact_where, key, fmt::format("\"{}\" is no known {}{}", name, noun, did_you_mean(name, words)), names);
}

}  // namespace openclose
