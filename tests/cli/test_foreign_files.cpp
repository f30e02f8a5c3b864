// What openclose has not written, or somebody has edited since, is neither replaced nor removed, whatever it is called.
#include <filesystem>
#include <fstream>
#include <string>

#include "command.h"
#include "support/catch.h"

using namespace openclose::test;
using Catch::Matchers::ContainsSubstring;

namespace {

constexpr const char* run_in_out = "run scene.toml --dt 0.001 --end 0.01 -q -o out";
constexpr const char* domain =
    "[domain]\nmaterial = 'rock'\nvertices_m = [[-30, -9], [30, -9], [30, -3], [-30, -3]]\n"
    "[[joint_set]]\ndip_deg = 90\nspacing_m = 5\norigin_m = [0, 0]\n";

/// The command is refused in one line that names the file, and nothing in the folder is other than before.
void check_refused(const Workplace& place, const std::string& command, const std::string& named) {
  INFO(command << ", " << named);
  const auto before = contents(place.folder().path());
  const CommandResult result = place.run(command);
  CHECK(result.status == 2);
  REQUIRE(result.errors.size() == 1);
  CHECK_THAT(result.errors[0], ContainsSubstring(named));
  CHECK(contents(place.folder().path()) == before);
}

}  // namespace

TEST_CASE("names that results have until they are complete, and that of their list, are not taken from anybody", "[cli][foreign]") {
  for (const std::string name :
       {"history.csv.part", "scene_as_read.toml.part", "summary.json.part", "checkpoint.bin.part", ".openclose", ".openclose.part"}) {
    const Workplace place;
    std::filesystem::create_directory(place.folder() / "out");
    place.folder().write("out/" + name, "my notes on openclose\n");
    check_refused(place, run_in_out, "out/" + name + ": is there and has not been written by openclose");
    check_refused(place, "fos scene.toml -q -o out", "out/" + name);
  }
}

TEST_CASE("scenes with such names are not written over", "[cli][foreign]") {
  for (const std::string name : {".openclose", "scene_as_read.toml.part", "summary.json.part", "history.csv.part"}) {
    const Workplace place("");
    place.folder().write(name, block_on_base);
    check_refused(place, "run " + name + " --dt 0.001 --end 0.01 -q -o .", name + ": is read, and a result of this name would replace it");
  }
  const Workplace place("");
  place.folder().write("blocks.toml.part", block_on_base + std::string(domain));
  check_refused(place, "cut blocks.toml.part -o blocks.toml", "blocks.toml.part: is there");
}

TEST_CASE("nothing is written through a link that has such a name", "[cli][foreign]") {
  const Workplace place;
  REQUIRE(place.run(run_in_out).status == 0);
  place.folder().write("victim", "mine\n");
  std::filesystem::create_symlink("../victim", place.folder() / "out/summary.json.part");
  check_refused(place, run_in_out, "out/summary.json.part");
}

TEST_CASE("cut and draw replace what they have written, as long as nobody has edited it", "[cli][foreign]") {
  const Workplace place;
  place.folder().write("rock.toml", block_on_base + std::string(domain));
  const std::string cut = "cut rock.toml -o blocks.toml -q", draw = "draw out -o drawing.svg -q";
  REQUIRE(place.run(run_in_out).status == 0);
  for (int i = 0; i < 2; ++i) {
    CHECK(place.run(cut).status == 0);
    CHECK(place.run(draw).status == 0);
  }
  CHECK(place.run("check blocks.toml").status == 0);
  std::ofstream(place.folder() / "blocks.toml", std::ios::app) << "# with a load of mine\n";
  check_refused(place, cut, "blocks.toml: is there and has not been written by openclose, or edited since");
  place.folder().write("drawing.svg", "<svg>\n<!-- drawn by openclose, lettered by me -->\n</svg>\n");
  check_refused(place, draw, "drawing.svg: is there and has not been written by openclose, or edited since");
  std::filesystem::rename(place.folder() / "drawing.svg", place.folder() / "out/drawing.svg");
  check_refused(place, run_in_out, "out/drawing.svg");
}

