// Every kind of bad input: one line on standard error, exit code 2, nothing written.
#include <filesystem>
#include <map>
#include <string>

#include "cli/command.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using openclose::test::block_on_base;
using openclose::test::CommandResult;
using openclose::test::with_line;
using openclose::test::Workplace;

namespace {

const std::string steps = " --dt 0.001 --end 0.01";

/// The command must refuse the scene; its message is returned.
std::string refusal(const Workplace& place, const std::string& arguments) {
  const auto before = place.folder().entries();
  const CommandResult result = place.run(arguments);
  INFO(arguments);
  CHECK(result.status == 2);
  CHECK(result.out.empty());
  CHECK(place.folder().entries() == before);
  REQUIRE(result.errors.size() == 1);
  CHECK_THAT(result.errors[0], StartsWith("openclose: "));
  return result.errors[0];
}

/// All three commands must refuse it, with the same words.
std::string refusal_of_scene(const std::string& scene, const std::string& overrides = "") {
  const Workplace place(scene);
  const std::string message = refusal(place, "run scene.toml -o out" + steps + overrides);
  CHECK(refusal(place, "run scene.toml" + steps + overrides) == message);
  CHECK(refusal(place, "fos scene.toml -o out" + overrides) == message);
  CHECK(refusal(place, "check scene.toml" + overrides) == message);
  return message;
}

std::string refusal_with(int line, const std::string& replacement) {
  return refusal_of_scene(with_line(block_on_base, line, replacement));
}

std::string refusal_with_vertices(const std::string& vertices) {
  return refusal_with(20, "vertices_m = " + vertices);
}

}  // namespace

TEST_CASE("the scene that the bad ones are made of is good", "[cli][bad_input]") {
  const Workplace place;
  CHECK(place.run("run scene.toml -o out" + steps).status == 0);
  CHECK(place.run("check scene.toml").status == 0);
}

TEST_CASE("missing file", "[cli][bad_input]") {
  CHECK_THAT(refusal_of_scene(""), ContainsSubstring("scene.toml: there is no such file"));
}

TEST_CASE("a folder instead of a file", "[cli][bad_input]") {
  const Workplace place("");
  std::filesystem::create_directory(place.folder() / "scene.toml");
  CHECK_THAT(refusal(place, "run scene.toml -o out" + steps), ContainsSubstring("scene.toml: this is not a regular file"));
}

TEST_CASE("not TOML", "[cli][bad_input]") {
  CHECK_THAT(refusal_with(5, "[[joint"), ContainsSubstring("scene.toml:5: ") && ContainsSubstring("accepted: TOML 1.0"));
  CHECK_THAT(refusal_of_scene("\x7f"
                              "ELF\x01\x02\xff\xfe"),
             ContainsSubstring("accepted: TOML 1.0"));
}

TEST_CASE("empty scene", "[cli][bad_input]") {
  CHECK_THAT(refusal_of_scene("\n"), ContainsSubstring("scene.toml: the file is empty"));
  CHECK_THAT(refusal_of_scene("# nothing yet\n"), ContainsSubstring("scene.toml: the file is empty"));
  CHECK_THAT(refusal_of_scene("title = 'no blocks'\n"), ContainsSubstring("scene.toml: material: the scene has none"));
  CHECK_THAT(refusal_of_scene("[[material]]\nname = 'rock'\ndensity_kg_per_m3 = 2700\n"), ContainsSubstring("scene.toml: block: the scene has none"));
}

TEST_CASE("unknown key", "[cli][bad_input]") {
  CHECK_THAT(refusal_with(9, "friction_angel_deg = 35"), ContainsSubstring("scene.toml:9: joint[0].friction_angel_deg: "));
  CHECK_THAT(refusal_of_scene(block_on_base + "[methods]\n"), ContainsSubstring("scene.toml:22: methods: "));
}

