#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <set>
#include <string>

#include "cli/command.h"
#include "openclose/version.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using openclose::test::block_on_base;
using openclose::test::CommandResult;
using openclose::test::fields_of;
using openclose::test::lines_of;
using openclose::test::text_of;
using openclose::test::Workplace;

namespace {

nlohmann::json summary_in(const std::string& folder) {
  return nlohmann::json::parse(text_of(folder + "/summary.json"));
}

std::set<std::string> entries(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

/// What a run has written before it ends.
const std::set<std::string> tables_of_run = {"block_properties.csv", "block_states.csv", "blocks.csv",         "contacts.csv", "cracks.csv",
                                             "energy.csv",           "history.csv",      "scene_as_read.toml", ".openclose"};

/// But for the list of names, which has the sum of summary.json with its CPU times.
void check_same_tables(const Workplace& place, const std::string& a, const std::string& b) {
  for (const std::string& file : tables_of_run) {
    if (file != ".openclose") CHECK(text_of(place.folder() / (a + "/" + file)) == text_of(place.folder() / (b + "/" + file)));
  }
}

}  // namespace

TEST_CASE("help and version", "[cli]") {
  const Workplace place;
  const CommandResult help = place.run("--help"), run_help = place.run("run --help"), version = place.run("--version");
  for (const CommandResult* result : {&help, &run_help, &version}) {
    CHECK(result->status == 0);
    CHECK(result->errors.empty());
  }
  CHECK_THAT(help.out, ContainsSubstring("run") && ContainsSubstring("fos") && ContainsSubstring("check") && ContainsSubstring("Exit status"));
  CHECK_THAT(run_help.out, ContainsSubstring("--contact") && ContainsSubstring("--dt") && ContainsSubstring("--end") &&
                               ContainsSubstring("--start") && ContainsSubstring("--set") && ContainsSubstring("--output") &&
                               ContainsSubstring("--quiet"));
  for (const char* name : {"soft", "hard", "shi", "dem", "path_average"}) CHECK_THAT(run_help.out, ContainsSubstring(std::string(name) + " ("));
  CHECK(version.out == std::string(openclose::version) + "\n");
}

TEST_CASE("run writes its files and one line", "[cli]") {
  const Workplace place;
  const CommandResult result = place.run("run scene.toml -o out --dt 0.001 --end 0.01");
  CHECK(result.status == 0);
  CHECK(result.errors.empty());
  CHECK_THAT(result.out, StartsWith("soft: 2 blocks, ") && ContainsSubstring("written to out"));
  CHECK(std::count(result.out.begin(), result.out.end(), '\n') == 1);
  const std::string out = place.folder() / "out";
  std::set<std::string> written = tables_of_run;
  written.insert("summary.json");
  CHECK(entries(out) == written);
  CHECK(place.folder().entries() == std::set<std::string>{"scene.toml", "out"});

  const auto history = lines_of(out + "/history.csv");
  REQUIRE(history.size() == 1 + 11);
  CHECK_THAT(history[1], StartsWith("0,block,0,0,0,0,0"));
  CHECK(std::stod(history[11]) == 10 * 0.001);
  CHECK(lines_of(out + "/energy.csv").size() == 1 + 11);
  CHECK(lines_of(out + "/blocks.csv").size() == 1 + 3 * 8);

  // Settled: W/(kn L) with W = 2700 * 9.81 on 1 m.
  const auto contacts = lines_of(out + "/contacts.csv");
  REQUIRE(contacts.size() == 1 + 2 * 2);
  CHECK(std::stod(fields_of(contacts[1])[8]) == Approx(-2700.0 * 9.81 / 1e9).epsilon(1e-6));

  const auto summary = summary_in(out);
  CHECK(summary.at("version") == openclose::version);
  CHECK(summary.at("command") == "run");
  CHECK(summary.at("scene") == "scene.toml");
  CHECK(summary.at("converged") == true);
  CHECK(summary.at("reason") == "");
  CHECK(summary.at("blocks") == 2);
  CHECK(summary.at("free_blocks") == 1);
  CHECK(summary.at("time_s") == 10 * 0.001);
  CHECK(summary.at("max_penetration_m").get<double>() == Approx(2700.0 * 9.81 / 1e9).epsilon(1e-6));
  for (const char* key : {"options", "counters", "stage_s", "overrides", "warnings", "settling"}) CHECK(summary.contains(key));
}

TEST_CASE("quiet runs say nothing", "[cli]") {
  const Workplace place;
  for (const std::string arguments : {"run scene.toml -o out --dt 0.001 --end 0.01 -q", "run scene.toml -o out --dt 0.001 --end 0.01 --quiet"}) {
    const CommandResult result = place.run(arguments);
    CHECK(result.status == 0);
    CHECK(result.out.empty());
    CHECK(result.errors.empty());
  }
}

TEST_CASE("the output folder is named like the scene where none is given", "[cli]") {
  const Workplace place;
  CHECK(place.run("run ./scene.toml --dt 0.001 --end 0.002").status == 0);
  CHECK(std::filesystem::is_regular_file(place.folder() / "results/scene/summary.json"));
}

TEST_CASE("a second run replaces the files of the first", "[cli]") {
  const Workplace place;
  CHECK(place.run("run scene.toml -o out --dt 0.001 --end 0.05").status == 0);
  const auto longer = lines_of(place.folder() / "out/history.csv");
  CHECK(place.run("run scene.toml -o out --dt 0.001 --end 0.01").status == 0);
  CHECK(longer.size() == 52);
  CHECK(lines_of(place.folder() / "out/history.csv").size() == 12);
}

TEST_CASE("a folder has the results of one run only, beside files of the user's own", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  const auto in_out = [&] { return entries(place.folder() / "out"); };
  const std::string run = "run scene.toml -o out --dt 0.001 --end 0.01 ";
  std::set<std::string> killed = tables_of_run;
  killed.insert("mine.csv");
  std::set<std::string> bare = killed;
  bare.insert("summary.json");
  REQUIRE(place.run(run + "--set output.milestones_m=[9] --set output.checkpoint_every_s=1").status == 0);
  place.folder().write("out/mine.csv", "kept");
  place.folder().write("out/checkpoint.bin.part", "of a run that was killed");
  std::ofstream(place.folder() / "out/.openclose", std::ios::app) << "checkpoint.bin.part\n";

  SECTION("another run") {
    CHECK(place.run(run).status == 0);
    CHECK(in_out() == bare);
  }
  SECTION("a factor of safety, and a run again") {
    CHECK(place
              .run("fos scene.toml -o out --dt 0.001 --set strength_reduction.definition=large_displacements --set strength_reduction.width=1 --set "
                   "settle.failure_displacement_m=0.05 --set "
                   "strength_reduction.curve=[1.1] "
                   "--set strength_reduction.curve_time_s=0.01")
              .status == 0);
    CHECK(in_out() == std::set<std::string>{"block_properties.csv", "block_states.csv", "blocks.csv", "contacts.csv", "cracks.csv", "curve.csv",
                                            "mine.csv", "scene_as_read.toml", "summary.json", "trials.csv", ".openclose"});
    CHECK(place.run(run).status == 0);
    CHECK(in_out() == bare);
  }
  SECTION("a run that is killed leaves no summary of the one before") {
    place.run("run scene.toml -o out --dt 0.001 --end 1000", "ulimit -t 1; ");
    CHECK(in_out() == killed);
  }
  SECTION("a run that is refused") {
    const auto before = in_out();
    CHECK(place.run(run + "--set method.thetta=1").status == 2);
    CHECK(place.run("run scene.toml -o out --dt 0.001 --end 1e18").status == 2);
    CHECK(place.run(run + "--start steady_sliding --set 'block[1].vertices_m=[[0, 5], [1, 5], [1, 6], [0, 6]]'").status == 2);
    CHECK(place.run(run + "--restart nowhere.bin").status == 2);
    CHECK(place.run("fos scene.toml -o out --set strength_reduction.curve_time_s=1").status == 2);
    CHECK(in_out() == before);
    CHECK(before.count("milestones.csv") == 1);
  }
  CHECK(text_of(place.folder() / "out/mine.csv") == "kept");
}

TEST_CASE("a result that cannot be written to its end breaks the command off", "[cli]") {
  const Workplace place;
  const auto broken_off_at = [&](const std::string& file, const std::string& arguments) {
    const CommandResult result = place.run(arguments, "ulimit -f 16; ");
    INFO(arguments);
    CHECK(result.status == 3);
    CHECK(result.out.empty());
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], StartsWith("openclose: ") && ContainsSubstring(place.folder() / file + ": cannot be written to its end"));
  };
  const std::string out = place.folder() / "out";
  // Long before the run would end.
  broken_off_at("out/history.csv", "run scene.toml --dt 0.001 --end 1000 -o " + out);
  CHECK(entries(place.folder() / "out") == tables_of_run);
  const std::string cut =
      "[domain]\nmaterial = 'rock'\nvertices_m = [[-30, -9], [30, -9], [30, -3], [-30, -3]]\n"
      "[[joint_set]]\ndip_deg = 90\nspacing_m = 0.1\norigin_m = [0, 0]\n";
  place.folder().write("scene.toml", block_on_base + cut);
  broken_off_at("cut/blocks.toml", "cut scene.toml -o " + place.folder() / "cut/blocks.toml");
  CHECK_FALSE(std::filesystem::exists(place.folder() / "cut"));
}

