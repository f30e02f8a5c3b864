// The cut command: what it writes, and that it writes all or nothing.
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "cli/command.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using openclose::test::CommandResult;
using openclose::test::lines_of;
using openclose::test::text_of;
using openclose::test::with_line;
using openclose::test::Workplace;

namespace {

using Names = std::set<std::string>;

/// Twelve blocks, the lowest four of them fixed.
const std::string wall =
    "title = 'A wall & more'\n"                        // 1
    "[[material]]\n"                                   // 2
    "name = 'rock'\n"                                  // 3
    "density_kg_per_m3 = 2700\n"                       // 4
    "[[joint]]\n"                                      // 5
    "materials = ['rock', 'rock']\n"                   // 6
    "normal_stiffness_pa_per_m = 1e9\n"                // 7
    "shear_stiffness_pa_per_m = 1e9\n"                 // 8
    "friction_angle_deg = 35\n"                        // 9
    "[domain]\n"                                       // 10
    "material = 'rock'\n"                              // 11
    "vertices_m = [[0, 0], [4, 0], [4, 3], [0, 3]]\n"  // 12
    "[[joint_set]]\n"                                  // 13
    "dip_deg = 0\n"                                    // 14
    "spacing_m = 1\n"                                  // 15
    "origin_m = [0, 0]\n"                              // 16
    "[[joint_set]]\n"                                  // 17
    "dip_deg = 90\n"                                   // 18
    "spacing_m = 1\n"                                  // 19
    "origin_m = [0, 0]\n"                              // 20
    "[[fixed_line]]\n"                                 // 21
    "from_m = [0, 0]\n"                                // 22
    "to_m = [4, 0]\n";                                 // 23

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

void check_refused(const Workplace& place, const std::string& arguments, const std::string& message) {
  INFO(arguments);
  const Names before = place.folder().entries();
  const CommandResult result = place.run(arguments);
  CHECK(result.status == 2);
  CHECK(result.out.empty());
  REQUIRE(result.errors.size() == 1);
  CHECK_THAT(result.errors[0], StartsWith("openclose: ") && ContainsSubstring(message) && ContainsSubstring("; accepted: "));
  CHECK(place.folder().entries() == before);
}

}  // namespace

TEST_CASE("cut writes the blocks as a scene and draws them", "[cli][cut]") {
  const Workplace place(wall);
  const CommandResult result = place.run("cut scene.toml -o out/wall.toml");
  CHECK(result.status == 0);
  CHECK(result.errors.empty());
  CHECK(count_of(result.out, "\n") == 2);
  CHECK_THAT(result.out, StartsWith("scene.toml: 12 blocks cut by ") &&
                             ContainsSubstring("12 m2 (domain 12 m2), smallest 1 m2; 4 of 12 blocks fixed") &&
                             ContainsSubstring("0 slivers merged (0 m2), 0 dangling ends dropped; written to out/wall.toml and out/wall.svg"));
  CHECK(place.folder().entries() == Names{"scene.toml", "out"});
  std::set<std::string> written;
  for (const auto& entry : std::filesystem::directory_iterator(place.folder() / "out")) written.insert(entry.path().filename().string());
  CHECK(written == Names{"wall.toml", "wall.svg"});

  SECTION("the scene can be read again: the same blocks, areas and contacts") {
    const std::string whole = place.run("check scene.toml").out;
    const std::string again = place.run("check out/wall.toml").out;
    CHECK_THAT(whole, StartsWith("scene.toml: 12 blocks, 8 of them free, 12 m2 (8 m2 free); "));
    CHECK(again == "out/wall.toml" + whole.substr(std::string("scene.toml").size()));
  }
  SECTION("there is nothing left in it to cut") {
    check_refused(place, "cut out/wall.toml -o out/again.toml", "domain: the scene has none");
  }
  SECTION("the drawing has every block by its name, the fixed ones marked, title, materials and scale") {
    const std::string drawing = text_of(place.folder() / "out/wall.svg");
    CHECK_THAT(drawing, StartsWith("<svg ") && ContainsSubstring("A wall &amp; more (12 blocks)") && ContainsSubstring(">rock</text>") &&
                            ContainsSubstring(">1 m</text>") && ContainsSubstring(">fixed</text>"));
    CHECK(count_of(drawing, "</title></polygon>") == 12);
    CHECK(count_of(drawing, "<polygon") == 12 + 4);
    CHECK(count_of(drawing, "<title>b0007</title>") == 1);
  }
}

