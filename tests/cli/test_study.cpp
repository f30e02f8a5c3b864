// `study` and `sweep`: many runs of one scene, against closed forms.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "cli/command.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using openclose::test::block_on_incline;
using openclose::test::CommandResult;
using openclose::test::contents;
using openclose::test::fields_of;
using openclose::test::lines_of;
using openclose::test::text_of;
using openclose::test::Workplace;

namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// What a shell does to run the command that follows, and to send it SIGTERM as soon as there is such a file, or after a minute.
std::string stopped_when_there(const std::string& file) {
  return "sh -c '\"$@\" & for i in $(seq 1200); do [ -s \"" + file + "\" ] && break; sleep 0.05; done; kill -TERM $!; wait $!' sh ";
}

std::vector<std::map<std::string, std::string>> rows_of(const std::string& path) {
  const auto lines = lines_of(path);
  const auto columns = fields_of(lines.at(0));
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = fields_of(lines[i]);
    auto& row = rows.emplace_back();
    for (std::size_t k = 0; k < columns.size() && k < fields.size(); ++k) row[columns[k]] = fields[k];
  }
  return rows;
}

}  // namespace

TEST_CASE("sweep finds tan(phi)/tan(slope) for every friction angle, and does not run it twice", "[cli][sweep]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  const std::string command = "sweep scene.toml --vary joint[0].friction_angle_deg=25:35:5 --set joint[0].cohesion_pa=0 -o out";
  const CommandResult result = place.run(command);
  CHECK(result.status == 0);
  CHECK_THAT(result.out, ContainsSubstring("3 of 3 cases have an answer; written to out/sweep.csv and sweep.svg"));
  const auto rows = rows_of(place.folder() / "out/sweep.csv");
  REQUIRE(rows.size() == 3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double angle = 25.0 + 5.0 * static_cast<double>(i);
    CHECK(std::stod(rows[i].at("joint[0].friction_angle_deg")) == angle);
    CHECK(std::stod(rows[i].at("factor_of_safety")) == Approx(std::tan(angle * degree) / std::tan(20.0 * degree)).epsilon(2e-4));
    CHECK(rows[i].at("verdict") == "certified");
    CHECK(rows[i].at("status") == "success");
  }
  const auto written = [&] { return std::filesystem::last_write_time(place.folder() / "out/joint[0].friction_angle_deg=30/summary.json"); };
  const auto before = written();
  CHECK_THAT(place.run(command).out, ContainsSubstring("(3 were there)"));
  CHECK(written() == before);
  // More values: only these are run. Another scene: all.
  CHECK_THAT(place.run("sweep scene.toml --vary joint[0].friction_angle_deg=25:40:5 --set joint[0].cohesion_pa=0 -o out").out,
             ContainsSubstring("4 of 4 cases have an answer (3 were there)"));
  CHECK_THAT(place.run("sweep scene.toml --vary joint[0].friction_angle_deg=25:35:5 --set joint[0].cohesion_pa=1 -o out").out,
             ContainsSubstring("3 of 3 cases have an answer; written"));
  CHECK(written() != before);
}

TEST_CASE("a sweep of the multiplier of a load", "[cli][sweep]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  const CommandResult result = place.run(
      "sweep scene.toml --vary joint[0].friction_angle_deg=25:35:5 --set joint[0].cohesion_pa=0 --set strength_reduction.increase=gravity_x -o out");
  CHECK(result.status == 0);
  const auto rows = rows_of(place.folder() / "out/sweep.csv");
  REQUIRE(rows.size() == 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    CHECK(std::stod(rows[i].at("load_multiplier")) == Approx(std::tan((5.0 + 5.0 * static_cast<double>(i)) * degree)).epsilon(2e-4));
  CHECK_THAT(text_of(place.folder() / "out/sweep.svg"), ContainsSubstring("multiplier of gravity_x"));
}

