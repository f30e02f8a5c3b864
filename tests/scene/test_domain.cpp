#include <algorithm>
#include <cmath>
#include <map>

#include "openclose/geometry/polygon.h"
#include "openclose/scene/check.h"
#include "openclose/scene/writer.h"
#include "scene_file.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::read_text;
using openclose::test::SceneFile;

namespace {

/// A square of 4 m with two joint sets at right angles; what is appended begins on line 28.
const std::string square_domain =
    "[[material]]\n"                                   // 1
    "name = 'rock'\n"                                  // 2
    "density_kg_per_m3 = 2700\n"                       // 3
    "[[material]]\n"                                   // 4
    "name = 'clay'\n"                                  // 5
    "density_kg_per_m3 = 2000\n"                       // 6
    "[[joint]]\n"                                      // 7
    "materials = ['rock', 'rock']\n"                   // 8
    "normal_stiffness_pa_per_m = 1e9\n"                // 9
    "shear_stiffness_pa_per_m = 4e8\n"                 // 10
    "friction_angle_deg = 35\n"                        // 11
    "\n"                                               // 12
    "[domain]\n"                                       // 13
    "material = 'rock'\n"                              // 14
    "vertices_m = [[0, 0], [4, 0], [4, 4], [0, 4]]\n"  // 15
    "\n"                                               // 16
    "[[joint_set]]\n"                                  // 17
    "dip_deg = 0\n"                                    // 18
    "spacing_m = 1\n"                                  // 19
    "origin_m = [0, 0]\n"                              // 20
    "\n"                                               // 21
    "[[joint_set]]\n"                                  // 22
    "dip_deg = 90\n"                                   // 23
    "spacing_m = 2\n"                                  // 24
    "origin_m = [0, 0]\n"                              // 25
    "\n"                                               // 26
    "\n";                                              // 27

/// The same without joints: lines 1 to 16.
const std::string bare_domain = square_domain.substr(0, square_domain.find("[[joint_set]]"));

std::string line(double x0, double y0, double x1, double y1) {
  return "[[joint_line]]\nfrom_m = [" + std::to_string(x0) + ", " + std::to_string(y0) + "]\nto_m = [" + std::to_string(x1) + ", " +
         std::to_string(y1) + "]\n";
}

/// [m] Of all edges of blocks that have this joint.
double length_of(const Scene& scene, int joint) {
  double length = 0.0;
  for (const BlockInput& block : scene.blocks) {
    for (std::size_t i = 0; i < block.edge_joints.size(); ++i) {
      if (block.edge_joints[i] == joint) length += (block.vertices[(i + 1) % block.vertices.size()] - block.vertices[i]).norm();
    }
  }
  return length;
}

std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const SceneFile file(text);
  try {
    read_scene(file.path(), overrides);
  } catch (const InputError& error) {
    const std::string message = error.what();
    REQUIRE(message.find('\n') == std::string::npos);
    REQUIRE(message.substr(0, file.path().size() + 1) == file.path() + ":");
    return message.substr(file.path().size() + 1);
  }
  FAIL("no error");
  return {};
}

std::string error_with(int line_number, const std::string& replacement) {
  return error_of(test::with_line(square_domain, line_number, replacement));
}

std::vector<std::vector<Vec2>> polygons(const Scene& scene) {
  std::vector<std::vector<Vec2>> all;
  for (const BlockInput& block : scene.blocks) all.push_back(block.vertices);
  return all;
}

Scene paper_scene(const std::string& name) {
  return read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/" + name + ".toml");
}

int fixed_blocks(const Scene& scene) {
  return static_cast<int>(std::count_if(scene.blocks.begin(), scene.blocks.end(), [](const BlockInput& block) { return block.fixed; }));
}

}  // namespace

TEST_CASE("a domain is cut into blocks as it is read", "[scene][domain]") {
  const Scene scene = read_text(square_domain);
  REQUIRE(scene.blocks.size() == 8);
  CHECK(scene.blocks[0].name == "b0001");
  CHECK(scene.blocks[0].vertices == std::vector<Vec2>{{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}});
  CHECK(scene.blocks[1].name == "b0002");
  CHECK(scene.blocks[1].vertices[0] == Vec2(2.0, 0.0));
  CHECK(scene.blocks[7].name == "b0008");
  REQUIRE(scene.cutting.has_value());
  CHECK(scene.cutting->blocks == 8);
  CHECK(scene.cutting->area == 16.0);
  CHECK(scene.cutting->domain_area == 16.0);
  CHECK(scene.cutting->smallest_block == 2.0);
  CHECK(scene.cutting->warnings.empty());
  CHECK_NOTHROW(check_scene(scene));
}

