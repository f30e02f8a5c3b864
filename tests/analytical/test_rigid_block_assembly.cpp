#include <cmath>
#include <stdexcept>
#include <string>

#include "openclose/analytical/rigid_block_assembly.h"
#include "support/catch.h"

using namespace openclose::analytical;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A fixed base of 4 m, two free blocks beside each other on it, one over both; the upper one is written clockwise.
const std::string pile =
    "gravity_m_per_s2 = [0, -10]\n"
    "[[material]]\nname = 'rock'\ndensity_kg_per_m3 = 2000\n"
    "[[material]]\nname = 'brick'\nunit_weight_n_per_m3 = 15000\n"
    "[[joint]]\nmaterials = ['rock', 'rock']\nfriction_angle_deg = 45\ncohesion_pa = 1000\n"
    "[[joint]]\nmaterials = ['brick', 'rock']\nfriction_angle_deg = 0\ntensile_strength_pa = 7\n"
    "[[block]]\nname = 'base'\nmaterial = 'rock'\nfixed = true\nvertices_m = [[0, -1], [4, -1], [4, 0], [0, 0]]\n"
    "[[block]]\nname = 'left'\nmaterial = 'rock'\nvertices_m = [[0, 0], [2, 0], [2, 1], [0, 1]]\n"
    "[[block]]\nname = 'right'\nmaterial = 'rock'\nvertices_m = [[2, 0], [4, 0], [4, 1], [2, 1]]\n"
    "[[block]]\nname = 'top'\nmaterial = 'brick'\nvertices_m = [[1, 1], [1, 2], [3, 2], [3, 1]]\n";