TEST_CASE("sweep tells what earlier ones in its folder have and its table has not", "[cli][sweep]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  CHECK(place.run("sweep scene.toml --vary joint[0].friction_angle_deg=25:35:5 -o out").errors.empty());
  const CommandResult second = place.run("sweep scene.toml --vary joint[0].friction_angle_deg=30:40:10 -o out");
  CHECK(rows_of(place.folder() / "out/sweep.csv").size() == 2);
  REQUIRE(second.errors.size() == 1);
  CHECK_THAT(second.errors[0], ContainsSubstring("2 cases of earlier sweeps in out are not in this table"));
}

TEST_CASE("sweep goes on where it was broken off", "[cli][sweep]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  const std::string command = "sweep scene.toml --vary joint[0].friction_angle_deg=25:35:5 -j 1 -o out";
  REQUIRE(place.run(command).status == 0);
  // As a case leaves it that was killed: without its mark.
  std::filesystem::remove(place.folder() / "out/joint[0].friction_angle_deg=30/case.txt");
  std::filesystem::remove(place.folder() / "out/sweep.csv");
  CHECK_THAT(place.run(command).out, ContainsSubstring("(2 were there)"));
  CHECK(rows_of(place.folder() / "out/sweep.csv").size() == 3);
  // What a hand has left is its own; without it the case runs again.
  const std::string summary = place.folder() / "out/joint[0].friction_angle_deg=25/summary.json";
  std::ofstream(summary) << "{";
  const CommandResult refused = place.run(command);
  CHECK(refused.status == 2);
  REQUIRE(refused.errors.size() == 1);
  CHECK_THAT(refused.errors[0], ContainsSubstring("friction_angle_deg=25/summary.json: has been changed since openclose has written it"));
  std::filesystem::remove(summary);
  CHECK_THAT(place.run(command).out, ContainsSubstring("(2 were there)"));
  const std::string mark = place.folder() / "out/joint[0].friction_angle_deg=35/case.txt", text = text_of(mark);
  std::ofstream(mark) << text.substr(0, text.find('\n') + 1);
  CHECK_THAT(place.run(command).out, ContainsSubstring("(2 were there)"));
  CHECK(rows_of(place.folder() / "out/sweep.csv").size() == 3);
}

TEST_CASE("a sweep or study that is stopped stops its cases, and goes on where it was", "[cli][sweep][study]") {
  const Workplace place(block_on_incline(35.0));
  const std::string cases = " -j 1 -o out --set method.start=unloaded --set output.every_s=0.001 ";
  for (const std::string& command : {"sweep scene.toml --command run --vary end.time_s=0.01,1000 --set step.dt_s=0.001" + cases,
                                     "study scene.toml --dt 0.001,0.0011 --quantity energy.kinetic_j --set end.time_s=1000" + cases}) {
    INFO(command);
    // As soon as the long case computes.
    const std::string last = command.starts_with("sweep") ? "end.time_s=1000" : "soft,dt=0.0011";
    const CommandResult result = place.run(command, stopped_when_there("out/" + last + "/energy.csv"));
    CHECK(result.status == 143);
    REQUIRE(result.errors.size() == 1);
    const std::string ended = command.starts_with("sweep") ? "1 of 2" : "0 of 2";
    CHECK(result.errors[0] == "openclose: stopped when " + ended + " cases had ended; the same command goes on with the others");
    // Nobody holds the folders of the cases: none goes on computing.
    CHECK(std::system(("cd '" + place.folder().path() + "' && for f in out/*/; do flock -n $f true || exit 1; done").c_str()) == 0);
  }
  CHECK_THAT(place.run("sweep scene.toml --command run --vary end.time_s=0.01 --set step.dt_s=0.001" + cases).out,
             ContainsSubstring("(1 were there)"));
}

