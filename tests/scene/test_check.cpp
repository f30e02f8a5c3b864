#include <algorithm>
#include <cmath>

#include "openclose/scene/check.h"
#include "scene_file.h"
#include "support/builders.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::builders::free_block;
using openclose::builders::rectangle;
using openclose::test::block_on_base;
using openclose::test::read_text;

namespace {

/// A wall of unit bricks in running bond on a fixed course, each course shifted by half a brick.
Scene running_bond(int courses, int length) {
  Scene scene = builders::rock_scene(2700.0, builders::frictional_joint(1e9, 1e9, 0.0), 1e-11);
  scene.blocks = builders::wall(courses, length, 1.0, 0.5);
  for (int i = 0; i < length; ++i) scene.blocks[i].fixed = true;
  return scene;
}

}  // namespace

TEST_CASE("a sound scene has nothing to complain of", "[scene][check]") {
  CHECK(check_scene(read_text(block_on_base)).empty());
  CHECK(check_scene(running_bond(4, 4)).empty());
}

TEST_CASE("blocks that overlap at the start are refused", "[scene][check]") {
  const auto depth = GENERATE(0.0011, 0.1, 0.5);
  const std::string set = "block[1].vertices_m=[[0, " + std::to_string(-depth) + "], [1, 0], [1, 1], [0, 1]]";
  const test::SceneFile file(block_on_base);
  const Scene scene = read_scene(file.path(), {set});
  CHECK_THROWS_AS(check_scene(scene), InputError);
  CHECK_THROWS_WITH(check_scene(scene), ContainsSubstring(file.path() + ":17: block: \"block\" overlaps \"base\" (line 11) by at least ") &&
                                            ContainsSubstring("accepted: overlaps of at most 0.001 m"));
}

TEST_CASE("overlaps of blocks that overrides bring name these", "[scene][check]") {
  const test::SceneFile file(block_on_base);
  const std::string square = "material='rock', vertices_m=[[0, 5], [1, 5], [1, 6], [0, 6]]}";
  const Scene scene = read_scene(file.path(), {"block[0]={name='a', fixed=true, " + square, "block[1]={name='b', " + square});
  CHECK_THROWS_WITH(check_scene(scene), ContainsSubstring("command line: block: \"b\" overlaps \"a\" (") && ContainsSubstring("command line) by"));
}

TEST_CASE("overlaps of drawing accuracy are allowed", "[scene][check]") {
  CHECK_NOTHROW(check_scene(read_text(block_on_base, {"block[1].vertices_m=[[0, -0.0009], [1, 0], [1, 1], [0, 1]]"})));
}

TEST_CASE("overlaps of every kind are found among many blocks", "[scene][check]") {
  Scene scene = running_bond(10, 10);
  SECTION("the same block twice") {
    scene.blocks.push_back(free_block("twice", rectangle(5.0, 4.0, 1.0, 1.0)));
  }
  SECTION("a small block inside one") {
    scene.blocks.push_back(free_block("inside", rectangle(5.4, 4.4, 0.2, 0.2)));
  }
  SECTION("a beam across all") {
    scene.blocks.push_back(free_block("beam", rectangle(-1.0, 4.4, 20.0, 0.2)));
  }
  SECTION("a block around all") {
    scene.blocks.push_back(free_block("around", rectangle(-1.0, -1.0, 20.0, 20.0)));
  }
  CHECK_THROWS_AS(check_scene(scene), InputError);
  CHECK_THROWS_WITH(check_scene(scene), ContainsSubstring(scene.blocks.back().name));
}

TEST_CASE("of a thousand blocks only neighbours are compared", "[scene][check]") {
  const Scene scene = running_bond(20, 50);
  CHECK(check_scene(scene).empty());
  CHECK(blocks_that_may_overlap(scene.blocks).empty());
  // Each brick is drawn 3 mm too large on every side: it overlaps two beside, two above and two below it.
  std::vector<BlockInput> larger = scene.blocks;
  for (BlockInput& block : larger) {
    const Vec2 centre = 0.5 * (block.vertices[0] + block.vertices[2]);
    for (Vec2& vertex : block.vertices) vertex = centre + 1.006 * (vertex - centre);
  }
  const std::size_t beside = 20 * 49, above = 19 * 99;
  CHECK(blocks_that_may_overlap(larger).size() == beside + above);
}

