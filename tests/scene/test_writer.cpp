#include <cmath>
#include <random>

#include "openclose/scene/angle.h"
#include "openclose/scene/writer.h"
#include "scene_file.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::block_on_base;
using openclose::test::read_text;

namespace {

void check_same(const JointProperties& a, const JointProperties& b) {
  CHECK(a.materials == b.materials);
  CHECK(a.normal_stiffness == b.normal_stiffness);
  CHECK(a.shear_stiffness == b.shear_stiffness);
  CHECK(a.friction_angle == b.friction_angle);
  CHECK(a.cohesion == b.cohesion);
  CHECK(a.tensile_strength == b.tensile_strength);
  CHECK(a.cohesion_behaviour == b.cohesion_behaviour);
  CHECK(a.slip_weakening_distance == b.slip_weakening_distance);
  REQUIRE(a.residual_friction_angle.has_value() == b.residual_friction_angle.has_value());
  if (a.residual_friction_angle) CHECK(*a.residual_friction_angle == Approx(*b.residual_friction_angle).epsilon(1e-15));
  CHECK(a.damping_ratio == b.damping_ratio);
}

void check_same(const BlockInput& a, const BlockInput& b) {
  CHECK(a.name == b.name);
  CHECK(a.material == b.material);
  CHECK(a.vertices == b.vertices);
  CHECK(a.fixed == b.fixed);
  CHECK(a.rotation_locked == b.rotation_locked);
  CHECK(a.velocity == b.velocity);
  CHECK(a.angular_velocity == b.angular_velocity);
}

void check_same(const MethodInput& a, const MethodInput& b) {
  CHECK(a.contact == b.contact);
  CHECK(a.integrator == b.integrator);
  CHECK(a.theta == b.theta);
  CHECK(a.rho_inf == b.rho_inf);
  CHECK(a.dissipation == b.dissipation);
  CHECK(a.first_integrator == b.first_integrator);
  CHECK(a.first_integrator_time == b.first_integrator_time);
  CHECK(a.rotation == b.rotation);
  CHECK(a.start == b.start);
  CHECK(a.statics == b.statics);
  CHECK(a.residual_tolerance == b.residual_tolerance);
  CHECK(a.max_iterations == b.max_iterations);
  CHECK(a.linear_solver == b.linear_solver);
  CHECK(a.static_solver == b.static_solver);
  CHECK(a.skip_search == b.skip_search);
  CHECK(a.skip_narrow_phase == b.skip_narrow_phase);
  CHECK(a.skip_looks == b.skip_looks);
  CHECK(a.contact_skin == b.contact_skin);
  CHECK(a.skip_reload == b.skip_reload);
  CHECK(a.skip_factorisation == b.skip_factorisation);
  CHECK(a.skip_symbolic == b.skip_symbolic);
  CHECK(a.skip_still_steps == b.skip_still_steps);
  CHECK(a.skip_balanced == b.skip_balanced);
  CHECK(a.skip_resting == b.skip_resting);
  CHECK(a.threads == b.threads);
  CHECK(a.penalty == b.penalty);
  CHECK(a.penalty_shear_ratio == b.penalty_shear_ratio);
  CHECK(a.penetration_tolerance == b.penetration_tolerance);
  CHECK(a.closing_tolerance == b.closing_tolerance);
  CHECK(a.gap_tolerance == b.gap_tolerance);
  CHECK(a.max_open_close_iterations == b.max_open_close_iterations);
  CHECK(a.step_cut == b.step_cut);
  CHECK(a.step_fraction == b.step_fraction);
  CHECK(a.damping == b.damping);
  CHECK(a.local_damping == b.local_damping);
}

void check_same_points(const Scene& a, const Scene& b) {
  REQUIRE(a.supports.size() == b.supports.size());
  for (std::size_t i = 0; i < a.supports.size(); ++i) {
    CHECK(a.supports[i].block == b.supports[i].block);
    CHECK(a.supports[i].point == b.supports[i].point);
    CHECK(a.supports[i].stiffness == b.supports[i].stiffness);
    CHECK(a.supports[i].name == b.supports[i].name);
  }
  REQUIRE(a.loads.size() == b.loads.size());
  for (std::size_t i = 0; i < a.loads.size(); ++i) {
    CHECK(a.loads[i].block == b.loads[i].block);
    CHECK(a.loads[i].point == b.loads[i].point);
    CHECK(a.loads[i].force == b.loads[i].force);
    CHECK(a.loads[i].name == b.loads[i].name);
  }
  REQUIRE(a.surcharges.size() == b.surcharges.size());
  for (std::size_t i = 0; i < a.surcharges.size(); ++i) {
    CHECK(a.surcharges[i].block == b.surcharges[i].block);
    CHECK(a.surcharges[i].from == b.surcharges[i].from);
    CHECK(a.surcharges[i].to == b.surcharges[i].to);
    CHECK(a.surcharges[i].pressure == b.surcharges[i].pressure);
    CHECK(a.surcharges[i].shear == b.surcharges[i].shear);
    CHECK(a.surcharges[i].name == b.surcharges[i].name);
  }
  REQUIRE(a.measured_points.size() == b.measured_points.size());
  for (std::size_t i = 0; i < a.measured_points.size(); ++i) {
    CHECK(a.measured_points[i].name == b.measured_points[i].name);
    CHECK(a.measured_points[i].block == b.measured_points[i].block);
    CHECK(a.measured_points[i].point == b.measured_points[i].point);
  }
}

void check_same(const Scene& a, const Scene& b) {
  CHECK(a.title == b.title);
  CHECK(a.gravity == b.gravity);
  REQUIRE(a.materials.size() == b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) {
    CHECK(a.materials[i].name == b.materials[i].name);
    CHECK(a.materials[i].density == b.materials[i].density);
  }
  REQUIRE(a.joints.size() == b.joints.size());
  for (std::size_t i = 0; i < a.joints.size(); ++i) check_same(a.joints[i], b.joints[i]);
  REQUIRE(a.blocks.size() == b.blocks.size());
  for (std::size_t i = 0; i < a.blocks.size(); ++i) check_same(a.blocks[i], b.blocks[i]);
  check_same_points(a, b);
  check_same(a.method, b.method);
  CHECK(a.step.dt == b.step.dt);
  CHECK(a.step.max_displacement == b.step.max_displacement);
  CHECK(a.step.smallest_fraction == b.step.smallest_fraction);
  CHECK(a.step.adaptive == b.step.adaptive);
  CHECK(a.step.error_tolerance == b.step.error_tolerance);
  CHECK(a.step.look_ahead == b.step.look_ahead);
  CHECK(a.rest.time == b.rest.time);
  CHECK(a.rest.displacement == b.rest.displacement);
  CHECK(a.rest.acceleration == b.rest.acceleration);
  CHECK(a.end_time == b.end_time);
  CHECK(a.output_every == b.output_every);
  CHECK(a.checkpoint_every == b.checkpoint_every);
  CHECK(a.run_strength_reduction_factor == b.run_strength_reduction_factor);
  CHECK(a.settled_by == b.settled_by);
  CHECK(a.end_displacement == b.end_displacement);
  CHECK(a.milestones == b.milestones);
  CHECK(a.snapshot_times == b.snapshot_times);
  CHECK(a.snapshots_every == b.snapshots_every);
  CHECK(a.formats == b.formats);
  REQUIRE(a.measured_contacts.size() == b.measured_contacts.size());
  for (std::size_t i = 0; i < a.measured_contacts.size(); ++i) {
    CHECK(a.measured_contacts[i].name == b.measured_contacts[i].name);
    CHECK(a.measured_contacts[i].block_a == b.measured_contacts[i].block_a);
    CHECK(a.measured_contacts[i].block_b == b.measured_contacts[i].block_b);
    CHECK(a.measured_contacts[i].point == b.measured_contacts[i].point);
  }
  CHECK(a.settle.unbalanced_fraction == b.settle.unbalanced_fraction);
  CHECK(a.settle.first_dt == b.settle.first_dt);
  CHECK(a.settle.max_steps == b.settle.max_steps);
  CHECK(a.settle.max_explicit_steps == b.settle.max_explicit_steps);
  CHECK(a.settle.failure_displacement == b.settle.failure_displacement);
  CHECK(a.settle.criterion == b.settle.criterion);
  CHECK(a.settle.relative_displacement == b.settle.relative_displacement);
  CHECK(a.settle.steady_steps == b.settle.steady_steps);
  CHECK(a.settle.max_time_steps == b.settle.max_time_steps);
  CHECK(a.settle.keep_bonds == b.settle.keep_bonds);
  CHECK(a.settle.unbalanced_force == b.settle.unbalanced_force);
  CHECK(a.strength_reduction.width == b.strength_reduction.width);
  CHECK(a.strength_reduction.increase == b.strength_reduction.increase);
  CHECK(a.strength_reduction.upper_limit == b.strength_reduction.upper_limit);
  CHECK(a.strength_reduction.curve == b.strength_reduction.curve);
  CHECK(a.strength_reduction.curve_time == b.strength_reduction.curve_time);
}

/// Every field away from its default, numbers with all their bits used.
Scene random_scene(unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> fraction(0.1, 0.9);
  const auto number = [&] { return fraction(generator) * std::pow(10.0, std::floor(20.0 * fraction(generator)) - 10.0); };
  const auto vector = [&] { return Vec2(-number(), number()); };

  Scene scene;
  scene.title = "back\\slash, \"quotes\",\ttab,\nline, \x01 and \xc3\xbc";
  scene.gravity = 0.1 * vector();  // within what is accepted
  scene.materials = {{"granite", number()}, {"a b = [c] #", number()}};
  scene.joints.resize(2);
  for (JointProperties& joint : scene.joints) {
    joint.normal_stiffness = number();
    joint.shear_stiffness = number();
    joint.friction_angle = radians(90.0 * fraction(generator));
    joint.cohesion = number();
    joint.tensile_strength = number();
    joint.cohesion_behaviour = CohesionBehaviour::lost_on_opening;
    joint.damping_ratio = number();
  }
  scene.joints[1].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  scene.joints[1].residual_friction_angle = 0.5 * scene.joints[1].friction_angle;
  scene.joints[1].slip_weakening_distance = 0.1 * fraction(generator);
  scene.joints[0].materials = {0, 0};
  scene.joints[1].materials = {1, 0};
  for (int i = 0; i < 5; ++i) {
    BlockInput block;
    const Vec2 corner(1e6 * fraction(generator), -1e3 * fraction(generator));
    block.name = "block " + std::to_string(i);
    block.material = i % 2;
    block.vertices = {corner, corner + Vec2(fraction(generator), -0.05), corner + Vec2(1.0, fraction(generator)), corner + Vec2(0.01, 1.0)};
    block.fixed = i == 0;
    block.rotation_locked = i == 1;
    block.velocity = vector();
    block.angular_velocity = block.rotation_locked ? 0.0 : -number();
    const std::string name = i % 2 == 0 ? "" : "push " + std::to_string(i);
    scene.supports.push_back({i, corner, {0.0, number()}, name});
    scene.loads.push_back({i, corner, vector(), name});
    if (i > 1) scene.surcharges.push_back({i, block.vertices[1], block.vertices[2], number(), -number(), name});
    scene.measured_points.push_back({"point " + std::to_string(i), i, corner});
    scene.blocks.push_back(block);
  }
  scene.method.contact = "hard";
  scene.method.integrator = "theta";
  scene.method.theta = 0.5 + 0.5 * fraction(generator);
  scene.method.rho_inf = fraction(generator);
  scene.method.dissipation = fraction(generator);
  scene.method.first_integrator = "path_average";
  scene.method.first_integrator_time = number();
  scene.method.rotation = RotationKind::linear;
  scene.method.start = Start::steady_sliding;
  scene.method.statics = true;
  scene.method.residual_tolerance = fraction(generator);
  scene.method.max_iterations = 123456;
  scene.method.linear_solver = LinearSolverKind::iterative;
  scene.method.static_solver = StaticSolver::relaxation;
  scene.method.skip_search = false;
  scene.method.skip_narrow_phase = false;
  scene.method.skip_looks = false;
  scene.method.contact_skin = number();
  scene.method.skip_reload = false;
  scene.method.skip_factorisation = false;
  scene.method.skip_symbolic = false;
  scene.method.skip_still_steps = false;
  scene.method.skip_balanced = false;
  scene.method.skip_resting = true;
  scene.method.threads = 3;
  scene.method.penalty = number();
  scene.method.penalty_shear_ratio = number();
  scene.method.penetration_tolerance = number();
  scene.method.closing_tolerance = number();
  scene.method.gap_tolerance = number();
  scene.method.max_open_close_iterations = 7;
  scene.method.step_cut = fraction(generator);
  scene.method.step_fraction = fraction(generator);
  scene.method.damping = MassDamping::local;
  scene.method.local_damping = fraction(generator);
  scene.step = {number(), number(), fraction(generator), true, number(), fraction(generator)};
  scene.rest = {number(), number(), number()};
  scene.end_time = number();
  scene.output_every = number();
  scene.checkpoint_every = number();
  scene.run_strength_reduction_factor = number();
  scene.settled_by = "settler";
  scene.end_displacement = number();
  const double first = number();
  scene.milestones = {first, 2.0 * first};
  scene.snapshot_times = {0.0, first};
  scene.snapshots_every = number();
  scene.formats = {"one", "another"};
  // Two blocks that share a corner: the second one is turned by half a turn about it.
  const Vec2 shared = scene.blocks[0].vertices[0], old = scene.blocks[1].vertices[0];
  for (Vec2& v : scene.blocks[1].vertices) v = shared - (v - old);
  scene.supports[1].point = scene.loads[1].point = scene.measured_points[1].point = scene.blocks[0].vertices[0];
  scene.measured_contacts = {{"contact", 1, 0, scene.blocks[0].vertices[0]}};
  scene.settle = {fraction(generator), number(), 77, number(), SettleCriterion::paper, fraction(generator), 78, 79, 80};
  scene.strength_reduction = {FactorDefinition::joint_closures, false, "-push 3", number(), 1.0 + number(), {number(), number()}, number()};
  return scene;
}

}  // namespace

