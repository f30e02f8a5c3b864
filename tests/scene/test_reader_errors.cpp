// Each kind of bad input: an InputError, one line, with file, line, key, what was read and what is accepted.
#include <filesystem>
#include <map>
#include <string_view>

#include "scene_file.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using openclose::test::block_on_base;
using openclose::test::SceneFile;
using openclose::test::with_line;

namespace {

/// The error with the file's name cut off: "LINE: KEY: READ; accepted: ..." or, for the file as a whole, "KEY: ...".
std::string error_of(const std::string& text) {
  const SceneFile file(text);
  try {
    read_scene(file.path());
  } catch (const InputError& error) {
    const std::string message = error.what();
    REQUIRE(message.substr(0, file.path().size() + 1) == file.path() + ":");
    REQUIRE(message.find('\n') == std::string::npos);
    std::string rest = message.substr(file.path().size() + 1);
    return rest.front() == ' ' ? rest.substr(1) : rest;
  }
  FAIL("no error for\n" << text);
  return {};
}

/// The error when one line of the small scene is replaced.
std::string error_with(int line, const std::string& replacement) {
  return error_of(with_line(block_on_base, line, replacement));
}

std::string error_with_vertices(const std::string& vertices) {
  return error_with(20, "vertices_m = " + vertices);
}

}  // namespace

TEST_CASE("files that are none", "[scene][reader][errors]") {
  SECTION("missing") {
    CHECK_THROWS_WITH(read_scene("/nowhere/scene.toml"), "/nowhere/scene.toml: there is no such file; accepted: the path of a scene file");
  }
  SECTION("directory") {
    const std::string directory = std::filesystem::temp_directory_path().string();
    CHECK_THROWS_AS(read_scene(directory), InputError);
    CHECK_THROWS_WITH(read_scene(directory), directory + ": this is not a regular file; accepted: the path of a scene file");
  }
  SECTION("empty path") {
    CHECK_THROWS_AS(read_scene(""), InputError);
  }
}

TEST_CASE("files without a scene", "[scene][reader][errors]") {
  CHECK(error_of("") == "the file is empty; accepted: a scene with at least one [[material]] and one [[block]] or a [domain]");
  CHECK_THAT(error_of("# nothing\n\n"), ContainsSubstring("the file is empty"));
  CHECK(error_of("title = 'nothing'\n") == "material: the scene has none; accepted: at least one [[material]]");
  CHECK(error_of("[[material]]\nname = 'a'\ndensity_kg_per_m3 = 1\n") == "block: the scene has none; accepted: at least one [[block]] or a [domain]");
  CHECK(error_of("material = []\nblock = []\n") == "material: the scene has none; accepted: at least one [[material]]");
}

TEST_CASE("text that is not TOML", "[scene][reader][errors]") {
  CHECK_THAT(error_with(3, "density_kg_per_m3 2700"), ContainsSubstring("3: \"") && ContainsSubstring("accepted: TOML 1.0"));
  CHECK_THAT(error_with(3, "density_kg_per_m3 = 1\ndensity_kg_per_m3 = 2"), ContainsSubstring("4: ") && ContainsSubstring("accepted: TOML 1.0"));
  CHECK_THAT(error_of(std::string("\x7f"
                                  "ELF\x02\x01\0\0\xff\xfe",
                                  10)),
             ContainsSubstring("accepted: TOML 1.0"));
}

TEST_CASE("what is likely meant by a line that is not TOML", "[scene][reader][errors]") {
  const std::map<std::string, std::string> accepted = {
      {"name = rock", "column 8; accepted: TOML 1.0, where a text has quotes: name = \"rock\""},
      {"density_kg_per_m3 = 2700,5", "; accepted: TOML 1.0, where decimals follow a point: density_kg_per_m3 = 2700.5"},
      {"density_kg_per_m3 = -2700 kg # heavy", "where a number stands alone, its unit being part of the key: density_kg_per_m3 = -2700"},
      {"density_kg_per_m3 = 45%", "its unit being part of the key: density_kg_per_m3 = 45"},
      {"[joint_set]\ndip_deg = 1\n[joint_set]", "several times has double brackets: [[joint_set]]"}};
  for (const auto& [line, words] : accepted) CHECK_THAT(error_with(3, line), ContainsSubstring(words));
  for (const std::string line : {"density_kg_per_m3 =", "= 1", "[method]\n[method]", "density_kg_per_m3 = 1_"})
    CHECK_THAT(error_with(3, line), EndsWith("accepted: TOML 1.0"));
}

TEST_CASE("a strength that stands with a joint set is shown the way over a named joint", "[scene][reader][errors]") {
  CHECK_THAT(error_of(block_on_base +
                      "[domain]\nmaterial = 'rock'\nvertices_m = [[0, 10], [9, 10], [9, 15], [0, 15]]\n[[joint_set]]\nfriction_angle_deg = 28\n"),
             ContainsSubstring(
                 "belongs in another table; accepted: joint.friction_angle_deg, of a [[joint]] with a name, and joint_set.joint with that name"));
}

TEST_CASE("unknown keys", "[scene][reader][errors]") {
  CHECK_THAT(error_with(15, "fixd = true"), ContainsSubstring("15: block[0].fixd: this key is not known, did you mean fixed?; accepted: fixed, "));
  CHECK_THAT(error_with(11, "[[blok]]"), ContainsSubstring("11: blok: this key is not known, did you mean block?; accepted: block, "));
  CHECK_THAT(error_of(block_on_base + "[method]\nthetta = 1\n"),
             ContainsSubstring("23: method.thetta: this key is not known, did you mean theta?; accepted: theta, "));
  CHECK_THAT(error_of(block_on_base + "[end]\nvertices = 1\n"), ContainsSubstring("23: end.vertices: this key is not known; accepted: time_s"));
  SECTION("a misspelt key goes before the one that is missing for it") {
    CHECK_THAT(
        error_with(9, "friction_angel_deg = 35"),
        ContainsSubstring("9: joint[0].friction_angel_deg: this key is not known, did you mean friction_angle_deg?; accepted: friction_angle_deg, "));
  }
  SECTION("a key with a line break leaves the message on one line") {
    CHECK_THAT(error_with(15, "\"a\\nb\" = 1"), ContainsSubstring("15: block[0].a\\x0ab: "));
  }
}

