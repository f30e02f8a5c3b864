#include <cmath>

#include "openclose/contact/joint_table.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using test::degree;
using test::empty_scene;
using test::fixed_block;
using test::free_block;
using test::rectangle;

namespace {

JointProperties joint_between(int a, int b, double friction_deg) {
  JointProperties joint = test::frictional_joint(1e9, 4e8, friction_deg * degree);
  joint.materials = {a, b};
  joint.cohesion = 5e4;
  joint.tensile_strength = 2e4;
  return joint;
}

/// Fixed clay, free sand and free lime.
Scene three_materials() {
  Scene scene = empty_scene();
  scene.materials = {{"clay", 2000.0}, {"sand", 1800.0}, {"lime", 2600.0}};
  scene.blocks = {fixed_block("base", rectangle(0.0, -1.0, 9.0, 1.0)), free_block("a", rectangle(0.0, 0.0, 1.0, 1.0)),
                  free_block("b", rectangle(2.0, 0.0, 1.0, 1.0))};
  for (int b = 0; b < 3; ++b) scene.blocks[b].material = b;
  scene.joints = {joint_between(1, 0, 10.0), joint_between(2, 1, 20.0), joint_between(0, 2, 30.0)};
  return scene;
}

}  // namespace

TEST_CASE("joints are found in either order of the materials", "[contact][joint_table]") {
  const JointTable table(three_materials());
  CHECK(table.index(0, 1) == 0);
  CHECK(table.index(1, 0) == 0);
  CHECK(table.index(1, 2) == 1);
  CHECK(table.index(2, 1) == 1);
  CHECK(table.index(0, 2) == 2);
  CHECK(table.index(2, 0) == 2);
  CHECK(table.joint(table.index(2, 1)).friction_angle == 20.0 * degree);
}

TEST_CASE("a seam that both blocks name has its own joint, everything else that of the materials", "[contact][joint_table]") {
  Scene scene = three_materials();
  JointProperties seam = joint_between(JointProperties::no_material, JointProperties::no_material, 5.0);
  seam.name = "bedding";
  scene.joints.push_back(seam);
  constexpr int none = BlockInput::by_materials;
  scene.blocks[0].edge_joints = {none, none, 3, none};  // the top of the base
  scene.blocks[1].edge_joints = {3, none, none, none};  // the lower side of a
  const JointTable table(scene);
  const BlockSystem system(scene);
  const auto joint = [&](int vertex_block, int vertex, int edge_block, int edge) {
    Contact contact;
    contact.vertex_block = vertex_block;
    contact.vertex = system.block(vertex_block).first_vertex + vertex;
    contact.edge_block = edge_block;
    contact.edge = system.block(edge_block).first_vertex + edge;
    return table.index(system, contact);
  };
  CHECK(joint(1, 0, 0, 2) == 3);                  // the edge that begins at the corner
  CHECK(joint(1, 1, 0, 2) == 3);                  // the edge that ends there
  CHECK(joint(1, 2, 0, 2) == 3);                  // a corner of which neither edge runs along the seam
  CHECK(joint(1, 0, 0, 1) == table.index(0, 1));  // another side of the base
  CHECK(joint(2, 0, 0, 2) == table.index(0, 2));  // a block that names nothing
  CHECK(joint(0, 3, 1, 0) == 3);
}

TEST_CASE("a missing joint is bad input, in the words of the scene", "[contact][joint_table]") {
  Scene scene = three_materials();
  scene.joints.pop_back();
  CHECK_THROWS_AS(JointTable(scene), InputError);
  CHECK_THROWS_WITH(JointTable(scene), ContainsSubstring("\"clay\"") && ContainsSubstring("\"lime\"") && ContainsSubstring("[[joint]]"));
}

TEST_CASE("two free blocks of one material need a joint with themselves", "[contact][joint_table]") {
  Scene scene = three_materials();
  CHECK_NOTHROW(JointTable(scene));
  scene.blocks.push_back(free_block("c", rectangle(4.0, 0.0, 1.0, 1.0)));
  scene.blocks.back().material = 1;
  CHECK_THROWS_AS(JointTable(scene), InputError);
  scene.joints.push_back(joint_between(1, 1, 40.0));
  CHECK(JointTable(scene).index(1, 1) == 3);
}

TEST_CASE("materials that cannot meet need no joint", "[contact][joint_table]") {
  Scene scene = three_materials();
  scene.blocks[2].fixed = true;
  scene.joints.pop_back();
  // Clay and lime are both fixed.
  CHECK_NOTHROW(JointTable(scene));
}

TEST_CASE("strength reduction divides tan(phi), cohesion and tension, always from the scene's values", "[contact][joint_table]") {
  const Scene scene = three_materials();
  JointTable table(scene);
  for (const double factor : {2.0, 0.5, 3.7}) {
    table.reduce_strength(factor);
    for (int j = 0; j < 3; ++j) {
      const JointProperties &reduced = table.joint(j), &given = scene.joints[j];
      CHECK(std::tan(reduced.friction_angle) == Approx(std::tan(given.friction_angle) / factor).epsilon(1e-15));
      CHECK(reduced.cohesion == given.cohesion / factor);
      CHECK(reduced.tensile_strength == given.tensile_strength / factor);
      CHECK(reduced.normal_stiffness == given.normal_stiffness);
      CHECK(reduced.shear_stiffness == given.shear_stiffness);
    }
  }
  table.reduce_strength(1.0);
  CHECK(table.joint(2).friction_angle == Approx(30.0 * degree).epsilon(1e-15));
  CHECK(table.joint(2).cohesion == 5e4);
}

TEST_CASE("strength reduction divides the tangents of both friction angles", "[contact][joint_table]") {
  Scene scene = three_materials();
  scene.joints[1].residual_friction_angle = 12.0 * degree;
  JointTable table(scene);
  CHECK(table.joint(1).residual_friction == Approx(std::tan(12.0 * degree)).epsilon(1e-15));
  CHECK(table.joint(0).residual_friction == table.joint(0).friction);
  table.reduce_strength(1.6);
  CHECK(table.joint(1).friction == Approx(std::tan(20.0 * degree) / 1.6).epsilon(1e-15));
  CHECK(table.joint(1).residual_friction == Approx(std::tan(12.0 * degree) / 1.6).epsilon(1e-15));
  CHECK(table.joint(0).residual_friction == table.joint(0).friction);
}

TEST_CASE("the joints of a state that was saved without a reduction have none", "[contact][joint_table]") {
  const Scene scene = three_materials();
  JointTable full(scene), reduced(scene);
  reduced.reduce_strength(2.0);
  Archive written;
  full.exchange(written);
  Archive bytes(written.bytes());
  reduced.exchange(bytes);
  CHECK(bytes.at_end());
  CHECK_FALSE(reduced.reduction());
  for (int j = 0; j < full.count(); ++j) CHECK(reduced.joint(j).friction_angle == full.joint(j).friction_angle);
}