TEST_CASE("a written scene reads back bit by bit", "[scene][writer]") {
  const unsigned seed = GENERATE(range(0u, 50u));
  const Scene scene = random_scene(seed);
  check_same(read_text(write_scene(scene)), scene);
}

TEST_CASE("a scene of defaults reads back", "[scene][writer]") {
  const Scene scene = read_text(block_on_base);
  check_same(read_text(write_scene(scene)), scene);
}

TEST_CASE("what was read is written as a person would", "[scene][writer]") {
  const std::string text = write_scene(read_text(block_on_base, {"title=slope"}));
  const std::string expected =
      "title = \"slope\"\n"
      "gravity_m_per_s2 = [0, -9.81]\n"
      "\n"
      "[[material]]\n"
      "name = \"rock\"\n"
      "density_kg_per_m3 = 2700\n"
      "\n"
      "[[joint]]\n"
      "materials = [\"rock\", \"rock\"]\n"
      "normal_stiffness_pa_per_m = 1000000000\n"
      "shear_stiffness_pa_per_m = 400000000\n"
      "friction_angle_deg = 35\n"
      "cohesion_pa = 0\n"
      "tensile_strength_pa = 0\n"
      "cohesion_behaviour = \"ductile\"\n"
      "slip_weakening_distance_m = 0\n"
      "damping_ratio = 0\n"
      "\n"
      "[[block]]\n"
      "name = \"base\"\n"
      "material = \"rock\"\n"
      "vertices_m = [[-1, -1], [2, -1], [2, 0], [-1, 0]]\n"
      "fixed = true\n";
  CHECK(text.substr(0, expected.size()) == expected);
}

TEST_CASE("a negative zero keeps its sign", "[scene][writer]") {
  Scene scene = read_text(block_on_base);
  scene.gravity = Vec2(-0.0, -1.0);
  CHECK(std::signbit(read_text(write_scene(scene)).gravity.x()));
}
