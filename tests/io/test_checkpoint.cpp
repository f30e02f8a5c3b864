#include <cmath>
#include <regex>
#include <string>

#include "io/files.h"
#include "openclose/core/check_sum.h"
#include "openclose/core/error.h"
#include "openclose/io/checkpoint.h"
#include "openclose/version.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::TemporaryFolder;
using openclose::test::text_of;

namespace {

Scene a_scene() {
  Scene scene = test::block_on_base();
  scene.end_time = 2.0;
  return scene;
}

Checkpoint a_checkpoint() {
  return {1.5, {{"history.csv", 5, check_sum("12345")}}, "state"};
}

struct Saved {
  TemporaryFolder folder;
  std::string path = folder / "checkpoint.bin";
  Saved() {
    folder.write("history.csv", "12345678");
    write_checkpoint(path, a_scene(), a_checkpoint());
  }
};

std::string refusal(const std::string& path, const Scene& scene) {
  try {
    read_checkpoint(path, scene);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// "format 7" of a checkpoint, from its first line.
std::string format_named_in(const std::string& checkpoint) {
  std::smatch found;
  const std::string first_line = checkpoint.substr(0, checkpoint.find('\n'));
  return std::regex_search(first_line, found, std::regex("format [0-9]+")) ? found.str() : "a format";
}

}  // namespace

TEST_CASE("a checkpoint comes back", "[io][checkpoint]") {
  const Saved saved;
  Scene scene = a_scene();
  // What may have changed.
  scene.title = "again";
  scene.end_time = 3.0;
  scene.output_every = 0.5;
  scene.checkpoint_every = 0.25;
  scene.step.smallest_fraction = 1e-3;
  scene.method.max_iterations = 7;
  scene.method.threads = 2;
  const Checkpoint read = read_checkpoint(saved.path, scene);
  CHECK(read.time == 1.5);
  CHECK(read.tables == a_checkpoint().tables);
  CHECK(read.state == "state");
  CHECK(saved.folder.entries() == std::set<std::string>{"checkpoint.bin", "history.csv"});
  CHECK(text_of(saved.path).rfind("openclose checkpoint, " + format_named_in(text_of(saved.path)) + ", version " + std::string(version) + "\n", 0) ==
        0);
}

TEST_CASE("a checkpoint that cannot be made is no bad input: the run has begun", "[io][checkpoint]") {
  const Saved saved;
  CHECK_THROWS_AS(write_checkpoint(saved.folder / "history.csv/checkpoint.bin", a_scene(), a_checkpoint()), WriteError);
  CHECK(saved.folder.entries() == std::set<std::string>{"checkpoint.bin", "history.csv"});
}

TEST_CASE("a checkpoint does not take the place of a file that has come there while the run went on", "[io][checkpoint]") {
  const Saved saved;
  for (const char* name : {"checkpoint.bin", "checkpoint.bin.part"}) {
    saved.folder.write(name, "notes on openclose");
    CHECK_THROWS_WITH(write_checkpoint(saved.path, a_scene(), a_checkpoint()),
                      ContainsSubstring("checkpoint.bin: has been replaced") && !ContainsSubstring("disk"));
    CHECK_THROWS_AS(write_checkpoint(saved.path, a_scene(), a_checkpoint()), WriteError);
    CHECK(text_of(saved.folder / name) == "notes on openclose");
    std::filesystem::remove(saved.folder / name);
  }
  CHECK_NOTHROW(write_checkpoint(saved.path, a_scene(), a_checkpoint()));
}

TEST_CASE("a checkpoint of another scene is refused by what differs first", "[io][checkpoint]") {
  const Saved saved;
  Scene scene = a_scene();
  scene.joints[0].friction_angle = 0.25;
  CHECK_THAT(refusal(saved.path, scene), ContainsSubstring("it belongs to another scene") && ContainsSubstring("friction_angle_deg"));
  scene = a_scene();
  scene.method.contact = "hard";
  CHECK_THAT(refusal(saved.path, scene), ContainsSubstring("there \"contact = \"soft\"\", here \"contact = \"hard\"\""));
  scene = a_scene();
  scene.step.dt = 2e-3;
  CHECK_THAT(refusal(saved.path, scene), ContainsSubstring("dt_s = 0.002"));
}

TEST_CASE("a checkpoint behind the end of the scene is refused", "[io][checkpoint]") {
  const Saved saved;
  Scene scene = a_scene();
  scene.end_time = 1.0;
  CHECK_THAT(refusal(saved.path, scene),
             ContainsSubstring("end.time_s") && ContainsSubstring("1 s lies before the checkpoint, which stands at 1.5 s"));
}

TEST_CASE("a checkpoint that stands at the end but for rounding is read", "[io][checkpoint]") {
  const Saved saved;
  Scene scene = a_scene();
  scene.end_time = std::nextafter(1.5, 0.0);
  CHECK(read_checkpoint(saved.path, scene).time == 1.5);
}

TEST_CASE("a checkpoint without the tables of its run is refused", "[io][checkpoint]") {
  const Saved saved;
  saved.folder.write("history.csv", "12845678");
  CHECK_THAT(refusal(saved.path, a_scene()), ContainsSubstring("history.csv") && ContainsSubstring("are not those that the run has written"));
  saved.folder.write("history.csv", "1234");
  CHECK_THAT(refusal(saved.path, a_scene()), ContainsSubstring("history.csv") && ContainsSubstring("first 5 bytes"));
  std::filesystem::remove(saved.folder / "history.csv");
  CHECK_THAT(refusal(saved.path, a_scene()), ContainsSubstring("history.csv"));
}

TEST_CASE("no checkpoint, a damaged one, or one of another version is refused", "[io][checkpoint]") {
  const Saved saved;
  CHECK_THAT(refusal(saved.folder / "none.bin", a_scene()), ContainsSubstring("there is no such file"));
  CHECK_THAT(refusal(saved.folder.path(), a_scene()), ContainsSubstring("this is not a regular file"));
  CHECK_THAT(refusal(saved.folder / "history.csv", a_scene()), ContainsSubstring("this is no checkpoint"));
  const std::string whole = text_of(saved.path);
  for (const std::size_t at : {whole.size() - 1, whole.size() / 2, std::size_t{60}}) {
    std::string flipped = whole;
    flipped[at] ^= 1;
    CHECK_THAT(refusal(saved.folder.write("flipped.bin", flipped), a_scene()), ContainsSubstring("the checkpoint is damaged"));
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{10}, whole.size() / 2, whole.size() - 1}) {
    CHECK_THAT(refusal(saved.folder.write("cut.bin", whole.substr(0, length)), a_scene()),
               ContainsSubstring(length < 30 ? "this is no checkpoint" : "the checkpoint is damaged"));
  }
  const std::string current = format_named_in(whole);
  std::string older = whole;
  older.replace(older.find(current), current.size(), "format 3");
  const auto heading_of = [](const std::string& bytes) { return bytes.substr(0, bytes.find('\n')); };
  CHECK_THAT(refusal(saved.folder.write("older.bin", older), a_scene()),
             ContainsSubstring("it was written by another version: " + heading_of(older) + "; accepted: " + heading_of(whole)));
}