TEST_CASE("keys with another unit", "[scene][reader][errors]") {
  CHECK(error_with(3, "density_g_per_cm3 = 2.7") == "3: material[0].density_g_per_cm3: this key has another unit; accepted: density_kg_per_m3");
  CHECK(error_with(3, "density = 2.7") == "3: material[0].density: this key has another unit; accepted: density_kg_per_m3");
  CHECK(error_with(7, "normal_stiffness_mpa_per_mm = 1") ==
        "7: joint[0].normal_stiffness_mpa_per_mm: this key has another unit; accepted: normal_stiffness_pa_per_m");
  CHECK(error_with(9, "friction_angle_rad = 1") == "9: joint[0].friction_angle_rad: this key has another unit; accepted: friction_angle_deg");
  CHECK(error_of(block_on_base + "[step]\ndt_ms = 1\n") == "23: step.dt_ms: this key has another unit; accepted: dt_s");
}

TEST_CASE("missing keys", "[scene][reader][errors]") {
  CHECK(error_with(2, "") == "1: material[0].name: this key is missing; accepted: a table with name");
  CHECK(error_with(3, "") ==
        "1: material[0]: neither density nor unit weight is given; accepted: exactly one of density_kg_per_m3, unit_weight_n_per_m3");
  CHECK(error_with(6, "") == "5: joint[0].materials: this key is missing; accepted: a table with materials");
  CHECK(error_with(7, "") == "5: joint[0].normal_stiffness_pa_per_m: this key is missing; accepted: a table with normal_stiffness_pa_per_m");
  CHECK_THAT(error_with(8, ""), ContainsSubstring("5: joint[0].shear_stiffness_pa_per_m: this key is missing"));
  CHECK_THAT(error_with(9, ""), ContainsSubstring("5: joint[0].friction_angle_deg: this key is missing"));
  CHECK_THAT(error_with(18, ""), ContainsSubstring("17: block[1].name: this key is missing"));
  CHECK_THAT(error_with(19, ""), ContainsSubstring("17: block[1].material: this key is missing"));
  CHECK_THAT(error_with(20, ""), ContainsSubstring("17: block[1].vertices_m: this key is missing"));
  CHECK_THAT(error_of(block_on_base + "[[support]]\n"),
             ContainsSubstring("22: support[0].point_m: this key is missing; accepted: a table with point_m, stiffness_n_per_m"));
  CHECK_THAT(error_of(block_on_base + "[[load]]\n"),
             ContainsSubstring("22: load[0].point_m: this key is missing; accepted: a table with point_m, force_n"));
  CHECK_THAT(error_of(block_on_base + "[[measured_point]]\n"), ContainsSubstring("22: measured_point[0].name: this key is missing"));
}

TEST_CASE("values of another type", "[scene][reader][errors]") {
  CHECK(error_with(3, "density_kg_per_m3 = '2700'") == "3: material[0].density_kg_per_m3: \"2700\" is a string; accepted: a number > 0");
  CHECK(error_with(3, "density_kg_per_m3 = true") == "3: material[0].density_kg_per_m3: true is a boolean; accepted: a number > 0");
  CHECK(error_with(3, "density_kg_per_m3 = [1]") == "3: material[0].density_kg_per_m3: is an array of 1 values; accepted: a number > 0");
  CHECK(error_with(3, "density_kg_per_m3 = {}") == "3: material[0].density_kg_per_m3: is a table; accepted: a number > 0");
  CHECK(error_with(3, "density_kg_per_m3 = 1979-05-27") == "3: material[0].density_kg_per_m3: is a date or a time; accepted: a number > 0");
  CHECK(error_with(2, "name = 5") == "2: material[0].name: 5 is a number; accepted: a text in quotes");
  CHECK(error_with(15, "fixed = 1") == "15: block[0].fixed: 1 is a number; accepted: true or false");
  CHECK(error_with(15, "fixed = 'true'") == "15: block[0].fixed: \"true\" is a string; accepted: true or false");
  CHECK(error_with(15, "velocity_m_per_s = 1.5") == "15: block[0].velocity_m_per_s: 1.5 is a number; accepted: [x, y], each a finite number");
  CHECK(error_with(15, "velocity_m_per_s = [1, 2, 3]") ==
        "15: block[0].velocity_m_per_s: is an array of 3 values; accepted: [x, y], each a finite number");
  CHECK(error_with(15, "velocity_m_per_s = [1, 'x']") == "15: block[0].velocity_m_per_s[1]: \"x\" is a string; accepted: a finite number");
  CHECK(error_with_vertices("1") == "20: block[1].vertices_m: 1 is a number; accepted: an array");
  CHECK_THAT(error_with_vertices("[[0, 0],\n [1, 0],\n [1]]"),
             ContainsSubstring("22: block[1].vertices_m[2]: is an array of 1 values; accepted: [x, y], each a number in ["));
  CHECK(error_with(6, "materials = 'rock'") == "6: joint[0].materials: \"rock\" is a string; accepted: a list, e.g. [\"rock\"]");
  CHECK(error_of(block_on_base + "[solver]\nmax_iterations = 1.5\n") ==
        "23: solver.max_iterations: 1.5 is not a whole number; accepted: a whole number in [1, 1000000000]");
  CHECK(error_of(block_on_base + "[solver]\nmax_iterations = 'many'\n") ==
        "23: solver.max_iterations: \"many\" is a string; accepted: a whole number in [1, 1000000000]");
  CHECK(error_of(block_on_base + "[strength_reduction]\ncurve = [1, 'x']\n") ==
        "23: strength_reduction.curve[1]: \"x\" is a string; accepted: a number > 0");
}

