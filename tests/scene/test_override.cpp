#include "openclose/scene/angle.h"
#include "scene_file.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::block_on_base;
using openclose::test::read_text;
using openclose::test::SceneFile;

namespace {

/// The error with the file's name cut off.
std::string error_of(const std::string& override) {
  const SceneFile file(block_on_base);
  try {
    read_scene(file.path(), {override});
  } catch (const InputError& error) {
    const std::string message = error.what();
    REQUIRE(message.substr(0, file.path().size() + 2) == file.path() + ": ");
    REQUIRE(message.find('\n') == std::string::npos);
    return message.substr(file.path().size() + 2);
  }
  FAIL("no error for " << override);
  return {};
}

}  // namespace

TEST_CASE("overrides replace values of the file", "[scene][override]") {
  CHECK(read_text(block_on_base, {"joint[0].friction_angle_deg=20"}).joints[0].friction_angle == radians(20.0));
  CHECK(read_text(block_on_base, {"joint[0].friction_angle_deg = 20"}).joints[0].friction_angle == radians(20.0));
  CHECK(read_text(block_on_base, {"block[1].vertices_m[0]=[-0.5, 0]"}).blocks[1].vertices[0] == Vec2(-0.5, 0.0));
  CHECK(read_text(block_on_base, {"block[1].vertices_m[0][1]=0.5"}).blocks[1].vertices[0] == Vec2(0.0, 0.5));
  CHECK(read_text(block_on_base, {"block[0].fixed=false"}).blocks[0].fixed == false);
  SECTION("the last one counts") {
    CHECK(read_text(block_on_base, {"step.dt_s=1", "step.dt_s=2"}).step.dt == 2.0);
  }
}

TEST_CASE("overrides add what the file leaves out", "[scene][override]") {
  CHECK(read_text(block_on_base, {"method.theta=0.6"}).method.theta == 0.6);
  CHECK(read_text(block_on_base, {"method={theta=0.7, statics=true}"}).method.theta == 0.7);
  CHECK(read_text(block_on_base, {"gravity_m_per_s2=[0, -1]"}).gravity == Vec2(0.0, -1.0));
  CHECK(read_text(block_on_base, {"joint[0].cohesion_pa=1e3"}).joints[0].cohesion == 1e3);
  CHECK(read_text(block_on_base, {"end.time_s=1e-3"}).end_time == 1e-3);
}

TEST_CASE("elements of arrays go by their names, too", "[scene][override]") {
  const Scene scene = read_text(block_on_base, {"material.rock.density_kg_per_m3=1234", "block.base.fixed=false"});
  CHECK(scene.materials.at(0).density == 1234.0);
  CHECK_FALSE(scene.blocks.at(0).fixed);
  CHECK_THROWS_WITH(
      read_text(block_on_base, {"material.granite.density_kg_per_m3=1"}),
      ContainsSubstring("no material is called \"granite\"; accepted: an index, [0] to [0], before it, or the name of an element: \"rock\""));
}

TEST_CASE("what several loads share is no name of one of them", "[scene][override]") {
  const std::string loads = block_on_base +
                            "[[load]]\nname = 'a'\npoint_m = [0, 1]\nforce_n = [1, 0]\n[[load]]\nname = 'b'\npoint_m = [0, 1]\nforce_n = [2, 0]\n"
                            "[[load]]\nname = 'b'\npoint_m = [1, 1]\nforce_n = [3, 0]\n";
  CHECK(read_text(loads, {"load.a.force_n=[7, 8]"}).loads.at(0).force == Vec2(7.0, 8.0));
  CHECK(read_text(loads, {"strength_reduction.increase=-b"}).strength_reduction.increase == "-b");
  CHECK_THROWS_WITH(read_text(loads, {"load.b.force_n=[7, 8]"}), ContainsSubstring("2 are called \"b\"; accepted: an index, such as [1]"));
}

TEST_CASE("a single word is a text with or without quotes", "[scene][override]") {
  CHECK(read_text(block_on_base, {"method.contact=shi"}).method.contact == "shi");
  CHECK(read_text(block_on_base, {"method.contact=\"shi\""}).method.contact == "shi");
  CHECK(read_text(block_on_base, {"method.start=normal_balanced"}).method.start == Start::normal_balanced);
  CHECK(read_text(block_on_base, {"title='two words'"}).title == "two words");
}

