#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "openclose/analysis/settle.h"
#include "openclose/analysis/simulation.h"
#include "openclose/integrator/integrators.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;

namespace {

using Scheme = TimeScheme;
using Unknowns = Scheme::Unknowns;

MethodInput method(const std::string& integrator) {
  MethodInput input;
  input.contact_where = {"scene.toml", 7};
  input.integrator = integrator;
  return input;
}

std::unique_ptr<Scheme> make(const std::string& integrator) {
  return make_integrator(method(integrator));
}

/// Steps x'' = force(x) of unit mass; averaging over the path is done by the caller's force, which gets both ends.
class Oscillator {
 public:
  Oscillator(std::unique_ptr<Scheme> scheme, double frequency) : scheme_(std::move(scheme)), square_(frequency * frequency) {
    if (scheme_->wants_accelerations()) scheme_->start(0, Unknowns(-square_ * x, 0.0, 0.0));
  }

  void step(double dt) {
    do {
      stage(scheme_->stage(dt));
    } while (scheme_->is_within_step());
  }

  double x = 1.0, v = 0.0;
  double energy() const { return 0.5 * (v * v + square_ * x * x); }
  double work = 0.0;  ///< of the forces and of the scheme's own on the work displacement

 private:
  void stage(double h) {
    const Unknowns v0(v, 0.0, 0.0);
    const double inertia = scheme_->inertia(h), theta = scheme_->averages_path() ? 0.5 : scheme_->end_weight();
    // inertia (drift - d) - theta w^2 (x + d) - (1 - theta) w^2 x = 0
    const double d = (inertia * scheme_->drift(0, h, v0)[0] - square_ * x) / (inertia + theta * square_);
    const Unknowns move(d, 0.0, 0.0);
    const double force = -square_ * (x + theta * d);
    work += force * scheme_->work_displacement(0, h, move, v0)[0] + scheme_->own_work(0, h, move, v0, Unknowns::Ones());
    v = scheme_->next_velocity(0, h, move, v0)[0];
    x += d;
    scheme_->record(0, h, move, v0);
    scheme_->accept(h);
  }

  std::unique_ptr<Scheme> scheme_;
  double square_;
};

double error_after(const std::string& integrator, int steps) {
  Oscillator o(make(integrator), 3.0);
  for (int i = 0; i < steps; ++i) o.step(1.0 / steps);
  return std::abs(o.x - std::cos(3.0));
}

/// Three blocks that hit each other and a base, one held by a support, one pushed, one not turning.
Scene collisions(const std::string& integrator) {
  Scene scene = test::empty_scene();
  scene.method.integrator = integrator;
  scene.joints[0].normal_stiffness = 2e7;
  scene.joints[0].shear_stiffness = 1e7;
  scene.blocks = {test::fixed_block("base", test::rectangle(-5.0, -1.0, 12.0, 1.0)), test::free_block("a", test::rectangle(0.0, 0.05, 2.0, 1.0)),
                  test::free_block("b", test::rectangle(0.3, 1.1, 1.0, 1.0)), test::free_block("c", test::rectangle(2.1, 0.1, 1.0, 2.0))};
  scene.blocks[1].velocity = {0.5, 0.0};
  scene.blocks[2].angular_velocity = 0.3;
  scene.blocks[3].velocity = {-0.5, 0.0};
  scene.blocks[3].rotation_locked = true;
  scene.supports = {{1, {0.0, 0.5}, {1e6, 0.0}}};
  scene.loads = {{2, {0.5, 1.5}, {2e3, -1e3}}};
  return scene;
}

}  // namespace

TEST_CASE("every listed integrator can be made by its name", "[integrator][integrators]") {
  std::vector<std::string> names;
  for (const auto& entry : integrators()) {
    names.emplace_back(entry.name);
    CHECK_FALSE(std::string(entry.summary).empty());
    CHECK(make(entry.name) != nullptr);
  }
  for (const char* name : {"shi", "theta", "generalized_alpha", "tr_bdf2", "path_average", default_integrator}) {
    CHECK(std::count(names.begin(), names.end(), name) == 1);
  }
}

TEST_CASE("without method.integrator theta says which it is", "[integrator][integrators]") {
  MethodInput input;
  CHECK(integrator_name(input) == default_integrator);
  input.theta = 1.0;
  CHECK(integrator_name(input) == "theta");
}

TEST_CASE("unknown integrators and parameters of another one are refused", "[integrator][integrators]") {
  CHECK_THROWS_WITH(make("newmark"), ContainsSubstring("scene.toml:7: method.integrator: \"newmark\"") && ContainsSubstring("\"path_average\""));
  MethodInput input = method("tr_bdf2");
  input.theta = 0.5;
  CHECK_THROWS_WITH(make_integrator(input), ContainsSubstring("method.theta") && ContainsSubstring("tr_bdf2"));
  input = method("shi");
  input.rho_inf = 0.5;
  CHECK_THROWS_WITH(make_integrator(input), ContainsSubstring("method.rho_inf"));
  input = method("shi");
  input.dissipation = 0.01;
  CHECK_THROWS_WITH(make_integrator(input), ContainsSubstring("method.dissipation"));
  input = method("path_average");
  input.rotation = RotationKind::linear;
  CHECK_THROWS_WITH(make_integrator(input), ContainsSubstring("method.rotation"));
}