TEST_CASE("tables written as something else", "[scene][reader][errors]") {
  CHECK(error_of("[material]\nname = 'rock'\n") == "1: material: is a table; accepted: an array of tables, each written [[material]]");
  CHECK(error_of("block = [1]\n") == "1: block[0]: 1 is a number; accepted: an array of tables, each written [[block]]");
  CHECK(error_of(block_on_base + "[[method]]\n") == "22: method: is an array of 1 values; accepted: a table, written [method]");
}

TEST_CASE("numbers that are none", "[scene][reader][errors]") {
  CHECK(error_with(3, "density_kg_per_m3 = nan") == "3: material[0].density_kg_per_m3: nan is not a finite number; accepted: a number > 0");
  CHECK(error_with(7, "normal_stiffness_pa_per_m = inf") ==
        "7: joint[0].normal_stiffness_pa_per_m: inf is not a finite number; accepted: a number > 0");
  CHECK_THAT(error_with_vertices("[[0, 0], [1, -inf], [1, 1]]"), ContainsSubstring("20: block[1].vertices_m[1][1]: -inf is not a finite number"));
  CHECK_THAT(error_of(block_on_base + "[end]\ntime_s = nan\n"), ContainsSubstring("23: end.time_s: nan is not a finite number"));
  CHECK_THAT(error_of(block_on_base + "[solver]\nmax_iterations = inf\n"),
             ContainsSubstring("23: solver.max_iterations: inf is not a finite number"));
  CHECK_THAT(error_of("gravity_m_per_s2 = [0, nan]\n" + block_on_base),
             ContainsSubstring("1: gravity_m_per_s2[1]: nan is not a finite number; accepted: a number in [-1000000, 1000000]"));
}

TEST_CASE("numbers out of range", "[scene][reader][errors]") {
  CHECK(error_with(3, "density_kg_per_m3 = -1") == "3: material[0].density_kg_per_m3: -1 is out of range; accepted: a number > 0");
  CHECK(error_with(3, "density_kg_per_m3 = 0") == "3: material[0].density_kg_per_m3: 0 is out of range; accepted: a number > 0");
  CHECK(error_with(3, "unit_weight_n_per_m3 = -26000") == "3: material[0].unit_weight_n_per_m3: -26000 is out of range; accepted: a number > 0");
  CHECK(error_with(7, "normal_stiffness_pa_per_m = 0") == "7: joint[0].normal_stiffness_pa_per_m: 0 is out of range; accepted: a number > 0");
  CHECK(error_with(8, "shear_stiffness_pa_per_m = -1e9") ==
        "8: joint[0].shear_stiffness_pa_per_m: -1000000000 is out of range; accepted: a number > 0");
  CHECK(error_with(9, "friction_angle_deg = 90") == "9: joint[0].friction_angle_deg: 90 is out of range; accepted: a number in [0, 90)");
  CHECK(error_with(9, "friction_angle_deg = -0.5") == "9: joint[0].friction_angle_deg: -0.5 is out of range; accepted: a number in [0, 90)");
  CHECK(error_with(10, "cohesion_pa = -1") == "10: joint[0].cohesion_pa: -1 is out of range; accepted: a number >= 0");
  CHECK(error_with(10, "damping_ratio = -1") == "10: joint[0].damping_ratio: -1 is out of range; accepted: a number >= 0");
  CHECK(error_with(10, "tensile_strength_pa = -1") == "10: joint[0].tensile_strength_pa: -1 is out of range; accepted: a number >= 0");
  CHECK_THAT(error_with_vertices("[[0, 0], [2e7, 0], [1, 1]]"),
             ContainsSubstring("20: block[1].vertices_m[1][0]: 20000000 is out of range; accepted: a number in [-"));
}

