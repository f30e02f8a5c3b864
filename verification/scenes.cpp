#include "scenes.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "openclose/analysis/frozen_limit.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/geometry/polygon.h"
#include "openclose/scene/writer.h"

namespace openclose::verification {

Scene empty_scene(const analytical::BlockOnPlane& data) {
  // Each corner of the block has half its width for tributary length.
  const double length = 0.5 * data.width;
  const JointProperties joint = frictional_joint(data.normal_stiffness / length, data.shear_stiffness / length, data.friction_angle);
  Scene scene = rock_scene(data.density, joint, 0.01 * gap_tolerance);
  scene.gravity = {0.0, -data.gravity};
  scene.step.max_displacement = 1.0;
  return scene;
}

Scene block_on_plane(const analytical::BlockOnPlane& data, double length_downhill) {
  Scene scene = empty_scene(data);
  const auto place = [&](double along, double above) { return on_slope(data.slope_angle, along, above); };
  scene.blocks.push_back(fixed_block("plane", {place(-20.0, 0.0), place(-20.0, -5.0), place(length_downhill, -5.0), place(length_downhill, 0.0)}));
  scene.blocks.push_back(free_block("block", {place(0.0, 0.0), place(data.width, 0.0), place(data.width, data.height), place(0.0, data.height)}));
  return scene;
}

double downhill(const analytical::BlockOnPlane& data, const Vec2& displacement) {
  return downhill(data.slope_angle).dot(displacement);
}
double off_plane(const analytical::BlockOnPlane& data, const Vec2& displacement) {
  return off_slope(data.slope_angle).dot(displacement);
}

const std::vector<Scheme>& schemes() {
  static const std::vector<Scheme> list = {
      {"soft", "", "shi", 1.0, 1.0, false, "Newmark (1/2, 1): order 1"},
      {"soft", "theta 0.6", "theta", 0.6, 1.0, false, "end forces with weight 0.6: order 1"},
      {"soft", "trapezoid", "theta", 0.5, 2.0, false, "trapezoid: order 2"},
      {"soft", "generalized_alpha", "generalized_alpha", std::nullopt, 2.0, false, "generalised alpha: order 2"},
      {"soft", "tr_bdf2", "tr_bdf2", std::nullopt, 2.0, false, "trapezoid and BDF2: order 2"},
      {"soft", "path_average", "path_average", std::nullopt, 2.0, true, "forces averaged over the path: order 2"},
      {"shi", "", "", 1.0, 1.0, false, "Newmark (1/2, 1): order 1"},
      {"dem", "", "", std::nullopt, 2.0, false, "central difference: order 2"},
      {"hard", "", "", std::nullopt, 1.0, false, "mid-step velocities, forces at the end of the step: order 1"},
  };
  return list;
}

std::vector<Scheme> spring_schemes() {
  std::vector<Scheme> list;
  for (const Scheme& s : schemes()) {
    if (s.contact != "hard") list.push_back(s);
  }
  return list;
}

const Scheme& scheme_named(const std::string& name) {
  for (const Scheme& s : schemes()) {
    if (s.name() == name) return s;
  }
  throw std::logic_error("no scheme is called " + name);
}

void set_scheme(Scene& scene, const Scheme& scheme) {
  scene.method.contact = scheme.contact;
  scene.method.integrator.reset();
  scene.method.theta.reset();
  if (!scheme.integrator.empty()) scene.method.integrator = scheme.integrator;
  if (scheme.integrator == "theta") scene.method.theta = scheme.weight;
}

std::string with_variant(const std::string& quantity, const Scheme& scheme) {
  return scheme.variant.empty() ? quantity : quantity + ", " + scheme.variant;
}

void check_ledger(Report& report, const std::string& name, const std::string& method, const Simulation& simulation, bool done) {
  const EnergyLedger& l = simulation.ledger();
  report.against(Reference::ledger)
      .near(name + ": energy ledger, imbalance over turnover", method, 0.0, done ? std::abs(l.imbalance()) / l.turnover : not_measured(), 1e-10, "-",
            "work of the forces = change of kinetic energy");
}

std::vector<double> downhill_history(Simulation& simulation, const analytical::BlockOnPlane& data, std::size_t count) {
  std::vector<double> list;
  for (const Sample& s : history(simulation)) list.push_back(downhill(data, s.motion.displacement));
  if (list.size() != count) list.assign(count, not_measured());
  return list;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = larger(worst, std::abs(a[i] - b.at(i)));
  return worst;
}

double stands(const Report& report, const Scene& scene) {
  Simulation simulation = report.simulate(scene);
  const SettleResult result = settle(simulation);
  if (result.criterion == "displacement") return 0.0;
  if (!result.settled) return not_measured();
  const BlockSystem& system = simulation.system();
  Vec2 weight = Vec2::Zero(), carried = Vec2::Zero();
  for (const int b : system.free_blocks()) weight += simulation.external().weight(system, b).head<2>();
  for (const Contact& c : simulation.change_contacts()) {
    if (c.status == ContactStatus::open) continue;
    const Eigen::Vector3d still = Eigen::Vector3d::Zero();
    const ContactKinematics k(system, c, still, still);
    const Vec2 on_vertex = c.normal_force * k.normal_vertex.head<2>() + c.shear_force * k.shear_vertex.head<2>();
    if (system.block(c.edge_block).equation < 0) carried += on_vertex;
    if (system.block(c.vertex_block).equation < 0) carried -= on_vertex;
  }
  constexpr double balance = 1e-3;  // [-] far above what settling leaves, far below what a solver that does nothing gives
  return (weight + carried).norm() <= balance * weight.norm() ? 1.0 : not_measured();
}

double threshold(double fails, double holds, double width, const std::function<double(double)>& stands) {
  if (stands(fails) != 0.0 || stands(holds) != 1.0) return not_measured();
  while (std::abs(holds - fails) > width) {
    const double middle = 0.5 * (fails + holds), result = stands(middle);
    if (std::isnan(result)) return not_measured();
    (result == 1.0 ? holds : fails) = middle;
  }
  return 0.5 * (fails + holds);
}

namespace {

/// At small displacements nothing takes steps of the simulation, and a solver that does nothing would not show: it is asked where blocks move.
Scene asked_of(const Report& report, const Scene& scene) {
  Scene asked = scene;
  if (report.null_solver()) asked.strength_reduction.definition = FactorDefinition::large_displacements;
  return asked;
}

}  // namespace

double strength_reduction_factor(const Report& report, const Scene& scene) {
  Simulation simulation = report.simulate(asked_of(report, scene));
  const auto result = factor_of_safety(simulation);
  return result.found() && result.bracket.failed ? result.stable() : not_measured();
}

namespace {

/// [-] Of blocks that move in both mechanisms, over that of blocks that move in one of them.
double common_area(const Scene& scene, const FrozenSystem& system, const limit_analysis::Problem& problem, const limit_analysis::Mechanism& mechanism,
                   const std::vector<FailingBlock>& of_program) {
  constexpr double slowest = 0.01;  // [-] of the fastest block, as in FactorOfSafety::mechanism
  std::vector<double> speeds;
  for (std::size_t row = 0; row < mechanism.size(); ++row) speeds.push_back(limit_analysis::speed(problem.blocks[row], mechanism[row]));
  const double fastest = largest(speeds);
  double in_one = 0.0, in_both = 0.0;
  for (std::size_t row = 0; row < mechanism.size(); ++row) {
    const int block = system.blocks()[row].block;
    const bool moves = speeds[row] > slowest * fastest;
    const bool moves_there = std::any_of(of_program.begin(), of_program.end(), [&](const FailingBlock& b) { return b.block == block; });
    const double area = std::abs(signed_area(scene.blocks[static_cast<std::size_t>(block)].vertices));
    if (moves || moves_there) in_one += area;
    if (moves && moves_there) in_both += area;
  }
  return in_both / in_one;
}

SlidingLimit sliding_limit_of(const Scene& scene, const FactorOfSafety& found) {
  SlidingLimit limit;
  if (found.found() && found.bracket.failed) limit.factor = found.stable();
  const auto stable = std::find_if(found.states.begin(), found.states.end(), [](const NamedState& s) { return s.name == "stable"; });
  if (std::isnan(limit.factor) || stable == found.states.end()) return limit;
  const FrozenSystem system(scene);
  FrozenStrength strength(system, scene);
  strength.reduce(limit.factor);
  limit_analysis::Problem problem = limit_problem(system, strength);
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const Contact& carries = stable->contacts.at(i);
    const double shear = strength.of(i, carries.joint_state).largest_shear(carries.normal_force / system.force_unit());
    problem.contacts[i].cohesion = limit.factor * shear * system.force_unit();
    problem.contacts[i].friction = 0.0;
  }
  const limit_analysis::Bracket bracket = limit_analysis::limit_analysis(problem);
  if (!bracket.found()) return limit;
  limit.limit = bracket.failed;
  limit.common_area = common_area(scene, system, problem, bracket.mechanism, found.mechanism);
  return limit;
}

}  // namespace

SlidingLimit sliding_limit(const Report& report, const Scene& scene) {
  Simulation simulation = report.simulate(asked_of(report, scene));
  return sliding_limit_of(scene, factor_of_safety(simulation));
}

double load_multiplier(const Report& report, const Scene& scene, const std::string& load) {
  Scene asked = scene;
  // Where blocks move there is no multiplier: a solver that does nothing is asked for the factor of safety, which it has not either.
  if (!report.null_solver()) asked.strength_reduction.increase = load;
  return strength_reduction_factor(report, asked);
}

analytical::LimitState limit_state(const Scene& scene) {
  return analytical::limit_analysis(analytical::parse_rigid_blocks(write_scene(scene)));
}

}  // namespace openclose::verification
