// Ranges and lists of values, and the folders of their combinations.
#include "openclose/core/error.h"
#include "openclose/study/cases.h"
#include "openclose/study/variation.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using Values = std::vector<std::string>;

TEST_CASE("a range has both ends where a step ends there", "[study]") {
  CHECK(variation_from("joint[0].friction_angle_deg=25:30:2.5").values == Values{"25", "27.5", "30"});
  CHECK(variation_from("a=0:1:0.1").values.size() == 11);
  CHECK(variation_from("a=0:1:0.1").values[3] == "0.3");
  CHECK(variation_from("a=0:1:0.3").values == Values{"0", "0.3", "0.6", "0.9"});
  CHECK(variation_from("a=3:1:-1").values == Values{"3", "2", "1"});
  CHECK(variation_from("a=2:2:1").values == Values{"2"});
}

TEST_CASE("a list keeps values as they are written, and vectors whole", "[study]") {
  CHECK(variation_from("joint[0].cohesion_pa=10e3,20e3").values == Values{"10e3", "20e3"});
  CHECK(variation_from("method.contact=soft,hard").key == "method.contact");
  CHECK(variation_from("gravity_m_per_s2=[0, -9.81],[1,-9]").values == Values{"[0, -9.81]", "[1,-9]"});
  CHECK(variation_from("title=\"a,b\",c").values == Values{"\"a,b\"", "c"});
}

TEST_CASE("what is no variation is refused with the form that is accepted", "[study]") {
  for (const std::string text : {"a", "=1:2:1", "a=", "a=1:2", "a=1:2:3:4", "a=1:x:1", "a=1:2:0", "a=1:2:-1", "a=1,,2", "a=0:1:1e-9"}) {
    INFO(text);
    CHECK_THROWS_AS(variation_from(text), InputError);
  }
  CHECK_THROWS_WITH(variation_from("a=1:2"), ContainsSubstring("KEY=FROM:TO:STEP"));
}

TEST_CASE("a range with hyphens or dots is told how to be written", "[study]") {
  const auto told = [](const std::string& value, const std::string& range) {
    INFO(value);
    CHECK_THROWS_WITH(variation_from("a=" + value), ContainsSubstring("accepted: a=" + range));
  };
  told("25-40", "25:40:STEP");
  told("25-40-5", "25:40:5");
  told("25..40", "25:40:STEP");
  told("0.5 - 1.5", "0.5:1.5:STEP");
  told("25\u201340", "25:40:STEP");
  told("-5--1", "-5:-1:STEP");
  told("1e-3-1e-2", "1e-3:1e-2:STEP");
  told("10,25-40", "25:40:STEP");
  for (const std::string value : {"-5", "1e-3", "soft-hard", "a-1", "bed-1-2", "\"1-2\"", "[1-2]", "-gravity_x", "5-"}) {
    INFO(value);
    CHECK(variation_from("a=" + value).values == Values{value});
  }
}

TEST_CASE("combinations run through the last key first, and their folders differ", "[study]") {
  const auto list = combinations({variation_from("a=1,2"), variation_from("b.c=x,y")});
  REQUIRE(list.size() == 4);
  CHECK(list[1] == Values{"a=1", "b.c=y"});
  CHECK(list[2] == Values{"a=2", "b.c=x"});
  CHECK(folder_name(list[1]) == "a=1,b.c=y");
  CHECK(folder_name({"a=../x"}) == "a=.._x");
  CHECK_THROWS_WITH(combinations({variation_from("a=1:1000:1"), variation_from("b=1:1000:1")}), ContainsSubstring("too many"));
}