TEST_CASE("options out of range", "[scene][reader][errors]") {
  struct Case {
    std::string table, line, read, accepted;
  };
  const Case c = GENERATE(values<Case>({
      {"method", "theta = 0.4", "0.4", "a number in [0.5, 1]"},
      {"method", "theta = 1.01", "1.01", "a number in [0.5, 1]"},
      {"method", "rho_inf = 1.5", "1.5", "a number in [0, 1]"},
      {"method", "dissipation = -0.1", "-0.1", "a number in [0, 1]"},
      {"solver", "residual_tolerance = 1", "1", "a number in (0, 1)"},
      {"solver", "max_iterations = 0", "0", "a whole number in [1, 1000000000]"},
      {"method", "threads = 0", "0", "a whole number in [1, 8]"},
      {"method", "threads = 9", "9", "a whole number in [1, 8]"},
      {"solver", "max_iterations = 3000000000", "3000000000", "a whole number in [1, 1000000000]"},
      {"method", "penalty_pa_per_m = 0", "0", "a number > 0"},
      {"method", "penalty_shear_ratio = -1", "-1", "a number > 0"},
      {"solver", "penetration_tolerance_m = 0", "0", "a number > 0"},
      {"solver", "closing_tolerance_m = -1", "-1", "a number >= 0"},
      {"solver", "gap_tolerance_m = 0", "0", "a number > 0"},
      {"solver", "contact_skin_m = 0", "0", "a number > 0"},
      {"solver", "max_open_close_iterations = 0", "0", "a whole number in [1, 1000000000]"},
      {"solver", "step_cut = 1", "1", "a number in (0, 1)"},
      {"method", "step_fraction = 1", "1", "a number in (0, 1)"},
      {"solver", "local_damping = 0", "0", "a number in (0, 1)"},
      {"settle", "max_explicit_steps = 0", "0", "a whole number in [1, 1000000000]"},
      {"step", "dt_s = 0", "0", "a number > 0"},
      {"step", "dt_s = -0.1", "-0.1", "a number > 0"},
      {"step", "max_displacement_m = 0", "0", "a number in (0, 10000000]"},
      {"step", "error_tolerance_m = 0", "0", "a number > 0"},
      {"step", "look_ahead = 1.5", "1.5", "a number in [0, 1]"},
      {"solver", "smallest_fraction = 2", "2", "a number in (0, 1]"},
      {"end", "time_s = -1", "-1", "a number >= 0"},
      {"output", "every_s = -1", "-1", "a number >= 0"},
      {"end", "displacement_m = 0", "0", "a number > 0"},
      {"end", "displacement_m = -1", "-1", "a number > 0"},
      {"run", "strength_reduction_factor = 0", "0", "a number > 0"},
      {"run", "strength_reduction_factor = -1.2", "-1.2", "a number > 0"},
      {"settle", "relative_displacement = 0", "0", "a number in (0, 1)"},
      {"settle", "relative_displacement = 1", "1", "a number in (0, 1)"},
      {"settle", "steady_steps = 0", "0", "a whole number in [1, 1000000000]"},
      {"settle", "steady_steps = -1", "-1", "a whole number in [1, 1000000000]"},
      {"settle", "max_time_steps = 0", "0", "a whole number in [1, 1000000000]"},
      {"settle", "max_time_steps = 2e9", "2000000000", "a whole number in [1, 1000000000]"},
      {"settle", "unbalanced_force_n = 0", "0", "a number > 0"},
      {"settle", "unbalanced_force_n = -1", "-1", "a number > 0"},
      {"settle", "unbalanced_fraction = 0", "0", "a number in (0, 1)"},
      {"settle", "first_dt_s = 0", "0", "a number > 0"},
      {"settle", "max_steps = 0", "0", "a whole number in [1, 1000000000]"},
      {"settle", "failure_displacement_m = 0", "0", "a number > 0"},
      {"strength_reduction", "width = 0", "0", "a number > 0"},
      {"strength_reduction", "upper_limit = 0", "0", "a number > 0"},
      {"strength_reduction", "upper_limit = 1", "1", "a number > 1, or with strength_reduction.increase a number > 0"},
      {"strength_reduction", "curve_time_s = 0", "0", "a number > 0"},
  }));
  const std::string key = c.table + "." + c.line.substr(0, c.line.find(' '));
  CHECK(error_of(block_on_base + "[" + c.table + "]\n" + c.line + "\n") ==
        "23: " + key + ": " + c.read + " is out of range; accepted: " + c.accepted);
}

TEST_CASE("a first integrator wants to know for how long", "[scene][reader][errors]") {
  const auto error = [](const std::string& lines) { return error_of(block_on_base + "[method]\n" + lines); };
  CHECK_THAT(error("first_integrator = 'a'\n"), ContainsSubstring("method.first_integrator_s: this key is missing"));
  CHECK_THAT(error("first_integrator_s = 1\n"), ContainsSubstring("method.first_integrator: this key is missing"));
  CHECK(error("first_integrator = 'a'\nfirst_integrator_s = 0\n") == "24: method.first_integrator_s: 0 is out of range; accepted: a number > 0");
}

TEST_CASE("a factor of the strength reduction curve out of range", "[scene][reader][errors]") {
  CHECK(error_of(block_on_base + "[strength_reduction]\ncurve = [1, 0]\n") ==
        "23: strength_reduction.curve[1]: 0 is out of range; accepted: a number > 0");
}

TEST_CASE("lists of what comes one after the other in a run", "[scene][reader][errors]") {
  const auto error = [](const std::string& line) { return error_of(block_on_base + "[output]\n" + line + "\n"); };
  CHECK(error("milestones_m = 10") == "23: output.milestones_m: 10 is a number; accepted: an array");
  CHECK(error("milestones_m = [0, 10]") == "23: output.milestones_m[0]: 0 is out of range; accepted: a number > 0");
  CHECK(error("milestones_m = [10, 30, 20]") == "23: output.milestones_m[2]: 20 follows 30; accepted: numbers that increase");
  CHECK(error("milestones_s = [10]") == "23: output.milestones_s: this key has another unit; accepted: milestones_m");
  CHECK(error("snapshots_s = [-1]") == "23: output.snapshots_s[0]: -1 is out of range; accepted: a number >= 0");
  CHECK(error("snapshots_s = [1, 1]") == "23: output.snapshots_s[1]: 1 follows 1; accepted: numbers that increase");
  CHECK(error("snapshots_s = [1, 'late']") == "23: output.snapshots_s[1]: \"late\" is a string; accepted: a number >= 0");
}