TEST_CASE("wrong unit suffix", "[cli][bad_input]") {
  CHECK_THAT(refusal_with(9, "friction_angle_rad = 0.6"),
             ContainsSubstring("joint[0].friction_angle_rad: ") && ContainsSubstring("friction_angle_deg"));
  CHECK_THAT(refusal_with(3, "density_g_per_cm3 = 2.7"),
             ContainsSubstring("material[0].density_g_per_cm3: ") && ContainsSubstring("density_kg_per_m3"));
  CHECK_THAT(refusal_of_scene(block_on_base + "[step]\ndt_ms = 1\n"), ContainsSubstring("step.dt_ms: ") && ContainsSubstring("dt_s"));
}

TEST_CASE("numbers that are none", "[cli][bad_input]") {
  CHECK_THAT(refusal_with(3, "density_kg_per_m3 = nan"),
             ContainsSubstring("scene.toml:3: material[0].density_kg_per_m3: nan is not a finite number"));
  CHECK_THAT(refusal_with(7, "normal_stiffness_pa_per_m = inf"), ContainsSubstring("joint[0].normal_stiffness_pa_per_m: inf is not a finite number"));
  CHECK_THAT(refusal_with_vertices("[[0, 0], [1, nan], [1, 1]]"), ContainsSubstring("block[1].vertices_m[1][1]: nan is not a finite number"));
  const Workplace place;
  CHECK_THAT(refusal(place, "run scene.toml -o out --dt nan --end 1"), ContainsSubstring("step.dt_s: nan is not a finite number"));
  CHECK_THAT(refusal(place, "run scene.toml -o out --dt 0.1 --end inf"), ContainsSubstring("end.time_s: inf is not a finite number"));
}

TEST_CASE("negative density", "[cli][bad_input]") {
  CHECK_THAT(refusal_with(3, "density_kg_per_m3 = -2700"),
             ContainsSubstring("material[0].density_kg_per_m3: -2700 is out of range; accepted: a number > 0"));
}

TEST_CASE("zero or negative stiffness", "[cli][bad_input]") {
  CHECK_THAT(refusal_with(7, "normal_stiffness_pa_per_m = 0"), ContainsSubstring("joint[0].normal_stiffness_pa_per_m: 0 is out of range"));
  CHECK_THAT(refusal_with(7, "normal_stiffness_pa_per_m = -1e9"),
             ContainsSubstring("joint[0].normal_stiffness_pa_per_m: -1000000000 is out of range"));
  CHECK_THAT(refusal_with(8, "shear_stiffness_pa_per_m = 0.0"), ContainsSubstring("joint[0].shear_stiffness_pa_per_m: 0 is out of range"));
  CHECK_THAT(refusal_with(8, "shear_stiffness_pa_per_m = -1"), ContainsSubstring("joint[0].shear_stiffness_pa_per_m: -1 is out of range"));
}

TEST_CASE("zero step", "[cli][bad_input]") {
  CHECK_THAT(refusal_of_scene(block_on_base + "[step]\ndt_s = 0\n", " --set step.dt_s=0.0"), ContainsSubstring("step.dt_s: 0 is out of range"));
  const Workplace place;
  CHECK_THAT(refusal(place, "run scene.toml -o out --dt 0 --end 1"), ContainsSubstring("step.dt_s: 0 is out of range; accepted: a number > 0"));
  CHECK_THAT(refusal(place, "run scene.toml -o out --dt -0.1 --end 1"), ContainsSubstring("step.dt_s: -0.1 is out of range"));
}

TEST_CASE("polygon with two points", "[cli][bad_input]") {
  CHECK_THAT(refusal_with_vertices("[[0, 0], [1, 0]]"),
             ContainsSubstring("scene.toml:20: block[1].vertices_m: the polygon has 2 vertices; accepted: at least 3"));
}

TEST_CASE("self-intersecting polygon", "[cli][bad_input]") {
  CHECK_THAT(refusal_with_vertices("[[0, 0], [1, 1], [1, 0], [0, 1]]"),
             ContainsSubstring("block[1].vertices_m: the polygon intersects or touches itself"));
}

TEST_CASE("zero-area sliver", "[cli][bad_input]") {
  CHECK_THAT(refusal_with_vertices("[[0, 0], [1, 0], [0.5, 1e-9]]"), ContainsSubstring("block[1].vertices_m: the polygon has an area of 5e-10 m2"));
  CHECK_THAT(refusal_with_vertices("[[0, 0], [1, 0], [2, 0]]"), ContainsSubstring("block[1].vertices_m: the polygon has an area of 0 m2"));
}