TEST_CASE("the domain's own joints may be none", "[scene][domain]") {
  CHECK(read_text(bare_domain).blocks.size() == 1);
}

TEST_CASE("the order of the joints makes no difference", "[scene][domain]") {
  const std::string sets = square_domain.substr(square_domain.find("[[joint_set]]"));
  const std::size_t second = sets.find("[[joint_set]]", 1);
  const std::string a = line(0.3, 0.2, 3.7, 3.9);
  const std::string b = line(3.9, 0.1, 0.1, 2.3);
  const Scene one = read_text(bare_domain + sets + a + b);
  const Scene other = read_text(bare_domain + b + sets.substr(second) + a + sets.substr(0, second));
  CHECK(one.blocks.size() == 14);
  CHECK(polygons(one) == polygons(other));
}

TEST_CASE("a scene with blocks cut and blocks written", "[scene][domain]") {
  const std::string extra = "[[block]]\nname = 'footing'\nmaterial = 'rock'\nvertices_m = [[1, 4], [3, 4], [3, 5], [1, 5]]\n";
  const Scene scene = read_text(square_domain + extra);
  REQUIRE(scene.blocks.size() == 9);
  CHECK(scene.blocks[0].name == "footing");
  SECTION("names must not clash") {
    CHECK_THAT(error_of(square_domain + extra, {"block[0].name=b0003"}), ContainsSubstring("\"b0003\" is already the name of the block"));
  }
  SECTION("overlaps are found") {
    CHECK_THROWS_WITH(check_scene(read_text(square_domain + extra, {"block[0].vertices_m[0]=[1, 3.5]"})), ContainsSubstring("overlaps"));
  }
}

TEST_CASE("regions give materials to the blocks whose centroids they contain", "[scene][domain]") {
  const std::string region = "[[region]]\nmaterial = 'clay'\nvertices_m = [[-1, -1], [5, -1], [5, 1.9], [-1, 1.9]]\n";
  const std::string later = "[[region]]\nmaterial = 'rock'\nvertices_m = [[0, 0], [1.5, 0], [1.5, 0.6], [0, 0.6]]\n";
  const Scene scene = read_text(square_domain + region + later);
  CHECK(scene.blocks[0].material == 0);
  CHECK(scene.blocks[1].material == 1);
  CHECK(scene.blocks[2].material == 1);
  CHECK(scene.blocks[4].material == 0);
}

TEST_CASE("blocks along a line are fixed", "[scene][domain]") {
  const Scene scene = read_text(square_domain + "[[fixed_line]]\nfrom_m = [0, 0]\nto_m = [4, 0]\n");
  for (std::size_t i = 0; i < scene.blocks.size(); ++i) CHECK(scene.blocks[i].fixed == (i < 2));
  SECTION("one that touches it with a corner is not") {
    CHECK(fixed_blocks(read_text(square_domain + "[[fixed_line]]\nfrom_m = [0, 0]\nto_m = [2, 0]\n")) == 1);
  }
  SECTION("written blocks are, too") {
    CHECK(fixed_blocks(read_text(test::block_on_base + "[[fixed_line]]\nfrom_m = [0.2, 1]\nto_m = [0.7, 1]\n")) == 2);
  }
  SECTION("a line that touches nothing is a mistake") {
    CHECK(error_of(square_domain + "[[fixed_line]]\nfrom_m = [0, -1]\nto_m = [4, -1]\n") ==
          "28: fixed_line[0]: no block touches the line; accepted: a line along edges of blocks, or through blocks");
  }
}

TEST_CASE("points tell their blocks", "[scene][domain]") {
  const Scene scene =
      read_text(square_domain + "[[measured_point]]\nname = 'p'\npoint_m = [3, 0.5]\n[[load]]\npoint_m = [1, 4]\nforce_n = [0, -1]\n");
  CHECK(scene.blocks[scene.measured_points[0].block].name == "b0002");
  CHECK(scene.blocks[scene.loads[0].block].name == "b0007");
  SECTION("but not on a joint or outside") {
    CHECK(error_of(square_domain + "[[load]]\npoint_m = [2, 0.5]\nforce_n = [0, -1]\n") ==
          "29: load[0].point_m: (2, 0.5) lies where \"b0001\" and \"b0002\" meet; accepted: a point inside a block, or on the boundary of one that "
          "the key "
          "block names");
    CHECK_THAT(error_of(square_domain + "[[load]]\npoint_m = [2, 5]\nforce_n = [0, -1]\n"),
               ContainsSubstring("29: load[0].point_m: (2, 5) lies in no block; the nearest one is ") && ContainsSubstring(", 1 m away; "));
  }
}