TEST_CASE("types and units of the options of a run", "[scene][reader][errors]") {
  CHECK(error_of(block_on_base + "[run]\nstrength_reduction_factor = 'much'\n") ==
        "23: run.strength_reduction_factor: \"much\" is a string; accepted: a number > 0");
  CHECK(error_of(block_on_base + "[end]\ndisplacement_mm = 1\n") == "23: end.displacement_mm: this key has another unit; accepted: displacement_m");
  CHECK(error_of(block_on_base + "[settle]\ncriterion = 1\n") == "23: settle.criterion: 1 is a number; accepted: a text in quotes");
  CHECK(error_of(block_on_base + "[settle]\ncriterion = ''\n") ==
        "23: settle.criterion: \"\" is not known; accepted: \"paper\", \"unbalanced_force\"");
  CHECK_THAT(error_of(block_on_base + "[settle]\ncriterion = 'papers'\n"), ContainsSubstring("\"papers\" is not known; accepted: \"paper\""));
  CHECK_THAT(error_of(block_on_base + "[settle]\nrelative_displacement = true\n"),
             ContainsSubstring("true is a boolean; accepted: a number in (0, 1)"));
  CHECK_THAT(error_of(block_on_base + "[settle]\nsteady_steps = 1.5\n"), ContainsSubstring("1.5 is not a whole number"));
  CHECK_THAT(error_of(block_on_base + "[settle]\nmax_time_steps = 'all'\n"), ContainsSubstring("\"all\" is a string"));
}

TEST_CASE("words that are not known", "[scene][reader][errors]") {
  CHECK(error_with(10, "cohesion_behaviour = 'brittle'") ==
        "10: joint[0].cohesion_behaviour: \"brittle\" is not known; accepted: \"ductile\", \"lost_on_slip\", \"lost_on_opening\"");
  CHECK(error_of(block_on_base + "[method]\nrotation = 'exakt'\n") == "23: method.rotation: \"exakt\" is not known; accepted: \"exact\", \"linear\"");
  CHECK_THAT(error_of(block_on_base + "[method]\nstart = 'sliding'\n"),
             ContainsSubstring("23: method.start: \"sliding\" is not known; accepted: ") && ContainsSubstring("\"steady_sliding\""));
  CHECK_THAT(error_of(block_on_base + "[method]\ncontact = ''\n"), ContainsSubstring("23: method.contact: the name is empty; accepted: "));
}

TEST_CASE("density and unit weight", "[scene][reader][errors]") {
  CHECK(error_with(3, "density_kg_per_m3 = 1\nunit_weight_n_per_m3 = 1") ==
        "1: material[0]: both density and unit weight are given; accepted: exactly one of density_kg_per_m3, unit_weight_n_per_m3");
  CHECK(error_of("gravity_m_per_s2 = [0, 0]\n" + with_line(block_on_base, 3, "unit_weight_n_per_m3 = 1")) ==
        "4: material[0].unit_weight_n_per_m3: without gravity a unit weight gives no mass; accepted: density_kg_per_m3");
}

TEST_CASE("names that refer to nothing", "[scene][reader][errors]") {
  CHECK(error_with(13, "material = 'rok'") == "13: block[0].material: there is no material \"rok\", did you mean \"rock\"?; accepted: \"rock\"");
  CHECK(error_with(6, "materials = ['rock', 'clay']") == "6: joint[0].materials[1]: there is no material \"clay\"; accepted: \"rock\"");
  CHECK(error_with(6, "materials = ['rock']") == "6: joint[0].materials: there are 1 names; accepted: two names of materials");
  CHECK(error_of(block_on_base + "[[load]]\nblock = 'blokc'\npoint_m = [0, 0]\nforce_n = [0, 0]\n") ==
        "23: load[0].block: there is no block \"blokc\", did you mean \"block\"?; accepted: \"block\", \"base\"");
}

TEST_CASE("names that are not usable", "[scene][reader][errors]") {
  CHECK_THAT(error_with(18, "name = ''"), ContainsSubstring("18: block[1].name: the name is empty; accepted: a name of its own for every block"));
  CHECK_THAT(error_with(18, "name = 'a,b'"), ContainsSubstring("18: block[1].name: \"a,b\" cannot be written to a table of results; accepted: "));
  CHECK_THAT(error_with(18, "name = \"a\\nb\""),
             ContainsSubstring("18: block[1].name: \"a\\x0ab\" cannot be written to a table of results; accepted: "));
}

TEST_CASE("names given twice", "[scene][reader][errors]") {
  CHECK_THAT(error_with(18, "name = 'base'"),
             ContainsSubstring("18: block[1].name: \"base\" is already the name of the block of line 12; accepted: "));
  CHECK_THAT(error_with(4, "[[material]]\nname = 'rock'\ndensity_kg_per_m3 = 1\n"),
             ContainsSubstring("5: material[1].name: \"rock\" is already the name of the material of line 2; accepted: "));
  const std::string point = "[[measured_point]]\nname = 'p'\nblock = 'block'\npoint_m = [0, 0]\n";
  CHECK_THAT(error_of(block_on_base + point + point),
             ContainsSubstring("27: measured_point[1].name: \"p\" is already the name of the measured point of line 23; accepted: "));
}

TEST_CASE("two joints for one pair of materials", "[scene][reader][errors]") {
  const std::string second_material = "[[material]]\nname = 'clay'\ndensity_kg_per_m3 = 2000\n";
  const std::string values = "normal_stiffness_pa_per_m = 1\nshear_stiffness_pa_per_m = 1\nfriction_angle_deg = 0\n";
  const std::string text =
      block_on_base + second_material + "[[joint]]\nmaterials = ['rock', 'clay']\n" + values + "[[joint]]\nmaterials = ['clay', 'rock']\n" + values;
  CHECK(error_of(text) == "30: joint[2]: the joint of line 25 is for the same two materials; accepted: one [[joint]] for each pair of materials");
}

TEST_CASE("polygons with too few vertices", "[scene][reader][errors]") {
  CHECK(error_with_vertices("[]") == "20: block[1].vertices_m: the polygon has 0 vertices; accepted: at least 3");
  CHECK(error_with_vertices("[[0, 0], [1, 0]]") == "20: block[1].vertices_m: the polygon has 2 vertices; accepted: at least 3");
}