TEST_CASE("where an overridden contact method stands", "[scene][override]") {
  const SceneFile file(block_on_base);
  const SourceLocation where = read_scene(file.path(), {"method.contact=shi"}).method.contact_where;
  CHECK(where.file == file.path() + ": command line");
  CHECK(where.line == 0);
}

TEST_CASE("errors in overridden values name the override", "[scene][override]") {
  CHECK(error_of("method.theta=2") == "command line: method.theta: 2 is out of range; accepted: a number in [0.5, 1]");
  CHECK(error_of("step.dt_s=abc") == "command line: step.dt_s: \"abc\" is a string; accepted: a number > 0");
  CHECK(error_of("step.dt_s=") == "command line: step.dt_s: \"\" is not a TOML value; accepted: a number, true, false, a text, or [x, y]");
  CHECK(error_of("step.dt_s=nan") == "command line: step.dt_s: nan is not a finite number; accepted: a number > 0");
  CHECK(error_of("step={dt_s=0}") == "command line: step.dt_s: 0 is out of range; accepted: a number > 0");
  CHECK(error_of("block[1].vertices_m[2]=[5]") ==
        "command line: block[1].vertices_m[2]: is an array of 1 values; accepted: [x, y], each a number in [-10000000, 10000000]");
}

TEST_CASE("overrides of keys that are not known", "[scene][override]") {
  CHECK_THAT(error_of("method.thetta=1"),
             ContainsSubstring("command line: method.thetta: this key is not known, did you mean theta?; accepted: theta, "));
  CHECK_THAT(error_of("metod.theta=1"), ContainsSubstring("command line: metod: this key is not known, did you mean method?; accepted: method, "));
  CHECK(error_of("step.dt_ms=1") == "command line: step.dt_ms: this key has another unit; accepted: dt_s");
}

TEST_CASE("overrides of elements that are not there", "[scene][override]") {
  CHECK(error_of("joint[1].cohesion_pa=1") == "command line: joint[1].cohesion_pa: there is no [1]; accepted: [0] to [0]");
  CHECK(error_of("block[1].vertices_m[4]=[0, 0]") == "command line: block[1].vertices_m[4]: there is no [4]; accepted: [0] to [3]");
  CHECK(error_of("joint.cohesion_pa=1") ==
        "command line: joint.cohesion_pa: \"cohesion_pa\" follows an array; accepted: an index, [0] to [0], before it, or the name of an element; "
        "none of them "
        "has one");
  CHECK(error_of("method[0]=1") == "command line: method[0]: [0] follows something that is not an array; accepted: a key that the scene has");
  CHECK(error_of("block[0].name.x=1") ==
        "command line: block[0].name.x: \"x\" follows something that is not a table; accepted: a key that the scene has");
  CHECK_THAT(error_of("load[0].force_n=[1, 1]"), ContainsSubstring("command line: load[0].force_n: [0] follows something that is not an array"));
}

TEST_CASE("overrides that are no assignments", "[scene][override]") {
  const std::string accepted = "; accepted: --set KEY=VALUE, e.g. --set joint[0].friction_angle_deg=20";
  CHECK(error_of("method.theta") == "--set method.theta: this is no assignment" + accepted);
  CHECK(error_of("=1") == "--set =1: this is no assignment" + accepted);
  CHECK(error_of("joint[0=1") == "command line: joint[0: this is not a dotted key; accepted: one such as joint[0].friction_angle_deg");
  CHECK(error_of("joint[x].cohesion_pa=1") ==
        "command line: joint[x].cohesion_pa: this is not a dotted key; accepted: one such as joint[0].friction_angle_deg");
  CHECK(error_of("joint[-1].cohesion_pa=1") ==
        "command line: joint[-1].cohesion_pa: this is not a dotted key; accepted: one such as joint[0].friction_angle_deg");
  CHECK_THAT(error_of("step.dt_s=1\nother=2"), ContainsSubstring("is not a TOML value"));
  CHECK_THAT(error_of("title=two words"), ContainsSubstring("\"two words\" is not a TOML value"));
}
