#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "openclose/analysis/settle.h"
#include "openclose/analysis/simulation.h"
#include "openclose/integrator/newton.h"
#include "openclose/integrator/registry.h"
#include "openclose/scene/reader.h"
#include "support/catch.h"
#include "support/equations.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

constexpr double small_move = 1e-7;  // [m] far less than any penetration of a settled scene, so that no contact changes its state
constexpr double large_move = 1e-5;  // [m] where no contact is closed: supports feel the rounding of whole coordinates, 1e-15 m
constexpr double accuracy = 1e-8;    // [-] rounding of forces 1e-16 * 1e5 N / 1e-7 m over 1e9 N/m, and the square of a move: both below 1e-9

/// A settled scene: blocks that all rest on each other, held and loaded off their centres.
Scene settled_scene(int blocks) {
  Scene scene = test::column_of_blocks(blocks);
  scene.gravity = {1.0, -9.81};
  const Vec2 corner = scene.blocks[1].vertices[3];
  scene.supports = {{1, corner, {3e7, 5e7}}};
  scene.loads = {{blocks, scene.blocks[blocks].vertices[2], {-2000.0, -5000.0}}};
  return scene;
}

/// A step from the settled state. Contacts slide where `slides` says so: the law then does not ask how far.
struct Probe {
  explicit Probe(const Scene& scene) : simulation(scene) {
    REQUIRE(settle(simulation).settled);
    const StepProblem problem = simulation.problem(1.0, false);
    for (const Contact& c : problem.contacts) springs.push_back(simulation.enforcement().springs(problem, c));
  }

  int closed_contacts() const {
    return static_cast<int>(std::count_if(springs.begin(), springs.end(), [](const ContactSprings& s) { return s.gap < -10.0 * small_move; }));
  }

  /// Every other contact, beginning with `first`, is pushed beyond its strength, in turn one way and the other; the rest sticks.
  void mobilise(int first) {
    double sign = 1.0;
    for (std::size_t c = 0; c < springs.size(); ++c) {
      const bool slides = static_cast<int>(c) % 2 == first;
      const double normal = std::max(0.0, -springs[c].normal * springs[c].gap);
      springs[c].initial_shear = sign * (slides ? 2.0 : 0.2) * normal * std::tan(simulation.scene().joints[0].friction_angle);
      if (slides) sign = -sign;
    }
  }

  /// Forces after the blocks have moved by d.
  Eigen::VectorXd forces(const Eigen::VectorXd& d) {
    const StepProblem here = simulation.problem(1.0, false);
    const auto of = [&](int b) -> Eigen::Vector3d {
      const int i = here.system.block(b).equation;
      return i < 0 ? Eigen::Vector3d::Zero().eval() : d.segment<3>(3 * i).eval();
    };
    std::vector<ContactSprings> moved_springs = springs;
    for (std::size_t c = 0; c < springs.size(); ++c) {
      const Contact& contact = here.contacts[c];
      const ContactKinematics k(here.system, contact, of(contact.vertex_block), of(contact.edge_block));
      moved_springs[c].gap += k.gap_change;
      moved_springs[c].initial_shear -= springs[c].shear * k.slip_change;
    }
    BlockSystem moved = here.system;
    for (int b : moved.free_blocks()) moved.advance(b, of(b));
    const StepProblem there{moved, here.external, here.joints, here.contacts, here.method, here.dt, here.statics, here.inertia, here.end_weight};
    return test::forces_of(there, moved_springs);
  }

  Eigen::MatrixXd stiffness() { return test::stiffness_of(simulation.problem(1.0, false), springs); }

  Simulation simulation;
  std::vector<ContactSprings> springs;
  Newton newton;
};

Eigen::VectorXd random_displacement(Eigen::Index size, double largest, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-largest, largest);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return number(random); });
}

/// Largest deviation of the stiffness from difference quotients of the forces, over its largest effect, in some random directions that leave the
/// unknowns in `still` alone.
double deviation(Probe& probe, double largest_move = small_move, const std::vector<int>& still = {}) {
  std::mt19937 random(11);
  const Eigen::MatrixXd k = probe.stiffness();
  double worst = 0.0;
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd d = random_displacement(k.rows(), largest_move, random);
    for (int u : still) d[u] = 0.0;
    Eigen::VectorXd difference = 0.5 * (probe.forces(d) - probe.forces(-d)) + k * d;
    for (int u : still) difference[u] = 0.0;
    worst = std::max(worst, difference.norm() / (k * d).norm());
  }
  return worst;
}