TEST_CASE("results that somebody has changed since are not replaced", "[cli][foreign]") {
  const Workplace place;
  const std::string command = run_in_out + std::string(" --set output.formats='[\"svg\",\"vtk\"]'");
  REQUIRE(place.run(command).status == 0);
  REQUIRE(place.run(command).status == 0);
  for (const std::string name : {"history.csv", "summary.json", "scene_as_read.toml", "svg/0001.svg", "vtk/blocks.pvd"}) {
    const std::string file = place.folder() / ("out/" + name), original = text_of(file);
    std::ofstream(file, std::ios::app) << "\n";
    check_refused(place, command, "out/" + name + ": has been changed since openclose has written it");
    check_refused(place, "fos scene.toml -q -o out", "out/" + name);
    std::ofstream(file, std::ios::trunc) << original;
  }
  // Another state than those of the run, as openclose would call it.
  place.folder().write("out/svg/0999.svg", "<svg/>");
  check_refused(place, command, "out/svg/0999.svg: is there and has not been written by openclose");
  std::filesystem::remove(place.folder() / "out/svg/0999.svg");
  CHECK(place.run("run scene.toml --dt 0.001 --end 0.01 -q -o out").status == 0);
  CHECK_FALSE(std::filesystem::exists(place.folder() / "out/svg"));
  CHECK_FALSE(std::filesystem::exists(place.folder() / "out/vtk"));
}

TEST_CASE("what is called like the folder of a format, and is none, stays", "[cli][foreign]") {
  const Workplace place;
  std::filesystem::create_directories(place.folder() / "out");
  std::filesystem::create_directories(place.folder() / "pictures");
  SECTION("a file") {
    place.folder().write("out/vtk", "mine\n");
    check_refused(place, run_in_out, "out/vtk: is no folder that can be read");
  }
  SECTION("a link to a folder") {
    std::filesystem::create_symlink("../pictures", place.folder() / "out/svg");
    const CommandResult result = place.run(run_in_out);
    CHECK(result.status == 2);
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], ContainsSubstring("out/svg: is no folder that can be read"));
    CHECK(std::filesystem::is_symlink(place.folder() / "out/svg"));
  }
}

TEST_CASE("a run that goes on writes no more to tables that have another name, too", "[cli][foreign][restart]") {
  const Workplace place;
  const std::string command = "run scene.toml --dt 0.001 -q --set output.checkpoint_every_s=0.005 -o ";
  REQUIRE(place.run(command + "out --end 0.01").status == 0);
  REQUIRE(std::system(("cd '" + place.folder().path() + "' && cp -al out kept").c_str()) == 0);
  const auto before = contents(place.folder() / "kept");
  REQUIRE(place.run(command + "out --end 0.02 --restart out/checkpoint.bin").status == 0);
  CHECK(contents(place.folder() / "kept") == before);
  CHECK(lines_of(place.folder() / "out/history.csv").size() > lines_of(place.folder() / "kept/history.csv").size());
}

TEST_CASE("what comes into the folder after a run that was stopped or killed is not taken for its own", "[cli][foreign]") {
  const Workplace place(block_on_incline(35.0));
  const std::string command = "run scene.toml --start unloaded --dt 0.001 -q -o out --end ";
  // A longer list than what the next analysis leaves.
  REQUIRE(place.run("fos scene.toml -q -o out").status == 0);
  for (const std::string signal : {"INT", "KILL"}) {
    INFO(signal);
    place.run(command + "1000", "timeout --foreground -s " + signal + " 1 ");
    REQUIRE(std::filesystem::exists(place.folder() / "out/history.csv"));
    for (const std::string name : {"curve.csv", "mechanism.csv", "trials.csv"}) {
      place.folder().write("out/" + name, "mine\n");
      check_refused(place, command + "0.01", "out/" + name + ": is there and has not been written by openclose");
      std::filesystem::remove(place.folder() / ("out/" + name));
    }
    CHECK(place.run(command + "0.01").status == 0);
  }
}