TEST_CASE("a sweep takes up what one that was killed has left, and leaves cases alone that have ended", "[cli][sweep]") {
  const Workplace place(block_on_incline(20.0));
  const std::string command = "sweep scene.toml --vary joint[0].friction_angle_deg=25,30 -j 1 -o out";
  REQUIRE(place.run(command).status == 0);
  // In the midst of writing its mark and its table.
  const std::string folder = "out/joint[0].friction_angle_deg=30/";
  std::filesystem::remove(place.folder() / (folder + "case.txt"));
  place.folder().write(folder + "case.txt.part", "openc");
  place.folder().write("out/sweep.csv.part", "joint[0].fri");
  // Notes on a case that is not run again.
  std::ofstream(place.folder() / "out/joint[0].friction_angle_deg=25/trials.csv", std::ios::app) << "mine\n";
  CHECK_THAT(place.run(command).out, ContainsSubstring("2 of 2 cases have an answer (1 were there)"));
  // What is not ours under that name is not removed.
  std::filesystem::remove(place.folder() / (folder + "case.txt"));
  place.folder().write(folder + "case.txt.part", "my notes\n");
  CHECK(place.run(command).status == 2);
  CHECK(text_of(place.folder() / (folder + "case.txt.part")) == "my notes\n");
}

TEST_CASE("a sweep waits for its cases though it was started with a disregard for the ends of children", "[cli][sweep]") {
  const Workplace place(block_on_incline(20.0));
  CHECK(place.run("sweep scene.toml --vary joint[0].friction_angle_deg=25 -q -o out", "timeout 60 sh -c 'trap \"\" CHLD; exec \"$@\"' sh ").status ==
        0);
}

TEST_CASE("a folder that another openclose writes to is left to it", "[cli][run][fos][sweep]") {
  const Workplace place(block_on_incline(35.0));
  REQUIRE(place.run("run scene.toml --dt 0.001 --end 0.01 --start unloaded -q -o out").status == 0);
  const auto before = contents(place.folder().path());
  for (const std::string command : {"run scene.toml --dt 0.001 --end 0.01 --start unloaded -q -o out", "fos scene.toml -q -o out",
                                    "sweep scene.toml --vary joint[0].friction_angle_deg=25 -q -o out"}) {
    const CommandResult result = place.run(command, "flock out ");
    CHECK(result.status == 2);
    REQUIRE(result.errors.size() == 1);
    CHECK(result.errors[0] ==
          "openclose: out: another openclose is writing to this folder; accepted: -o with another folder, or to wait until that one has ended");
    CHECK(contents(place.folder().path()) == before);
  }
  CHECK(place.run("run scene.toml --dt 0.001 --end 0.01 --start unloaded -q -o out").status == 0);
}

TEST_CASE("a sweep over another key takes the place of the table of the one before, but of no other file", "[cli][sweep]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  REQUIRE(place.run("sweep scene.toml --vary joint[0].friction_angle_deg=25 -o out").status == 0);
  CHECK(place.run("sweep scene.toml --vary joint[0].cohesion_pa=0 -o out").status == 0);
  CHECK_THAT(lines_of(place.folder() / "out/sweep.csv").at(0), StartsWith("joint[0].cohesion_pa,"));
  place.folder().write("out/sweep.csv", "mine\n1\n");
  CHECK(place.run("sweep scene.toml --vary joint[0].cohesion_pa=0 -o out").status == 2);
  CHECK(text_of(place.folder() / "out/sweep.csv") == "mine\n1\n");
}

TEST_CASE("sweep of run has a quantity, and names the case that does not come to its end", "[cli][sweep]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  const CommandResult result = place.run(
      "sweep scene.toml --command run --vary step.dt_s=0.001,0.002 --vary method.contact=soft,hard --end 0.1 --set method.start=unloaded "
      "--quantity block.displacement_m -o out");
  CHECK(result.status == 0);
  const auto rows = rows_of(place.folder() / "out/sweep.csv");
  REQUIRE(rows.size() == 4);
  // Half of g (sin - cos tan(phi)) t^2, to which the springs add their closure.
  for (const auto& row : rows) {
    CHECK(std::stod(row.at("block.displacement_m")) > 0.0);
    CHECK(std::stod(row.at("time_s")) == Approx(0.1));
  }
  const CommandResult refused =
      place.run("sweep scene.toml --command run --vary method.start=settled,unloaded --set step.dt_s=0.001 --end 0.01 -o other");
  CHECK(refused.status == 1);
  CHECK_THAT(refused.out, ContainsSubstring("1 of 2 cases have an answer"));
  REQUIRE(refused.errors.size() == 1);
  CHECK_THAT(refused.errors[0], ContainsSubstring("method.start=settled: not converged: no static equilibrium"));
}