TEST_CASE("a cut scene written and read again has the same blocks", "[scene][domain][writer]") {
  const Scene scene = read_text(square_domain + line(0.3, 0.2, 3.7, 3.9) + "[[fixed_line]]\nfrom_m = [0, 0]\nto_m = [4, 0]\n");
  const Scene again = read_text(write_scene(scene));
  CHECK_FALSE(again.cutting.has_value());
  CHECK(polygons(again) == polygons(scene));
  CHECK(fixed_blocks(again) == fixed_blocks(scene));
  CHECK(again.blocks[5].name == scene.blocks[5].name);
}

TEST_CASE("the paper's slopes have the paper's numbers of blocks", "[scene][domain][paper]") {
  SECTION("example 3.3: 28 blocks in both truncated models") {
    const std::string name = GENERATE("example_3_3_toe", "example_3_3_shifted");
    const Scene scene = paper_scene(name);
    CHECK(scene.blocks.size() == 28);
    CHECK(scene.cutting->area == Approx(scene.cutting->domain_area).epsilon(1e-12));
    CHECK(check_scene(scene).empty());
    // Free are the layers above the lowest joint that daylights.
    for (const BlockInput& block : scene.blocks) CHECK(block.fixed == (block.vertices[0].y() == 0.0 && block.vertices[1].y() == 0.0));
  }
  SECTION("example 3.3, whole wedge") {
    CHECK(check_scene(paper_scene("example_3_3_wedge")).empty());
  }
  SECTION("example 3.4: 482 blocks, the smallest 0.057 m2") {
    const Scene scene = paper_scene("example_3_4");
    CHECK(scene.blocks.size() == 482);
    CHECK(scene.cutting->smallest_block == Approx(0.057).margin(0.0005));
    CHECK(scene.cutting->area == Approx(scene.cutting->domain_area).epsilon(1e-12));
    CHECK(scene.cutting->slivers_merged == 0);
    CHECK(check_scene(scene).empty());
  }
}

TEST_CASE("scattered sets are read and repeat themselves", "[scene][domain]") {
  const std::string scatter = "dip_scatter_deg = 5\nspacing_scatter = 0.3\nseed = 7\n";
  const auto scattered = [&](const std::string& more) {
    return polygons(read_text(test::with_line(square_domain, 26, more), {"domain.enclosed_joints=drop"}));
  };
  CHECK(scattered(scatter) == scattered(scatter));
  CHECK(scattered(scatter) != scattered("dip_scatter_deg = 5\nspacing_scatter = 0.3\nseed = 8\n"));
  CHECK(scattered("seed = 8\n") == scattered(""));
}

TEST_CASE("a wall in running bond from two sets", "[scene][domain]") {
  const Scene scene = read_text(test::with_line(square_domain, 26, "trace_length_m = 1\ngap_m = 1\n") +
                                "[[joint_set]]\ndip_deg = 90\nspacing_m = 2\norigin_m = [1, 1]\ntrace_length_m = 1\npersistence = 0.5\n");
  CHECK(scene.blocks.size() == 10);
  CHECK(scene.cutting->dangling_ends == 0);
  for (const BlockInput& block : scene.blocks) CHECK(block.vertices.size() == 4);
}