TEST_CASE("a surcharge that goes on over a fixed block is not said to have no effect, one that lies on fixed blocks alone is", "[scene][check]") {
  const std::string next = "[[block]]\nname = 'next'\nmaterial = 'rock'\nfixed = true\nvertices_m = [[1, 0], [2, 0], [2, 1], [1, 1]]\n";
  const auto warnings = [&](const std::string& from) {
    const Scene scene = read_text(block_on_base + next + "[[surcharge]]\npressure_pa = 1e3\nfrom_m = " + from + "\nto_m = [2, 1]\n");
    std::string all;
    for (const std::string& warning : check_scene(scene)) all += warning;
    return all;
  };
  CHECK_THAT(warnings("[0, 1]"), !ContainsSubstring("has no effect"));
  CHECK_THAT(warnings("[1.2, 1]"), ContainsSubstring("the surcharge at") && ContainsSubstring("has no effect"));
}

TEST_CASE("loads and supports of fixed blocks are worth a warning", "[scene][check]") {
  Scene scene = read_text(block_on_base);
  scene.blocks[0].fixed = true;
  scene.blocks[1].fixed = false;
  scene.loads = {{1, scene.blocks[1].vertices[0], {0.0, -1.0}}, {0, scene.blocks[0].vertices[0], {0.0, -1.0}}};
  scene.supports = {{0, scene.blocks[0].vertices[0], {1.0, 0.0}}, {1, scene.blocks[1].vertices[0], {1.0, 0.0}}};
  const std::vector<std::string> warnings = check_scene(scene);
  REQUIRE(warnings.size() == 2);
  CHECK_THAT(warnings[0], ContainsSubstring("the load at") && ContainsSubstring("has no effect") && ContainsSubstring(scene.blocks[0].name));
  CHECK_THAT(warnings[1], ContainsSubstring("the support at"));
}

TEST_CASE("nothing that holds the blocks is worth a warning", "[scene][check]") {
  Scene scene = read_text(block_on_base);
  scene.blocks[0].fixed = false;
  const std::vector<std::string> warnings = check_scene(scene);
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], ContainsSubstring("nothing is fixed or supported under gravity: every block will fall"));
  SECTION("unless there is a support") {
    scene.supports.push_back({0, {0.0, -1.0}, {0.0, 1e9}});
    CHECK(check_scene(scene).empty());
  }
  SECTION("or no gravity") {
    scene.gravity = Vec2::Zero();
    scene.blocks[1].velocity = {1.0, 0.0};
    CHECK(check_scene(scene).empty());
  }
}

TEST_CASE("nothing that could move the blocks is worth a warning", "[scene][check]") {
  Scene scene = read_text(block_on_base);
  scene.gravity = Vec2::Zero();
  const std::vector<std::string> warnings = check_scene(scene);
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], ContainsSubstring("there is no gravity, load, surcharge, base motion or velocity"));
  SECTION("unless there is a load") {
    scene.loads.push_back({1, scene.blocks[1].vertices[0], {0.0, -1.0}});
    CHECK(check_scene(scene).empty());
  }
  SECTION("a support is none") {
    scene.supports.push_back({1, scene.blocks[1].vertices[0], {0.0, 1e9}});
    CHECK(check_scene(scene).size() == 1);
  }
  SECTION("unless a block turns") {
    scene.blocks[1].angular_velocity = 1.0;
    CHECK(check_scene(scene).empty());
  }
}

TEST_CASE("materials that can meet need a joint", "[scene][check]") {
  Scene scene = read_text(block_on_base);
  scene.materials.push_back({"clay", 2000.0});
  SECTION("not while no block is of that material") {
    CHECK(check_scene(scene).empty());
  }
  SECTION("between two materials") {
    scene.blocks[1].material = 1;
    CHECK_THROWS_WITH(check_scene(scene), ContainsSubstring("joint: none for the materials \"rock\" and \"clay\""));
    // Whichever of them is the free one's.
    std::swap(scene.blocks[0].material, scene.blocks[1].material);
    CHECK_THROWS_WITH(check_scene(scene), ContainsSubstring("joint: none for the materials \"rock\" and \"clay\""));
  }
  SECTION("within one material, if it has two blocks") {
    scene.joints.clear();
    CHECK_THROWS_WITH(check_scene(scene), ContainsSubstring("joint: none for the materials \"rock\" and \"rock\""));
  }
  SECTION("not among fixed blocks, which cannot touch each other") {
    scene.joints.clear();
    scene.blocks[1].fixed = true;
    const std::vector<std::string> warnings = check_scene(scene);
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0], ContainsSubstring("no block is free: nothing will move"));
  }
}

