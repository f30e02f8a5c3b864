// The tables of keys: every row is gone through, so that a new key is tested as soon as it has one.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "openclose/core/error.h"
#include "openclose/scene/check.h"
#include "openclose/scene/keys.h"
#include "openclose/scene/toml_text.h"
#include "openclose/scene/writer.h"
#include "scene_file.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::block_on_base;
using openclose::test::read_text;
using openclose::test::SceneFile;

namespace {

/// Two numbers that are accepted, the second one above the first.
std::pair<double, double> numbers_in(const Range& range) {
  const double low = std::isfinite(range.low) ? range.low : -1e3;
  const double high = std::isfinite(range.high) ? std::min(range.high, low + 8.0) : low + 8.0;
  return {low + 0.25 * (high - low), low + 0.5 * (high - low)};
}

/// A value that is accepted and is not the default.
std::string other_value(const KeyEntry& entry) {
  const auto [a, b] = numbers_in(entry.range);
  switch (entry.type) {
    case ValueType::boolean:
      return entry.value == "true" ? "false" : "true";
    case ValueType::number:
      return toml(entry.value == toml(a) ? b : a);
    case ValueType::whole_number:
      return toml(static_cast<int>(std::ceil(entry.value == toml(static_cast<int>(std::ceil(a))) ? b : a)));
    case ValueType::text:
      return "\"something\"";
    case ValueType::word:
      return toml(entry.value == toml(entry.words.front().text) ? entry.words.back().text : entry.words.front().text);
    case ValueType::list:
      return "[" + toml(a) + ", " + toml(b) + "]";
    case ValueType::names:
      return "[\"something\"]";
    default:
      FAIL("no option has such a type");
  }
  return {};
}

/// The key set to the value in a file; keys that are asked for together get a value each, and what a key names is there.
std::string file_with(const std::string& dotted, const std::string& value) {
  const std::size_t dot = dotted.find('.');
  const std::string table = dotted.substr(0, dot), key = dotted.substr(dot + 1);
  std::string text = block_on_base + "[" + table + "]\n" + key + " = " + value + "\n";
  if (key == "first_integrator") text += "first_integrator_s = 1\n";
  if (key == "first_integrator_s") text += "first_integrator = \"something\"\n";
  if (key == "increase") text += "[[load]]\nname = \"something\"\npoint_m = [0, 1]\nforce_n = [1, 0]\n";
  return text;
}

std::optional<std::string> value_of(const Scene& scene, const std::string& dotted) {
  for (const KeyEntry& entry : key_entries(scene)) {
    if (entry.dotted() == dotted) return entry.value;
  }
  return "no such key";
}

std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read_text(text, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

const std::vector<KeyEntry>& all_keys = option_keys();

}  // namespace

TEST_CASE("a row says what its key does and what holds without it", "[scene][keys]") {
  REQUIRE(all_keys.size() > 60);
  std::set<std::string> names;
  for (const KeyEntry& entry : all_keys) {
    INFO(entry.dotted());
    CHECK(names.insert(entry.dotted()).second);
    CHECK(std::ranges::all_of(entry.key.name, [](char c) { return std::islower(c) || std::isdigit(c) || c == '_'; }));
    CHECK_FALSE(entry.key.says.empty());
    CHECK(entry.key.says.back() != '.');
    CHECK(entry.value.has_value() == entry.key.absent.empty());
    CHECK_FALSE(entry.table.says.empty());
  }
  for (const KeyEntry& entry : all_keys) CHECK(names.count(std::string(entry.key.formerly)) == 0);
}

TEST_CASE("the tables that a user meets for method and steps stay small", "[scene][keys]") {
  CHECK(std::ranges::count_if(all_keys, [](const KeyEntry& entry) { return entry.table.name == "method" || entry.table.name == "step"; }) <= 20);
  for (const KeyEntry& entry : all_keys) {
    if (entry.key.name.starts_with("skip_")) CHECK(entry.table.audience == Audience::developer);
  }
}

TEST_CASE("every key is read from a file and from --set, written, and read back", "[scene][keys]") {
  const std::size_t i = GENERATE(range(std::size_t{0}, all_keys.size()));
  const KeyEntry& entry = all_keys[i];
  const std::string value = other_value(entry);
  INFO(entry.dotted() << " = " << value);
  REQUIRE(entry.value != value);
  const Scene scene = read_text(file_with(entry.dotted(), value));
  CHECK(value_of(scene, entry.dotted()) == value);
  CHECK(scene.warnings.empty());
  CHECK(value_of(read_text(file_with(entry.dotted(), entry.value.value_or(value)), {entry.dotted() + "=" + value}), entry.dotted()) == value);
  for (const KeyEntry& other : all_keys) {
    INFO(other.dotted());
    if (other.dotted() != entry.dotted() && !(entry.key.name.starts_with("first_integrator") && other.key.name.starts_with("first_integrator")))
      CHECK(value_of(scene, other.dotted()) == other.value);
  }
  const Scene again = read_text(write_scene(scene));
  CHECK(again.warnings.empty());
  for (const KeyEntry& other : key_entries(scene)) {
    INFO(other.dotted());
    CHECK(value_of(again, other.dotted()) == other.value);
  }
  // The text by which a checkpoint knows its scene.
  const bool told = write_fixed_part(scene) != write_fixed_part(read_text(block_on_base));
  CHECK(told == !entry.key.may_change_on_restart);
}

TEST_CASE("a former key is read with one warning that names the new one", "[scene][keys]") {
  int formerly = 0;
  for (const KeyEntry& entry : all_keys) {
    if (entry.key.formerly.empty()) continue;
    ++formerly;
    const std::string old(entry.key.formerly), value = other_value(entry);
    INFO(old << " = " << value);
    const SceneFile file(file_with(old, value));
    const Scene scene = read_scene(file.path());
    CHECK(value_of(scene, entry.dotted()) == value);
    CHECK(scene.warnings == std::vector<std::string>{file.path() + ":23: " + old + " is now " + entry.dotted() + "; the old name is still read"});
    CHECK(check_scene(scene) == scene.warnings);

    const SceneFile plain(block_on_base);
    const auto refusal = [&] {
      try {
        read_scene(plain.path(), {old + " =" + value});
      } catch (const InputError& refused) {
        return std::string(refused.what());
      }
      return std::string();
    };
    REQUIRE(refusal().empty());
    const Scene set = read_scene(plain.path(), {old + " =" + value});
    CHECK(value_of(set, entry.dotted()) == value);
    CHECK(set.warnings ==
          std::vector<std::string>{plain.path() + ": command line: " + old + " is now " + entry.dotted() + "; the old name is still read"});
    // Without a value there is nothing to hand on, whatever the name.
    CHECK_THROWS_WITH(read_scene(plain.path(), {old}), ContainsSubstring(old) && !ContainsSubstring(entry.dotted()));
    // What is set on the command line counts, whichever name the file has.
    const Scene over = read_scene(file.path(), {entry.dotted() + "=" + entry.value.value_or(value)});
    CHECK(value_of(over, entry.dotted()) == entry.value.value_or(value));
  }
  CHECK(formerly > 20);
}

TEST_CASE("a key that is not there any more is left out with one warning", "[scene][keys]") {
  const SceneFile file(block_on_base + "[method]\nskip_unmoved = false\n[solver]\nskip_unmoved = 'whatever'\n");
  const auto note = [](const std::string& where, const std::string& key) {
    return where + ": " + key + " is not there any more and counts for nothing; leave it out";
  };
  CHECK(read_scene(file.path()).warnings ==
        std::vector<std::string>{note(file.path() + ":23", "method.skip_unmoved"), note(file.path() + ":25", "solver.skip_unmoved")});
  const SceneFile plain(block_on_base);
  const Scene set = read_scene(plain.path(), {"solver.skip_unmoved = false"});
  CHECK(set.warnings == std::vector<std::string>{note(plain.path() + ": command line", "solver.skip_unmoved")});
  CHECK(write_scene(set) == write_scene(read_scene(plain.path())));
}

TEST_CASE("a key under both names is refused", "[scene][keys]") {
  CHECK_THAT(
      error_of(block_on_base + "[method]\nmax_iterations = 5\n[solver]\nmax_iterations = 6\n"),
      ContainsSubstring(":23: method.max_iterations: line 25 gives solver.max_iterations, the new name of this key, too; accepted: one of the two"));
  CHECK_THAT(error_of("solver = 5\n" + block_on_base + "[method]\nmax_iterations = 5\n"),
             ContainsSubstring(":1: solver: 5 is a number; accepted: a table"));
  CHECK_THAT(error_of(block_on_base + "[method]\nmax_iterations = 0\n"), ContainsSubstring(":23: solver.max_iterations: 0 is out of range"));
}

TEST_CASE("a switch that has become a name in a list is still read", "[scene][keys]") {
  CHECK(read_text(block_on_base + "[output]\nvtk = true\n").formats == std::vector<std::string>{"vtk"});
  CHECK(read_text(block_on_base + "[output]\nvtk = false\n").formats.empty());
  CHECK(read_text(block_on_base, {"output.vtk=true"}).formats == std::vector<std::string>{"vtk"});
  CHECK(read_text(block_on_base + "[output]\nvtk = true\n", {"output.vtk=false"}).formats.empty());
  CHECK_THAT(error_of(block_on_base + "[output]\nvtk = 1\n"), ContainsSubstring(":23: output.formats: 1 is a number; accepted: an array"));
}

namespace {

/// What the reader asks of a table: all its keys, or those without which it is refused, from the lists in its errors.
std::set<std::string> names_after(const std::string& error, const std::string& start) {
  const std::size_t begin = error.find(start);
  INFO(error);
  REQUIRE(begin != std::string::npos);
  std::set<std::string> names;
  std::string name;
  for (const char c : error.substr(begin + start.size()) + ",") {
    if (c == ',') {
      names.insert(std::exchange(name, ""));
    } else if (c != ' ') {
      name += c;
    }
  }
  return names;
}

/// A scene with an empty table of this name, to which a line can be added.
std::vector<std::string> scenes_with(const std::string& table) {
  const std::string domain = "[domain]\nmaterial = 'rock'\nvertices_m = [[10, 0], [20, 0], [20, 10], [10, 10]]\n";
  if (table == "base_motion.pulse") return {block_on_base + "[base_motion]\nkind = 'pulses'\n[[base_motion.pulse]]\n"};
  if (table == "base_motion") {
    std::vector<std::string> kinds;
    for (const char* kind : {"pulses", "harmonic", "record"}) kinds.push_back(block_on_base + "[base_motion]\nkind = '" + kind + "'\n");
    return kinds;
  }
  if (table == "domain") return {block_on_base + "[domain]\n"};
  if (table == "joint") return {block_on_base + "[[joint]]\nname = 'seam'\n"};  // one without a name needs materials
  return {block_on_base + domain + "[[" + table + "]]\n"};
}

}  // namespace

TEST_CASE("what a scene is made of is described with the keys that the reader asks for", "[scene][keys]") {
  std::map<std::string, std::pair<std::set<std::string>, std::set<std::string>>> described;
  for (const KeyEntry& entry : element_keys()) {
    INFO(entry.dotted());
    CHECK_FALSE(entry.key.says.empty());
    auto& [all, required] = described[std::string(entry.table.name)];
    CHECK(all.insert(std::string(entry.key.name)).second);
    if (entry.key.required) required.insert(std::string(entry.key.name));
  }
  CHECK(described.size() == 16);
  CHECK(described[""].first == std::set<std::string>{"title", "gravity_m_per_s2"});
  for (const auto& [table, keys] : described) {
    if (table.empty()) continue;
    std::set<std::string> asked;
    for (const std::string& scene : scenes_with(table)) {
      asked.merge(names_after(error_of(scene + "qqqqqqqqqqqqqqqq = 1\n"), "qqqqqqqqqqqqqqqq: this key is not known; accepted: "));
    }
    INFO("[" << table << "]");
    if (table == "base_motion") asked.erase("pulse");  // a table within it
    CHECK(keys.first == asked);
    if (table == "base_motion") continue;
    const std::string error = error_of(scenes_with(table).front());
    if (!keys.second.empty()) CHECK(keys.second == names_after(error, "this key is missing; accepted: a table with "));
  }
}

TEST_CASE("a key in the wrong table says where it belongs", "[scene][keys]") {
  CHECK_THAT(error_of(block_on_base + "[step]\ntheta = 1\n"),
             ContainsSubstring(":23: step.theta: this key belongs in another table; accepted: method.theta"));
  CHECK_THAT(error_of(block_on_base + "[output]\ntime_s = 1\n"),
             ContainsSubstring("output.time_s: this key belongs in another table; accepted: rest.time_s, end.time_s"));
  CHECK_THAT(error_of("contact = 'dem'\n" + block_on_base),
             ContainsSubstring(":1: contact: this key belongs in another table; accepted: method.contact"));
  CHECK_THAT(error_of(block_on_base, {"step.contact=dem"}),
             ContainsSubstring("step.contact: this key belongs in another table; accepted: method.contact"));
}

TEST_CASE("a key of the right table in the wrong case of it is no stranger's", "[scene][keys]") {
  CHECK_THAT(error_of(block_on_base + "[base_motion]\nkind = 'pulses'\nfrequency_hz = 1\n"),
             ContainsSubstring("base_motion.frequency_hz: this key is not known; accepted: "));
  CHECK_THAT(error_of(block_on_base + "[[load]]\nstiffness_n_per_m = [1, 1]\n"),
             ContainsSubstring("load[0].stiffness_n_per_m: this key belongs in another table; accepted: support.stiffness_n_per_m"));
}

TEST_CASE("a misspelt key is guessed, in its table and beyond", "[scene][keys]") {
  CHECK_THAT(error_of(block_on_base + "[method]\ncontakt = 'dem'\n"),
             ContainsSubstring("method.contakt: this key is not known, did you mean contact?"));
  CHECK_THAT(error_of(block_on_base + "[method]\nskip_serch = false\n"), ContainsSubstring("method.skip_serch: this key is not known; accepted: "));
  CHECK_THAT(error_of(block_on_base + "[solver]\nskip_serch = false\n"),
             ContainsSubstring("solver.skip_serch: this key is not known, did you mean skip_search?"));
  CHECK_THAT(error_of(block_on_base + "[stop]\ndt_s = 1\n"), ContainsSubstring("stop: this key is not known, did you mean step?"));
  CHECK_THAT(error_of(block_on_base + "[step]\nwater = 1\n"), ContainsSubstring("step.water: this key is not known; accepted: "));
}

TEST_CASE("the unit of a key stands at its end", "[scene][keys]") {
  CHECK(unit_of("dt_s") == "s");
  CHECK(unit_of("penalty_pa_per_m") == "Pa/m");
  CHECK(unit_of("acceleration_m_per_s2") == "m/s2");
  CHECK(unit_of("unbalanced_force_n") == "N");
  CHECK(unit_of("max_steps").empty());
  CHECK(unit_of("theta").empty());
}