TEST_CASE("clockwise polygon is turned", "[cli][bad_input]") {
  const Workplace counterclockwise, clockwise(with_line(block_on_base, 20, "vertices_m = [[0, 0], [0, 1], [1, 1], [1, 0]]"));
  const std::string arguments = "run scene.toml -o out --quiet --set 'load=[{block=\"block\", point_m=[0.5, 1], force_n=[100, 0]}]'" + steps;
  for (const Workplace* place : {&counterclockwise, &clockwise}) {
    const CommandResult result = place->run(arguments);
    CHECK(result.status == 0);
    CHECK(result.errors.empty());
  }
  const auto lines_a = openclose::test::lines_of(counterclockwise.folder() / "out/history.csv");
  const auto lines_b = openclose::test::lines_of(clockwise.folder() / "out/history.csv");
  REQUIRE(lines_a.size() == 12);
  REQUIRE(lines_b.size() == 12);
  for (std::size_t i = 1; i < lines_a.size(); ++i) {
    const auto fields_a = openclose::test::fields_of(lines_a[i]), fields_b = openclose::test::fields_of(lines_b[i]);
    // The sums over the vertices run in another order, which shows in the last digits.
    for (int k : {2, 3, 4}) CHECK(std::stod(fields_a[k]) == Approx(std::stod(fields_b[k])).epsilon(1e-9).margin(1e-13));
  }
}

TEST_CASE("blocks that overlap deeper than the stated depth", "[cli][bad_input]") {
  CHECK_THAT(
      refusal_with_vertices("[[0, -0.002], [1, -0.002], [1, 1], [0, 1]]"),
      ContainsSubstring("scene.toml:17: block: \"block\" overlaps \"base\" (line 11)") && ContainsSubstring("accepted: overlaps of at most 0.001 m"));
  const Workplace place(with_line(block_on_base, 20, "vertices_m = [[0, -0.0009], [1, -0.0009], [1, 1], [0, 1]]"));
  CHECK(place.run("check scene.toml").status == 0);
}

TEST_CASE("unknown material", "[cli][bad_input]") {
  CHECK_THAT(refusal_with(19, "material = \"roc\""),
             ContainsSubstring("scene.toml:19: block[1].material: there is no material \"roc\", did you mean \"rock\"?; accepted: \"rock\""));
}

TEST_CASE("missing joint", "[cli][bad_input]") {
  const std::string clay = "[[material]]\nname = 'clay'\ndensity_kg_per_m3 = 2000\n";
  CHECK_THAT(refusal_of_scene(with_line(block_on_base, 19, "material = 'clay'") + clay),
             ContainsSubstring("joint: none for the materials \"rock\" and \"clay\""));
}

TEST_CASE("nothing fixed under gravity is worth a warning only", "[cli][bad_input]") {
  const Workplace place(with_line(block_on_base, 15, ""));
  const std::string warning = "openclose: warning: scene.toml: nothing is fixed or supported under gravity: every block will fall";
  SECTION("check") {
    const CommandResult result = place.run("check scene.toml");
    CHECK(result.status == 0);
    CHECK(result.errors == std::vector<std::string>{warning});
  }
  SECTION("run") {
    const CommandResult result = place.run("run scene.toml -o out --quiet --start unloaded" + steps);
    CHECK(result.status == 0);
    CHECK(result.errors == std::vector<std::string>{warning});
    CHECK_THAT(openclose::test::text_of(place.folder() / "out/summary.json"), ContainsSubstring("every block will fall"));
  }
}

