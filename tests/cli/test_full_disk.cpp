// A disk that is full, or a limit on the size of files: every command ends with status 3 and one message that names the file, and leaves what was
// there.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "command.h"
#include "support/catch.h"

using namespace openclose::test;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Slides, so that there is something to write; every output there is.
std::string sliding_scene() {
  return block_on_incline(45.0) +
         "[[measured_point]]\nname = 'p'\nblock = 'block'\npoint_m = [0, 0]\n[output]\ncheckpoint_every_s = 0.02\n"
         "milestones_m = [0.001]\nsnapshots_every_s = 0.02\nformats = ['vtk', 'svg']\n";
}

/// One line that names the file.
void check_broken_off(const CommandResult& result, const std::string& file) {
  INFO(file);
  CHECK(result.status == 3);
  REQUIRE(result.errors.size() == 1);
  CHECK_THAT(result.errors[0], ContainsSubstring(file + ": cannot be written to its end"));
}

}  // namespace

TEST_CASE("a full disk under any file of a run or a search is named; the tables stay", "[cli][full_disk]") {
  struct Part {
    std::string command;
    std::vector<std::string> files;
  };
  const std::vector<Part> parts = {
      {"run scene.toml --start unloaded --dt 0.001 --end 0.1",
       {".openclose", "scene_as_read.toml", "block_properties.csv", "milestones.csv", "summary.json", "vtk/blocks.pvd", "svg/0000.svg"}},
      {"fos scene.toml",
       {".openclose", "scene_as_read.toml", "block_properties.csv", "trials.csv", "mechanism.csv", "summary.json", "vtk/blocks.pvd"}}};
  for (const Part& part : parts) {
    const Workplace place(sliding_scene());
    const std::string command = part.command + " -q -o out";
    REQUIRE(place.run(command).status == 0);
    for (const std::string& file : part.files) {
      INFO(part.command);
      REQUIRE(std::filesystem::exists(place.folder() / ("out/" + file)));
      check_broken_off(place.run(command, full_under("out/" + file)), "out/" + file);
      // Nothing that is not whole has a name of its own.
      CHECK((file == ".openclose" || !std::filesystem::exists(place.folder() / ("out/" + file))));
      REQUIRE(place.run(command).status == 0);
    }
  }
}

TEST_CASE("a run whose tables reach a limit on their size says which, and goes on from its checkpoint", "[cli][full_disk]") {
  const Workplace place(sliding_scene());
  const std::string command = "run scene.toml --start unloaded --dt 0.001 --end 0.1 -q --set 'output.formats=[]'";
  REQUIRE(place.run(command + " -o whole").status == 0);
  std::uintmax_t largest = 0;
  for (const auto& file : std::filesystem::directory_iterator(place.folder() / "whole")) largest = std::max(largest, file.file_size());
  bool with_checkpoint = false;
  // Half a kilobyte each; from what is just more than the scene's copy.
  const std::uintmax_t scene = std::filesystem::file_size(place.folder() / "whole/scene_as_read.toml");
  for (const double part : {0.1, 0.3, 0.6, 0.95}) {
    const auto limit = static_cast<std::uintmax_t>(static_cast<double>(scene) + part * static_cast<double>(largest - scene)) / 512;
    INFO(limit);
    std::filesystem::remove_all(place.folder() / "out");
    const CommandResult broken = place.run(command + " -o out", "ulimit -f " + std::to_string(limit) + " && ");
    CHECK(broken.status == 3);
    REQUIRE(broken.errors.size() == 1);
    CHECK_THAT(broken.errors[0], ContainsSubstring("out/") && ContainsSubstring(": cannot be written to its end"));
    CHECK_FALSE(std::filesystem::exists(place.folder() / "out/summary.json"));
    if (!std::filesystem::exists(place.folder() / "out/checkpoint.bin")) continue;
    with_checkpoint = true;
    CHECK(place.run(command + " --restart out/checkpoint.bin -o out").status == 0);
    for (const char* table : {"history.csv", "energy.csv", "blocks.csv", "contacts.csv", "cracks.csv", "block_states.csv", "milestones.csv"}) {
      INFO(table);
      if (std::string(table) == "milestones.csv") continue;  // has CPU times
      CHECK(text_of(place.folder() / (std::string("out/") + table)) == text_of(place.folder() / (std::string("whole/") + table)));
    }
  }
  CHECK(with_checkpoint);
}

TEST_CASE("a file that takes the place of another one does so when it is whole, also on a full disk", "[cli][full_disk]") {
  const Workplace place(sliding_scene());
  REQUIRE(place.run("run scene.toml --start unloaded --dt 0.001 --end 0.02 -q -o out").status == 0);
  struct Part {
    std::string command, file;
  };
  const std::vector<Part> parts = {{"draw out -o drawing.svg", "drawing.svg"},
                                   {"report out -o page.html", "page.html"},
                                   {"check scene.toml --dt 0.001 --spectrum spectrum.csv", "spectrum.csv"},
                                   {"study scene.toml --set method.start=unloaded --dt 0.002,0.001 --end 0.02 -q -o study", "study/study.csv"},
                                   {"sweep scene.toml --vary 'joint[0].friction_angle_deg=30,50' -q -o sweep", "sweep/sweep.csv"}};
  for (const Part& part : parts) {
    INFO(part.command);
    const CommandResult first = place.run(part.command);
    INFO(first.out);
    CHECK(first.status == 0);
    const std::string before = text_of(place.folder() / part.file);
    CHECK_FALSE(before.empty());
    check_broken_off(place.run(part.command, full_under(part.file)), part.file);
    CHECK(text_of(place.folder() / part.file) == before);
  }
}

TEST_CASE("an answer on standard output that is lost is no success, and a message that is lost no crash", "[cli][full_disk]") {
  const Workplace place;
  for (const char* command :
       {"check scene.toml", "check scene.toml --json", "explain --page", "run scene.toml --dt 0.001 --end 0.01 --json -o out"}) {
    INFO(command);
    const CommandResult result = place.run(std::string("") + command + " >/dev/full #");
    CHECK(result.status == 3);
  }
  for (const char* command : {"check nowhere.toml", "check nowhere.toml --json"})
    CHECK(place.run(std::string(command) + " >/dev/full 2>/dev/full #").status == 2);
  // A warning that nobody sees ends nothing.
  CHECK(place.run("run scene.toml --dt 0.001 --end 0.01 --set 'output.milestones_m=[9]' -q -o out 2>/dev/full #").status == 0);
}