TEST_CASE("numbers that no material has are warned of", "[scene][check]") {
  const auto warning_of = [](const std::string& key, const std::string& value) {
    const std::vector<std::string> warnings = check_scene(read_text(block_on_base, {key + "=" + value}));
    REQUIRE(warnings.size() == 1);
    return warnings.front();
  };
  CHECK_THAT(warning_of("joint[0].friction_angle_deg", "89.99999"),
             ContainsSubstring("joint of \"rock\" and \"rock\": friction_angle_deg = 89.99999 is hardly meant"));
  CHECK_THAT(warning_of("joint[0].normal_stiffness_pa_per_m", "1e16"), ContainsSubstring("normal_stiffness_pa_per_m = 1e+16"));
  CHECK_THAT(warning_of("joint[0].shear_stiffness_pa_per_m", "100"), ContainsSubstring("shear_stiffness_pa_per_m = 100"));
  CHECK_THAT(warning_of("joint[0].damping_ratio", "11"), ContainsSubstring("damping_ratio = 11"));
  CHECK_THAT(warning_of("joint[0].cohesion_pa", "2e10"), ContainsSubstring("cohesion_pa = 20000000000"));
  // t/m3, kN/m3 divided by nothing, g/m3.
  for (const std::string density : {"2.7", "27"})
    CHECK_THAT(warning_of("material[0].density_kg_per_m3", density), ContainsSubstring("material \"rock\": density_kg_per_m3 = " + density));
  CHECK_THAT(warning_of("material[0].density_kg_per_m3", "2.7e6"), ContainsSubstring("material \"rock\": density_kg_per_m3 = 2700000"));
  CHECK(check_scene(read_text(block_on_base, {"joint[0].friction_angle_deg=80"})).empty());
  const std::vector<std::string> of_two =
      check_scene(read_text(block_on_base + "[[material]]\nname = 'concrete'\ndensity_kg_per_m3 = 2400\n[[joint]]\nmaterials = ['rock', 'concrete']\n"
                                            "normal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 4e8\nfriction_angle_deg = 89.99999\n"));
  CHECK(std::ranges::any_of(of_two, [](const std::string& w) { return w.find("joint of \"rock\" and \"concrete\": friction") != w.npos; }));
}

TEST_CASE("a joint that slip makes stronger where it pulls is warned of", "[scene][check]") {
  const std::vector<std::string> softening{"joint[0].friction_angle_deg=45", "joint[0].residual_friction_angle_deg=0",
                                           "joint[0].slip_weakening_distance_m=0.01", "joint[0].cohesion_pa=2000",
                                           "joint[0].tensile_strength_pa=1000"};
  const auto warnings_with = [&](const std::string& more) {
    std::vector<std::string> set = softening;
    set.push_back(more);
    return check_scene(read_text(block_on_base, set));
  };
  // What is lost of tan(45 deg), times the tensile strength.
  REQUIRE(warnings_with("joint[0].cohesion_behaviour=ductile").size() == 1);
  CHECK_THAT(warnings_with("joint[0].cohesion_behaviour=ductile").front(), ContainsSubstring("up to 1000 Pa more shear where it pulls"));
  for (const std::string without : {"joint[0].cohesion_behaviour=lost_on_slip", "joint[0].tensile_strength_pa=0", "joint[0].cohesion_pa=0",
                                    "joint[0].slip_weakening_distance_m=0"})
    CHECK(warnings_with(without).empty());
}

