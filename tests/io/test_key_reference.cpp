#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "openclose/core/error.h"
#include "openclose/io/key_reference.h"
#include "openclose/scene/keys.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;

namespace {

std::string text_of(const std::string& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

TEST_CASE("the reference page is up to date", "[io][keys]") {
  INFO("openclose explain --page > docs/keys.md");
  CHECK(keys_page() == text_of(OPENCLOSE_DOCS "/keys.md"));
}

TEST_CASE("the schema is up to date", "[io][keys]") {
  INFO("openclose explain --schema > docs/scene.schema.json");
  CHECK(scene_schema() == text_of(OPENCLOSE_DOCS "/scene.schema.json"));
}

TEST_CASE("page, schema and explanation know every key", "[io][keys]") {
  const std::string page = keys_page();
  const nlohmann::json schema = nlohmann::json::parse(scene_schema());
  for (const KeyEntry& entry : key_entries(Scene{})) {
    INFO(entry.dotted());
    const std::string table(entry.table.name), key(entry.key.name);
    const std::size_t section = page.find("\n## [" + table + "]\n");
    REQUIRE(section != std::string::npos);
    const std::string rows = page.substr(section, page.find("\n## ", section + 1) - section);
    CHECK_THAT(rows, ContainsSubstring("\n| `" + key + "` | " + unit_of(key) + " | "));
    CHECK_THAT(rows, ContainsSubstring(std::string(entry.key.says)));
    const nlohmann::json& property = schema.at("properties").at(table).at("properties").at(key);
    CHECK(property.contains("default") == entry.value.has_value());
    if (entry.value) CHECK(property.at("default") == nlohmann::json::parse(*entry.value));
    // Links are told as files on a terminal.
    const std::string said = entry.dotted() + ": " + std::string(entry.key.says);
    CHECK_THAT(explanation_of(entry.dotted()), ContainsSubstring(said.substr(0, said.find('['))));
  }
}

TEST_CASE("the names of methods come from their registries", "[io][keys]") {
  CHECK_THAT(keys_page(), ContainsSubstring("| `contact` |  | \"soft\" | \"soft\", \"hard\", \"shi\", \"dem\" | "));
  const nlohmann::json method = nlohmann::json::parse(scene_schema()).at("properties").at("method").at("properties");
  CHECK(method.at("contact").at("enum") == nlohmann::json::parse(R"(["soft", "hard", "shi", "dem"])"));
  CHECK(method.at("integrator").at("enum").size() == 5);
  CHECK(method.at("theta").at("minimum") == 0.5);
  CHECK(method.at("theta").at("maximum") == 1.0);
}

TEST_CASE("what a word chooses is told by explanation, page and schema", "[io][keys]") {
  const std::string says = "static equilibrium first; refused where the blocks do not stand";
  CHECK_THAT(explanation_of("start"), ContainsSubstring("\n            settled          " + says + "\n"));
  CHECK_THAT(keys_page(), ContainsSubstring("\n- `start`\n  - \"unloaded\": ") && ContainsSubstring("\n  - \"settled\": " + says + "\n"));
  const nlohmann::json method = nlohmann::json::parse(scene_schema()).at("properties").at("method").at("properties");
  CHECK_THAT(method.at("start").at("description").get<std::string>(), ContainsSubstring("the state at time 0\n\"unloaded\": "));
  CHECK_THAT(method.at("start").at("description").get<std::string>(), ContainsSubstring("\n\"settled\": " + says + "\n"));
  // Those of registries are told by these, and once where two keys of a table have the same.
  CHECK_THAT(explanation_of("contact"), ContainsSubstring("            dem   explicit: central difference"));
  CHECK_THAT(keys_page(), ContainsSubstring("\n- `integrator`, `first_integrator`\n  - \"shi\": "));
  for (const auto* entries : {&option_keys(), &element_keys()}) {
    for (const KeyEntry& entry : *entries) {
      for (const KnownWord& word : entry.words) {
        INFO(entry.dotted() << ' ' << word.text);
        CHECK_FALSE(word.says.empty());
      }
    }
  }
}

TEST_CASE("a key is explained by its name, its table or its former name", "[io][keys]") {
  const std::string theta = explanation_of("theta");
  CHECK(theta == explanation_of("method.theta"));
  CHECK_THAT(theta, ContainsSubstring("accepted  a number in [0.5, 1]") && ContainsSubstring("default   1\n"));
  CHECK_THAT(explanation_of("dt_s"), ContainsSubstring("unit      s\n"));
  CHECK_THAT(explanation_of("method.max_iterations"),
             ContainsSubstring("solver.max_iterations: ") && ContainsSubstring("formerly  method.max_iterations"));
  CHECK_THAT(explanation_of("step"), ContainsSubstring("step.dt_s: ") && ContainsSubstring("step.adaptive: "));
  CHECK_THROWS_AS(explanation_of("thetta"), InputError);
  CHECK_THROWS_WITH(explanation_of("method.thetta"), ContainsSubstring("accepted: method.theta, "));
}

TEST_CASE("tables are told, suggested, and shown without the links of the page", "[io][keys]") {
  const std::string tables = tables_in_words();
  CHECK_THAT(tables, ContainsSubstring("  [[joint_set]] ") && ContainsSubstring("  [step] "));
  for (const auto* entries : {&option_keys(), &element_keys()}) {
    for (const KeyEntry& entry : *entries) {
      CHECK_THAT(explanation_of(entry.dotted()), !ContainsSubstring("]("));
      CHECK_THAT(tables, ContainsSubstring(std::string("[").append(entry.table.name)));
    }
  }
  CHECK_THAT(explanation_of("method.contact"), ContainsSubstring("see docs/methods.md"));
  CHECK_THROWS_WITH(explanation_of("joint_sets"), ContainsSubstring("did you mean joint_set?"));
  CHECK_THROWS_WITH(explanation_of("loads"), ContainsSubstring("did you mean load?"));
}