std::string error_of(const std::string& text) {
  try {
    parse_rigid_blocks(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

/// Two squares of side `size` with a common vertical edge, the second `gap` away and `step` up.
std::vector<RigidBlock> neighbours(double size, double gap, double step, const Point& origin = Point::Zero(), double angle = 0) {
  std::vector<RigidBlock> blocks(2);
  const auto place = [&](double x, double y) {
    return Point(origin.x() + x * std::cos(angle) - y * std::sin(angle), origin.y() + x * std::sin(angle) + y * std::cos(angle));
  };
  blocks[0].vertices = {place(0, 0), place(size, 0), place(size, size), place(0, size)};
  const double x = size + gap;
  blocks[1].vertices = {place(x, step), place(x + size, step), place(x + size, step + size), place(x, step + size)};
  for (RigidBlock& block : blocks) {
    block.density = 1;
    complete_block(block, {0, -10});
  }
  return blocks;
}

}  // namespace

TEST_CASE("rigid blocks: a file is read with weights, strengths and interfaces") {
  const RigidBlockAssembly assembly = parse_rigid_blocks(pile);
  REQUIRE(assembly.blocks.size() == 4);
  CHECK(assembly.blocks[0].fixed);
  CHECK(assembly.blocks[3].load.isApprox(Eigen::Vector3d(0, -30000, 0), 1e-14));
  CHECK((assembly.blocks[3].centroid - Point(2, 1.5)).norm() < 1e-15);
  // base-left, base-right, left-right, left-top, right-top; the top edge is in two parts.
  REQUIRE(assembly.interfaces.size() == 5);
  for (const Interface& i : assembly.interfaces) {
    const bool brick = i.b == 3;
    CHECK(i.length() == Approx(brick || i.a == 1 ? 1.0 : 2.0).epsilon(1e-14));
    CHECK(i.strength.friction == Approx(brick ? 0.0 : 1.0).margin(1e-15));
    CHECK(i.strength.cohesion == (brick ? 0.0 : 1000.0));
    CHECK(i.strength.tension == (brick ? 7.0 : 0.0));
    // Into the first block: down into what lies below, left into the left one.
    const Point expected = i.a == 1 && i.b == 2 ? Point(-1, 0) : Point(0, -1);
    CHECK((i.normal - expected).norm() < 1e-14);
  }
}

TEST_CASE("rigid blocks: an interface has the joint that both of its edges name, else that of the materials") {
  // The upper block is written clockwise: its last edge, from (3, 1) to (1, 1), stays the last one when it is turned.
  const std::string top = "vertices_m = [[1, 1], [1, 2], [3, 2], [3, 1]]\n", left = "vertices_m = [[0, 0], [2, 0], [2, 1], [0, 1]]\n";
  std::string text = pile;
  text.replace(text.find(left), left.size(), left + "edge_joints = ['', '', 'seam', 'seam']\n");
  text.replace(text.find(top), top.size(), top + "edge_joints = ['', '', '', 'seam']\n");
  text.replace(text.find("[[joint]]"), 0, "[[joint]]\nname = 'seam'\nfriction_angle_deg = 0\ncohesion_pa = 500\n");
  const RigidBlockAssembly assembly = parse_rigid_blocks(text);
  REQUIRE(assembly.interfaces.size() == 5);
  for (const Interface& i : assembly.interfaces) {
    const bool is_seam = i.a == 1 && i.b == 3;
    CHECK((i.joint != Interface::by_materials) == is_seam);
    if (is_seam) CHECK(i.strength.cohesion == 500.0);
    if (i.a == 2 && i.b == 3) CHECK(i.strength.tension == 7.0);
  }
  text.replace(text.find("'seam']"), 6, "'none'");
  CHECK_THAT(error_of(text), ContainsSubstring("\"none\""));
}

TEST_CASE("rigid blocks: point loads act on the centroid with their moment") {
  const RigidBlockAssembly assembly = parse_rigid_blocks(pile + "[[load]]\nblock = 'top'\npoint_m = [2, 2]\nforce_n = [100, 50]\n");
  CHECK(assembly.blocks[3].load.isApprox(Eigen::Vector3d(100, -29950, -50), 1e-14));
}

TEST_CASE("rigid blocks: surcharges push onto their edge, whichever end comes first") {
  for (const std::string ends : {"from_m = [3, 1.5]\nto_m = [3, 2]\n", "from_m = [3, 2]\nto_m = [3, 1.5]\n"}) {
    const RigidBlockAssembly assembly = parse_rigid_blocks(pile + "[[surcharge]]\nblock = 'top'\npressure_pa = 200\nshear_pa = 40\n" + ends);
    // 0.5 m of the right side: 100 N to the left, 20 N up, 1 m to the right of the centroid and 0.25 m above it.
    CHECK(assembly.blocks[3].load.isApprox(Eigen::Vector3d(-100, -30000 + 20, 20 + 25), 1e-14));
  }
}

TEST_CASE("rigid blocks: an interface is where edges face each other, wherever the blocks lie") {
  for (const double angle : {0.0, 0.3, 1.5707963267948966, 2.0, -1.1}) {
    for (const Point& origin : {Point(0, 0), Point(1e6, -1e6)}) {
      const auto interfaces = find_interfaces(neighbours(2, 0, 0.5, origin, angle));
      REQUIRE(interfaces.size() == 1);
      CHECK(std::abs(interfaces[0].length() - 1.5) < 1e-9);
      CHECK((interfaces[0].normal - Point(-std::cos(angle), -std::sin(angle))).norm() < 1e-9);
      CHECK((interfaces[0].tangent() - Point(-std::sin(angle), std::cos(angle))).norm() < 1e-9);
    }
  }
  CHECK(find_interfaces(neighbours(2, 0.1 * touching_distance, 0)).size() == 1);
  CHECK(find_interfaces(neighbours(2, 10 * touching_distance, 0)).empty());
  CHECK(find_interfaces(neighbours(2, 0, 2)).empty());  // corner to corner
  auto fixed = neighbours(2, 0, 0);
  fixed[0].fixed = fixed[1].fixed = true;
  CHECK(find_interfaces(fixed).empty());
}

TEST_CASE("rigid blocks: bad files are refused with what is wrong") {
  CHECK(error_of(pile) == "none");
  CHECK_THAT(error_of("x = ["), ContainsSubstring("line 1"));
  CHECK_THAT(error_of(""), ContainsSubstring("has no blocks"));
  CHECK_THAT(error_of(pile + "[domain]\n"), ContainsSubstring("openclose cut"));
  CHECK_THAT(error_of(pile + "[[support]]\n"), ContainsSubstring("supports"));
  CHECK_THAT(error_of(pile + "[[block]]\nname = 'x'\nmaterial = 'clay'\nvertices_m = [[0, 0], [1, 0], [0, 1]]\n"), ContainsSubstring("\"clay\""));
  CHECK_THAT(error_of(pile + "[[block]]\nname = 'x'\nmaterial = 'rock'\nvertices_m = [[0, 0], [1, 0], 3]\n"), ContainsSubstring("[x, y]"));
  CHECK_THAT(error_of(pile + "[[block]]\nname = 'x'\nmaterial = 'rock'\nvertices_m = [[0, 0], [1, 0]]\n"), ContainsSubstring("three vertices"));
  CHECK_THAT(error_of(pile + "[[block]]\nname = 'x'\nmaterial = 'rock'\nvertices_m = [[0, 0], [1, 0], [2, 0]]\n"), ContainsSubstring("no area"));
  CHECK_THAT(error_of(pile + "[[block]]\nname = 'x'\nmaterial = 'brick'\nvertices_m = [[1, 2], [3, 2], [3, 3], [1, 3]]\n"),
             ContainsSubstring("no joint for the materials of blocks top and x"));
  CHECK_THROWS_AS(read_rigid_blocks("/nowhere/blocks.toml"), std::invalid_argument);
}
