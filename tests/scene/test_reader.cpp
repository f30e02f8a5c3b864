#include <numbers>

#include "openclose/scene/reader.h"
#include "scene_file.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::block_on_base;
using openclose::test::read_text;
using openclose::test::SceneFile;
using openclose::test::with_line;

TEST_CASE("a small scene gets the defaults of the structs", "[scene][reader]") {
  const SceneFile file(block_on_base);
  const Scene scene = read_scene(file.path());
  CHECK(scene.where.file == file.path());
  CHECK(scene.title.empty());
  CHECK(scene.gravity == Vec2(0.0, -9.81));
  REQUIRE(scene.materials.size() == 1);
  CHECK(scene.materials[0].density == 2700.0);
  REQUIRE(scene.joints.size() == 1);
  CHECK(scene.joints[0].friction_angle == Approx(35.0 * std::numbers::pi / 180.0).epsilon(1e-15));
  CHECK(scene.joints[0].cohesion == 0.0);
  REQUIRE(scene.blocks.size() == 2);
  CHECK(scene.blocks[0].name == "base");
  CHECK(scene.blocks[0].fixed);
  CHECK(scene.blocks[0].line == 11);
  CHECK(scene.blocks[1].line == 17);
  CHECK_FALSE(scene.blocks[1].fixed);
  CHECK(scene.blocks[1].vertices == std::vector<Vec2>{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}});
  CHECK(scene.method.contact == MethodInput{}.contact);
  CHECK(scene.method.contact_where.file == file.path());
  CHECK_FALSE(scene.method.penalty);
  CHECK(scene.step.dt == 0.0);
  CHECK(scene.end_time == 0.0);
  CHECK_FALSE(scene.end_displacement);
  CHECK(scene.run_strength_reduction_factor == 1.0);
  CHECK_FALSE(scene.settled_by.has_value());
  CHECK(scene.milestones.empty());
  CHECK(scene.snapshot_times.empty());
  CHECK(scene.settle.criterion == SettleCriterion::unbalanced_force);
  CHECK(scene.settle.relative_displacement == 1e-5);
  CHECK(scene.settle.unbalanced_force == 1e3);
  CHECK(scene.settle.keep_bonds);
}