TEST_CASE("joints that give nothing", "[scene][domain][errors]") {
  CHECK(error_of(bare_domain + line(5, 5, 6, 6)) == "17: joint_line[0]: the line is outside the domain; accepted: joints that meet the domain");
  CHECK(error_of(bare_domain + "[[joint_set]]\ndip_deg = 30\nspacing_m = 100\norigin_m = [0, 50]\n") ==
        "17: joint_set[0]: no trace of the set is in the domain; accepted: joints that meet the domain");
  CHECK(error_of(bare_domain + line(1, 1, 2, 2)) ==
        "13: domain: the joints cut no block out of the domain; accepted: joints that cross the domain or each other, or none at all");
  CHECK(error_of(square_domain + "[[joint_set]]\ndip_deg = 45\nspacing_m = 2\norigin_m = [0.4, 0.5]\ntrace_length_m = 0.1\ngap_m = 30\n") ==
        "28: joint_set[2]: the set bounds no block: all its traces end loose inside one; accepted: traces that reach the boundary or other joints at "
        "both "
        "ends");
  SECTION("a single line among others is only warned of") {
    const Scene scene = read_text(square_domain + line(0.2, 0.2, 0.8, 0.7));
    CHECK(scene.blocks.size() == 8);
    CHECK(scene.cutting->dangling_ends == 2);
    REQUIRE(scene.cutting->warnings.size() == 1);
    CHECK_THAT(check_scene(scene)[0], ContainsSubstring("line 28: the line ends loose inside one block and bounds none"));
  }
}

TEST_CASE("a sliver that no neighbour could take is warned of", "[scene][domain]") {
  // The whole domain is one.
  const std::vector<std::string> warnings = read_text(bare_domain, {"domain.sliver_area_m2=100"}).cutting->warnings;
  CHECK(std::ranges::count_if(warnings,
                              [](const std::string& text) { return text.ends_with("1 sliver(s) that no neighbour could take are left"); }) == 1);
}

TEST_CASE("lengths that are large beside the blocks of a domain are warned of", "[scene][domain]") {
  // Eight blocks of 2 m2.
  CHECK(read_text(square_domain).cutting->warnings.empty());
  const std::vector<std::string> reach = read_text(square_domain, {"domain.joint_end_reach_m=0.015"}).cutting->warnings;
  REQUIRE(reach.size() == 1);
  CHECK_THAT(reach[0], ContainsSubstring("joint_end_reach_m = 0.015 closes bridges of rock up to 1.1 % of the median block's size of 1.4 m"));
  CHECK(read_text(square_domain, {"domain.joint_end_reach_m=0.014"}).cutting->warnings.empty());
  // No farther than coordinates go, where lengths lose the digits that cutting needs.
  CHECK_THROWS_WITH(read_text(square_domain, {"domain.joint_end_reach_m=1e18"}),
                    ContainsSubstring("domain.joint_end_reach_m: 1e+18 is out of range; accepted: a number in [0, 10000000]"));
  // A third joint cuts strips of 1 cm off four of them: 0.04 of 16 m2.
  const std::string strips = square_domain + "[[joint_set]]\ndip_deg = 90\nspacing_m = 5\norigin_m = [1.99, 0]\n";
  const Scene whole = read_text(strips), merged = read_text(strips, {"domain.sliver_width_m=0.03"});
  CHECK(whole.cutting->warnings.empty());
  CHECK(merged.cutting->slivers_merged == 4);
  REQUIRE(merged.cutting->warnings.size() == 1);
  CHECK_THAT(merged.cutting->warnings[0], ContainsSubstring("4 blocks with 0.25 % of the area are thinner than domain.sliver_width_m = 0.03"));
}

TEST_CASE("parallel sets that share joints", "[scene][domain][errors]") {
  const std::string accepted = "; accepted: sets of different dips, or parallel ones whose joints lie between each other";
  CHECK(error_with(23, "dip_deg = 180") == "22: joint_set[1]: the set is parallel to the one of line 17 and shares joints with it" + accepted);
  SECTION("parallel sets between each other are layers of two thicknesses") {
    const std::string text = test::with_line(test::with_line(square_domain, 23, "dip_deg = 0"), 25, "origin_m = [0, 0.25]");
    CHECK(read_text(text).blocks.size() == 6);
  }
}