/// As Newton's method leaves the first step of a motion, from its drift.
StepSolution first_step(const Scene& scene, bool has_another_way = false) {
  Simulation simulation(scene);
  const StepProblem problem = simulation.problem(scene.step.dt, false);
  std::vector<ContactSprings> springs;
  for (const Contact& c : problem.contacts) springs.push_back(simulation.enforcement().springs(problem, c));
  StepSolution solution;
  solution.d = drift(problem);
  Newton newton;
  newton.set_another_way(has_another_way);
  newton.solve(problem, springs, solution);
  return solution;
}

}  // namespace

TEST_CASE("what a step reduces is in motion the root of the work of all residuals, in statics their norm", "[integrator][newton]") {
  Probe probe(settled_scene(4));
  std::mt19937 random(5);
  for (const bool statics : {false, true}) {
    const StepProblem problem = probe.simulation.problem(0.01, statics);
    ContactTrial contacts;
    StepEquations equations;
    equations.prepare(problem, springs_in(probe.springs), contacts);
    equations.evaluate(random_displacement(dofs * equations.rows(), small_move, random));
    double work = 0.0;  // [J]
    for (int row = 0; row < equations.rows(); ++row) {
      const auto residual = equations.residual().segment<dofs>(dofs * row);
      for (int u = 0; u < dofs; ++u) work += residual[u] * residual[u] / equations.blocks()[row].inertia[u];
    }
    const double norm = equations.residual_norm();
    REQUIRE(std::isfinite(norm));
    REQUIRE(norm > 1.0);  // not in balance
    CHECK(equations.merit(norm) == Approx(statics ? norm : std::sqrt(work)));
  }
}

TEST_CASE("Newton's stiffness is minus the derivative of its forces", "[integrator][newton]") {
  const int blocks = GENERATE(1, 2, 3, 4, 5);
  Probe probe(settled_scene(blocks));
  REQUIRE(probe.closed_contacts() >= 2 * blocks);
  SECTION("all sticking") {
    for (ContactSprings& s : probe.springs) s.initial_shear = 0.0;
    CHECK(deviation(probe) < accuracy);
    const Eigen::MatrixXd k = probe.stiffness();
    CHECK((k - k.transpose()).norm() < accuracy * k.norm());
  }
  SECTION("sticking and sliding by turns") {
    probe.mobilise(GENERATE(0, 1));
    CHECK(deviation(probe) < accuracy);
    const Eigen::MatrixXd k = probe.stiffness();
    CHECK((k - k.transpose()).norm() > 1e-3 * k.norm());
  }
  SECTION("supports and loads alone, no contact closed") {
    for (ContactSprings& s : probe.springs) s.gap = 1.0;
    CHECK(deviation(probe, large_move) < accuracy);
  }
}

TEST_CASE("Newton's stiffness after large rotations", "[integrator][newton]") {
  Scene scene = test::tumbling_blocks();
  scene.supports = {{1, scene.blocks[1].vertices[0], {3e7, 5e7}}};
  scene.loads = {{2, scene.blocks[2].vertices[2], {-2000.0, -5000.0}}};
  scene.settle.failure_displacement = 100.0;
  Probe probe(scene);
  REQUIRE(std::abs(probe.simulation.system().displacement(2)[2]) > 0.1);
  probe.mobilise(GENERATE(0, 1));
  CHECK(deviation(probe) < accuracy);
}

TEST_CASE("a locked rotation takes no part in the stiffness", "[integrator][newton]") {
  Scene scene = settled_scene(3);
  scene.blocks[2].rotation_locked = true;
  Probe probe(scene);
  probe.mobilise(0);
  const int locked = 3 * 1 + 2;
  CHECK(deviation(probe, small_move, {locked}) < accuracy);
  const Eigen::MatrixXd k = probe.stiffness();
  for (int i = 0; i < k.rows(); ++i) {
    if (i == locked) continue;
    CHECK(k(i, locked) == 0.0);
    CHECK(k(locked, i) == 0.0);
  }
}