TEST_CASE("the first integrator has none of the parameters of the other one, and is refused if it is unknown", "[integrator][integrators]") {
  MethodInput input = method("theta");
  input.theta = 0.5;
  input.first_integrator = "shi";
  CHECK(make_integrator(input)->end_weight() == 0.5);
  CHECK(make_integrator(method_at_first(input))->end_weight() == 1.0);
  input.first_integrator = "path_average";
  CHECK_FALSE(make_integrator(input)->averages_path());
  CHECK(make_integrator(method_at_first(input))->averages_path());
  input.first_integrator = "newmark";
  CHECK_THROWS_WITH(make_integrator(input),
                    ContainsSubstring("scene.toml:7: method.first_integrator: \"newmark\"") && ContainsSubstring("\"path_average\""));
  input.first_integrator = "path_average";
  input.rotation = RotationKind::linear;
  CHECK_THROWS_WITH(make_integrator(input), ContainsSubstring("method.rotation"));
}

TEST_CASE("integrators: observed order on an oscillator", "[integrator][integrators]") {
  for (const auto& [name, order] :
       std::vector<std::pair<std::string, double>>{{"shi", 1.0}, {"generalized_alpha", 2.0}, {"tr_bdf2", 2.0}, {"path_average", 2.0}}) {
    CAPTURE(name);
    CHECK(std::log2(error_after(name, 200) / error_after(name, 400)) == Approx(order).margin(0.05));
  }
}

TEST_CASE("integrators: the change of kinetic energy is the work of the forces and the scheme's own", "[integrator][integrators]") {
  for (const auto& entry : integrators()) {
    CAPTURE(entry.name);
    Oscillator o(make(entry.name), 3.0);
    for (const double dt : {0.1, 0.2, 0.05, 0.4, 0.1}) {
      const double before = o.v * o.v / 2, done = o.work;
      o.step(dt);
      CHECK(std::abs(o.v * o.v / 2 - before - (o.work - done)) < 1e-13);
    }
  }
}

TEST_CASE("integrators: what infinitely fast vibrations do", "[integrator][integrators]") {
  const auto energy_left = [](const std::string& name) {
    Oscillator o(make(name), 1e6);
    const double before = o.energy();
    for (int i = 0; i < 10; ++i) o.step(1.0);
    return o.energy() / before;
  };
  CHECK(energy_left("tr_bdf2") < 1e-20);
  CHECK(energy_left("path_average") == Approx(1.0).epsilon(1e-6));
  MethodInput input = method("generalized_alpha");
  for (const double rho : {0.3, 0.5, 0.8}) {
    input.rho_inf = rho;
    Oscillator o(make_integrator(input), 1e6);
    constexpr int n = 200;
    for (int i = 0; i < n; ++i) o.step(1.0);
    const double before = std::abs(o.x);
    o.step(1.0);
    // A double eigenvalue of modulus rho: x_n = (a + b n) rho^n.
    CHECK(std::abs(o.x) / before == Approx(rho).epsilon(3.0 / n));
  }
}

TEST_CASE("integrators: energy ledger of collisions", "[integrator][integrators]") {
  for (const auto& entry : integrators()) {
    for (const double damping_ratio : {0.0, 0.2}) {
      CAPTURE(entry.name, damping_ratio);
      Scene scene = collisions(entry.name);
      scene.joints[0].damping_ratio = damping_ratio;
      Simulation simulation(scene);
      for (int i = 0; i < 400; ++i) REQUIRE(simulation.advance(1e-3));
      const EnergyLedger& l = simulation.ledger();
      CHECK(l.friction > 1e-3 * l.turnover);
      CHECK(std::abs(l.imbalance()) < 1e-11 * l.turnover);
      CHECK((l.contact_damping > 0.0) == (damping_ratio > 0.0));
      CHECK(simulation.velocity(3)[2] == 0.0);
      // Rotations of a step are of 1e-3 rad; to third order their work is lost in rounding.
      if (std::string(entry.name) == "path_average") CHECK(std::abs(l.scheme) < 1e-7 * l.turnover);
    }
  }
}