TEST_CASE("more blocks than the limit", "[scene][domain][errors]") {
  CHECK(read_text(square_domain, {"domain.max_blocks=8"}).blocks.size() == 8);
  CHECK(error_of(square_domain, {"domain.max_blocks=7"}) ==
        "13: domain: the joints cut the domain into more than 7 blocks; accepted: fewer joints, or a higher domain.max_blocks");
  SECTION("found out at once") {
    // Cut to the end they would take hours, or all memory.
    CHECK_THAT(error_with(19, "spacing_m = 1e-9"), ContainsSubstring("17: joint_set[0]: the set has more than 1000000 traces in the domain"));
    CHECK_THAT(error_of(test::with_line(test::with_line(square_domain, 26, "dip_scatter_deg = 30"), 24, "spacing_m = 1e-3"),
                        {"joint_set[0].spacing_m=1e-3", "joint_set[0].dip_scatter_deg=30"}),
               ContainsSubstring("13: domain: the joints cut the domain into more than 1000000 blocks"));
    CHECK_THAT(
        error_of(test::with_line(test::with_line(square_domain, 25, "origin_m = [0, 3e6]"), 26, "trace_length_m = 1\ngap_m = 1\ntrace_scatter = 0.5"),
                 {"joint_set[1].spacing_m=0.01"}),
        ContainsSubstring("22: joint_set[1]: the set has more than 1000000 traces in the domain, or its origin lies as many of them away"));
    CHECK_THAT(error_with(26, "trace_length_m = 1e-9\ngap_m = 1e-9"),
               ContainsSubstring("22: joint_set[1]: the set has more than 1000000 traces in the domain"));
    CHECK_THAT(
        error_of(test::with_line(test::with_line(square_domain, 19, "spacing_m = 1e-5"), 24, "spacing_m = 1e-5"), {"domain.max_blocks=500000"}),
        ContainsSubstring("13: domain: the joints cut the domain into more than 500000 blocks"));
  }
}

TEST_CASE("values out of range", "[scene][domain][errors]") {
  CHECK(error_with(19, "spacing_m = 0") == "19: joint_set[0].spacing_m: 0 is out of range; accepted: a number > 0");
  CHECK_THAT(error_with(19, "spacing_m = -1"), ContainsSubstring("19: joint_set[0].spacing_m: -1 is out of range"));
  CHECK_THAT(error_with(18, "dip_deg = 181"), ContainsSubstring("18: joint_set[0].dip_deg: 181 is out of range; accepted: a number in [-180, 180]"));
  CHECK_THAT(error_with(18, "dip = 18"), ContainsSubstring("18: joint_set[0].dip: this key has another unit; accepted: dip_deg"));
  CHECK_THAT(error_with(26, "spacing_scatter = 1"), ContainsSubstring("26: joint_set[1].spacing_scatter: 1 is out of range"));
  CHECK_THAT(error_with(26, "seed = 1.5"), ContainsSubstring("26: joint_set[1].seed: 1.5 is not a whole number"));
  CHECK_THAT(error_with(16, "sliver_width_m = 0"), ContainsSubstring("16: domain.sliver_width_m: 0 is out of range; accepted: a number >= 4e-06"));
  CHECK_THAT(error_with(14, "material = 'rok'"), ContainsSubstring("14: domain.material: there is no material \"rok\""));
}

TEST_CASE("lengths and scatters out of range", "[scene][domain][errors]") {
  for (const std::string value : {"0", "-0.5", "1.5"}) {
    CHECK(error_with(26, "trace_length_m = 1\npersistence = " + value) ==
          "27: joint_set[1].persistence: " + value + " is out of range; accepted: a number in (0, 1]");
  }
  CHECK_THAT(error_with(26, "trace_length_m = 1\npersistence = nan"), ContainsSubstring("27: joint_set[1].persistence: nan is not a finite number"));
  CHECK_THAT(error_with(26, "trace_length_m = 0\ngap_m = 1"), ContainsSubstring("26: joint_set[1].trace_length_m: 0 is out of range"));
  CHECK_THAT(error_with(26, "trace_length_m = 1\ngap_m = -1"), ContainsSubstring("27: joint_set[1].gap_m: -1 is out of range"));
  CHECK_THAT(error_with(19, "spacing_m = nan"), ContainsSubstring("19: joint_set[0].spacing_m: nan is not a finite number"));
  CHECK_THAT(error_with(19, "spacing_m = inf"), ContainsSubstring("19: joint_set[0].spacing_m: inf is not a finite number"));
  CHECK_THAT(error_with(16, "max_blocks = 100000000"), ContainsSubstring("16: domain.max_blocks: 100000000 is out of range"));
}