TEST_CASE("study measures errors against a known value, and their order", "[cli][study]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  const double exact = 0.5 * 9.81 * (std::sin(40.0 * degree) - std::cos(40.0 * degree) * std::tan(30.0 * degree)) * 0.2 * 0.2;
  const CommandResult result = place.run(
      "study scene.toml --dt 0.01,0.005,0.0025 --contact hard --end 0.2 --set joint[0].friction_angle_deg=30 --set method.start=unloaded "
      "--reference " +
      std::to_string(exact) + " --quantity block.displacement_m -o out");
  CHECK(result.status == 0);
  CHECK_THAT(result.out, ContainsSubstring("observed") || ContainsSubstring("order"));
  const auto rows = rows_of(place.folder() / "out/study.csv");
  REQUIRE(rows.size() == 3);
  for (const auto& row : rows) {
    const double value = std::stod(row.at("value"));
    CHECK(std::stod(row.at("error")) == Approx(std::abs(value - std::stod(row.at("reference")))));
    CHECK(value == Approx(exact).epsilon(0.1));
  }
  CHECK(std::stol(rows[2].at("steps")) >= 80);
  CHECK_THAT(text_of(place.folder() / "out/study.svg"), StartsWith("<svg ") && ContainsSubstring("the given value"));
}

TEST_CASE("study warns where a refinement changes more than the one before", "[cli][study]") {
  // Contacts that ring from an unloaded start: long steps leave the ringing out, short ones follow it.
  const Workplace place(openclose::test::block_on_incline(40.0));
  const std::string command =
      "study scene.toml --contact soft --end 0.1 --set method.start=unloaded --set joint[0].shear_stiffness_pa_per_m=1e9 --quantity "
      "block.displacement_m";
  const auto warned = [](const CommandResult& result) {
    return std::ranges::any_of(result.errors, [](const std::string& line) { return line.find("do not converge yet") != std::string::npos; });
  };
  CHECK(warned(place.run(command + " --dt 0.01,0.005,0.0005 -o coarse")));
  CHECK_FALSE(warned(place.run(command + " --dt 0.0002,0.0001,0.00005 -o fine")));
}

TEST_CASE("study warns of runs that end earlier or later than others, and not of rounding", "[cli][study]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  // Three steps of 0.1 s and ten of 0.03 s differ by 6e-17 s.
  const std::string command = "study scene.toml --contact hard --set method.start=unloaded --quantity block.displacement_m";
  const CommandResult same = place.run(command + " --end 0.3 --dt 0.1,0.05,0.03 -o same");
  CHECK(same.status == 0);
  CHECK(same.errors.empty());
  const CommandResult earlier = place.run(command + " --end 3 --set end.displacement_m=0.1 --dt 0.1,0.05,0.03 -o earlier");
  REQUIRE(earlier.errors.size() == 1);
  CHECK_THAT(earlier.errors[0], ContainsSubstring("choose steps that divide end.time_s") && ContainsSubstring("others at"));
}

TEST_CASE("study marks what gave warnings, and tells how much energy the integrator took", "[cli][study]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  const std::string command = "study scene.toml --dt 0.01,0.005 --end 0.05 --set method.start=unloaded";
  const CommandResult clean = place.run(command + " -o clean"), marked = place.run(command + " -o marked --set material[0].density_kg_per_m3=2.7");
  CHECK_THAT(clean.out, !ContainsSubstring("*"));
  CHECK_THAT(text_of(place.folder() / "clean/study.svg"), !ContainsSubstring("Hollow points"));
  CHECK(std::ranges::count(marked.out, '*') == 3);
  CHECK_THAT(marked.out, ContainsSubstring("\n* runs that gave warnings"));
  for (const auto& row : rows_of(place.folder() / "clean/study.csv")) {
    const std::string folder = "clean/soft,dt=" + std::string(row.at("dt_s").starts_with("0.01") ? "0.01" : "0.005");
    const auto last = rows_of(place.folder() / folder + "/energy.csv").back();
    const double share = std::stod(last.at("scheme_j")) / std::stod(last.at("turnover_j"));
    CHECK(std::abs(share) > 1e-6);
    CHECK(std::stod(row.at("integrator_loss")) == Approx(share).epsilon(1e-5));
  }
}