TEST_CASE("the same run twice gives the same files bit for bit", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  const std::string arguments = " --dt 0.001 --end 0.1 --start unloaded";
  CHECK(place.run("run scene.toml -o a" + arguments).status == 0);
  CHECK(place.run("run scene.toml -o b" + arguments).status == 0);
  check_same_tables(place, "a", "b");
}

TEST_CASE("overrides change the scene and are on record", "[cli]") {
  const Workplace place(block_on_base + "[method]\ncontact = 'hard'\n[step]\ndt_s = 0.1\n[end]\ntime_s = 9\n");
  const CommandResult result = place.run(
      "run scene.toml -o out --contact shi --dt 0.001 --end 0.004 --start unloaded --set method.penalty_pa_per_m=5e9 --set title=renamed "
      "--set joint[0].friction_angle_deg=20");
  CHECK(result.status == 0);
  const auto summary = summary_in(place.folder() / "out");
  CHECK(summary.at("options").at("method").at("contact") == "shi");
  CHECK(summary.at("options").at("method").at("start") == "unloaded");
  CHECK(summary.at("options").at("step").at("dt_s") == 0.001);
  CHECK(summary.at("options").at("end").at("time_s") == 0.004);
  CHECK(summary.at("title") == "renamed");
  CHECK(summary.at("counters").at("steps") == 4);
  CHECK(summary.at("overrides").size() == 7);
  CHECK(text_of(place.folder() / "out/summary.json").find("joint[0].friction_angle_deg=20") != std::string::npos);
}