TEST_CASE("the forces of a settled scene are in balance", "[integrator][newton]") {
  Probe probe(settled_scene(GENERATE(1, 3, 5)));
  const double weight = test::block_weight;
  CHECK(probe.forces(Eigen::VectorXd::Zero(3 * probe.simulation.system().free_count())).cwiseAbs().maxCoeff() < 1e-7 * weight);
  // Without its contacts the sum of the forces is weight, load and support.
  for (ContactSprings& s : probe.springs) s.gap = 1.0;
  const Eigen::VectorXd f = probe.forces(Eigen::VectorXd::Zero(3 * probe.simulation.system().free_count()));
  CHECK(f.cwiseAbs().maxCoeff() > 0.5 * weight);
}

TEST_CASE("solving a step again with springs that start differently is solving it anew with these", "[integrator][newton]") {
  Probe probe(settled_scene(3));
  const StepProblem problem = probe.simulation.problem(0.01, GENERATE(false, true));
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(3 * problem.system.free_count());
  for (ContactSprings& s : probe.springs) s.normal_damping = 0.01 * s.normal;
  const FirstTangent first_tangent = GENERATE(FirstTangent::present, FirstTangent::last_solution);
  const std::vector<ContactSprings> first = probe.springs;
  probe.mobilise(0);
  for (ContactSprings& s : probe.springs) {
    s.target = 0.5 * s.gap;
    s.shift = -2.0 * s.normal * s.gap;
  }
  const auto solved = [&](bool again) {
    Newton newton;
    StepSolution solution;
    solution.d = start;
    newton.solve(problem, first, solution);
    REQUIRE(solution.converged);
    solution.d = start;
    if (again) {
      newton.solve_again(probe.springs, solution, first_tangent);
    } else {
      newton.solve(problem, probe.springs, solution, first_tangent);
    }
    REQUIRE(solution.converged);
    return std::pair(solution.d, newton.equations().force_scale());
  };
  const auto [again, again_scale] = solved(true);
  const auto [anew, anew_scale] = solved(false);
  CHECK(again == anew);
  CHECK(again_scale == anew_scale);
  CHECK(anew.norm() > 1e-7);
}

TEST_CASE("a step whose matrix was singular is solved again with springs that hold", "[integrator][newton]") {
  Probe probe(test::column_of_blocks(3));
  const StepProblem present = probe.simulation.problem(1.0, true);
  const StepProblem problem{present.system, present.external, present.joints, present.contacts, present.method, present.dt, true, 0.0};
  std::vector<ContactSprings> open = probe.springs;
  for (ContactSprings& s : open) s.target = s.gap - 1.0;
  StepSolution solution;
  solution.d = Eigen::VectorXd::Zero(3 * problem.system.free_count());
  probe.newton.solve(problem, open, solution, FirstTangent::present);
  REQUIRE_FALSE(solution.converged);
  REQUIRE(solution.reason == "singular matrix");
  solution.d.setZero();
  probe.newton.solve_again(probe.springs, solution, FirstTangent::present);
  CHECK(solution.converged);
  CHECK(solution.contacts.size() == probe.springs.size());
}

TEST_CASE("a bond that broke in a relaxed step that is not taken holds in the next one", "[integrator][newton]") {
  const auto scene_with_gravity = [](double gravity) {
    // Beyond friction, 7.3 kPa pull the block down a slope of 45 degrees with 9.81 m/s2.
    Scene scene = test::block_on_incline(45.0 * test::degree);
    scene.joints[0].cohesion = 5e3;
    scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
    scene.gravity = {0.0, -gravity};
    scene.method.static_solver = StaticSolver::relaxation;
    return scene;
  };
  Simulation heavy(scene_with_gravity(9.81)), light(scene_with_gravity(2.0));
  const auto soft = make_soft();
  const auto statuses = [&](Simulation& simulation) {
    StepSolution solution;
    soft->solve(simulation.problem(0.1, true), solution);
    REQUIRE(solution.converged);
    std::vector<ContactStatus> list;
    for (std::size_t c = 0; c < solution.contacts.size(); ++c) list.push_back(solution.contacts.status(c));
    return list;
  };
  const std::vector<ContactStatus> both_slide(2, ContactStatus::sliding), both_stick(2, ContactStatus::sticking);
  CHECK(statuses(heavy) == both_slide);
  CHECK(statuses(light) == both_stick);
}