TEST_CASE("regions that give no block a material", "[scene][domain][errors]") {
  const std::string accepted = "; accepted: a polygon around the centroids of blocks";
  const std::string outside = "[[region]]\nmaterial = 'clay'\nvertices_m = [[5, 5], [6, 5], [6, 6]]\n";
  const std::string between = "[[region]]\nmaterial = 'clay'\nvertices_m = [[0, 0], [0.5, 0], [0.5, 0.4]]\n";
  CHECK(error_of(square_domain + outside) == "28: region[0]: no block of the domain has its centroid in the region" + accepted);
  CHECK(error_of(square_domain + between) == "28: region[0]: no block of the domain has its centroid in the region" + accepted);
  CHECK_THAT(error_of(square_domain + test::with_line(between, 2, "material = 'cly'")),
             ContainsSubstring("29: region[0].material: there is no material \"cly\""));
  CHECK_THAT(error_of(square_domain + test::with_line(between, 3, "vertices_m = [[0, 0], [1, 1], [1, 0], [0, 1]]")),
             ContainsSubstring("30: region[0].vertices_m: the polygon intersects or touches itself"));
}

TEST_CASE("traces need both lengths or none", "[scene][domain][errors]") {
  CHECK(error_with(26, "gap_m = 1") == "22: joint_set[1]: gap_m is given for joints that run through; accepted: trace_length_m with it");
  CHECK(error_with(26, "trace_length_m = 1") ==
        "22: joint_set[1]: neither gap nor persistence is given; accepted: exactly one of gap_m, persistence");
  CHECK(error_with(26, "trace_length_m = 1\ngap_m = 1\npersistence = 0.5") ==
        "22: joint_set[1]: both gap and persistence are given; accepted: exactly one of gap_m, persistence");
}

TEST_CASE("domains that are no polygons", "[scene][domain][errors]") {
  CHECK(error_with(15, "vertices_m = [[0, 0], [4, 4], [4, 0], [0, 4]]") ==
        "15: domain.vertices_m: the polygon intersects or touches itself: edges [0]-[1] and [2]-[3]; accepted: a simple polygon; vertices are "
        "numbered from "
        "0");
  CHECK_THAT(error_with(15, "vertices_m = [[0, 0], [1, 0], [2, 0]]"), ContainsSubstring("accepted: a domain at least 1e-06 m wide"));
  CHECK(error_with(16, "holes_m = [[[1.2, 1.2], [1.8, 1.2], [1.8, 1.8]], [[3.5, 3.5], [5, 3.5], [5, 5]]]") ==
        "16: domain.holes_m[1]: the hole meets the domain's boundary; accepted: holes inside the domain that touch neither its boundary nor each "
        "other");
  CHECK_THAT(error_with(15, "vertices_m = [[0, 0], [4, 0], [2, 1], [4, 4], [0, 4], [2, 1]]"), ContainsSubstring("intersects or touches itself"));
  CHECK(error_of(bare_domain + line(-1e6, 1, 1e6 + 20, 1)) == "17: joint_line[0]: the line is 2.00002e+06 m long; accepted: at most 2e+06 m");
  CHECK(error_with(15, "vertices_m = [[-1, 0], [1000000, 0], [0, 4]]") ==
        "15: domain.vertices_m: a domain 1000001 m wide; accepted: domains at most 1000000 m wide");
  CHECK_THAT(error_with(15, "vertices_m = []"), ContainsSubstring("15: domain.vertices_m: the polygon has 0 vertices; accepted: at least 3"));
  CHECK_THAT(error_with(15, "vertices_m = [[0, 0], [4, 0]]"),
             ContainsSubstring("15: domain.vertices_m: the polygon has 2 vertices; accepted: at least 3"));
  CHECK_THAT(error_with(16, "holes_m = [[[1, 1], [2, 1], [2, 2]], [[2, 2], [3, 2], [3, 3]]]"),
             ContainsSubstring("16: domain.holes_m[1]: the hole meets hole [0]; accepted: "));
  CHECK_THAT(error_with(16, "holes_m = [[[1, 1], [3, 1], [3, 3], [1, 3]], [[2, 2], [2.5, 2], [2.5, 2.5]]]"),
             ContainsSubstring("16: domain.holes_m[1]: the hole lies inside or around hole [0]; accepted: "));
  CHECK_THAT(error_with(16, "holes_m = [[[0, 1], [2, 1], [2, 2]]]"),
             ContainsSubstring("16: domain.holes_m[0]: the hole meets the domain's boundary"));
  CHECK_THAT(error_with(16, "holes_m = [[[1, 1], [2, 1], [3, 1]]]"), ContainsSubstring("accepted: a hole at least 1e-06 m wide"));
  CHECK_THAT(error_with(16, "holes_m = [[[11.2, 1.2], [11.8, 1.2], [11.8, 1.8]]]"),
             ContainsSubstring("16: domain.holes_m[0]: the hole lies outside the domain"));
}