TEST_CASE("an overridden friction angle decides whether a block slides", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  CHECK(place.run("run scene.toml -o out --dt 0.001 --end 0.01").status == 0);
  const CommandResult result =
      place.run("run scene.toml -o out --dt 0.001 --end 0.01 --set joint[0].friction_angle_deg=29 --set settle.failure_displacement_m=0.05");
  CHECK(result.status == 1);
}

TEST_CASE("steady sliding through the whole command", "[cli]") {
  const double slope = 30.0, phi = 20.0, degree = std::numbers::pi / 180.0;
  const Workplace place(openclose::test::block_on_incline(slope));
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    const CommandResult result = place.run("run scene.toml -o out --dt 0.001 --end 0.3 --start steady_sliding --set output.every_s=0.1 --contact " +
                                           method + " --set joint[0].friction_angle_deg=20");
    CHECK(result.status == 0);
    const auto history = lines_of(place.folder() / "out/history.csv");
    REQUIRE(history.size() == 1 + 4);
    const auto last = fields_of(history.back());
    const double exact = 0.5 * 9.81 * (std::sin(slope * degree) - std::tan(phi * degree) * std::cos(slope * degree)) * 0.3 * 0.3;
    CHECK(std::hypot(std::stod(last[2]), std::stod(last[3])) == Approx(exact).epsilon(1e-9));
  }
}

TEST_CASE("factor of safety", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  const double exact = std::tan(35.0 * std::numbers::pi / 180.0) / std::tan(30.0 * std::numbers::pi / 180.0);
  const CommandResult result = place.run("fos scene.toml -o out");
  CHECK(result.status == 0);
  CHECK(result.errors.empty());
  CHECK_THAT(result.out, StartsWith("factor of safety 1.21") && ContainsSubstring("soft") && ContainsSubstring("limit analysis"));
  const std::string out = place.folder() / "out";
  CHECK(entries(out) == std::set<std::string>{"block_properties.csv", "block_states.csv", "blocks.csv", "contacts.csv", "cracks.csv", "mechanism.csv",
                                              "scene_as_read.toml", "summary.json", "trials.csv", ".openclose"});
  const auto summary = summary_in(out);
  CHECK(summary.at("command") == "fos");
  CHECK(summary.at("converged") == true);
  CHECK(summary.at("factor_of_safety").get<double>() == Approx(exact).margin(2e-4));
  CHECK(summary.at("verdict") == "certified");
  CHECK(summary.at("bracket").at("stable") == summary.at("factor_of_safety"));
  CHECK(summary.at("bracket").at("failed").get<double>() > exact * (1.0 - 1e-5));
  CHECK_FALSE(summary.at("bracket").at("failed_by").get<std::string>().empty());
  CHECK(summary.at("limit_analysis").at("factor").get<double>() == Approx(exact).margin(2e-5));
  std::set<std::string> states;
  for (const std::string& line : lines_of(out + "/blocks.csv")) states.insert(line.substr(0, line.find(',')));
  CHECK(states == std::set<std::string>{"state", "initial", "stable", "failed"});
  CHECK_THAT(text_of(out + "/trials.csv"), StartsWith("srf,stage,stable,criterion,steps,displacement_m\n1,bracket,1,"));
}

TEST_CASE("the multiplier of a load", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(15.0));
  const double exact = std::tan(20.0 * std::numbers::pi / 180.0);
  const CommandResult result = place.run("fos scene.toml --increase gravity_x -o out");
  CHECK(result.status == 0);
  CHECK(result.errors.empty());
  CHECK_THAT(result.out, StartsWith("multiplier of gravity_x 0.3639") && ContainsSubstring("certified: stable at 0.3639") &&
                             ContainsSubstring("rigid-block limit analysis: at most 0.36397"));
  const auto summary = summary_in(place.folder() / "out");
  CHECK(summary.at("factor_of_safety").is_null());
  CHECK(summary.at("load_multiplier").get<double>() == Approx(exact).epsilon(1e-4));
  CHECK(summary.at("options").at("strength_reduction").at("increase") == "gravity_x");
  CHECK(summary.at("limit_analysis").at("factor").get<double>() == Approx(exact).epsilon(2e-5));
  CHECK_THAT(text_of(place.folder() / "out/trials.csv"), StartsWith("multiplier,stage,stable,criterion,steps,displacement_m\n0,bracket,1,"));
  // Uphill, and as a key of the scene.
  CHECK_THAT(place.run("fos scene.toml --increase=-gravity_x -o up").out, StartsWith("multiplier of -gravity_x 1.191"));
  CHECK_THAT(place.run("fos scene.toml --set strength_reduction.increase=-gravity_x -o up").out, StartsWith("multiplier of -gravity_x 1.191"));
  CHECK_THAT(place.run("fos scene.toml --increase gravity_x --set strength_reduction.upper_limit=0.2 -o out").out,
             StartsWith("multiplier of gravity_x above 0.2 (soft): still stable at strength_reduction.upper_limit"));
  const CommandResult slides = place.run("fos scene.toml --increase gravity_x --set joint[0].friction_angle_deg=10 -o out");
  CHECK(slides.status == 1);
  REQUIRE(slides.errors.size() == 1);
  CHECK_THAT(slides.errors[0], ContainsSubstring("no multiplier of gravity_x: not stable before gravity_x grows (mechanism)"));
  REQUIRE(place.run("fos scene.toml --increase gravity_x -o out -q").status == 0);
  REQUIRE(place.run("draw out").status == 0);
  CHECK_THAT(text_of(place.folder() / "out/drawing.svg"), ContainsSubstring("multiplier of gravity_x 0.3639"));
}