TEST_CASE("a solution that is kept stays as it was while another one is found", "[integrator][newton]") {
  Probe probe(test::column_of_blocks(3));
  const StepProblem problem = probe.simulation.problem(0.01, false);
  StepSolution solution;
  solution.d = Eigen::VectorXd::Zero(3 * problem.system.free_count());
  probe.newton.solve(problem, probe.springs, solution, FirstTangent::present);
  REQUIRE(solution.converged);
  const StepSolution kept = solution;
  std::vector<ContactSprings> stiffer = probe.springs;
  for (ContactSprings& s : stiffer) s.normal *= 2.0;
  probe.newton.solve_again(stiffer, solution, FirstTangent::present);
  REQUIRE(solution.converged);
  for (std::size_t c = 0; c < probe.springs.size(); ++c) {
    CHECK(kept.contacts.normal_stiffness(c) == probe.springs[c].normal);
    CHECK(solution.contacts.normal_stiffness(c) == stiffer[c].normal);
  }
}

TEST_CASE("a displacement that has run away is no solution, however much its rounding excuses", "[integrator][newton]") {
  Probe probe(test::column_of_blocks(3));
  StepProblem problem = probe.simulation.problem(1e6, true);  // so long that inertia is below the rounding of the springs
  StepSolution solution;
  solution.d = Eigen::VectorXd::Zero(3 * problem.system.free_count());
  for (int b : problem.system.free_blocks()) solution.d[3 * problem.system.block(b).equation] = 1e30;
  probe.newton.solve(problem, probe.springs, solution, FirstTangent::present);
  CHECK((!solution.converged || solution.d.cwiseAbs().maxCoeff() < 1.0));
}

TEST_CASE("a solution carries the forces of the law, also where its last iteration has reversed the slip", "[integrator][newton]") {
  Scene scene = test::column_of_blocks(1);
  constexpr double friction = 0.01;
  scene.joints[0].friction_angle = std::atan(friction);
  scene.blocks[1].rotation_locked = true;
  Probe probe(scene);
  // Friction B slows the block from one side and then from the other: residuals 3 B and 2 B, of which the second is tolerated.
  MethodInput method = scene.method;
  method.residual_tolerance = 2.5 * friction;
  const StepProblem present = probe.simulation.problem(0.01, false);
  const StepProblem problem{present.system, present.external, present.joints, present.contacts, method, present.dt, false, present.inertia};
  const int block = present.system.free_blocks().front();
  const double inertia = problem.inertia * problem.system.block(block).mass[0];
  StepSolution solution;
  solution.d = -2.0 * friction * test::block_weight / inertia * Eigen::Vector3d::UnitX();
  probe.newton.solve(problem, probe.springs, solution, FirstTangent::present);
  REQUIRE(solution.converged);
  REQUIRE(solution.effort.iterations == 1);
  for (std::size_t c = 0; c < probe.springs.size(); ++c) {
    const ContactOutcome& o = solution.contacts[c];
    const ContactStrength strength(problem.joints.joint(problem.contacts[c].joint), problem.contacts[c]);
    const ContactForces law = spring_slider(probe.springs[c], strength, o.pose.gap_change, o.pose.slip_change);
    CHECK(law.status == ContactStatus::sliding);
    CHECK(o.forces.status == law.status);
    CHECK(o.forces.shear == law.shear);
    CHECK(o.forces.elastic_shear == law.elastic_shear);
    CHECK(o.forces.elastic_normal == law.elastic_normal);
  }
}

TEST_CASE("contacts that another pass holds where they were begin it in the state they had", "[integrator][newton]") {
  Scene scene = test::column_of_blocks(4);
  scene.gravity = {1.0, -9.81};
  scene.joints[0].friction_angle = std::atan(0.25);  // enough for all contacts, but not for twice the shear force
  Probe probe(scene);
  const StepProblem problem = probe.simulation.problem(1.0, false);
  for (ContactSprings& s : probe.springs) s.initial_shear = 0.0;
  StepSolution first;
  first.d = drift(problem);
  probe.newton.solve(problem, probe.springs, first);
  REQUIRE(first.converged);
  // Multipliers: what they carry, and back to where they were. Where they are now they seem to carry the shear force twice.
  for (std::size_t c = 0; c < probe.springs.size(); ++c) {
    REQUIRE(first.contacts.status(c) == ContactStatus::sticking);
    probe.springs[c].target = probe.springs[c].gap;
    probe.springs[c].shift = first.contacts[c].forces.normal;
    probe.springs[c].initial_shear = first.contacts[c].forces.shear;
  }
  const auto solves = [&](FirstTangent tangent) {
    StepSolution solution = first;
    solution.effort.iterations = 0;
    probe.newton.solve(problem, probe.springs, solution, tangent);
    REQUIRE(solution.converged);
    return solution.effort.iterations;
  };
  CHECK(solves(FirstTangent::last_solution) <= 2);  // the second for the turning of the blocks
  CHECK(solves(FirstTangent::present) > solves(FirstTangent::last_solution));
}