TEST_CASE("polygons without area", "[scene][reader][errors]") {
  CHECK(error_with_vertices("[[0, 0], [1, 0], [2, 0]]") ==
        "20: block[1].vertices_m: the polygon has an area of 0 m2 on a longest edge of 2 m; accepted: a block at least 1e-06 m wide (2 area / "
        "longest edge)");
  CHECK_THAT(error_with_vertices("[[1, 1], [1, 1], [1, 1]]"),
             ContainsSubstring("20: block[1].vertices_m: the polygon has an area of 0 m2 on a longest edge of 0 m"));
  CHECK_THAT(error_with_vertices("[[0, 0], [1, 0], [0.5, 1e-7]]"), ContainsSubstring("20: block[1].vertices_m: the polygon has an area of 5e-08 m2"));
  CHECK_THAT(error_with_vertices("[[0, 0], [1, 0], [1, 1e-9], [0, 1e-9]]"),
             ContainsSubstring("20: block[1].vertices_m: the polygon has an area of 1e-09 m2"));
  CHECK_THAT(error_with_vertices("[[0, 0], [1, 1], [2, 2], [1, 1]]"), ContainsSubstring("20: block[1].vertices_m: the polygon has an area of 0 m2"));
  SECTION("a thin bent strip is not on a line and still a sliver") {
    CHECK_THAT(error_with_vertices("[[0, 0], [1, 0], [1, 1], [0.9999999, 1], [0.9999999, 1e-7], [0, 1e-7]]"),
               ContainsSubstring("the polygon has an area of 2e-07 m2"));
  }
}

TEST_CASE("polygons that meet themselves name the edges by the vertices of the file", "[scene][reader][errors]") {
  const std::string accepted = "; accepted: a simple polygon; vertices are numbered from 0";
  CHECK(error_with_vertices("[[0, 0], [1, 1], [1, 0], [0, 1]]") ==
        "20: block[1].vertices_m: the polygon intersects or touches itself: edges [0]-[1] and [2]-[3]" + accepted);
  CHECK(error_with_vertices("[[0, 0], [0, 0], [0.5, 0.5], [1, 1], [1, 0], [0, 1]]") ==
        "20: block[1].vertices_m: the polygon intersects or touches itself: edges [0]-[3] and [4]-[5]" + accepted);
  CHECK(error_with_vertices("[[0, 0], [4, 0], [4, 2], [2, 0], [0, 2]]") ==
        "20: block[1].vertices_m: the polygon intersects or touches itself: edges [0]-[1] and [2]-[3]" + accepted);
}

TEST_CASE("points outside their block", "[scene][reader][errors]") {
  const std::string accepted = "; accepted: a point of the block, to within 1e-06 m";
  CHECK(error_of(block_on_base + "[[load]]\nblock = 'block'\nforce_n = [0, 0]\npoint_m = [0.5, 1.25]\n") ==
        "25: load[0].point_m: (0.5, 1.25) lies 0.25 m outside the block \"block\"" + accepted);
  CHECK(error_of(block_on_base + "[[support]]\nblock = 'block'\nstiffness_n_per_m = [1, 1]\npoint_m = [-3, 5]\n") ==
        "25: support[0].point_m: (-3, 5) lies 5 m outside the block \"block\"" + accepted);
  CHECK(error_of(block_on_base + "[[measured_point]]\nname = 'p'\nblock = 'block'\npoint_m = [1.0000011, 0.5]\n") ==
        "25: measured_point[0].point_m: (1.0000011, 0.5) lies 1.1e-06 m outside the block \"block\"" + accepted);
}

TEST_CASE("supports without stiffness", "[scene][reader][errors]") {
  CHECK(error_of(block_on_base + "[[support]]\nblock = 'block'\npoint_m = [0, 0]\nstiffness_n_per_m = [0, 0]\n") ==
        "25: support[0].stiffness_n_per_m: both stiffnesses are 0; accepted: [kx, ky] of which one may be 0");
  CHECK(error_of(block_on_base + "[[support]]\nblock = 'block'\npoint_m = [0, 0]\nstiffness_n_per_m = [1, -1]\n") ==
        "25: support[0].stiffness_n_per_m[1]: -1 is out of range; accepted: a number >= 0");
}

TEST_CASE("measured contacts that are none", "[scene][reader][errors]") {
  const auto error = [](const std::string& lines) { return error_of(block_on_base + "[[measured_contact]]\nname = 'c'\n" + lines); };
  CHECK(
      error("point_m = [0.5, 0.5]\n") ==
      "24: measured_contact[0].point_m: (0.5, 0.5) lies on the boundaries of 0 blocks; accepted: a point of the joint between two blocks; where more "
      "of them meet, block_a and block_b name the two");
  const std::string neighbour = "[[block]]\nname = 'neighbour'\nmaterial = 'rock'\nvertices_m = [[1, 0], [2, 0], [2, 1], [1, 1]]\n";
  CHECK_THAT(error_of(block_on_base + neighbour + "[[measured_contact]]\nname = 'c'\npoint_m = [1, 0]\n"),
             Catch::Matchers::ContainsSubstring("(1, 0) lies on the boundaries of 3 blocks"));
  CHECK(error("point_m = [0.5, 1]\nblock_a = 'base'\nblock_b = 'block'\n") ==
        "24: measured_contact[0].point_m: (0.5, 1) does not lie on the boundary of \"base\"; accepted: a point of the joint between the two");
  CHECK(error("point_m = [0.5, 0]\nblock_a = 'base'\nblock_b = 'base'\n") ==
        "26: measured_contact[0].block_b: this is block_a, too; accepted: the name of another block");
  CHECK_THAT(error("point_m = [0.5, 0]\nblock_a = 'base'\n"), Catch::Matchers::ContainsSubstring("block_b"));
}