TEST_CASE("unknown method", "[cli][bad_input]") {
  const std::string in_file = refusal_of_scene(block_on_base + "[method]\ncontact = 'firm'\n");
  CHECK_THAT(in_file, ContainsSubstring("scene.toml:23: method.contact: \"firm\""));
  for (const std::string& message : {in_file, refusal_of_scene(block_on_base, " --contact firm")}) {
    CHECK_THAT(message, ContainsSubstring("method.contact: \"firm\"") && ContainsSubstring("\"soft\"") && ContainsSubstring("\"hard\"") &&
                            ContainsSubstring("\"shi\""));
  }
  // What a message quotes neither ends it nor breaks its line.
  CHECK_THAT(refusal_of_scene(block_on_base + "[method]\ncontact = \"a\\u0000b\\u001b[31m\\nc\"\n"),
             ContainsSubstring("method.contact: \"a\\x00b\\x1b[31m\\x0ac\" is no known") && ContainsSubstring("accepted: "));
}

TEST_CASE("a method that has no use for theta", "[cli][bad_input]") {
  CHECK_THAT(refusal_of_scene(block_on_base, " --contact hard --set method.theta=0.5"), ContainsSubstring("method.theta: "));
  CHECK_THAT(refusal_of_scene(block_on_base, " --contact shi --set method.theta=0.5"), ContainsSubstring("method.theta: "));
}

TEST_CASE("unknown start", "[cli][bad_input]") {
  CHECK_THAT(refusal_of_scene(block_on_base, " --start sliding"),
             ContainsSubstring("method.start: \"sliding\" is not known") && ContainsSubstring("\"steady_sliding\""));
}

TEST_CASE("a start that the scene does not have", "[cli][bad_input]") {
  const Workplace place(block_on_base + "[[block]]\nname = 'top'\nmaterial = 'rock'\nvertices_m = [[0, 1], [1, 1], [1, 2], [0, 2]]\n");
  CHECK_THAT(refusal(place, "run scene.toml -o out --start steady_sliding" + steps),
             ContainsSubstring("block: \"block\" rests on a block that is not fixed"));
}

TEST_CASE("unwritable output folder", "[cli][bad_input]") {
  const Workplace place;
  place.folder().write("file", "kept");
  for (const std::string& command : {"run scene.toml" + steps, std::string("fos scene.toml")}) {
    for (const std::string folder : {"file", "file/below", "/proc/openclose"}) {
      CHECK_THAT(refusal(place, command + " -o " + folder), ContainsSubstring(folder + ": cannot write to this output folder"));
    }
  }
  CHECK(openclose::test::text_of(place.folder() / "file") == "kept");
}

TEST_CASE("missing step or end", "[cli][bad_input]") {
  const Workplace place;
  CHECK_THAT(refusal(place, "run scene.toml -o out --end 1"), ContainsSubstring("scene.toml: step.dt_s: missing") && ContainsSubstring("--dt"));
  CHECK_THAT(refusal(place, "run scene.toml -o out --dt 0.1"), ContainsSubstring("scene.toml: end.time_s: missing") && ContainsSubstring("--end"));
  CHECK_THAT(refusal(place, "fos scene.toml -o out --set strength_reduction.curve_time_s=1"), ContainsSubstring("scene.toml: step.dt_s: missing"));
  CHECK_THAT(refusal(place, "fos scene.toml -o out --set settle.criterion=paper"),
             ContainsSubstring("scene.toml: step.dt_s: missing") && ContainsSubstring("settle.criterion asks for motion"));
  CHECK_THAT(refusal(place, "run scene.toml -o out --dt 0.1 --set end.displacement_m=1"), ContainsSubstring("scene.toml: end.time_s: missing"));
}

TEST_CASE("options of a run that mean nothing", "[cli][bad_input]") {
  CHECK_THAT(refusal_of_scene(block_on_base, " --set run.strength_reduction_factor=0"),
             ContainsSubstring("run.strength_reduction_factor: 0 is out of range"));
  CHECK_THAT(refusal_of_scene(block_on_base, " --set end.displacement_m=-1"), ContainsSubstring("end.displacement_m: -1 is out of range"));
  CHECK_THAT(refusal_of_scene(block_on_base, " --set output.milestones_m=[2,1]"), ContainsSubstring("output.milestones_m[1]: 1 follows 2"));
  CHECK_THAT(refusal_of_scene(block_on_base, " --set output.snapshots_s=[-1]"), ContainsSubstring("output.snapshots_s[0]: -1 is out of range"));
  CHECK_THAT(refusal_of_scene(block_on_base, " --set settle.criterion=force"), ContainsSubstring("settle.criterion: \"force\" is not known"));
  CHECK_THAT(refusal_of_scene(block_on_base, " --set settle.relative_displacement=1"),
             ContainsSubstring("settle.relative_displacement: 1 is out of range"));
}