TEST_CASE("factor of safety: the settled state penetrates by what its contacts carry, the failed one has moved", "[cli]") {
  const double slope = 30.0 * std::numbers::pi / 180.0;
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place
              .run("fos scene.toml -o out --set strength_reduction.definition='large_displacements' --set settle.failure_displacement_m=0.05 "
                   "--set strength_reduction.width=0.01")
              .status == 0);
  const std::string out = place.folder() / "out";
  const auto summary = summary_in(out);
  REQUIRE(summary.at("bracket").at("failed_by") == "displacement");

  // The block is 2 m long and 1 m high; its weight, 0.5 m above its two contacts of 1 m each, leans on the lower one.
  const double weight = 2700.0 * 9.81 * 2.0, lower = 0.5 * weight * std::cos(slope) * (1.0 + 0.5 * std::tan(slope));
  // The block tilts by 1e-5, which turns the forces by as much.
  CHECK(summary.at("max_penetration_m").get<double>() == Approx(lower / 1e9).epsilon(1e-4));

  std::map<std::string, std::pair<double, double>> corner;
  for (const std::string& line : lines_of(out + "/blocks.csv")) {
    const auto fields = fields_of(line);
    if (fields[1] == "block" && fields[2] == "0") corner[fields[0]] = {std::stod(fields[3]), std::stod(fields[4])};
  }
  const double along = (corner.at("failed").first - corner.at("settled").first) * std::cos(slope) -
                       (corner.at("failed").second - corner.at("settled").second) * std::sin(slope);
  // What counts as displacement is that of the farthest point, which the tilt moves by 1e-5 m more.
  CHECK(along > 0.05 - 1e-4);
}

TEST_CASE("fos warns of what it is given for steps in time and does not take", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  const auto trials = [&](const std::string& arguments, std::size_t warnings) {
    INFO(arguments);
    const CommandResult result =
        place.run("fos scene.toml -o out -q --set strength_reduction.width=0.1 --set settle.failure_displacement_m=0.05 " + arguments);
    CHECK(result.status == 0);
    const auto warns = [](const std::string& line) { return line.find("has no effect on fos") != std::string::npos; };
    CHECK(static_cast<std::size_t>(std::ranges::count_if(result.errors, warns)) == warnings);
    if (warnings > 0) CHECK_THAT(result.errors[0], StartsWith("openclose: warning: scene.toml: command line: step.dt_s has no effect on fos"));
    const nlohmann::json summary = nlohmann::json::parse(text_of(place.folder() / "out/summary.json"));
    CHECK(std::ranges::count_if(summary.at("warnings"), [&](const nlohmann::json& text) { return warns(text.get<std::string>()); }) ==
          static_cast<std::ptrdiff_t>(warnings));
    return text_of(place.folder() / "out/trials.csv");
  };
  const std::string given = " --dt 0.02 --integrator path_average --set 'method.dissipation = 0.5'";
  for (const std::string definition : {"small_displacements", "joint_closures", "large_displacements"}) {
    const std::string common = "--set strength_reduction.definition=" + definition;
    CHECK(trials(common, 0) == trials(common + given, 3));
  }
  for (const std::string contact : {"hard", "shi", "dem"})
    CHECK(trials("--contact " + contact, 0) == trials("--contact " + contact + " --dt 0.02", 1));
  // With motion they count, and so they do in a scene that is for `run`, too.
  const std::string paper = "--set strength_reduction.definition=large_displacements --set settle.criterion=paper --dt ";
  CHECK(trials(paper + "0.001", 0) != trials(paper + "0.002", 0));
  trials("--set strength_reduction.definition=large_displacements --set strength_reduction.curve_time_s=0.1" + given, 0);
  place.folder().write("scene.toml", openclose::test::block_on_incline(20.0) + "[step]\ndt_s = 0.02\n");
  trials("", 0);
}

TEST_CASE("who waits for fos at a terminal is told how many blocks there are", "[cli]") {
  const Workplace place("");
  if (place.run("--version", "script -qec true /dev/null && ").status != 0) {
    WARN("no pseudo-terminal can be made here");
    return;
  }
  REQUIRE(place.run("new slope -o scene.toml --bedding-spacing-m 0.8 --cross-spacing-m 0.9").status == 0);
  // Minutes of work, of which the first seconds are enough.
  place.run("--version", "script -qec \"timeout -s INT 3 '" OPENCLOSE_COMMAND "' fos scene.toml -o out\" /dev/null >shown; ");
  CHECK_THAT(text_of(place.folder() / "shown"), ContainsSubstring("6266 blocks with 25063 vertices; a larger joint_set.spacing_m makes fewer") &&
                                                    ContainsSubstring("strength reduction ["));
}

