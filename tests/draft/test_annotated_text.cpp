#include "openclose/draft/annotated_text.h"
#include "openclose/scene/keys.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;

namespace {

std::string says(const std::string& dotted) {
  for (const KeyEntry& entry : element_keys()) {
    if (entry.dotted() == dotted) return std::string(entry.key.says);
  }
  return "no such key";
}

}  // namespace

TEST_CASE("every key stands with what its row in the table of keys says, once", "[draft][annotated]") {
  AnnotatedText text;
  text.table("joint");
  text.key("friction_angle_deg", 35.0);
  text.table("joint", "Another one");
  text.key("friction_angle_deg", 40.0);
  CHECK(text.text() == "\n# " + std::string([] {
                         for (const KeyEntry& entry : element_keys()) {
                           if (entry.table.name == "joint") return std::string(entry.table.says);
                         }
                         return std::string();
                       }()) +
                           "\n[[joint]]\nfriction_angle_deg = 35                     # [deg] " + says("joint.friction_angle_deg") +
                           "\n\n# Another one\n[[joint]]\nfriction_angle_deg = 40\n");
}

TEST_CASE("what does not fit behind a value stands above it, with links as paths", "[draft][annotated]") {
  AnnotatedText text;
  text.table("block");
  text.points("vertices_m", {{0.0, -1e-12}, {1.0 / 3.0, 0.0}, {0.0, 1.0}});
  text.key("edge_joints", std::vector<std::string_view>{"", "", ""});
  REQUIRE(says("block.edge_joints").find("[scenes](scene.md)") != std::string::npos);
  CHECK_THAT(text.text(), ContainsSubstring("\n# vertices_m: [m] a simple polygon, convex or not;") &&
                              ContainsSubstring("\nvertices_m = [[0, 0], [0.333333333, 0], [0, 1]]\n") && ContainsSubstring("see docs/scene.md") &&
                              !ContainsSubstring("]("));
  for (std::size_t begin = 0; begin < text.text().size(); begin = text.text().find('\n', begin) + 1)
    CHECK(text.text().find('\n', begin) - begin <= 110);
}

TEST_CASE("keys that are left out are comments", "[draft][annotated]") {
  AnnotatedText text;
  text.left_out_table("joint");
  text.left_out_key("name", std::string_view("rock"));
  text.left_out_key("cohesion_pa", 1e6);
  CHECK_THAT(text.text(),
             ContainsSubstring("# [[joint]]\n") && ContainsSubstring("\n# name = \"rock\"") && ContainsSubstring("\n# cohesion_pa = 1e6 "));
  for (const char c : {'[', 'n', 'c'}) CHECK(text.text().find(std::string("\n") + c) == std::string::npos);
}

TEST_CASE("a key that there is not is a fault of the draft", "[draft][annotated]") {
  AnnotatedText text;
  text.table("joint");
  CHECK_THROWS_AS(text.key("friction", 35.0), std::logic_error);
  CHECK_THROWS_AS(text.table("joints"), std::logic_error);
}