TEST_CASE("cut tells the dip in the section of a set written by dip and dip direction", "[cli][cut]") {
  // Planes that fall along the section keep their dip and spacing; of those that fall 60 degrees off its back, tan(dip) is half as much.
  std::string scene = with_line(wall, 18, "dip_deg = 45\ndip_direction_deg = 330");
  scene = with_line(scene, 14, "dip_deg = 45\ndip_direction_deg = 90");
  scene = with_line(scene, 11, "material = 'rock'\nsection_direction_deg = 90");
  const Workplace place(scene);
  const std::string out = place.run("cut scene.toml -o out/slope.toml").out;
  CHECK_THAT(out, ContainsSubstring("joint set of line 14: in the section its joints dip 45 degrees to the right and lie 1 m apart\n"));
  CHECK_THAT(out, ContainsSubstring("in the section its joints dip 26.6 degrees to the left and lie "));
  // Planes that fall out of the section are level lines in it.
  place.folder().write("level.toml", with_line(with_line(scene, 15, "dip_deg = 45"), 16, "dip_direction_deg = 0"));
  CHECK_THAT(place.run("cut level.toml -o out/level.toml").out, ContainsSubstring("in the section its joints are horizontal and lie "));
}

TEST_CASE("names of the files that cut writes", "[cli][cut]") {
  const Workplace place(wall);
  SECTION("by default after the scene, in results") {
    CHECK(place.run("cut scene.toml").status == 0);
    CHECK(std::filesystem::is_regular_file(place.folder() / "results/scene/blocks.toml"));
    CHECK(std::filesystem::is_regular_file(place.folder() / "results/scene/blocks.svg"));
  }
  SECTION("the drawing elsewhere") {
    CHECK(place.run("cut scene.toml -o wall.toml --svg pictures/deep/wall.svg").status == 0);
    CHECK(place.folder().entries() == Names{"scene.toml", "wall.toml", "pictures"});
    CHECK(std::filesystem::is_regular_file(place.folder() / "pictures/deep/wall.svg"));
  }
  SECTION("old ones are replaced") {
    REQUIRE(place.run("cut scene.toml -o wall.toml --set title=old").status == 0);
    REQUIRE(text_of(place.folder() / "wall.toml").find("old") != std::string::npos);
    CHECK(place.run("cut scene.toml -o wall.toml").status == 0);
    CHECK(text_of(place.folder() / "wall.toml").find("old") == std::string::npos);
    CHECK(count_of(text_of(place.folder() / "wall.toml"), "[[block]]") == 12);
    CHECK_THAT(text_of(place.folder() / "wall.svg"), StartsWith("<svg "));
    CHECK(place.folder().entries() == Names{"scene.toml", "wall.toml", "wall.svg"});
  }
}

TEST_CASE("a quiet cut says nothing", "[cli][cut]") {
  const Workplace place(wall);
  const CommandResult result = place.run("cut scene.toml -o wall.toml --quiet");
  CHECK(result.status == 0);
  CHECK(result.out.empty());
  CHECK(result.errors.empty());
  SECTION("but what it warns of") {
    const Workplace loose(wall + "[[joint_line]]\nfrom_m = [0.2, 0.2]\nto_m = [0.8, 0.7]\n");
    const CommandResult warned = loose.run("cut scene.toml -o wall.toml -q");
    CHECK(warned.status == 0);
    CHECK(warned.out.empty());
    REQUIRE(warned.errors.size() == 1);
    CHECK_THAT(warned.errors[0], StartsWith("openclose: warning: scene.toml: line 24: the line ends loose inside one block"));
  }
}

TEST_CASE("cut takes overrides", "[cli][cut]") {
  const Workplace place(wall);
  const CommandResult result = place.run("cut scene.toml -o wall.toml --set joint_set[1].spacing_m=2");
  CHECK(result.status == 0);
  CHECK_THAT(result.out, StartsWith("scene.toml: 6 blocks cut by "));
}

