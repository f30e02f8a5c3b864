#include "openclose/analysis/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "openclose/contact/kinematics.h"
#include "openclose/core/error.h"
#include "openclose/core/tolerance.h"
#include "openclose/integrator/registry.h"

namespace openclose {
namespace {

void require_step_options(const Scene& scene, const Enforcement& enforcement) {
  if (scene.step.adaptive && !enforcement.takes_adaptive_steps())
    throw InputError(scene.step.adaptive_where, "step.adaptive", "true has no meaning for method.contact = \"" + scene.method.contact + "\"",
                     "contact = \"soft\"");
  if (scene.step.look_ahead > 0.0 && (enforcement.is_explicit() || !enforcement.follows_gaps()))
    throw InputError(scene.step.look_ahead_where, "step.look_ahead", "has no meaning for method.contact = \"" + scene.method.contact + "\"",
                     "contact = \"soft\" or \"hard\", or 0");
}

/// [m] Slip of a contact between two states if that is more than its shear spring can carry in the second one, or else 0.
double slip_between(const BlockSystem& start, const Contact& before, const BlockSystem& system, const Contact& now, const TabulatedJoint& joint) {
  const auto way = [&](int b) -> Motion::Unknowns { return system.displacement(b) - start.displacement(b); };
  const ContactKinematics k(start, before, way(now.vertex_block), way(now.edge_block));
  const ContactStrength strength(joint, now);
  const double stiffness = JointSprings(joint, now.length).shear;
  const double wanted = stiffness * std::abs(before.elastic_slip + k.slip_change);
  const double carried = strength.largest_shear(std::max(now.normal_force, -strength.tension));
  const bool slips = wanted > carried + stiffness * tolerance::rounding_of_ways_m;
  return slips ? std::abs(before.elastic_slip + k.slip_change - now.elastic_slip) : 0.0;
}

}  // namespace

Simulation::Simulation(Scene scene) : Simulation(std::move(scene), nullptr) {
  if (state_.enforcement->is_explicit()) explicit_ = std::make_unique<ExplicitStepper>(state_);
}

Simulation::Simulation(Scene scene, std::unique_ptr<Enforcement> enforcement) : state_(std::move(scene), std::move(enforcement)), solved_(state_) {
  require_step_options(state_.scene, *state_.enforcement);
  require_settling_method(state_.scene);
}

const SimulationState& Simulation::state() const {
  if (explicit_ && explicit_->is_ahead()) throw std::logic_error("the explicit loop has left the state behind: collect() comes first");
  return state_;
}

SimulationState& Simulation::taken_back() {
  if (explicit_) explicit_->collect();
  state_.take_back();
  return state_;
}

StepResult Simulation::step(double dt, bool statics) {
  if (explicit_ && !statics) return explicit_->step_of_any_length(dt);
  return solved_.step(dt, statics);
}

bool Simulation::advance(double dt) {
  return explicit_ ? explicit_->advance(dt) : solved_.advance(dt);
}

StepProblem Simulation::problem(double dt, bool statics) {
  if (explicit_) explicit_->collect();
  return solved_.problem(dt, statics);
}

BlockSystem& Simulation::change_system() {
  return taken_back().system;
}

JointTable& Simulation::change_joints() {
  return taken_back().joints;
}

std::vector<Contact>& Simulation::change_contacts() {
  taken_back().find_contacts();
  return state_.contacts.moving;
}

void Simulation::positions_changed() {
  taken_back().detector.forget();
  state_.contacts_current = false;
}

void Simulation::set_velocity(int b, const Unknowns& velocity) {
  taken_back().output_velocity[static_cast<std::size_t>(b)] = velocity;
}

void Simulation::restore_velocities() {
  taken_back();
  const std::vector<BlockInput>& blocks = state_.scene.blocks;
  for (std::size_t b = 0; b < blocks.size(); ++b) state_.output_velocity[b] = BlockSystem::velocity_at_start(blocks[b]);
}

void Simulation::come_to_rest() {
  taken_back();
  const double dropped = state_.system.kinetic_energy() + state_.kinetic_ahead;
  state_.kinetic_ahead = 0.0;
  state_.ledger.scheme += dropped;
  state_.ledger.kinetic -= dropped;
  state_.system.stop();
  state_.output_velocity = state_.system.state().velocity;
  state_.restart_scheme();
}

void Simulation::judge_bonds(const Snapshot* from) {
  change_contacts();
  std::map<std::pair<int, int>, const Contact*> before;
  BlockSystem start = state_.system;
  if (from) {
    start.restore(from->blocks);
    for (const Contact& c : from->contacts) before.emplace(std::pair(c.vertex, c.edge), &c);
  }
  for (Contact& c : state_.contacts.moving) {
    const TabulatedJoint& joint = state_.joints.joint(c.joint);
    const auto known = before.find({c.vertex, c.edge});
    // What slides, nobody knows how far, has slid all the way.
    const bool is_known = known != before.end();
    const double slip = is_known && c.status != ContactStatus::open ? slip_between(start, *known->second, state_.system, c, joint) : 0.0;
    const ContactStatus on_the_way = c.status == ContactStatus::sticking && slip > 0.0 ? ContactStatus::sliding : c.status;
    c.joint_state = state_after(joint, c.joint_state, on_the_way, is_known ? slip : std::numeric_limits<double>::infinity());
  }
}

void Simulation::change_method(const MethodInput& method) {
  taken_back();
  state_.scene.method = method;
  state_.enforcement = make_enforcement(method);
  explicit_ = state_.enforcement->is_explicit() ? std::make_unique<ExplicitStepper>(state_) : nullptr;
  state_.restart_scheme();
}

void Simulation::restart_clock() {
  taken_back();
  state_.time = 0.0;
  state_.ledger = EnergyLedger();
  state_.kinetic_ahead = 0.0;
  solved_.restart_ledger();
  state_.max_penetration = state_.friction_work = state_.lagging_friction_work = state_.fastest_weakening = 0.0;
  state_.restart_scheme();
}

Simulation::Snapshot Simulation::save() {
  change_contacts();
  Snapshot snapshot{state_.system.state(), state_.contacts.moving};
  snapshot.blocks.velocity = state_.output_velocity;
  return snapshot;
}

void Simulation::restore(const Snapshot& snapshot) {
  taken_back();
  state_.system.restore(snapshot.blocks);
  state_.contacts.moving = snapshot.contacts;
  state_.detector.forget();
  state_.may_rest = false;  // what is known of quiet blocks and their contacts is of another state
  state_.contacts_current = true;
  state_.output_velocity = snapshot.blocks.velocity;
  solved_.forget();
  if (explicit_) explicit_->forget();
  state_.restart_scheme();
}

bool Simulation::fits(const Snapshot& snapshot) const {
  const BlockSystem::State &own = state_.system.state(), &other = snapshot.blocks;
  return other.displacement.size() == own.displacement.size() && other.velocity.size() == own.velocity.size() && other.arm.size() == own.arm.size() &&
         other.point_arm.size() == own.point_arm.size() && other.is_finite() &&
         Detector::contacts_fit(state_.system, state_.joints, snapshot.contacts);
}

void Simulation::exchange(Archive& archive) {
  archive(state_, solved_);
  if (explicit_) archive(*explicit_);
}

}  // namespace openclose
