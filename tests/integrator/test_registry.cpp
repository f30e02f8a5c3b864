#include <algorithm>
#include <string>
#include <vector>

#include "openclose/core/error.h"
#include "openclose/integrator/registry.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::all_methods;

namespace {

MethodInput method(const std::string& contact, double theta = 1.0) {
  MethodInput input;
  input.contact = contact;
  input.contact_where = {"scene.toml", 7};
  input.theta = theta;
  return input;
}

}  // namespace

TEST_CASE("every listed enforcement can be made by its name", "[integrator][registry]") {
  std::vector<std::string> names;
  for (const auto& entry : enforcements()) {
    names.emplace_back(entry.name);
    CHECK_FALSE(std::string(entry.summary).empty());
    CHECK(make_enforcement(method(entry.name)) != nullptr);
  }
  CHECK(names.size() == all_methods.size());
  for (const std::string& name : all_methods) CHECK(std::count(names.begin(), names.end(), name) == 1);
}

TEST_CASE("an unknown enforcement is refused with the list of known ones", "[integrator][registry]") {
  CHECK_THROWS_AS(make_enforcement(method("sotf")), InputError);
  CHECK_THROWS_WITH(make_enforcement(method("sotf")), ContainsSubstring("scene.toml:7: method.contact: \"sotf\"") && ContainsSubstring("\"soft\"") &&
                                                          ContainsSubstring("\"hard\"") && ContainsSubstring("\"shi\""));
}

TEST_CASE("names are compared whole", "[integrator][registry]") {
  CHECK_THROWS_AS(make_enforcement(method("")), InputError);
  CHECK_THROWS_AS(make_enforcement(method("Soft")), InputError);
  CHECK_THROWS_AS(make_enforcement(method("soft ")), InputError);
}

TEST_CASE("theta is soft's own: other enforcements refuse it", "[integrator][registry]") {
  const double theta = GENERATE(0.5, 0.75, 0.999);
  CHECK(make_enforcement(method("soft"))->make_time_scheme(method("soft", theta))->end_weight() == theta);
  for (const std::string name : {"hard", "shi"}) {
    const auto enforcement = make_enforcement(method(name));
    CHECK_THROWS_AS(enforcement->make_time_scheme(method(name, theta)), InputError);
    CHECK_THROWS_WITH(enforcement->make_time_scheme(method(name, theta)),
                      ContainsSubstring("scene.toml:7: method.theta: ") && ContainsSubstring(name));
    CHECK(enforcement->make_time_scheme(method(name))->end_weight() == 1.0);
  }
}

TEST_CASE("a first integrator is soft's own: other enforcements refuse it", "[integrator][registry]") {
  for (const std::string& name : all_methods) {
    MethodInput input = method(name);
    input.first_integrator = "path_average";
    if (name == "soft")
      CHECK_NOTHROW(make_enforcement(input)->make_time_scheme(input));
    else
      CHECK_THROWS_WITH(make_enforcement(input)->make_time_scheme(input),
                        ContainsSubstring("scene.toml:7: method.first_integrator: ") && ContainsSubstring(name));
  }
}

TEST_CASE("only hard contacts store no energy", "[integrator][registry]") {
  for (const std::string& name : all_methods) CHECK(make_enforcement(method(name))->has_elastic_contacts() == (name != "hard"));
}

TEST_CASE("shi cuts its steps by the factor of the scene, the others halve them", "[integrator][registry]") {
  MethodInput input = method("shi");
  input.step_cut = 0.123;
  CHECK(make_enforcement(input)->step_cut(input) == 0.123);
  for (const std::string name : {"soft", "hard"}) CHECK(make_enforcement(method(name))->step_cut(input) == 0.5);
}

TEST_CASE("only dem is explicit", "[integrator][registry]") {
  for (const std::string& name : all_methods) CHECK(make_enforcement(method(name))->is_explicit() == (name == "dem"));
}