TEST_CASE("factor of safety with a curve", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  const CommandResult result = place.run(
      "fos scene.toml -o out --dt 0.001 --set strength_reduction.definition=large_displacements --set settle.failure_displacement_m=0.05 "
      "--set 'strength_reduction.curve=[1.1, 1.5]' "
      "--set strength_reduction.curve_time_s=0.1 --set strength_reduction.width=0.01");
  CHECK(result.status == 0);
  const auto curve = lines_of(place.folder() / "out/curve.csv");
  REQUIRE(curve.size() == 3);
  CHECK(curve[0] == "srf,point,displacement_m");
  CHECK(fields_of(curve[1])[1] == "block");
  CHECK(std::stod(fields_of(curve[1])[2]) < 1e-4);
  CHECK(std::stod(fields_of(curve[2])[2]) > 1e-3);
}

TEST_CASE("check writes the spectrum that it is asked for", "[cli]") {
  const Workplace place;
  CHECK(place.run("check scene.toml --spectrum spectrum.csv --dt 0.001").status == 0);
  const auto lines = lines_of(place.folder() / "spectrum.csv");
  REQUIRE(lines.size() == 2);
  CHECK(lines[0] == "lowest_rad_per_s,highest_rad_per_s,critical_step_s,condition_number");
  const auto fields = fields_of(lines[1]);
  CHECK(std::stod(fields[1]) * std::stod(fields[2]) == Approx(2.0));
  const CommandResult refused = place.run("check scene.toml --spectrum other.csv --dt 0.001 --contact hard");
  CHECK(refused.status == 2);
  REQUIRE(refused.errors.size() == 1);
  CHECK_THAT(refused.errors[0], ContainsSubstring("method.contact"));
  CHECK(place.run("check scene.toml --spectrum scene.toml --dt 0.001").status == 2);
  CHECK(place.run("check scene.toml").status == 0);
  CHECK(place.folder().entries() == std::set<std::string>{"scene.toml", "spectrum.csv"});
}

TEST_CASE("check tells the steps of dem, where nothing bounds them, too", "[cli]") {
  const Workplace place;
  CHECK_THAT(place.run("check scene.toml --contact dem").out, ContainsSubstring("\ncritical step 0.0"));
  const CommandResult free = place.run("check scene.toml --contact dem --set 'block[1].vertices_m=[[0, 5], [1, 5], [1, 6], [0, 6]]'");
  CHECK(free.status == 0);
  CHECK_THAT(free.out, ContainsSubstring("no critical step") && ContainsSubstring("step.dt_s") && !ContainsSubstring("inf"));
}

TEST_CASE("check tells what it has read and writes nothing", "[cli]") {
  const Workplace place;
  const CommandResult result = place.run("check scene.toml --contact hard");
  CHECK(result.status == 0);
  CHECK(result.errors.empty());
  CHECK_THAT(result.out, ContainsSubstring("2 blocks, 1 of them free, 4 m2 (1 m2 free); 2 contacts") && ContainsSubstring("method hard"));
  CHECK(place.folder().entries() == std::set<std::string>{"scene.toml"});
}

TEST_CASE("check names what does not stand, in its text and in its object", "[cli]") {
  const Workplace place;
  const std::string in_the_air = "check scene.toml --set 'block[1].vertices_m=[[0, 5], [1, 5], [1, 6], [0, 6]]'";
  const std::string words = "touches no other block and moves down (a block in its way, a [[support]] or fixed = true would hold it)";
  const CommandResult text = place.run(in_the_air);
  CHECK(text.status == 0);
  CHECK_THAT(text.out, ContainsSubstring("do not stand as they are drawn: ") && ContainsSubstring(words));
  CHECK_THAT(place.run(in_the_air + " --json").out, ContainsSubstring("\"loose_blocks\": ") && ContainsSubstring(words));
  CHECK_THAT(place.run("check scene.toml --json").out, !ContainsSubstring("loose_blocks"));
}

TEST_CASE("a multiplier has a results folder of its own", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  CHECK(place.run("fos scene.toml").status == 0);
  CHECK(place.run("fos scene.toml --increase gravity_x").status == 0);
  CHECK(place.run("fos scene.toml --increase=-gravity_x").status == 0);
  for (const std::string name : {"scene", "scene-gravity_x", "scene--gravity_x"})
    CHECK(std::filesystem::exists(place.folder() / ("results/" + name + "/summary.json")));
}

TEST_CASE("fos names the two factors between which blocks moved to another equilibrium", "[cli]") {
  const Workplace place;
  REQUIRE(place.run("new arch --voussoirs 21 --radius-m 5 --thickness-m 0.75 --springing-deg 10 -o arch.toml").status == 0);
  // The blocks move farthest while the load takes its large strides, which is no jump: these are found after it.
  const CommandResult result = place.run("fos arch.toml --increase gravity_x -o out");
  REQUIRE(result.errors.size() == 1);
  const std::regex words("another equilibrium between the multipliers ([0-9.]+) and ([0-9.]+).*; up to ([0-9.]+) they stand where they are drawn");
  std::smatch found;
  REQUIRE(std::regex_search(result.errors[0], found, words));
  const double before = std::stod(found[1]), after = std::stod(found[2]), undisturbed = std::stod(found[3]);
  CHECK(undisturbed <= before);
  CHECK(before < after);
  CHECK(after <= summary_in(place.folder() / "out").at("load_multiplier"));
}

TEST_CASE("check begins without the load that fos increases", "[cli]") {
  const Workplace place(openclose::test::block_on_base + "[[load]]\nname = 'push'\npoint_m = [0, 1]\nforce_n = [1e6, 0]\n");
  CHECK_THAT(place.run("check scene.toml").out, ContainsSubstring("do not stand as they are drawn"));
  CHECK_THAT(place.run("check scene.toml --set strength_reduction.increase=push").out, !ContainsSubstring("do not stand"));
}