TEST_CASE("a seam that one block alone names is warned of", "[scene][check]") {
  Scene scene = read_text(std::string(block_on_base) +
                          "[[joint]]\nname = 'seam'\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 1e9\nfriction_angle_deg = 20\n");
  constexpr int none = BlockInput::by_materials, seam = 1;
  scene.blocks[0].edge_joints = {seam, none, none, none};
  REQUIRE(check_scene(scene).size() == 1);
  CHECK_THAT(check_scene(scene).front(), ContainsSubstring("joint \"seam\" is named by edges of block \"" + scene.blocks[0].name + "\" alone"));
  scene.joints[seam].materials = {0, 0};  // there, too, where no block names it
  CHECK(check_scene(scene).empty());
  scene.joints[seam].materials = {JointProperties::no_material, JointProperties::no_material};
  scene.blocks[1].edge_joints = {none, none, seam, none};
  CHECK(check_scene(scene).empty());
}

TEST_CASE("loads and motions that nothing has are warned of", "[scene][check]") {
  const auto warning_of = [](const std::string& table) {
    const std::vector<std::string> warnings = check_scene(read_text(block_on_base + table));
    REQUIRE(warnings.size() == 1);
    return warnings.front();
  };
  const std::string load = "[[load]]\nblock = 'block'\npoint_m = [0, 1]\nforce_n = ";
  CHECK_THAT(warning_of(load + "[0, -2e12]\n"),
             ContainsSubstring("load on \"block\": length of force_n = 2000000000000 is hardly meant: a metre of"));
  CHECK(check_scene(read_text(block_on_base + load + "[0, -1e12]\n")).empty());
  CHECK(check_scene(read_text(block_on_base + load + "[0, 0]\n")).empty());
  const std::string surcharge = "[[surcharge]]\nname = 'dam'\nfrom_m = [1, 1]\nto_m = [0, 1]\n";
  CHECK_THAT(warning_of(surcharge + "pressure_pa = -2e9\n"),
             ContainsSubstring("surcharge \"dam\" on \"block\": pressure_pa = -2000000000 is hardly"));
  CHECK_THAT(warning_of(surcharge + "pressure_pa = 1\nshear_pa = 2e9\n"), ContainsSubstring("shear_pa = 2000000000 is hardly meant"));
  CHECK_THAT(warning_of("[[support]]\npoint_m = [0, 1]\nblock = 'block'\nstiffness_n_per_m = [2e15, 0]\n"),
             ContainsSubstring("length of stiffness_n_per_m = 2000000000000000 is hardly meant"));
  const std::string motion = "[base_motion]\nkind = ";
  CHECK_THAT(warning_of(motion + "'harmonic'\namplitude_m_per_s2 = [1, 0]\nfrequency_hz = 1e20\n"),
             ContainsSubstring("base_motion: frequency_hz = 1e+20"));
  CHECK_THAT(warning_of(motion + "'harmonic'\namplitude_m_per_s2 = [1e20, 0]\nfrequency_hz = 1\n"),
             ContainsSubstring("factor times the length of amplitude_m_per_s2 = 1e+20"));
  CHECK_THAT(warning_of(motion + "'pulses'\nfactor = 10\n[[base_motion.pulse]]\nduration_s = 1\nacceleration_m_per_s2 = [0, 101]\n"),
             ContainsSubstring("base_motion: factor times the largest acceleration = 1010 is hardly meant: earthquakes reach 20"));
  CHECK_THAT(warning_of(motion + "'record'\nvertical_time_s = [0, 1]\nvertical_m_per_s2 = [0, -2000]\n"),
             ContainsSubstring("factor times the largest acceleration = 2000"));
}

TEST_CASE("springs into which blocks sink are warned of", "[scene][check]") {
  // 2700 kg/m3 and 9.81 m/s2, a block of 1 m: a tenth of its size is closed with 10 times its unit weight per metre.
  const auto warnings_with = [](double stiffness) {
    return check_scene(read_text(block_on_base, {"joint[0].normal_stiffness_pa_per_m=" + std::to_string(stiffness)}));
  };
  CHECK(warnings_with(10.01 * 2700.0 * 9.81).empty());
  // Twice as large a block closes twice as much, which is as much of it.
  const std::string larger = test::with_line(block_on_base, 20, "vertices_m = [[0, 0], [2, 0], [2, 2], [0, 2]]");
  CHECK(check_scene(read_text(larger, {"joint[0].normal_stiffness_pa_per_m=265133"})).empty());
  REQUIRE(warnings_with(9.99 * 2700.0 * 9.81).size() == 1);
  CHECK_THAT(warnings_with(9.99 * 2700.0 * 9.81).front(),
             ContainsSubstring("a block of 1 m, the median of the free ones, sinks 0.1 m into the one below"));
  CHECK(check_scene(read_text("gravity_m_per_s2 = [0, 0]\n" + block_on_base, {"joint[0].normal_stiffness_pa_per_m=1e4"})).size() ==
        1);  // nothing loads
}

