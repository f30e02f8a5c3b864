#include <string>
#include <vector>

#include "openclose/study/cases.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("of warnings that differ in their numbers the first is told, with the number of other cases", "[study][cases]") {
  CaseWarnings warnings;
  warnings.add("one", R"({"warnings": ["0.1 m deep", "0.25 m deep", "no joint"]})");
  warnings.add("two", R"({"warnings": ["3 m deep"]})");
  warnings.add("three", R"({"steps": 3})");
  warnings.add("four", "");
  CHECK(warnings.texts() == std::vector<std::string>{"one: 0.1 m deep (and the same of 1 other case, each with its own numbers)", "one: no joint"});
}