TEST_CASE("intervals of snapshots", "[scene][reader][errors]") {
  CHECK(error_of(block_on_base + "[output]\nsnapshots_every_s = -1\n") ==
        "23: output.snapshots_every_s: -1 is out of range; accepted: a number >= 0");
}

TEST_CASE("surcharges that are on no edge", "[scene][reader][errors]") {
  const std::string accepted =
      "; accepted: from_m and to_m at different points of edges in one line, with blocks on one side only or with the key block, which names one of "
      "them";
  const std::string for_each = "; a [[surcharge]] for each straight stretch";
  const auto error = [](const std::string& lines) { return error_of(block_on_base + "[[surcharge]]\npressure_pa = 1\n" + lines); };
  CHECK(error("from_m = [0.25, 1]\nto_m = [1, 0.5]\n") ==
        "25: surcharge[0].to_m: (0.25, 1) and (1, 0.5) are not on edges of any block in one line, with none from (0.25, 1) to (1, 0.5): "
        "(0.25, 1) is on the edge from (1, 1) to (0, 1) of \"block\", (1, 0.5) is on the edge from (1, 0) to (1, 1) of \"block\"" +
            accepted + for_each);
  CHECK(error("from_m = [0.25, 1]\nto_m = [0.5, 1.1]\nblock = 'block'\n") ==
        "25: surcharge[0].to_m: (0.25, 1) and (0.5, 1.1) are not on edges of \"block\" in one line, with none from (0.25, 1) to (0.5, 1.1): "
        "(0.25, 1) is on the edge from (1, 1) to (0, 1) of \"block\", (0.5, 1.1) is 0.1 m from the edge from (1, 1) to (0, 1) of \"block\"" +
            accepted + for_each);
  // The part that has no edge is named. A corner belongs to two edges: the one that leads to the other end is named.
  CHECK_THAT(
      error("from_m = [0, 1]\nto_m = [2, 1]\n"),
      ContainsSubstring("with none from (1, 1) to (2, 1): (0, 1) is on the edge from (1, 1) to (0, 1) of \"block\", (2, 1) is 1 m from the edge"));
  CHECK_THAT(error("from_m = [-1, 1]\nto_m = [0.5, 1]\n"), ContainsSubstring("with none from (-1, 1) to (0, 1): "));
  // One block over another one, by more than drawings are rounded to.
  const std::string next = "[[block]]\nname = 'next'\nmaterial = 'rock'\nvertices_m = [[0.9, 0], [2, 0], [2, 1], [0.9, 1]]\n";
  CHECK_THAT(error_of(block_on_base + next + "[[surcharge]]\npressure_pa = 1\nfrom_m = [0, 1]\nto_m = [2, 1]\n"),
             ContainsSubstring("with two from (0.9, 1) to (1, 1): "));
  CHECK(error("from_m = [0.25, 0]\nto_m = [0.5, 0]\n") ==
        "25: surcharge[0].to_m: (0.25, 0) and (0.5, 0) are on edges of \"block\" and \"base\"" + accepted);
  CHECK(error("from_m = [0.25, 1]\nto_m = [0.25, 1]\n") == "25: surcharge[0].to_m: (0.25, 1) and (0.25, 1) are one point" + accepted);
  CHECK_THAT(error("from_m = [0.25, 1]\n"), Catch::Matchers::ContainsSubstring("surcharge[0].to_m"));
}

TEST_CASE("residual friction that contradicts the rest of the joint", "[scene][reader][errors]") {
  CHECK(error_with(10, "residual_friction_angle_deg = 35.5") ==
        "10: joint[0].residual_friction_angle_deg: it is above the friction angle; accepted: an angle up to friction_angle_deg");
  CHECK_THAT(error_with(10, "residual_friction_angle_deg = 20\ncohesion_behaviour = 'lost_on_opening'"),
             ContainsSubstring("11: joint[0].cohesion_behaviour: with a lower residual friction angle slip breaks the bond"));
}

TEST_CASE("a slip-weakening distance of a joint that slip does not weaken", "[scene][reader][errors]") {
  CHECK(error_with(10, "slip_weakening_distance_m = 0.01") ==
        "10: joint[0].slip_weakening_distance_m: slip takes no strength from this joint; accepted: 0, or a residual_friction_angle_deg below "
        "friction_angle_deg, or a cohesion_pa with cohesion_behaviour = \"lost_on_slip\"");
  CHECK_THAT(error_with(10, "slip_weakening_distance_m = 0.01\ncohesion_behaviour = 'lost_on_slip'"),
             ContainsSubstring("10: joint[0].slip_weakening_distance_m: slip takes no strength"));
  CHECK_THAT(error_with(10, "slip_weakening_distance_m = -1"), ContainsSubstring("10: joint[0].slip_weakening_distance_m"));
}