TEST_CASE("a failing slope: reduced strength, milestones, snapshots, end by displacement", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  const std::string arguments =
      " --dt 0.001 --end 9 --set run.strength_reduction_factor=2 --set end.displacement_m=0.3 --set 'output.milestones_m=[0.1, 0.2]' "
      "--set 'output.snapshots_s=[0, 0.25]' --set output.every_s=0.1";
  const CommandResult result = place.run("run scene.toml -o out" + arguments);
  CHECK(result.status == 0);
  CHECK(result.errors.empty());
  CHECK_THAT(result.out, ContainsSubstring("(end.displacement_m)"));
  const std::string out = place.folder() / "out";
  std::set<std::string> states;
  for (const std::string& line : lines_of(out + "/blocks.csv")) states.insert(fields_of(line)[0]);
  CHECK(states == std::set<std::string>{"state", "initial", "start", "t=0", "moved 0.1 m", "moved 0.2 m", "t=0.25", "final"});

  const auto summary = summary_in(out);
  CHECK(summary.at("converged") == true);
  CHECK(summary.at("ended_by") == "end.displacement_m");
  CHECK(summary.at("settling").at("settled") == true);
  CHECK(summary.at("warnings").empty());
  REQUIRE(summary.at("milestones").size() == 2);
  const double degree = std::numbers::pi / 180.0;
  const double acceleration = 9.81 * (std::sin(30.0 * degree) - 0.5 * std::tan(35.0 * degree) * std::cos(30.0 * degree));
  // The springs let go of less than 0.1 mm at the beginning, which is dt = d(d)/v here.
  const double time = summary.at("milestones")[0].at("time_s");
  CHECK(time == Approx(std::sqrt(0.2 / acceleration)).margin(5e-4 / std::sqrt(0.2 * acceleration)));
  const auto milestones = lines_of(out + "/milestones.csv");
  REQUIRE(milestones.size() == 3);
  CHECK(std::stod(fields_of(milestones[1])[1]) == time);
  const auto history = lines_of(out + "/history.csv");
  CHECK(std::stod(fields_of(history.back())[0]) == summary.at("time_s"));

  // CPU times differ from run to run and stand in summary.json and milestones.csv only.
  CHECK(place.run("run scene.toml -o again" + arguments).status == 0);
  check_same_tables(place, "out", "again");
}

TEST_CASE("a method to settle by that nothing asks for is worth a warning", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  const auto warning = [&](const std::string& arguments) {
    const CommandResult result = place.run(arguments + " scene.toml -o out --dt 0.001");
    CHECK(result.status == 0);
    const auto summary = summary_in(place.folder() / "out");
    CHECK(summary.at("warnings").size() == result.errors.size());
    return result.errors.empty() ? std::string() : result.errors[0];
  };
  CHECK(warning("run --end 0.01 --set run.settled_by=dem").empty());
  CHECK(warning("run --end 0.01 --start unloaded --set run.settled_by=soft").empty());
  CHECK_THAT(warning("run --end 0.01 --start unloaded --set run.settled_by=dem"),
             StartsWith("openclose: warning: scene.toml: run.settled_by is for method.start = \"settled\""));
  CHECK_THAT(warning("fos --set strength_reduction.width=0.5 --set run.settled_by=dem"),
             StartsWith("openclose: warning: scene.toml: run.settled_by is for run"));
}

TEST_CASE("what was asked for and did not come is worth a warning", "[cli]") {
  const Workplace place;
  const CommandResult result =
      place.run("run scene.toml -o out --dt 0.001 --end 0.01 --set end.displacement_m=1 --set output.milestones_m=[2] --set output.snapshots_s=[3]");
  CHECK(result.status == 0);
  REQUIRE(result.errors.size() == 3);
  CHECK_THAT(result.errors[0], StartsWith("openclose: warning: milestone 2 m not reached: the run ended at t = 0.01 s"));
  CHECK_THAT(result.errors[1], StartsWith("openclose: warning: no snapshot at t = 3 s"));
  CHECK_THAT(result.errors[2], ContainsSubstring("before any measured point had moved 1 m"));
  const auto summary = summary_in(place.folder() / "out");
  CHECK(summary.at("ended_by") == "end.time_s");
  CHECK(summary.at("warnings").size() == 3);
  CHECK(summary.at("milestones")[0].at("time_s").is_null());
}

TEST_CASE("factor of safety by the paper's criterion", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  const CommandResult result = place.run(
      "fos scene.toml -o out --dt 0.001 --set strength_reduction.definition=large_displacements --set settle.criterion=paper --set "
      "settle.relative_displacement=1e-8 --set run.strength_reduction_factor=2 "
      "--set method.first_integrator=path_average --set method.first_integrator_s=10");
  CHECK(result.status == 0);
  REQUIRE(result.errors.size() == 3);
  CHECK_THAT(result.errors[0], ContainsSubstring("run.strength_reduction_factor is for run"));
  CHECK_THAT(result.errors[1], ContainsSubstring("method.first_integrator is for run"));
  CHECK_THAT(result.errors[2], ContainsSubstring("settle.criterion = \"paper\" takes for resting what accelerates by up to"));
  CHECK_THAT(result.out, StartsWith("factor of safety 1.21"));
  CHECK(summary_in(place.folder() / "out").at("bracket").at("failed_by") == "steps");
  CHECK_THAT(text_of(place.folder() / "out/trials.csv"), ContainsSubstring("\n1,bracket,1,relative displacement,"));
}