TEST_CASE("more steps than anyone waits for", "[cli][bad_input]") {
  const Workplace place;
  CHECK_THAT(refusal(place, "run scene.toml -o out --dt 0.001 --end 1e300"),
             ContainsSubstring("end.time_s: 1e+300 s in steps of 0.001 s; accepted: at most 1e+09"));
  CHECK_THAT(refusal(place, "run scene.toml -o out --dt 1e-16 --end 0.1"), ContainsSubstring("end.time_s"));
  CHECK_THAT(refusal(place, "fos scene.toml -o out --dt 1e-16 --set strength_reduction.curve_time_s=1"),
             ContainsSubstring("strength_reduction.curve_time_s"));
}

TEST_CASE("check refuses what run or fos would refuse, in the same words", "[cli][bad_input]") {
  const Workplace place;
  const auto refused_by_check_and = [&](const std::string& command, const std::string& arguments) {
    CHECK(refusal(place, "check scene.toml" + arguments) == refusal(place, command + " scene.toml -o out" + arguments));
  };
  refused_by_check_and("run", " --dt 0.001 --end 1e18");
  refused_by_check_and("run", " --dt 1e-320 --end 1");
  refused_by_check_and("run", steps + " --start steady_sliding --set 'block[1].vertices_m=[[0, 5], [1, 5], [1, 6], [0, 6]]'");
  refused_by_check_and("fos", " --dt 1e-16 --set strength_reduction.curve_time_s=1");
  refused_by_check_and("fos", " --set strength_reduction.curve_time_s=1");
  refused_by_check_and("fos", " --set settle.criterion=paper");
  // A step or an end for the command line, or none for fos.
  for (const char* arguments : {"", " --dt 0.001", " --end 1", " --start steady_sliding"})
    CHECK(place.run(std::string("check scene.toml") + arguments).status == 0);
}

TEST_CASE("overrides that cannot be", "[cli][bad_input]") {
  CHECK_THAT(refusal_of_scene(block_on_base, " --set joint[7].friction_angle_deg=20"), ContainsSubstring("joint[7]"));
  CHECK_THAT(refusal_of_scene(block_on_base, " --set method.thetta=0.6"), ContainsSubstring("method.thetta"));
  CHECK_THAT(refusal_of_scene(block_on_base, " --set method.theta"), ContainsSubstring("method.theta"));
  CHECK_THAT(refusal_of_scene(block_on_base, " --set method.theta=often"), ContainsSubstring("method.theta: \"often\" is a string"));
}

TEST_CASE("bad options", "[cli][bad_input]") {
  const Workplace place;
  CHECK_THAT(refusal(place, "run scene.toml -o out --fast" + steps), ContainsSubstring("--fast") && ContainsSubstring("see openclose run --help"));
  CHECK_THAT(refusal(place, "run" + steps), ContainsSubstring("scene"));
  CHECK_THAT(refusal(place, ""), ContainsSubstring("subcommand is required; accepted: run, fos, check, cut, draw"));
  CHECK_THAT(refusal(place, "walk scene.toml"), ContainsSubstring("see openclose --help"));
  CHECK_THAT(refusal(place, "check scene.toml -o out"), ContainsSubstring("-o"));
  CHECK_THAT(refusal(place, "run scene.toml -o out --end 1 --dt"), ContainsSubstring("--dt"));
  CHECK_THAT(refusal(place, "run scene.toml other.toml -o out" + steps), ContainsSubstring("other.toml"));
}

TEST_CASE("a record that is not there", "[cli][bad_input]") {
  CHECK_THAT(refusal_of_scene(block_on_base + "[base_motion]\nkind = 'record'\nhorizontal_file = 'nowhere.AT2'\n"),
             ContainsSubstring("nowhere.AT2: there is no such file"));
}