TEST_CASE("integrators: brittle joints, tension and cohesion keep the ledger closed", "[integrator][integrators]") {
  for (const auto behaviour : {CohesionBehaviour::ductile, CohesionBehaviour::lost_on_opening, CohesionBehaviour::lost_on_slip}) {
    for (const auto& entry : integrators()) {
      CAPTURE(entry.name, static_cast<int>(behaviour));
      Scene scene = collisions(entry.name);
      scene.joints[0].cohesion = 2e4;
      scene.joints[0].tensile_strength = 1e4;
      scene.joints[0].cohesion_behaviour = behaviour;
      scene.blocks[1].vertices = test::rectangle(0.0, 0.0, 2.0, 1.0);
      scene.blocks[2].vertices = test::rectangle(0.3, 1.0, 1.0, 1.0);
      scene.blocks[2].velocity = {0.4, 0.6};
      Simulation simulation(scene);
      for (int i = 0; i < 300; ++i) REQUIRE(simulation.advance(1e-3));
      const EnergyLedger& l = simulation.ledger();
      CHECK(l.friction > 0.0);
      CHECK(std::abs(l.imbalance()) < 1e-11 * l.turnover);
    }
  }
}

TEST_CASE("integrators: a step in stages that is cut goes on as a new step", "[integrator][integrators]") {
  Scene scene = test::falling_block();
  scene.method.integrator = "tr_bdf2";
  scene.step.max_displacement = 0.05;
  Simulation simulation(scene);
  REQUIRE(simulation.advance(0.3));
  CHECK(simulation.state().counters.steps > 6);
  // Constant forces are integrated exactly, whatever the stages.
  CHECK(simulation.system().displacement(0)[1] == Approx(-0.5 * 9.81 * 0.09).epsilon(1e-12));
  CHECK(simulation.velocity(0)[1] == Approx(-9.81 * 0.3).epsilon(1e-12));
}

TEST_CASE("integrators: the dissipation of a path average is in proportion to the step and the contact's frequency, up to a tenth",
          "[integrator][integrators]") {
  Scene scene = test::block_on_base();
  scene.method.integrator = "path_average";
  scene.method.dissipation = 0.2;
  Simulation simulation(scene);
  // 1 m of 1e9 Pa/m under each corner of 5000 kg.
  const double frequency = std::sqrt(1e9 / 5000.0);
  for (const double dt : {1e-5, 1e-4, 1e-2}) {
    INFO(dt);
    const StepProblem problem = simulation.problem(dt, false);
    REQUIRE(problem.contacts.size() == 2);
    for (const Contact& c : problem.contacts) {
      CHECK(simulation.enforcement().springs(problem, c).dissipation == Approx(std::min(0.1, 0.2 * frequency * dt)).epsilon(1e-12));
    }
  }
}

TEST_CASE("path averages keep the energy of a support's springs where there is no contact at all", "[integrator][integrators]") {
  Scene scene = test::empty_scene();
  scene.gravity = {0.0, 0.0};
  scene.method.integrator = "path_average";
  scene.blocks = {test::free_block("block", test::rectangle(0.0, 0.0, 2.0, 1.0))};
  scene.supports = {{0, {1.0, 0.5}, {5e5, 1e6}}};
  scene.blocks[0].velocity = {1.0, 0.5};
  Simulation simulation(scene);
  const auto kinetic = [&] { return 0.5 * simulation.system().velocity(0).cwiseAbs2().dot(simulation.system().block(0).mass); };
  const double before = kinetic();
  for (int i = 0; i < 100; ++i) REQUIRE(simulation.advance(0.02));
  const Vec2 moved = simulation.system().displacement(0).head<2>();
  CHECK(kinetic() + 0.5 * Vec2(5e5, 1e6).dot(moved.cwiseAbs2()) == Approx(before).epsilon(1e-10));
  CHECK(std::abs(simulation.ledger().scheme) < 1e-9 * before);
}

TEST_CASE("path averages converge fast where the weight turns a block about soft contacts", "[integrator][integrators]") {
  // A tall column sways on springs so soft that the turning of the contact forces takes a third of their stiffness against tilting, k b^2/2 of m g
  // h/2.
  Scene scene = test::empty_scene();
  scene.method.integrator = "path_average";
  scene.blocks = {test::fixed_block("base", test::rectangle(-10.0, -1.0, 20.0, 1.0)),
                  test::free_block("column", test::rectangle(-1.0, 0.0, 2.0, 20.0))};
  scene.joints[0].normal_stiffness = 3e6;
  scene.joints[0].shear_stiffness = 3e6;
  scene.joints[0].friction_angle = 60.0 * test::degree;
  scene.method.start = Start::settled;
  Simulation simulation(scene);
  REQUIRE(settle(simulation).settled);
  simulation.restart_clock();
  simulation.set_velocity(1, {0.0, 0.0, 0.01});
  simulation.restart_clock();
  const long before = simulation.state().counters.iterations;
  for (int i = 0; i < 40; ++i) REQUIRE(simulation.step(0.05, false).accepted);
  const long solves = simulation.state().counters.iterations - before;
  CHECK(std::abs(simulation.system().displacement(1)[2]) > 1e-3);
  // Contacts keep their states: one solve, and another for what is not linear; four with a tangent whose geometric part is wrong.
  CHECK(solves <= 3 * 40);
}