TEST_CASE("a moving base: its energy is written, and fos says that it is not for it", "[cli]") {
  const Workplace place(openclose::test::block_on_base +
                        "[base_motion]\nkind = 'harmonic'\namplitude_m_per_s2 = [9, 0]\nfrequency_hz = 5\n[[measured_point]]\nname = 'p'\nblock = "
                        "'block'\npoint_m = [0, 0]\n");
  CHECK(place.run("run scene.toml -o out --dt 0.001 --end 0.05").status == 0);
  const auto summary = summary_in(place.folder() / "out");
  CHECK(summary.at("options").at("base_motion") == "harmonic");
  CHECK(std::abs(summary.at("energy_ledger").at("base_motion_j").get<double>()) > 1.0);
  const CommandResult fos = place.run("fos scene.toml -o fos");
  REQUIRE(!fos.errors.empty());
  CHECK_THAT(fos.errors[0], ContainsSubstring("base_motion is for run"));
}

TEST_CASE("help of check says what it does not do", "[cli]") {
  const CommandResult result = Workplace().run("check --help");
  CHECK(result.status == 0);
  CHECK_THAT(result.out, ContainsSubstring("whether it settles"));
}

TEST_CASE("the scene that a run has read is in its folder, and runs again to the same results", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  const std::string common = " --set output.snapshots_every_s=0.02";
  REQUIRE(place.run("run scene.toml -o a --dt 0.001 --end 0.05 --start unloaded --set joint[0].friction_angle_deg=20" + common).status == 0);
  REQUIRE(place.run("run a/scene_as_read.toml -o b").status == 0);
  check_same_tables(place, "a", "b");
  const std::string copy = text_of(place.folder() / "a/scene_as_read.toml");
  CHECK_THAT(copy, ContainsSubstring("friction_angle_deg = 20"));

  SECTION("but not in its own folder, where it would be written over") {
    for (const std::string command : {"run", "fos"}) {
      const CommandResult refused = place.run(command + " a/scene_as_read.toml -o a");
      CHECK(refused.status == 2);
      REQUIRE(refused.errors.size() == 1);
      CHECK_THAT(refused.errors[0], ContainsSubstring("-o with another folder"));
      CHECK(text_of(place.folder() / "a/scene_as_read.toml") == copy);
      CHECK(entries(place.folder() / "a").count("summary.json") == 1);
    }
  }
}

TEST_CASE("measured contacts have their own history, in runs only", "[cli]") {
  const Workplace place(block_on_base + "[[measured_contact]]\nname = 'foot'\npoint_m = [0.5, 0]\n");
  REQUIRE(place.run("run scene.toml -o out --dt 0.001 --end 0.01").status == 0);
  const auto lines = lines_of(place.folder() / "out/contact_history.csv");
  REQUIRE(lines.size() == 1 + 11);
  CHECK(lines[0] == "time_s,contact,normal_force_n,shear_force_n,gap_m,slip_m,status,closed_contacts");
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = fields_of(lines[i]);
    CHECK(fields[1] == "foot");
    CHECK(std::stod(fields[2]) == Approx(2700.0 * 9.81).epsilon(1e-6));
    CHECK(std::abs(std::stod(fields[3])) < 1.0);
    CHECK(std::stod(fields[4]) == Approx(-2700.0 * 9.81 / 1e9).epsilon(1e-6));
    CHECK(fields[6] == "sticking");
    CHECK(fields[7] == "2");
  }
  const CommandResult fos = place.run("fos scene.toml -o out");
  CHECK(fos.errors.size() > 0);
  CHECK_THAT(fos.errors[0], ContainsSubstring("measured_contact is for run"));
  CHECK_FALSE(std::filesystem::exists(place.folder() / "out/contact_history.csv"));
}

TEST_CASE("writing states leaves the run as it is, bit for bit", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(36.0));
  for (const std::string method : {"soft", "hard", "shi", "dem"}) {
    INFO(method);
    const std::string common = "run scene.toml --dt 0.001 --end 0.3 --start unloaded --contact " + method;
    REQUIRE(place.run(common + " -o plain").status == 0);
    REQUIRE(place.run(common + " -o states --set output.snapshots_every_s=0.007 --set 'output.formats=[\"vtk\", \"svg\"]'").status == 0);
    for (const std::string file : {"history.csv", "energy.csv"}) {
      CHECK(text_of(place.folder() / "plain/" + file) == text_of(place.folder() / "states/" + file));
    }
    CHECK(lines_of(place.folder() / "states/cracks.csv").size() == 1 + 2 + 42);
  }
}

TEST_CASE("explain tells a key, and refuses an unknown one", "[cli][keys]") {
  const Workplace place("");
  const CommandResult theta = place.run("explain theta");
  CHECK(theta.status == 0);
  CHECK_THAT(theta.out, ContainsSubstring("method.theta: ") && ContainsSubstring("accepted  a number in [0.5, 1]"));
  CHECK_THAT(place.run("explain --page").out, ContainsSubstring("| `dt_s` | s | "));
  CHECK_THAT(place.run("explain --schema").out, ContainsSubstring("\"$schema\""));
  const CommandResult refused = place.run("explain thetta");
  CHECK(refused.status == 2);
  CHECK(refused.errors.size() == 1);
  CHECK(refused.out.empty());
  CHECK_THAT(place.run("explain").out, ContainsSubstring("[[joint_set]]"));
  CHECK_THAT(place.run("explain thetta").errors.at(0), ContainsSubstring("explain: thetta: this key is not known, did you mean theta?"));
  // Several tables have a key `name`.
  CHECK_THAT(place.run("explain nam").errors.at(0), ContainsSubstring("accepted: name, ") && !ContainsSubstring("name, name"));
}