TEST_CASE("velocities that no block has are warned of", "[scene][check]") {
  const auto warnings_of = [](const std::string& velocity) {
    return check_scene(
        read_text(block_on_base + "[[block]]\nname = 'thrown'\nmaterial = 'rock'\nvertices_m = [[3, 5], [4, 5], [4, 6]]\n" + velocity));
  };
  REQUIRE(warnings_of("velocity_m_per_s = [0, -1001]\n").size() == 1);
  CHECK_THAT(warnings_of("velocity_m_per_s = [0, -1001]\n").front(),
             ContainsSubstring("block \"thrown\": length of velocity_m_per_s = 1001 is hardly meant"));
  REQUIRE(warnings_of("angular_velocity_rad_per_s = -10001\n").size() == 1);
  // A wrong unit is that of all blocks: the fastest stands for them.
  const std::string another = "[[block]]\nname = 'another'\nmaterial = 'rock'\nvertices_m = [[6, 5], [7, 5], [7, 6]]\nvelocity_m_per_s = [2000, 0]\n";
  REQUIRE(warnings_of("velocity_m_per_s = [0, -1001]\n" + another).size() == 1);
  CHECK_THAT(warnings_of("velocity_m_per_s = [0, -1001]\n" + another).front(), ContainsSubstring("block \"another\""));
  CHECK(warnings_of("velocity_m_per_s = [0, -1000]\nangular_velocity_rad_per_s = 10000\n").empty());
}

TEST_CASE("slivers are named with the key that unites them", "[scene][check]") {
  const auto sliver = [](const std::string& height) {
    return "[[block]]\nname = 'sliver'\nmaterial = 'rock'\nvertices_m = [[1.5, 0], [1.51, 0], [1.51, " + height + "], [1.5, " + height + "]]\n";
  };
  const std::string third = "[[block]]\nname = 'third'\nmaterial = 'rock'\nvertices_m = [[0, 1], [1, 1], [1, 2], [0, 2]]\n";
  const std::vector<std::string> warnings = check_scene(read_text(block_on_base + third + sliver("0.009")));
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings.front(), ContainsSubstring("\"sliver\" with 9e-05 m2, of 3 free blocks, is smaller than 0.0001 of the median block"));
  CHECK_THAT(warnings.front(), !ContainsSubstring("domain"));
  // A hundredth of the size of the median block, and one that is fixed, are none.
  CHECK(check_scene(read_text(block_on_base + third + sliver("0.0101"))).empty());
  CHECK(check_scene(read_text(block_on_base + third + sliver("0.009") + "fixed = true\n")).empty());
}

TEST_CASE("a scene is judged by its memory before it is taken", "[scene][check]") {
  const Scene scene = running_bond(100, 100);
  CHECK_NOTHROW(require_memory(scene, std::size_t{1} << 30));
  CHECK_THROWS_WITH(require_memory(scene, std::size_t{10} << 20),
                    ContainsSubstring("block: ") && ContainsSubstring(" blocks with ") && ContainsSubstring("accepted: fewer [[block]]"));
}

TEST_CASE("a fixed block has no velocity of its own", "[scene][check]") {
  Scene scene = read_text(block_on_base);
  const auto warns = [&] {
    const auto is_of_it = [](const std::string& w) { return w.find("the velocity of block") != std::string::npos; };
    return std::ranges::any_of(check_scene(scene), is_of_it);
  };
  REQUIRE(scene.blocks[0].fixed);
  scene.blocks[1].velocity = {1.0, 0.0};
  CHECK_FALSE(warns());
  scene.blocks[0].velocity = {1.0, 0.0};
  CHECK(warns());
  scene.blocks[0].velocity = {0.0, 0.0};
  scene.blocks[0].angular_velocity = 1.0;
  CHECK(warns());
}
