#include <stdexcept>

#include "registry.h"
#include "support/catch.h"

using namespace openclose::verification;

namespace {

struct Named {
  const char* name;
  const char* title;
};

}  // namespace

TEST_CASE("Cases come in the natural order of their identifiers, in whatever order they register", "[registry]") {
  const std::vector<Named> sorted = sorted_by_name<Named>({{"I", ""}, {"D10", ""}, {"D2i", ""}, {"D1c", ""}, {"B3", ""}, {"D1", ""}, {"D2", ""}});
  std::string names;
  for (const Named& entry : sorted) names += std::string(entry.name) + " ";
  CHECK(names == "B3 D1 D1c D2 D2i D10 I ");
}

TEST_CASE("Two cases with one identifier are an error that names both", "[registry]") {
  const std::vector<Named> list = {{"A1", "projectile"}, {"A2", "spin"}, {"A1", "bounce"}};
  CHECK_THROWS_WITH(sorted_by_name(list), Catch::Matchers::ContainsSubstring("projectile") && Catch::Matchers::ContainsSubstring("bounce") &&
                                              Catch::Matchers::ContainsSubstring("identifier A1"));
}

TEST_CASE("An object registers its entry", "[registry]") {
  const Registered<Named> second{{"B2", "second"}}, first{{"B1", "first"}};
  const std::vector<Named> all = Registered<Named>::all();
  REQUIRE(all.size() == 2);
  CHECK(std::string(all[0].title) == "first");
}
