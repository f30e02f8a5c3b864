#include "scenes.h"

#include <cmath>
#include <stdexcept>

#include "openclose/analysis/strength_reduction.h"
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

double strength_reduction_factor(const Report& report, const Scene& scene) {
  Scene asked = scene;
  // At small displacements nothing takes steps of the simulation, and a solver that does nothing would not show: it answers where blocks move.
  if (report.null_solver()) asked.strength_reduction.definition = FactorDefinition::large_displacements;
  Simulation simulation = report.simulate(asked);
  const auto result = factor_of_safety(simulation);
  return result.found() && result.bracket.failed ? result.stable() : not_measured();
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