TEST_CASE("a key in its old place is warned of once and changes nothing else", "[cli][keys]") {
  const std::string motion = "[step]\ndt_s = 0.001\n[end]\ntime_s = 0.01\n";
  const Workplace old_place(block_on_base + "[method]\nmax_iterations = 70\n" + motion),
      new_place(block_on_base + "[solver]\nmax_iterations = 70\n" + motion);
  const CommandResult old_key = old_place.run("run scene.toml -o out"), new_key = new_place.run("run scene.toml -o out");
  CHECK(old_key.status == 0);
  CHECK(old_key.errors == std::vector<std::string>{
                              "openclose: warning: scene.toml:23: method.max_iterations is now solver.max_iterations; the old name is still read"});
  CHECK(new_key.status == 0);
  CHECK(new_key.errors.empty());
  for (const char* table : {"out/history.csv", "out/energy.csv", "out/scene_as_read.toml"})
    CHECK(text_of(old_place.folder() / table) == text_of(new_place.folder() / table));
  CHECK(summary_in(old_place.folder() / "out").at("warnings").size() == 1);
}

TEST_CASE("a form of results that there is not is refused before anything is written", "[cli][formats]") {
  const Workplace place;
  const CommandResult result = place.run("run scene.toml -o out --dt 0.001 --end 0.002 --set 'output.formats=[\"dxf\"]'");
  CHECK(result.status == 2);
  CHECK_THAT(result.errors.at(0), ContainsSubstring("output.formats: \"dxf\" is no known form of results; accepted: \"vtk\", \"svg\""));
  CHECK_FALSE(std::filesystem::exists(place.folder() / "out"));
}

TEST_CASE("no result takes the place of a file that is read", "[cli]") {
  const Workplace place("");
  place.folder().write("history.csv", block_on_base);
  for (const std::string command : {"run", "fos"}) {
    const CommandResult result = place.run(command + " history.csv --dt 0.001 --end 0.01 -o .");
    CHECK(result.status == 2);
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], ContainsSubstring("history.csv: is read, and a result of this name would replace it"));
    CHECK(text_of(place.folder() / "history.csv") == block_on_base);
    CHECK(place.folder().entries() == std::set<std::string>{"history.csv"});
  }
}

TEST_CASE("a run whose folder is removed is broken off", "[cli]") {
  // Moved, not removed: one act, which cannot still be going on when the test clears up.
  const Workplace place;
  const CommandResult result =
      place.run("run scene.toml --dt 0.001 --end 1000 --set output.checkpoint_every_s=0.05 -o out", "{ (sleep 0.5; mv out elsewhere) & }; ");
  CHECK(result.status == 3);
  REQUIRE(result.errors.size() == 1);
  CHECK_THAT(result.errors[0], ContainsSubstring("out/") && ContainsSubstring("has been removed"));
}

TEST_CASE("messages go into no table where standard error is closed", "[cli]") {
  const Workplace place("");
  REQUIRE(place.run("new slope -o slope.toml -q").status == 0);
  const std::string there = "cd '" + place.folder().path() + "' && '" OPENCLOSE_COMMAND "' ";
  const CommandResult open = place.run("fos slope.toml -o told");
  REQUIRE(!open.errors.empty());  // there is something to say
  // If nothing took the place of closed streams, the output folder would get the first free number, a table the second.
  CHECK(std::system((there + "fos slope.toml -o out <&- >/dev/null 2>&-").c_str()) == 0);
  for (const auto& entry : std::filesystem::directory_iterator(place.folder() / "out")) {
    INFO(entry.path());
    if (entry.path().extension() == ".csv") CHECK_THAT(openclose::test::text_of(entry.path()), !ContainsSubstring("openclose"));
  }
  const int status = std::system((there + "check slope.toml >&- 2>/dev/null").c_str());
  CHECK(WEXITSTATUS(status) == 3);
}

TEST_CASE("a scene whose file name is no text is analysed like any other", "[cli]") {
  const Workplace place("");
  place.folder().write("b\xf6.toml", openclose::test::block_on_incline(20.0));
  CHECK(place.run("run b\xf6.toml --dt 0.001 --end 0.01 --start unloaded -q -o out").status == 0);
  CHECK(nlohmann::json::accept(openclose::test::text_of(place.folder() / "out/summary.json")));
}

TEST_CASE("strengths and loads beyond all rock do not end the process in the midst of a limit analysis", "[cli]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  const std::string strong = " scene.toml --set joint[0].tensile_strength_pa=1e50";
  CHECK(place.run("check" + strong).status == 0);
  CHECK(place.run("fos" + strong + " -o out").status == 0);
  // What a load of no rock does to the search is its own affair: a status of its own, and no signal.
  place.folder().write("loaded.toml",
                       openclose::test::block_on_incline(20.0) + "[[load]]\nname = 'p'\nblock = 'block'\npoint_m = [0, 0]\nforce_n = [1e150, 0]\n");
  const int status = place.run("fos loaded.toml --increase p -o loaded").status;
  CHECK((status == 0 || status == 1));
}