TEST_CASE("every key reaches its field", "[scene][reader]") {
  const Scene scene = read_text(
      "title = 'all of it'\n"
      "gravity_m_per_s2 = [1, -2.5]\n"
      "[[material]]\nname = 'a'\ndensity_kg_per_m3 = 2e3\n"
      "[[material]]\nname = 'b'\nunit_weight_n_per_m3 = 26926\n"
      "[[joint]]\nmaterials = ['b', 'a']\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 2e8\nfriction_angle_deg = 30\n"
      "cohesion_pa = 5\ntensile_strength_pa = 6\ncohesion_behaviour = 'lost_on_slip'\ndamping_ratio = 0.1\n"
      "[[block]]\nname = 'one'\nmaterial = 'b'\nvertices_m = [[0, 0], [1, 0], [0, 1]]\n"
      "velocity_m_per_s = [1, 2]\nangular_velocity_rad_per_s = -3\n"
      "[[block]]\nname = 'two'\nmaterial = 'a'\nvertices_m = [[5, 0], [6, 0], [5, 1]]\nrotation_locked = true\n"
      "[[support]]\nname = 'anchor'\nblock = 'one'\npoint_m = [0, 0]\nstiffness_n_per_m = [0, 7]\n"
      "[[load]]\nname = 'push'\nblock = 'one'\npoint_m = [0.25, 0.25]\nforce_n = [-8, 9]\n"
      "[[measured_point]]\nname = 'p'\nblock = 'one'\npoint_m = [1, 0]\n"
      "[method]\ncontact = 'anything'\ntheta = 0.5\nintegrator = 'any'\nrho_inf = 0.25\ndissipation = 0.01\n"
      "first_integrator = 'other'\nfirst_integrator_s = 0.5\nrotation = 'linear'\nstart = 'steady_sliding'\nstatics = true\n"
      "threads = 3\npenalty_pa_per_m = 11\npenalty_shear_ratio = 0.5\nstep_fraction = 0.5\ndamping = 'automatic'\n"
      "[solver]\nresidual_tolerance = 1e-9\nmax_iterations = 10\nskip_search = false\nskip_narrow_phase = false\nskip_looks = false\n"
      "contact_skin_m = 0.01\nskip_reload = false\nskip_factorisation = false\nskip_symbolic = false\nskip_balanced = false\n"
      "skip_still_steps = false\n"
      "skip_resting = true\npenetration_tolerance_m = 12\ngap_tolerance_m = 2e-9\nclosing_tolerance_m = 0\n"
      "max_open_close_iterations = 13.0\nstep_cut = 0.25\nlocal_damping = 0.6\nsmallest_fraction = 1\n"
      "[step]\ndt_s = 0.01\nmax_displacement_m = 14\nadaptive = true\nerror_tolerance_m = 1e-3\nlook_ahead = 0.75\n"
      "[rest]\ntime_s = 0.5\ndisplacement_m = 2e-3\nacceleration_m_per_s2 = 0.75\n"
      "[run]\nstrength_reduction_factor = 1.5\nsettled_by = 'another'\n"
      "[end]\ntime_s = 15\ndisplacement_m = 40\n[output]\nevery_s = 16\ncheckpoint_every_s = 24\nmilestones_m = [10, 20.5]\nsnapshots_s = [0, "
      "1.522]\nsnapshots_every_s = 0.25\nformats = ['vtk']\n"
      "[settle]\nunbalanced_fraction = 1e-3\nfirst_dt_s = 17\nmax_steps = 18\nfailure_displacement_m = 19\n"
      "criterion = 'paper'\nrelative_displacement = 1e-6\nsteady_steps = 22\nmax_time_steps = 23\nunbalanced_force_n = 24\nkeep_bonds = false\n"
      "[strength_reduction]\nincrease = '-push'\nwidth = 0.125\nupper_limit = 20\ncurve = [1, 1.5]\ncurve_time_s = 21\n");
  CHECK(scene.title == "all of it");
  CHECK(scene.gravity == Vec2(1.0, -2.5));
  CHECK(scene.materials[1].density == Approx(26926.0 / std::sqrt(7.25)).epsilon(1e-15));
  const JointProperties& joint = scene.joints.at(0);
  CHECK(joint.materials == std::array{1, 0});
  CHECK(joint.normal_stiffness == 1e9);
  CHECK(joint.shear_stiffness == 2e8);
  CHECK(joint.friction_angle == Approx(std::numbers::pi / 6.0).epsilon(1e-15));
  CHECK(joint.cohesion == 5.0);
  CHECK(joint.tensile_strength == 6.0);
  CHECK(joint.cohesion_behaviour == CohesionBehaviour::lost_on_slip);
  CHECK(joint.damping_ratio == 0.1);
  CHECK(scene.joint(0, 1) == &joint);
  CHECK(scene.joint(1, 0) == &joint);
  CHECK(scene.joint(0, 0) == nullptr);
  const BlockInput& block = scene.blocks.at(0);
  CHECK(block.material == 1);
  CHECK_FALSE(block.rotation_locked);
  CHECK(scene.blocks.at(1).rotation_locked);
  CHECK(block.velocity == Vec2(1.0, 2.0));
  CHECK(block.angular_velocity == -3.0);
  CHECK(scene.supports.at(0).point == Vec2(0.0, 0.0));
  CHECK(scene.supports.at(0).stiffness == Vec2(0.0, 7.0));
  CHECK(scene.loads.at(0).point == Vec2(0.25, 0.25));
  CHECK(scene.loads.at(0).force == Vec2(-8.0, 9.0));
  CHECK(scene.loads.at(0).name == "push");
  CHECK(scene.supports.at(0).name == "anchor");
  CHECK(scene.measured_points.at(0).name == "p");
  CHECK(scene.measured_points.at(0).point == Vec2(1.0, 0.0));
  CHECK(scene.snapshots_every == 0.25);
  CHECK(scene.formats == std::vector<std::string>{"vtk"});
  const MethodInput& method = scene.method;
  CHECK(method.contact == "anything");
  CHECK(method.contact_where.line == 44);
  CHECK(method.theta == 0.5);
  CHECK(method.integrator == "any");
  CHECK(method.rho_inf == 0.25);
  CHECK(method.dissipation == 0.01);
  CHECK(method.first_integrator == "other");
  CHECK(method.first_integrator_time == 0.5);
  CHECK(method.rotation == RotationKind::linear);
  CHECK(method.start == Start::steady_sliding);
  CHECK(method.statics);
  CHECK(method.residual_tolerance == 1e-9);
  CHECK(method.max_iterations == 10);
  CHECK_FALSE(method.skip_search);
  CHECK_FALSE(method.skip_narrow_phase);
  CHECK_FALSE(method.skip_looks);
  CHECK(method.contact_skin == 0.01);
  CHECK_FALSE(method.skip_reload);
  CHECK_FALSE(method.skip_factorisation);
  CHECK_FALSE(method.skip_symbolic);
  CHECK_FALSE(method.skip_still_steps);
  CHECK_FALSE(method.skip_balanced);
  CHECK(method.skip_resting);
  CHECK(method.threads == 3);
  CHECK(scene.rest.time == 0.5);
  CHECK(scene.rest.displacement == 2e-3);
  CHECK(scene.rest.acceleration == 0.75);
  CHECK(method.penalty == 11.0);
  CHECK(method.penalty_shear_ratio == 0.5);
  CHECK(method.penetration_tolerance == 12.0);
  CHECK(method.closing_tolerance == 0.0);
  CHECK(method.gap_tolerance == 2e-9);
  CHECK(method.max_open_close_iterations == 13);
  CHECK(method.step_cut == 0.25);
  CHECK(method.step_fraction == 0.5);
  CHECK(method.damping == MassDamping::automatic);
  CHECK(method.local_damping == 0.6);
  CHECK(scene.step.dt == 0.01);
  CHECK(scene.step.max_displacement == 14.0);
  CHECK(scene.step.smallest_fraction == 1.0);
  CHECK(scene.step.adaptive);
  CHECK(scene.step.error_tolerance == 1e-3);
  CHECK(scene.step.look_ahead == 0.75);
  CHECK(scene.step.look_ahead_where.line - scene.step.adaptive_where.line == 2);
  CHECK(scene.end_time == 15.0);
  CHECK(scene.output_every == 16.0);
  CHECK(scene.checkpoint_every == 24.0);
  CHECK(scene.run_strength_reduction_factor == 1.5);
  CHECK(scene.settled_by == "another");
  CHECK(scene.end_displacement == 40.0);
  CHECK(scene.milestones == std::vector<double>{10.0, 20.5});
  CHECK(scene.snapshot_times == std::vector<double>{0.0, 1.522});
  CHECK(scene.settle.unbalanced_fraction == 1e-3);
  CHECK(scene.settle.first_dt == 17.0);
  CHECK(scene.settle.max_steps == 18);
  CHECK(scene.settle.failure_displacement == 19.0);
  CHECK(scene.settle.criterion == SettleCriterion::paper);
  CHECK(scene.settle.relative_displacement == 1e-6);
  CHECK(scene.settle.steady_steps == 22);
  CHECK(scene.settle.max_time_steps == 23);
  CHECK(scene.settle.unbalanced_force == 24.0);
  CHECK_FALSE(scene.settle.keep_bonds);
  CHECK(scene.strength_reduction.width == 0.125);
  CHECK(scene.strength_reduction.upper_limit == 20.0);
  CHECK(scene.strength_reduction.increase == "-push");
  CHECK(scene.strength_reduction.curve == std::vector<double>{1.0, 1.5});
  CHECK(scene.strength_reduction.curve_time == 21.0);
}