TEST_CASE("blocks that would have holes", "[scene][domain][errors]") {
  CHECK(error_with(16, "holes_m = [[[1.2, 1.2], [1.8, 1.2], [1.8, 1.8]]]") ==
        "16: domain.holes_m[0]: the joints do not connect the hole to the domain's boundary, so that a block would have a hole; accepted: joints "
        "that reach "
        "every hole in two places or more");
  const std::string loop = line(0.2, 0.2, 0.8, 0.2) + line(0.8, 0.2, 0.5, 0.8) + line(0.5, 0.8, 0.2, 0.2);
  CHECK_THAT(error_of(square_domain + loop), ContainsSubstring("13: domain: 1 group(s) of joints, one near (") &&
                                                 ContainsSubstring("enclose a block within another one, which would have a hole; accepted: "));
  SECTION("can be left out") {
    const Scene scene = read_text(square_domain + loop, {"domain.enclosed_joints=drop"});
    CHECK(scene.blocks.size() == 8);
    CHECK(scene.cutting->enclosed_groups == 1);
    CHECK(scene.cutting->warnings.size() == 4);
  }
}

TEST_CASE("sets and lines give their seams the joint they name", "[scene][domain]") {
  const std::string bedding =
      "[[joint]]\nname = 'bedding'\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 4e8\nfriction_angle_deg = 20\n";
  const Scene scene = read_text(bedding + bare_domain + "[[joint_set]]\ndip_deg = 0\nspacing_m = 2\norigin_m = [0, 0]\njoint = 'bedding'\n" +
                                "[[joint_line]]\nfrom_m = [1, 0]\nto_m = [1, 2]\n");
  REQUIRE(scene.joints.size() == 2);
  CHECK_FALSE(scene.joints[0].has_materials());
  REQUIRE(scene.blocks.size() == 3);
  constexpr int none = BlockInput::by_materials;
  CHECK(scene.blocks[0].edge_joints == std::vector<int>{none, none, 0, none});
  CHECK(scene.blocks[2].edge_joints == std::vector<int>{0, none, none, none});

  // What cut writes is the same scene.
  const Scene again = read_text(write_scene(scene));
  for (std::size_t b = 0; b < 3; ++b) CHECK(again.blocks[b].edge_joints == scene.blocks[b].edge_joints);
  CHECK(again.joints[0].name == "bedding");
  CHECK_FALSE(again.joints[0].has_materials());
  CHECK(write_scene(again) == write_scene(scene));

  // Without a name nothing is kept of the edges.
  const Scene plain = read_text(bare_domain + "[[joint_set]]\ndip_deg = 0\nspacing_m = 2\norigin_m = [0, 0]\n");
  for (const BlockInput& block : plain.blocks) CHECK(block.edge_joints.empty());
}