TEST_CASE("study and sweep refuse in one line, and write nothing", "[cli][study][sweep]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    INFO(arguments);
    const CommandResult result = place.run(arguments + " -o out");
    CHECK(result.status == 2);
    CHECK(result.out.empty());
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], StartsWith("openclose: ") && ContainsSubstring(message));
    CHECK_FALSE(std::filesystem::exists(place.folder() / "out"));
  };
  refused("sweep scene.toml --vary joint[0].friction_angle_deg=25:", "this is no range");
  refused("sweep scene.toml --vary joint[0].friction_angle_deg=25-40", "joint[0].friction_angle_deg=25:40:STEP");
  refused("sweep scene.toml", "--vary");
  refused("study scene.toml --dt 0.001 --reference nan", "nan is no finite number");
  refused("sweep scene.toml --vary joint[0].friction_angle_deg=25,95", "95");
  refused("sweep scene.toml --vary joint[0].friction=25,30", "friction");
  refused("sweep scene.toml --vary joint[0].friction_angle_deg=25,25", "the same values");
  refused("sweep scene.toml --vary joint[0].friction_angle_deg=25 --set joint[0].friction_angle_deg=30", "--vary alone for this key");
  refused("sweep scene.toml --vary joint[0].friction_angle_deg=25 --vary joint[0].friction_angle_deg=30", "varied twice");
  refused("study scene.toml --end 1 --dt 0.01 --set step.dt_s=0.1", "--dt alone for this key");
  refused("study scene.toml --end 1 --dt 0.01 --contact soft --set method.contact=dem", "--contact alone for this key");
  refused("sweep nothing.toml --vary joint[0].friction_angle_deg=25,30", "nothing.toml");
  refused("study scene.toml --dt 0.01,0.005", "end.time_s");
  refused("study scene.toml --end 1 --dt 0.01,0.01", "twice");
  refused("study scene.toml --end 1 --dt 0.01 --contact sof", "sof");
  refused("study scene.toml --end 1 --dt 0.01 --quantity nowhere.displacement_m", "is no quantity");
  refused("study scene.toml --end 1", "--dt");
  refused("study scene.toml --end 1 --dt 0.01 --contact soft,dem --set method.integrator=path_average", "has no meaning for method.contact");
  refused("study scene.toml --end 1 --dt 1e-3,-1", "-1 is no time step");
}

TEST_CASE("files of somebody else are found before the first case runs", "[cli][study][sweep]") {
  const std::string study = "study scene.toml --end 0.02 --dt 0.01 --set method.start=unloaded -o out",
                    sweep = "sweep scene.toml --vary joint[0].friction_angle_deg=25 -o out";
  const auto refused = [&](const std::string& command, const std::string& foreign) {
    INFO(command << ' ' << foreign);
    const Workplace place(openclose::test::block_on_incline(30.0));
    std::filesystem::create_directories(std::filesystem::path(place.folder() / foreign).parent_path());
    std::ofstream(place.folder() / foreign) << "mine\n";
    const CommandResult result = place.run(command);
    CHECK(result.status == 2);
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], ContainsSubstring(foreign) && ContainsSubstring("has not been written by openclose"));
    CHECK(text_of(place.folder() / foreign) == "mine\n");
    const auto files = std::filesystem::recursive_directory_iterator(place.folder() / "out");
    CHECK(std::ranges::count_if(files, [](const auto& entry) { return entry.is_regular_file(); }) == 1);
  };
  refused(study, "out/study.svg");
  refused(study, "out/study.csv");
  refused(study, "out/soft,dt=0.01/energy.csv");
  refused(study, "out/soft,dt=0.01/case.txt");
  refused(sweep, "out/sweep.svg");
  refused(sweep, "out/joint[0].friction_angle_deg=25/trials.csv");
}