TEST_CASE("keys of very many parts are refused before they are parsed", "[scene][reader][errors]") {
  const std::string expected = "a key has more than 16 parts; accepted: keys such as step.dt_s";
  // So few that the parser could take them, before as many as it could not.
  REQUIRE(error_of("a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q = 1\n") == "1: " + expected);
  std::string parts = "a";
  for (int i = 1; i < 50'000; ++i) parts += i % 2 == 0 ? ".a" : " . \"b, c\"";
  CHECK(error_of("# a.b\n" + parts + " = 1\n") == "2: " + expected);
  CHECK(error_of("[" + parts + "]\nx = 1\n") == "1: " + expected);
  CHECK(error_of("x = \"\"\"a\n\"b\"\n\"\"\"\ny = {" + parts + " = 1}\n") == "4: " + expected);
  // Texts of any length end where they do.
  for (const char* text : {"\"\"", "\"b\"", "\"bc\"", "\"\\\"\"", "'b'", "'\\'"})
    CHECK(error_of(std::string("y = {x = ") + text + ", a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q = 1}\n") == "1: " + expected);

  const SceneFile file(block_on_base);
  CHECK_THROWS_WITH(read_scene(file.path(), {parts + "=1"}), ContainsSubstring("a key has more than 16 parts"));
  CHECK_THROWS_WITH(read_scene(file.path(), {"step={" + parts + "=1}"}), ContainsSubstring("a key has more than 16 parts"));
}

TEST_CASE("dots outside of keys are no parts", "[scene][reader]") {
  const std::string dots = "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s.t.u.v.w.x.y.z";
  const std::string lists = "[[0.5, 1.5], [0.5, 1.5], [0.5, 1.5], [0.5, 1.5], [0.5, 1.5], [0.5, 1.5], [0.5, 1.5], [0.5, 1.5], [0.5, 1.5]]";
  CHECK(scene_of_text("# " + dots + "\ntitle = \"\"\"" + dots + "\n\\\"\" " + dots + "\"\"\"\n" + block_on_base, "x").blocks.size() == 2);
  CHECK_THAT(error_with_vertices(lists), ContainsSubstring("polygon"));
}

TEST_CASE("what a message quotes is cut in its middle where it is very long", "[scene][reader][errors]") {
  std::string key;
  for (int i = 0; i < 100'000; ++i) key += "\u00e4";
  const std::string message = error_of("\"" + key + "\" = 1\n" + block_on_base);
  CHECK(message.size() < 1000);
  CHECK_THAT(message, ContainsSubstring("\u00e4 [...] \u00e4"));
}

TEST_CASE("gravity that nobody has is refused", "[scene][reader][errors]") {
  CHECK_THAT(error_of("gravity_m_per_s2 = [0, -1e17]\n" + std::string(block_on_base)),
             ContainsSubstring("gravity_m_per_s2[1]: -1e+17 is out of range; accepted: a number in [-1000000, 1000000]"));
}

TEST_CASE("joints that edges of blocks name", "[scene][reader][errors]") {
  const std::string joint = "[[joint]]\nname = 'bedding'\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 4e8\nfriction_angle_deg = 20\n";
  const auto block = [&](const std::string& vertices, const std::string& joints) {
    return block_on_base + joint + "[[block]]\nname = 'c'\nmaterial = 'rock'\nvertices_m = " + vertices + "\nedge_joints = " + joints + "\n";
  };
  CHECK_THAT(error_of(block("[[50, 0], [52, 0], [50, 1]]", "['bedding']")), ContainsSubstring("there are 1 names for 3 vertices"));
  CHECK_THAT(error_of(block("[[50, 0], [52, 0], [50, 1]]", "['beding', '', '']")),
             ContainsSubstring("edge_joints[0]: there is no joint \"beding\", did you mean \"bedding\"?; accepted: \"bedding\""));
  CHECK_THAT(error_of(block_on_base + joint + joint), ContainsSubstring("\"bedding\" is already the name of the joint"));
}

TEST_CASE("loads that cannot be named, and loads to increase that are not there", "[scene][reader][errors]") {
  const std::string load = block_on_base + "[[load]]\nname = 'push'\npoint_m = [0, 1]\nforce_n = [1, 0]\n";
  const auto named = [](const std::string& name) {
    return error_of(block_on_base + "[[load]]\npoint_m = [0, 1]\nforce_n = [1, 0]\nname = '" + name + "'\n");
  };
  for (const std::string name : {"", "-push", "gravity_x", "a,b"})
    CHECK_THAT(named(name), ContainsSubstring("25: load[0].name: \"" + name + "\" cannot name a load"));
  const auto increased = [&](const std::string& what) { return error_of(load + "[strength_reduction]\nincrease = '" + what + "'\n"); };
  const std::string accepted = "; accepted: \"push\", \"gravity_x\", \"gravity_y\", with a minus before it or without";
  CHECK(increased("pusch") == "27: strength_reduction.increase: no load or surcharge has the name \"pusch\", did you mean \"push\"?" + accepted);
  CHECK(increased("-pusch") == "27: strength_reduction.increase: no load or surcharge has the name \"pusch\", did you mean \"push\"?" + accepted);
  CHECK_THAT(increased(""), ContainsSubstring("27: strength_reduction.increase: no load or surcharge has the name \"\""));
  CHECK(error_of("gravity_m_per_s2 = [0, 0]\n" + block_on_base + "[strength_reduction]\nincrease = 'gravity_x'\n") ==
        "24: strength_reduction.increase: \"gravity_x\" is a multiple of gravity, which is 0; accepted: the name of a load or surcharge");
}

TEST_CASE("a support has a name, and is no load", "[scene][reader][errors]") {
  CHECK_THAT(error_of(block_on_base +
                      "[[support]]\nname = 'anchor'\npoint_m = [0, 1]\nstiffness_n_per_m = [1, 0]\n[strength_reduction]\nincrease = 'anchor'\n"),
             ContainsSubstring("27: strength_reduction.increase: no load or surcharge has the name \"anchor\""));
}

TEST_CASE("a block that cannot turn does not turn", "[scene][reader][errors]") {
  CHECK_THAT(error_with(20, "vertices_m = [[0, 0], [1, 0], [0, 1]]\nrotation_locked = true\nangular_velocity_rad_per_s = 1"),
             ContainsSubstring(
                 "22: block[1].angular_velocity_rad_per_s: the block cannot turn: rotation_locked is true; accepted: 0, or a block that may turn"));
  const SceneFile file(with_line(block_on_base, 20, "vertices_m = [[0, 0], [1, 0], [0, 1]]\nrotation_locked = true\nangular_velocity_rad_per_s = 0"));
  CHECK(read_scene(file.path()).blocks.back().rotation_locked);
}