TEST_CASE("cut writes both files or none", "[cli][cut][bad_input]") {
  const Workplace place(wall);
  place.folder().write("file", "kept");
  std::filesystem::create_directory(place.folder() / "folder.svg");
  const std::string cannot = "cannot be written";
  check_refused(place, "cut scene.toml -o new/wall.toml --svg file/wall.svg", "file/wall.svg: " + cannot);
  check_refused(place, "cut scene.toml -o wall.toml --svg /proc/openclose/wall.svg", "/proc/openclose/wall.svg: " + cannot);
  check_refused(place, "cut scene.toml -o file/wall.toml --svg new/wall.svg", "file/wall.toml: " + cannot);
  check_refused(place, "cut scene.toml -o wall.toml --svg folder.svg", "folder.svg: is there and cannot be written over");
  check_refused(place, "cut scene.toml -o same.svg", "same.svg: the blocks and their drawing cannot be the same file");
  check_refused(place, "cut scene.toml -o a.toml --svg ./a.toml", "a.toml: the blocks and their drawing cannot be the same file");
  CHECK(text_of(place.folder() / "file") == "kept");
  SECTION("an older scene stays when the drawing cannot be made") {
    REQUIRE(place.run("cut scene.toml -o wall.toml --svg wall.svg").status == 0);
    std::ofstream(place.folder() / "wall.toml", std::ios::app) << "# old";
    const std::string old = text_of(place.folder() / "wall.toml");
    CHECK(place.run("cut scene.toml -o wall.toml --svg file/wall.svg").status == 2);
    CHECK(text_of(place.folder() / "wall.toml") == old);
  }
  SECTION("files that openclose has not written stay") {
    place.folder().write("wall.toml", "title = 'mine'");
    place.folder().write("wall.svg", "<svg>mine</svg>");
    check_refused(place, "cut scene.toml -o wall.toml --svg new.svg", "wall.toml: is there and has not been written by openclose");
    check_refused(place, "cut scene.toml -o new.toml --svg wall.svg", "wall.svg: is there and has not been written by openclose");
    CHECK(text_of(place.folder() / "wall.toml") == "title = 'mine'");
    CHECK(text_of(place.folder() / "wall.svg") == "<svg>mine</svg>");
  }
}

TEST_CASE("cut does not write over the scene that it cuts", "[cli][cut][bad_input]") {
  const Workplace place(wall);
  check_refused(place, "cut scene.toml -o scene.toml", "scene.toml: this is the scene that is being cut");
  check_refused(place, "cut scene.toml -o ./scene.toml --svg a.svg", "this is the scene that is being cut");
  check_refused(place, "cut scene.toml -o wall.toml --svg scene.toml", "this is the scene that is being cut");
  CHECK(text_of(place.folder() / "scene.toml") == wall);
}

TEST_CASE("bad domains and joints: nothing is written", "[cli][cut][bad_input]") {
  const auto refused = [](int line, const std::string& replacement, const std::string& message) {
    INFO(replacement);
    const Workplace place(with_line(wall, line, replacement));
    check_refused(place, "cut scene.toml -o out/wall.toml", "scene.toml:" + message);
    check_refused(place, "check scene.toml", "scene.toml:" + message);
  };
  refused(12, "vertices_m = [[0, 0], [4, 3], [4, 0], [0, 3]]", "12: domain.vertices_m: the polygon intersects or touches itself");
  refused(15, "spacing_m = 0", "15: joint_set[0].spacing_m: 0 is out of range");
  refused(15, "spacing_m = nan", "15: joint_set[0].spacing_m: nan is not a finite number");
  refused(15, "spacing_m = 1e-9", "13: joint_set[0]: the set has more than 1000000 traces in the domain");
  refused(14, "dip_deg = 90", "17: joint_set[1]: the set is parallel to the one of line 13 and shares joints with it");
  refused(16, "origin_m = [0, 9]\nregion_m = [[8, 8], [9, 8], [9, 10]]", "13: joint_set[0]: no trace of the set is in the domain");
}

TEST_CASE("a scene without a domain cannot be cut", "[cli][cut][bad_input]") {
  const Workplace place;
  check_refused(place, "cut scene.toml", "scene.toml: domain: the scene has none");
}