TEST_CASE("what cases say of themselves is written over nobody's file", "[cli][sweep]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  std::filesystem::create_directory(place.folder() / "out");
  const auto mine = place.folder() / "out/joint[0].friction_angle_deg=25.log";
  std::ofstream(mine) << "mine\n";
  const CommandResult result = place.run("sweep scene.toml --vary joint[0].friction_angle_deg=25 --set joint[0].cohesion_pa=0 -o out");
  CHECK(result.status == 0);
  CHECK(text_of(mine) == "mine\n");
  // A mark is a line of its own make and a status, and not any text about openclose.
  const auto mark = place.folder() / "out/joint[0].friction_angle_deg=25,joint[0].cohesion_pa=1/case.txt";
  std::filesystem::create_directories(std::filesystem::path(mark).parent_path());
  std::ofstream(mark) << "openclose is what I ran here\n";
  const std::string again = "sweep scene.toml --vary joint[0].friction_angle_deg=25 --vary joint[0].cohesion_pa=1 -o out";
  const CommandResult refused = place.run(again);
  CHECK(refused.status == 2);
  CHECK_THAT(refused.errors.at(0), ContainsSubstring("case.txt: has not been written by openclose"));
  CHECK(text_of(mark) == "openclose is what I ran here\n");
}

TEST_CASE("what runs warn of is told by study and sweep, alike warnings once", "[cli][study][sweep]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  const auto warned = [&](const std::string& command, const std::string& first) {
    const CommandResult result = place.run(command + " --set material[0].density_kg_per_m3=2.7");  // as if in t/m3
    CHECK(result.status == 0);
    const auto about_density = [](const std::string& line) { return line.find("density") != std::string::npos; };
    REQUIRE(std::ranges::count_if(result.errors, about_density) == 1);
    const std::string& line = *std::ranges::find_if(result.errors, about_density);
    CHECK_THAT(line, ContainsSubstring(first) && ContainsSubstring("(and the same of 1 other case,"));
  };
  warned("study scene.toml --dt 0.01,0.005 --end 0.05 --set method.start=unloaded -o study", "soft,dt=0.01: ");
  CHECK_THAT(text_of(place.folder() / "study/study.svg"),
             ContainsSubstring("Hollow points: runs that gave warnings") && ContainsSubstring("fill=\"white\" stroke"));
  warned("sweep scene.toml --vary joint[0].friction_angle_deg=46,47 -o sweep", "friction_angle_deg=46: ");
  const auto rows = rows_of(place.folder() / "study/study.csv");
  REQUIRE(rows.size() == 2);
  CHECK(std::stoi(rows[0].at("warnings")) >= 1);
}

TEST_CASE("a study in which no run comes to its end has no picture, and one warning", "[cli][study]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  place.folder().write("out/study.svg", "<svg><!-- drawn by openclose --></svg>");
  const CommandResult result = place.run("study scene.toml --dt 0.01,0.005,0.0025 --end 0.05 -o out");
  CHECK(result.status == 1);
  CHECK_THAT(result.out, ContainsSubstring("written to out/study.csv; no picture, since there is no error to draw"));
  CHECK_FALSE(std::filesystem::exists(place.folder() / "out/study.svg"));
  REQUIRE(result.errors.size() == 1);
  CHECK_THAT(result.errors[0], ContainsSubstring("soft at dt = 0.01 s: not converged: ") && ContainsSubstring("the same of 2 other cases,"));
}

TEST_CASE("sweep tells how many answers are no more than an interval", "[cli][sweep]") {
  const Workplace place;
  REQUIRE(place.run("new slope -o slope.toml").status == 0);
  // So few steps that shi finds no failure, and no limit analysis to prove one.
  const std::string command =
      "sweep slope.toml --vary method.contact=soft,shi --set strength_reduction.limit_analysis=false --set settle.max_steps=2 -o out";
  CHECK_THAT(place.run(command).out, ContainsSubstring("2 of 2 cases have an answer, 1 of them only an interval"));
  CHECK(nlohmann::json::parse(place.run(command + " --json").out).at("intervals") == 1);
}