TEST_CASE("the linear solver is chosen by its word", "[scene][reader]") {
  CHECK(read_text(block_on_base).method.linear_solver == LinearSolverKind::automatic);
  CHECK(read_text(std::string(block_on_base) + "[solver]\nlinear_solver = 'direct'\n").method.linear_solver == LinearSolverKind::direct);
}

TEST_CASE("the solver of static steps is chosen by its word", "[scene][reader]") {
  CHECK(read_text(block_on_base).method.static_solver == StaticSolver::automatic);
  CHECK(read_text(std::string(block_on_base) + "[solver]\nstatic_solver = 'relaxation'\n").method.static_solver == StaticSolver::relaxation);
  CHECK(read_text(std::string(block_on_base) + "[solver]\nstatic_solver = 'newton'\n").method.static_solver == StaticSolver::newton);
}

TEST_CASE("polygons are put in order silently", "[scene][reader]") {
  const std::vector<Vec2> square{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  const std::string vertices = GENERATE(as<std::string>{},                                                           //
                                        "[[0, 0], [0, 1], [1, 1], [1, 0]]",                                          // clockwise
                                        "[[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]",                                  // closed
                                        "[[0, 0], [0, 0], [1, 0], [1, 1], [1, 1], [0, 1]]",                          // doubled
                                        "[[0, 0], [0.3, 0], [0.5, 0], [1, 0], [1, 0.5], [1, 1], [0, 1], [0, 0.1]]",  // straight corners
                                        "[[0, 0], [0, 0.1], [0, 1], [1, 1], [1, 0], [1, 0], [0.5, 0], [0, 0]]");     // all of it
  CHECK(read_text(with_line(block_on_base, 20, "vertices_m = " + vertices)).blocks[1].vertices == square);
}

TEST_CASE("points on the rim of their block, to six decimals, belong to it", "[scene][reader]") {
  const Scene scene = read_text(block_on_base + "[[load]]\nblock = 'block'\npoint_m = [1.0000009, 0.5]\nforce_n = [1, 0]\n");
  CHECK(scene.loads.at(0).point == Vec2(1.0000009, 0.5));
}

TEST_CASE("the two blocks of a measured contact are named, or found by its point", "[scene][reader]") {
  const std::string contact = "[[measured_contact]]\nname = 'foot'\npoint_m = [0.5, 0]\n";
  for (const std::string names : {"", "block_a = 'base'\nblock_b = 'block'\n"}) {
    const Scene scene = read_text(block_on_base + contact + names);
    REQUIRE(scene.measured_contacts.size() == 1);
    CHECK(scene.measured_contacts[0].name == "foot");
    CHECK(scene.measured_contacts[0].block_a == 0);
    CHECK(scene.measured_contacts[0].block_b == 1);
    CHECK(scene.measured_contacts[0].point == Vec2(0.5, 0.0));
  }
  CHECK(read_text(block_on_base + contact + "block_a = 'block'\nblock_b = 'base'\n").measured_contacts[0].block_a == 1);
}

TEST_CASE("a surcharge lies on one edge of its block, which its points find; its ends are put in the order of the outline", "[scene][reader]") {
  const std::string ends = GENERATE(as<std::string>{}, "from_m = [0.75, 1]\nto_m = [0.25, 1]\n", "from_m = [0.25, 1]\nto_m = [0.75, 1]\n");
  const std::string name = GENERATE(as<std::string>{}, "", "block = 'block'\n");
  const Scene scene = read_text(block_on_base + "[[surcharge]]\n" + name + ends + "pressure_pa = 2e3\nshear_pa = -500\n");
  const Surcharge& surcharge = scene.surcharges.at(0);
  CHECK(surcharge.block == 1);
  // The top of a block is passed from right to left.
  CHECK(surcharge.from == Vec2(0.75, 1.0));
  CHECK(surcharge.to == Vec2(0.25, 1.0));
  CHECK(surcharge.pressure == 2e3);
  CHECK(surcharge.shear == -500.0);
  // Down onto the block, and to the right against the outline.
  CHECK((surcharge.resultant(surcharge.to - surcharge.from) - Vec2(250.0, -1000.0)).norm() <= 1e-12);
}

TEST_CASE("a surcharge on several edges in one line is one on each of them, whichever way it is written", "[scene][reader]") {
  const std::string ends = GENERATE(as<std::string>{}, "from_m = [0.25, 1]\nto_m = [2.5, 1]\n", "from_m = [2.5, 1]\nto_m = [0.25, 1]\n");
  const std::string next = "[[block]]\nname = 'next'\nmaterial = 'rock'\nvertices_m = [[1, 0], [2, 0], [2, 1], [1, 1]]\n";
  const std::string last = "[[block]]\nname = 'last'\nmaterial = 'rock'\nvertices_m = [[2, 0], [3, 0], [3, 1], [2, 1]]\n";
  const Scene scene = read_text(block_on_base + last + next + "[[surcharge]]\nname = 'stock'\n" + ends + "pressure_pa = 2e3\nshear_pa = -500\n");
  REQUIRE(scene.surcharges.size() == 3);
  Vec2 sum = Vec2::Zero();
  for (const Surcharge& part : scene.surcharges) {
    CHECK(part.name == "stock");
    sum += part.resultant(part.to - part.from);
    // The top of a block is passed from right to left.
    CHECK(part.from.x() > part.to.x());
    if (scene.blocks[part.block].name == "next") CHECK((part.from - Vec2(2.0, 1.0)).norm() + (part.to - Vec2(1.0, 1.0)).norm() <= 1e-12);
    if (scene.blocks[part.block].name == "block") CHECK(part.to == Vec2(0.25, 1.0));
    if (scene.blocks[part.block].name == "last") CHECK(part.from == Vec2(2.5, 1.0));
  }
  CHECK((sum - 2.25 * Vec2(500.0, -2000.0)).norm() <= 1e-9);
}

TEST_CASE("a short surcharge whose ends are rounded lies on a long edge", "[scene][reader]") {
  const std::string slab = "[[block]]\nname = 'slab'\nmaterial = 'rock'\nvertices_m = [[0, 1], [100, 31], [100, 32], [0, 2]]\n";
  // Half a millionth of a metre off, to either side.
  const std::string ends = "from_m = [50, 17.0000005]\nto_m = [51, 17.2999995]\n";
  const Scene scene = read_text(block_on_base + slab + "[[surcharge]]\npressure_pa = 1\n" + ends);
  REQUIRE(scene.surcharges.size() == 1);
  CHECK(scene.blocks[scene.surcharges[0].block].name == "slab");
}

TEST_CASE("edges of a block name their joints, however its vertices are written", "[scene][reader]") {
  const std::string joint = "[[joint]]\nname = 'bedding'\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 4e8\nfriction_angle_deg = 20\n";
  const auto block = [&](const std::string& vertices, const std::string& joints) {
    return block_on_base + joint + "[[block]]\nname = 'c'\nmaterial = 'rock'\nvertices_m = " + vertices + "\nedge_joints = " + joints + "\n";
  };
  constexpr int none = BlockInput::by_materials;
  const auto joints_of = [&](const std::string& text) { return read_text(text).blocks.back().edge_joints; };
  const int bedding = static_cast<int>(read_text(block("[[50, 0], [52, 0], [50, 1]]", "['', 'bedding', '']")).joints.size()) - 1;
  CHECK(joints_of(block("[[50, 0], [52, 0], [50, 1]]", "['bedding', '', '']")) == std::vector<int>{bedding, none, none});
  // Clockwise: the outline is turned about its first vertex.
  const Scene turned = read_text(block("[[50, 0], [50, 1], [52, 0]]", "['', '', 'bedding']"));
  CHECK(turned.blocks.back().vertices[1].isApprox(Vec2(52.0, 0.0)));
  CHECK(turned.blocks.back().edge_joints == std::vector<int>{bedding, none, none});
  // A vertex on a straight line is dropped, unless the joint changes there: on a repeated vertex the edge without a length says nothing.
  CHECK(joints_of(block("[[50, 0], [51, 0], [52, 0], [50, 1]]", "['bedding', 'bedding', '', '']")) == std::vector<int>{bedding, none, none});
  CHECK(joints_of(block("[[50, 0], [52, 0], [50, 1]]", "['', '', '']")).empty());
  for (const char* split : {"[[50, 0], [51, 0], [51.5, 0], [52, 0], [50, 1]]", "[[50, 0], [50, 1], [52, 0], [51.5, 0], [51, 0]]"}) {
    const bool is_clockwise = split[12] == '0';
    const Scene scene = read_text(block(split, is_clockwise ? "['', '', '', '', 'bedding']" : "['bedding', '', '', '', '']"));
    const BlockInput& c = scene.blocks.back();
    REQUIRE(c.vertices.size() == 4);
    CHECK(c.vertices[1] == Vec2(51.0, 0.0));
    CHECK(c.vertices[2] == Vec2(52.0, 0.0));
    CHECK(c.edge_joints == std::vector<int>{bedding, none, none, none});
  }
  const Scene repeated = read_text(block("[[50, 0], [50, 0], [52, 0], [50, 1]]", "['', 'bedding', '', '']"));
  CHECK(repeated.blocks.back().edge_joints == std::vector<int>{bedding, none, none});
}

TEST_CASE("a slip-weakening distance goes with what slip weakens, none goes with all joints", "[scene][reader]") {
  CHECK(read_text(block_on_base).joints[0].slip_weakening_distance == 0.0);
  for (const std::string weak : {"residual_friction_angle_deg = 20", "cohesion_pa = 1e3\ncohesion_behaviour = 'lost_on_slip'"}) {
    const JointProperties joint = read_text(with_line(block_on_base, 10, "slip_weakening_distance_m = 0.01\n" + weak)).joints[0];
    CHECK(joint.weakens_by_slip());
    CHECK(joint.slip_weakening_distance == 0.01);
  }
  CHECK_FALSE(read_text(with_line(block_on_base, 10, "slip_weakening_distance_m = 0")).joints[0].weakens_by_slip());
}

TEST_CASE("the residual friction angle is the friction angle unless it is given", "[scene][reader]") {
  CHECK_FALSE(read_text(block_on_base).joints[0].residual_friction_angle);
  const JointProperties joint = read_text(with_line(block_on_base, 10, "residual_friction_angle_deg = 30")).joints[0];
  CHECK(joint.residual_friction_angle.value() == Approx(std::numbers::pi / 6.0).epsilon(1e-15));
  CHECK(joint.softens());
  // As high as the friction angle it is accepted and changes nothing.
  CHECK_FALSE(read_text(with_line(block_on_base, 10, "residual_friction_angle_deg = 35")).joints[0].softens());
}