TEST_CASE("a method that cannot settle the scene is refused before anything is written", "[cli][bad_input]") {
  const Workplace place(block_on_base + "[method]\nrotation = \"linear\"\n[run]\nsettled_by = \"dem\"\n");
  const std::string message = refusal(place, "run scene.toml -o out" + steps);
  CHECK_THAT(message, ContainsSubstring("scene.toml:25: run.settled_by: \"dem\" cannot settle this scene: ") &&
                          ContainsSubstring("method.rotation: \"linear\" has no meaning"));
  CHECK(refusal(place, "check scene.toml") == message);
  CHECK(place.run("run scene.toml -o out --set run.settled_by=soft" + steps).status == 0);
}

TEST_CASE("methods that have no use for keys of the step name their lines", "[cli][bad_input]") {
  const std::string scene = block_on_base + "[method]\ncontact = \"dem\"\n[step]\n";
  CHECK_THAT(refusal_of_scene(scene + "look_ahead = 0.5\n"), ContainsSubstring("scene.toml:25: step.look_ahead: has no meaning"));
  CHECK_THAT(refusal_of_scene(scene + "adaptive = true\n"), ContainsSubstring("scene.toml:25: step.adaptive: true has no meaning"));
}

TEST_CASE("a word that is no command is named", "[cli][bad_input]") {
  const Workplace place;
  CHECK_THAT(refusal(place, "chek scene.toml"),
             ContainsSubstring("chek: there is no such command, did you mean check?; accepted: run, fos, check, "));
}

TEST_CASE("loads that fos cannot increase", "[cli][bad_input]") {
  const Workplace place;
  CHECK_THAT(refusal(place, "fos scene.toml --increase gravity_z"),
             ContainsSubstring("strength_reduction.increase: no load or surcharge has the name \"gravity_z\", did you mean \"gravity_x\"?; accepted: "
                               "\"gravity_x\", \"gravity_y\""));
  for (const std::string definition : {"joint_closures", "large_displacements"}) {
    const std::string options = " --set strength_reduction.increase=gravity_x --set strength_reduction.definition=" + definition;
    const std::string message = refusal(place, "fos scene.toml" + options);
    CHECK_THAT(message, ContainsSubstring("strength_reduction.increase: a load grows on the drawn geometry only; accepted: "
                                          "strength_reduction.definition = \"small_displacements\""));
  }
  CHECK_THAT(refusal(place, "run scene.toml --increase gravity_x"), ContainsSubstring("--increase"));
}

TEST_CASE("a misspelt command, option or word is told what may be meant, and which help has more", "[cli][errors]") {
  const Workplace place;
  const std::map<std::string, std::string> meant = {
      {"fso scene.toml", "did you mean fos?"},
      {"fos scene.toml --contcat hard", "--contcat: fos has no such option, did you mean --contact?"},
      {"fos scene.toml --contact hrad", "did you mean hard?"},
      {"draw out --colour displacment", "--colour: \"displacment\" is not known, did you mean displacement?"},
      {"fos scene.toml --nothing", "see openclose fos --help"},
      {"fos scene.toml more", "more: fos expects no such word here"},
      {"check scene.toml --set output.formats=vtk", "output.formats: \"vtk\" is a string; accepted: a list, e.g. [\"vtk\"]"},
      {"fos scene.toml -o /", "/: -o: this is the root of the file system"},
      {"sweep scene.toml --vary joint[0].friction_angle_deg=20 -o /", "/: -o: this is the root of the file system"}};
  for (const auto& [arguments, words] : meant) {
    INFO(arguments);
    const CommandResult result = place.run(arguments);
    CHECK(result.status == 2);
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], ContainsSubstring(words));
  }
}

TEST_CASE("the help of cut and check leaves out what they do not use", "[cli]") {
  const Workplace place;
  for (const std::string option : {"--dt", "--threads", "--integrator", "--contact"})
    CHECK_THAT(place.run("cut --help").out, !ContainsSubstring(option));
  CHECK_THAT(place.run("check --help").out, !ContainsSubstring("--threads") && ContainsSubstring("--dt"));
  CHECK(place.run("check scene.toml --threads 1").status == 0);
}