TEST_CASE("Newton ends where it is lost among the contact states, and goes on for as long as it gets on", "[integrator][newton][hard]") {
  // A slope of 978 blocks, too weak to stand, that gravity meets at once.
  Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4_post_failure.toml",
                           {"joint_set[0].spacing_m=27.2", "joint_set[1].spacing_m=6.8", "joint[0].cohesion_pa=47e3", "method.contact=\"hard\""});
  scene.method.residual_tolerance = 1e-6;
  scene.method.max_iterations = 1000;
  int longest = 0;
  for (const double friction_angle : {20.0, 21.0, 22.0, 23.0, 24.0, 25.0}) {
    scene.joints[0].friction_angle = friction_angle * test::degree;
    const StepSolution solution = first_step(scene);
    // From all blocks out of balance by the largest force to one that is so by what is tolerated.
    const double halvings = std::log2(std::sqrt(solution.d.size() / 3) / scene.method.residual_tolerance);
    INFO(friction_angle << " degrees: " << solution.effort.iterations << " iterations");
    CHECK(solution.effort.iterations <= halvings * most_iterations_to_halve);
    longest = std::max(longest, solution.effort.iterations);
  }
  CHECK(longest > 2 * most_iterations_to_halve);  // some has halved its residuals after a while, and then gone on
}

TEST_CASE("Newton with parts ends soon where a few contacts keep it from balance", "[integrator][newton]") {
  // The same slope with springs, of contacts that were bonded when gravity came.
  Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4_post_failure.toml",
                           {"joint_set[0].spacing_m=27.2", "joint_set[1].spacing_m=6.8", "method.contact=\"soft\""});
  scene.method.max_iterations = 1000;
  bool some_is_lost = false, some_is_found = false;
  for (const double cohesion : {20e3, 30e3, 40e3, 50e3, 60e3, 70e3}) {
    scene.joints[0].cohesion = cohesion;
    const StepSolution solution = first_step(scene);
    // From all blocks out of balance by the largest force to one that is so by what is tolerated.
    const double halvings = std::log2(std::sqrt(solution.d.size() / 3) / scene.method.residual_tolerance);
    INFO(cohesion << " Pa: " << solution.effort.iterations << " iterations");
    CHECK(solution.effort.iterations <= halvings * most_iterations_to_halve);
    (solution.converged ? some_is_found : some_is_lost) = true;
  }
  CHECK(some_is_found);
  CHECK(some_is_lost);
}

TEST_CASE("Newton gives up sooner where there is another way", "[integrator][newton]") {
  Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4_post_failure.toml",
                           {"joint_set[0].spacing_m=27.2", "joint_set[1].spacing_m=6.8", "method.contact=\"soft\""});
  scene.method.max_iterations = 1000;
  int lost = 0, lost_beside_another_way = 0;
  for (const double cohesion : {20e3, 30e3, 40e3, 50e3, 60e3, 70e3}) {
    scene.joints[0].cohesion = cohesion;
    const StepSolution usual = first_step(scene), sooner = first_step(scene, true);
    const double halvings = std::log2(std::sqrt(sooner.d.size() / 3) / scene.method.residual_tolerance);
    INFO(cohesion << " Pa: " << sooner.effort.iterations << " iterations");
    CHECK(sooner.effort.iterations <= halvings * most_iterations_to_halve_beside_another_way);
    if (sooner.converged) CHECK(sooner.d == usual.d);
    if (usual.converged) continue;
    lost += usual.effort.iterations;
    lost_beside_another_way += sooner.effort.iterations;
  }
  CHECK(lost_beside_another_way > 0);
  CHECK(lost_beside_another_way < lost);
}

TEST_CASE("Newton counts its linear solves and says why it gives up", "[integrator][newton]") {
  Scene scene = settled_scene(3);
  scene.method.max_iterations = 1;
  Simulation simulation(scene);
  const StepResult result = simulation.step(1.0, true);
  CHECK_FALSE(result.accepted);
  CHECK(result.reason == "Newton's method did not converge");
  CHECK(simulation.state().counters.iterations == 1);
  CHECK(simulation.state().counters.steps == 0);
  CHECK(simulation.state().counters.cuts == 1);
}