TEST_CASE("bridges of sets and lines are cut with the joint that they name", "[scene][domain]") {
  const std::string joints =
      "[[joint]]\nname = 'rock'\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 4e8\nfriction_angle_deg = 50\ncohesion_pa = 1e6\n"
      "[[joint]]\nname = 'bedding'\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 4e8\nfriction_angle_deg = 20\n";
  const std::string set = "[[joint_set]]\ndip_deg = 0\nspacing_m = 2\norigin_m = [0, 0]\njoint = 'bedding'\ntrace_length_m = 3\ngap_m = 1\n";
  constexpr int none = BlockInput::by_materials, rock = 0, bedding = 1;
  SECTION("a set of traces") {
    // Cut back, the trace reaches the left side only and bounds nothing.
    CHECK_THAT(error_of(joints + bare_domain + set), ContainsSubstring("the joints cut no block out of the domain"));
    const Scene scene = read_text(joints + bare_domain + set + "bridge = 'rock'\n");
    REQUIRE(scene.blocks.size() == 2);
    CHECK(scene.blocks[0].edge_joints == std::vector<int>{none, none, rock, bedding, none});
    CHECK(scene.blocks[1].edge_joints == std::vector<int>{bedding, rock, none, none, none});
    CHECK(scene.blocks[0].vertices[3] == Vec2(3.0, 2.0));
    CHECK(scene.blocks[1].vertices[1] == Vec2(3.0, 2.0));
    CHECK(length_of(scene, rock) == Approx(2.0 * 1.0).epsilon(1e-12));
    CHECK(scene.cutting->dangling_ends == 0);
    CHECK(scene.cutting->warnings.empty());
    const Scene again = read_text(write_scene(scene));
    CHECK(write_scene(again) == write_scene(scene));
    CHECK(again.blocks[1].vertices.size() == 5);
  }
  SECTION("a set that ends at its region") {
    const std::string through = "[[joint_set]]\ndip_deg = 0\nspacing_m = 2\norigin_m = [0, 0]\n";
    const std::string left = "region_m = [[-1, 1], [2.5, 1], [2.5, 3], [-1, 3]]\n";
    CHECK(length_of(read_text(joints + bare_domain + through + left + "bridge = 'rock'\n"), rock) == Approx(2.0 * 1.5).epsilon(1e-9));
    CHECK_THAT(error_of(joints + bare_domain + through + "bridge = 'rock'\n"),
               ContainsSubstring("joint_set[0].bridge: joints that run through have no bridges; accepted: trace_length_m or region_m with it"));
  }
  SECTION("a single line") {
    const Scene scene = read_text(joints + bare_domain + line(1, 1, 2, 2) + "bridge = 'rock'\n");
    REQUIRE(scene.blocks.size() == 2);
    CHECK(length_of(scene, rock) == Approx(2.0 * std::sqrt(18.0)).epsilon(1e-9));
    CHECK(std::ranges::count(scene.blocks[0].edge_joints, rock) == 2);
    CHECK_THAT(error_of(joints + bare_domain + line(1, 1, 2, 2) + "bridge = 'rack'\n"),
               ContainsSubstring("joint_line[0].bridge: there is no joint \"rack\", did you mean \"rock\"?; accepted: \"rock\", \"bedding\""));
  }
}

TEST_CASE("sets by dip and dip direction", "[scene][domain]") {
  const auto cut_with = [](const std::string& set) {
    return read_text(bare_domain + "section_direction_deg = 90\n" + "[[joint_set]]\nspacing_m = 1\norigin_m = [0, 0]\n" + set);
  };
  const Scene by_direction = cut_with("dip_deg = 60\ndip_direction_deg = 270\n");
  const Scene by_angle = cut_with("dip_deg = 60\n");
  REQUIRE(by_direction.blocks.size() == by_angle.blocks.size());
  CHECK(by_direction.blocks.size() > 3);
  for (std::size_t b = 0; b < by_angle.blocks.size(); ++b)
    CHECK((polygon_properties(by_direction.blocks[b].vertices).centroid - polygon_properties(by_angle.blocks[b].vertices).centroid).norm() < 1e-9);
  CHECK(by_direction.cutting->warnings.empty());
  // Lines of a set that strikes obliquely are flatter and farther apart: fewer blocks, and what slides leaves the section.
  const Scene oblique = cut_with("dip_deg = 60\ndip_direction_deg = 220\n");
  CHECK(oblique.blocks.size() < by_angle.blocks.size());
  REQUIRE(oblique.cutting->warnings.size() == 1);
  CHECK_THAT(oblique.cutting->warnings.front(), ContainsSubstring("the normals of the planes leave the section by more than 20 degrees"));
}

TEST_CASE("dip directions that say nothing", "[scene][domain][errors]") {
  const auto error_of_set = [](const std::string& section, const std::string& set) {
    return error_of(bare_domain + section + "[[joint_set]]\nspacing_m = 1\norigin_m = [0, 0]\n" + set);
  };
  const std::string section = "section_direction_deg = 90\n";
  CHECK_THAT(error_of_set("", "dip_deg = 60\ndip_direction_deg = 270\n"),
             ContainsSubstring("joint_set[0].dip_direction_deg: nothing says where the section points; accepted: domain.section_direction_deg"));
  CHECK_THAT(error_of_set(section, "dip_deg = -60\ndip_direction_deg = 270\n"), ContainsSubstring("accepted: a number in [0, 90]"));
  CHECK_THAT(error_of_set(section, "dip_deg = 90\ndip_direction_deg = 0\n"), ContainsSubstring("the planes lie in the section"));
}

TEST_CASE("cutting without a domain", "[scene][domain][errors]") {
  CHECK(error_of(test::block_on_base + line(0, 0, 1, 1)) == "22: joint_line[0]: there is no domain to cut; accepted: a scene with a [domain]");
}
