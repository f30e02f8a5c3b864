#include "openclose/analysis/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "openclose/analysis/solved_step.h"
#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"
#include "openclose/integrator/crossing_energy.h"
#include "openclose/integrator/integrators.h"
#include "openclose/integrator/registry.h"

namespace openclose {
namespace {

/// Adds the time of its own life to an account. Wall time: asking for CPU time costs more than a step of a small scene.
class Stopwatch {
 public:
  explicit Stopwatch(double& account) : account_(account) {}
  ~Stopwatch() { account_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& account_;
  Clock::time_point start_ = Clock::now();
};

/// [-] of the largest displacement of a step, to be aimed at where steps have to be shorter.
constexpr double part_of_limit = 0.9;

/// [rad] No block that is in contact turns by more than this in a step: then other edges face each other than those whose contacts the step knows,
/// and a splinter that may turn as it likes finds states of balance after whole turns. Where facing edges have become corners, nothing is left of
/// them.
constexpr double largest_turn_in_contact_rad = tolerance::parallel_none_rad;

/// Whether a block that is in contact at the start or the end of a step turns by more than that.
bool turns_too_far(const BlockSystem& system, const std::vector<Contact>& contacts, const StepSolution& solution) {
  const auto turns = [&](int b) { return std::abs(Motion::rotation(solution.of(system, b))) > largest_turn_in_contact_rad; };
  if (std::ranges::none_of(system.free_blocks(), turns)) return false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const bool touches = contacts[i].status != ContactStatus::open || solution.contacts.status(i) != ContactStatus::open;
    if (touches && (turns(contacts[i].vertex_block) || turns(contacts[i].edge_block))) return true;
  }
  return false;
}

/// [-] By which explicit steps may become longer before they do.
constexpr double worthwhile_growth = 1.1;

/// [-] Closure of an impact over the thickness of what it meets, to be aimed at with stiffer springs: a tenth is what dem promises to resolve.
constexpr double closure_of_thickness = 0.1;

bool has_joint_springs(const std::string& contact) {
  return std::ranges::any_of(enforcements(), [&](const auto& entry) { return entry.name == contact && entry.make()->has_joint_springs(); });
}

}  // namespace

double default_contact_skin(const std::vector<BlockInput>& blocks) {
  std::vector<double> areas;
  for (const BlockInput& block : blocks) {
    if (!block.fixed) areas.push_back(std::abs(signed_area(block.vertices)));
  }
  if (areas.empty()) return tolerance::contact_skin_m;
  const auto median = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
  std::nth_element(areas.begin(), median, areas.end());
  return std::min(tolerance::contact_skin_m, tolerance::contact_skin_of_size * std::sqrt(*median));
}

bool is_settled_by_another(const Scene& scene) {
  return scene.settled_by.value_or(scene.method.contact) != scene.method.contact;
}

MethodInput settling_method(const Scene& scene) {
  MethodInput settling = scene.method;
  if (!is_settled_by_another(scene)) return settling;
  settling.contact = *scene.settled_by;
  // These are of the motion's method, and some methods refuse them.
  settling.integrator.reset();
  settling.first_integrator.reset();
  settling.theta.reset();
  settling.rho_inf.reset();
  settling.dissipation.reset();
  settling.static_solver = StaticSolver::automatic;
  settling.statics = false;
  return settling;
}

Simulation::Simulation(Scene scene) : Simulation(std::move(scene), nullptr) {
  if (enforcement_->is_explicit()) loop_ = std::make_unique<CentralDifference>(contact_skin_);
}

Simulation::Simulation(Scene scene, std::unique_ptr<Enforcement> enforcement)
    : scene_(std::move(scene)),
      contact_skin_(scene_.method.contact_skin.value_or(default_contact_skin(scene_.blocks))),
      system_(scene_),
      external_(scene_, system_),
      joints_(scene_),
      enforcement_(enforcement ? std::move(enforcement) : make_enforcement(scene_.method)),
      begins_(scene_.method.first_integrator.has_value()),
      scheme_(make_scheme()),
      // Two vertices may approach each other by the largest displacement each.
      detector_(2.0 * scene_.step.max_displacement, {scene_.method.skip_search, scene_.method.skip_narrow_phase && enforcement_->follows_gaps(),
                                                     scene_.method.skip_looks, contact_skin_}),
      output_velocity_(system_.state().velocity),
      resting_(scene_.rest, system_),
      start_kinetic_energy_(system_.kinetic_energy()),
      control_(scene_.step.error_tolerance),
      bytes_of_scene_(bytes_of_blocks(scene_)) {
  if (scene_.step.adaptive && !enforcement_->takes_adaptive_steps())
    throw InputError(scene_.step.adaptive_where, "step.adaptive", "true has no meaning for method.contact = \"" + scene_.method.contact + "\"",
                     "contact = \"soft\"");
  if (scene_.step.look_ahead > 0.0 && (enforcement_->is_explicit() || !enforcement_->follows_gaps()))
    throw InputError(scene_.step.look_ahead_where, "step.look_ahead", "has no meaning for method.contact = \"" + scene_.method.contact + "\"",
                     "contact = \"soft\" or \"hard\", or 0");
  if (is_settled_by_another(scene_)) check_settling();
}

void Simulation::check_settling() const {
  if (!has_joint_springs(scene_.method.contact) || !has_joint_springs(*scene_.settled_by))
    throw InputError(scene_.settled_by_where, "run.settled_by",
                     fmt::format("no equilibrium of \"{}\" is one for method.contact = \"{}\"", *scene_.settled_by, scene_.method.contact),
                     "\"soft\" or \"dem\" where method.contact is one of these, or what method.contact is");
  const MethodInput settling = settling_method(scene_);
  try {
    make_enforcement(settling)->make_time_scheme(settling);
  } catch (const InputError& error) {
    throw InputError(scene_.settled_by_where, "run.settled_by", fmt::format("\"{}\" cannot settle this scene: {}", settling.contact, error.what()),
                     "");
  }
}

void Simulation::collect() const {
  if (!loop_is_ahead_) return;
  loop_is_ahead_ = false;
  loop_->store_blocks(system_);
  for (int b : system_.free_blocks()) output_velocity_[b] = loop_->velocity_at_end(system_.block(b).equation);
  loop_->store_contacts(contacts_);
  loop_->store_far_gaps(system_, contacts_);
  max_penetration_ = std::max(max_penetration_, loop_->max_penetration());
  const ExplicitEnergies e = loop_->take_energies();
  const double stored = moving_contact_energy();
  ledger_.contact_springs += stored - collected_contact_energy_;
  collected_contact_energy_ = stored;
  ledger_.gravity += e.gravity;
  ledger_.base_motion += e.base_motion;
  ledger_.loads += e.loads;
  ledger_.support_springs += e.support_springs;
  ledger_.friction += e.friction;
  ledger_.contact_damping += e.contact_damping;
  ledger_.mass_damping += e.mass_damping;
  ledger_.scheme += e.scheme;
  ledger_.redefinition += e.redefinition;
  ledger_.turnover += e.turnover;
  book_kinetic_energy(loop_->kinetic_ahead());
}

void Simulation::book_kinetic_energy(double ahead) const {
  ledger_.scheme -= ahead - kinetic_ahead_;
  kinetic_ahead_ = ahead;
  ledger_.kinetic = system_.kinetic_energy() + ahead - start_kinetic_energy_;
}

void Simulation::unload_loop() {
  collect();
  loop_is_loaded_ = false;
  still_step_ = 0.0;
}

void Simulation::take_back() {
  unload_loop();
  wake(std::vector<int>(system_.resting_blocks()));
}

void Simulation::rest_after(double dt) {
  if (!may_rest_) return;
  if (external_.base_acceleration().isZero(0.0)) {
    resting_.follow(system_, output_velocity_, dt);
  } else {
    resting_.disturb(system_);
  }
  const std::vector<int> quiet = resting_.quiet_blocks(system_, contacts_);
  if (quiet.empty()) return;
  unload_loop();
  const double before = system_.kinetic_energy();
  system_.put_to_rest(quiet);
  const double dropped = before - system_.kinetic_energy();
  ledger_.scheme += dropped;
  ledger_.kinetic -= dropped;
  for (const int b : quiet) {
    output_velocity_[b].setZero();
    scheme_->forget(b);
  }
  resting_.keep_forces(system_, quiet, contacts_, detector_.resting_contacts());
  step_counters_.put_to_rest += static_cast<long>(quiet.size());
  divide();
}

void Simulation::wake(const std::vector<int>& blocks) {
  if (blocks.empty()) return;
  unload_loop();
  system_.wake(blocks);
  contacts_current_ = false;
  divide();
}

void Simulation::divide() {
  detector_.divide(system_, contacts_);
  resting_.divide(system_, detector_.resting_contacts());
}

bool Simulation::wake_in_haste(const StepSolution& solution, double dt) {
  if (system_.resting_blocks().empty()) return false;
  std::vector<Unknowns>& pushes = resting_.pushes(system_);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const int a = contacts_[i].vertex_block, b = contacts_[i].edge_block;
    if (solution.contacts.status(i) == ContactStatus::open || !(system_.is_at_rest(a) || system_.is_at_rest(b))) continue;
    const ContactOutcome o = solution.contacts[i];
    const Vec2 force = o.forces.normal * o.pose.normal + o.forces.shear * o.pose.tangent();
    if (system_.is_at_rest(a)) pushes[system_.rest_number(a)] += Motion::gradient(o.pose.vertex_arm, force);
    if (system_.is_at_rest(b)) pushes[system_.rest_number(b)] -= Motion::gradient(o.pose.edge_arm, force);
  }
  resting_.judge(system_, dt);
  return wake_by_forces(Resting::Urgency::in_haste);
}

bool Simulation::wake_by_forces(Resting::Urgency urgency) {
  if (system_.resting_blocks().empty()) return false;
  const std::vector<int> woken = resting_.woken(system_, contacts_, detector_.resting_contacts(), urgency);
  if (urgency == Resting::Urgency::any) resting_.accept(system_);
  step_counters_.woken += static_cast<long>(woken.size());
  wake(woken);
  return !woken.empty();
}

void Simulation::count_moves() {
  step_counters_.block_steps += system_.free_count();
  step_counters_.block_steps_skipped += static_cast<long>(system_.resting_blocks().size());
}

void Simulation::note_memory() {
  Memory now = enforcement_->memory() + detector_.memory();
  if (loop_) now += loop_->memory();
  now.blocks += bytes_of_scene_ + system_.bytes() + bytes_of(output_velocity_);
  now.contacts += bytes_of(contacts_);
  memory_.grow_to(now);
}

BlockSystem& Simulation::system() {
  take_back();
  return system_;
}

const BlockSystem& Simulation::system() const {
  collect();
  return system_;
}

JointTable& Simulation::joints() {
  take_back();
  return joints_;
}

Simulation::Unknowns Simulation::velocity(int b) const {
  collect();
  return output_velocity_[b];
}

const EnergyLedger& Simulation::ledger() const {
  collect();
  return ledger_;
}

double Simulation::max_penetration() const {
  collect();
  return max_penetration_;
}

void Simulation::set_velocity(int b, const Unknowns& velocity) {
  take_back();
  output_velocity_[b] = velocity;
}

void Simulation::positions_changed() {
  take_back();
  detector_.forget();
  contacts_current_ = false;
}

double Simulation::stored_contact_energy() const {
  double energy = moving_contact_energy();
  for (const Contact& c : detector_.resting_contacts()) energy += c.stored_energy;
  return energy;
}

double Simulation::moving_contact_energy() const {
  collect();
  double energy = 0.0;
  for (const Contact& c : contacts_) energy += c.stored_energy;
  return energy;
}

double Simulation::force_scale() const {
  collect();
  double scale = 0.0;
  for (int b : system_.free_blocks()) scale = std::max(scale, external_.weight(system_, b).norm());
  if (scale > 0.0) return scale;
  for (const auto& element : external_.elements()) {
    if (element->account() == ForceAccount::loads) scale = std::max(scale, element->magnitude(element->path(system_, Unknowns::Zero())));
  }
  for (const Contact& c : contacts_) scale = std::max({scale, c.normal_force, std::abs(c.shear_force)});
  return scale > 0.0 ? scale : 1.0;
}

bool Simulation::find_contacts(double lead) {
  // What touches in the drawing is found there.
  if (lead == 0.0 || !detector_.knows_bonds()) return detector_.update(system_, joints_, contacts_);
  BlockSystem ahead = system_;
  for (int b : system_.free_blocks()) ahead.advance(b, lead * system_.velocity(b));
  return detector_.update(ahead, joints_, contacts_, &system_);
}

void Simulation::detect(double lead) {
  const Stopwatch watch(stage_times_.detection);
  const bool elastic = enforcement_->has_elastic_contacts();
  const double before = elastic ? moving_contact_energy() : 0.0;
  contacts_current_ = true;
  if (!find_contacts(lead) || !elastic) return;
  const StepProblem p = present_problem(scene_.step.dt, false);
  for (const DetectionChange& change : detector_.changes()) {
    for (int i = change.after.begin; i < change.after.end; ++i) store_energy(p, contacts_[i]);
  }
  for (Contact& c : contacts_) {
    if (!c.bonded && c.normal_force < 0.0) store_energy(p, c);  // it lost its strength while it was pulling
  }
  const double change = moving_contact_energy() - before;
  ledger_.redefinition -= change;
  ledger_.contact_springs += change;
}

void Simulation::store_energy(const StepProblem& problem, Contact& contact) const {
  const ContactSprings springs = enforcement_->springs(problem, contact);
  const ContactForces f = spring_slider(springs, ContactStrength(joints_.joint(contact.joint), contact), 0.0, 0.0);
  contact.stored_energy = stored_energy(springs.normal, springs.shear, f.normal, springs.initial_shear) - contact.crossing_energy;
}

std::vector<Contact>& Simulation::contacts() {
  take_back();
  return moving_contacts();
}

const std::vector<Contact>& Simulation::contacts() const {
  collect();
  return contacts_;
}

std::vector<Contact> Simulation::every_contact() const {
  std::vector<Contact> list = contacts();
  const std::vector<Contact>& resting = detector_.resting_contacts();
  list.insert(list.end(), resting.begin(), resting.end());
  return list;
}

std::vector<Contact>& Simulation::moving_contacts(double lead) {
  unload_loop();
  if (!contacts_current_) detect(lead);
  return contacts_;
}

bool Simulation::move_base(double dt, bool statics) {
  const TimeSpan span = scheme_->span_of_velocities(dt);
  if (base_moves_ && !statics) {
    external_.move_base(time_ + span.from, time_ + span.to);
  } else {
    external_.hold_base();
  }
  if (external_.base_acceleration().isZero(0.0) || system_.resting_blocks().empty()) return false;
  wake(std::vector<int>(system_.resting_blocks()));
  return true;
}

StepProblem Simulation::problem(double dt, bool statics) {
  move_base(dt, statics);
  moving_contacts(statics ? 0.0 : scene_.step.look_ahead * dt);
  return present_problem(dt, statics);
}

StepProblem Simulation::present_problem(double dt, bool statics) const {
  StepProblem p{system_, external_, joints_, contacts_, scene_.method};
  p.dt = dt;
  p.statics = statics;
  p.inertia = statics ? 2.0 / (dt * dt) : scheme_->inertia(dt);
  p.end_weight = statics ? 1.0 : scheme_->end_weight();
  p.failed_attempts = failed_attempts_;
  p.keep_bonds = keep_bonds_;
  p.longest_displacement = scene_.step.max_displacement;
  if (statics) {
    if (enforcement_->has_elastic_contacts()) p.negligible_force = negligible_force_;  // elsewhere it would show in the places of the blocks
    return p;
  }
  p.scheme = scheme_.get();
  if (scheme_->wants_accelerations()) {
    const Eigen::VectorXd force = forces_now(p, *enforcement_);
    for (int b : system_.free_blocks()) {
      const auto& block = system_.block(b);
      scheme_->start(b, force.segment<dofs>(dofs * block.equation).cwiseQuotient(block.mass));
    }
  }
  return p;
}

StepResult Simulation::step(double dt, bool statics) {
  if (loop_ && !statics) {
    StepResult taken = explicit_step(dt, scene_.method.damping, true);
    while (taken.relisted) taken = explicit_step(dt, scene_.method.damping, true);
    collect();
    return taken;
  }
  if (!statics && repeats_still_step(dt)) return repeat_still_step();
  StepResult result;
  if (statics) take_back();
  const StepProblem p = problem(dt, statics);
  StepSolution& solution = solution_;
  {
    const Stopwatch watch(stage_times_.solution);
    solution.clear();
    enforcement_->solve(p, solution);
  }
  step_counters_.add(solution.effort);
  note_memory();
  if (solution.converged && wake_in_haste(solution, dt)) {
    ++step_counters_.repeated_to_wake;
    return step(dt, statics);
  }
  if (solution.converged) result.moved = largest_move(system_, solution);
  const bool turned = solution.converged && turns_too_far(system_, contacts_, solution);
  const bool too_far = turned || result.moved > scene_.step.max_displacement;
  if (solution.converged && !too_far && !statics && scene_.step.adaptive) {
    result.error = local_error(p, solution);
    result.too_wrong = !(result.error <= control_.tolerance());
    if (result.too_wrong) {
      result.reason = "the local error of a step stays above step.error_tolerance_m";
      ++step_counters_.cuts;
      ++step_counters_.error_cuts;
      return result;
    }
  }
  const bool may_enter = solution.converged && !too_far;
  const double part = may_enter ? cuts_.part_before_entry(p, solution, *enforcement_, result.moved, detector_.candidate_pairs()) : 1.0;
  if (part < 1.0 && part * dt >= shortest_step()) {
    result.reason = "a corner enters a block that it is not in contact with";
    result.part = part;
    result.ends_at_entry = true;
    ++step_counters_.cuts;
    ++step_counters_.entry_cuts;
    cuts_.cut_at_entry(result.moved);
    return result;
  }
  if (!solution.converged || too_far) {
    result.reason = turned    ? "a block that is in contact turned by more than 15 degrees in one step"
                    : too_far ? "a block moved farther in one step than step.max_displacement_m"
                              : solution.reason;
    result.part = solution.part;
    ++step_counters_.cuts;
    ++failed_attempts_;
    return result;
  }
  const Stopwatch watch(stage_times_.bookkeeping);
  step_ledger_ = {};
  if (books_steps_) add_step(step_ledger_, p, solution, *scheme_, enforcement_->has_elastic_contacts());
  if (cuts_.creates_energy(p, solution, *enforcement_, ledger_, step_ledger_, shortest_step())) {
    result.reason = "a step creates energy";
    ++step_counters_.cuts;
    cuts_.cut_for_energy();
    return result;
  }
  if (statics) result.unbalanced_force = openclose::unbalanced_force(p, solution);
  result.lost_strength = loses_strength(p, solution);
  accept(p, solution);
  result.accepted = true;
  wake_by_forces(Resting::Urgency::any);
  return result;
}

void Simulation::take_end_of_explicit_step(const StepProblem& problem, const StepSolution& solution) {
  std::vector<Unknowns> force = forces_at_end(problem, solution);
  book_kinetic_energy(kinetic_ahead(problem, force));
  for (int b : system_.free_blocks()) {
    if (system_.block(b).rotation_locked) force[b][Motion::rotation_index] = 0.0;
    output_velocity_[b] = system_.velocity(b) + 0.5 * problem.dt * force[b].cwiseQuotient(system_.block(b).mass);
  }
}

void Simulation::end_of_blow(const Blow& blow) {
  if (system_.block(blow.block).equation < 0) return;
  output_velocity_[blow.block] -= blow.part * (output_velocity_[blow.block] - system_.velocity(blow.block));
}

StepResult Simulation::repeat_still_step() {
  if (books_steps_) ledger_ += step_ledger_;
  time_ += still_step_;
  ++step_counters_.steps;
  ++step_counters_.still;
  count_moves();
  StepResult result;
  result.accepted = true;
  return result;
}

bool Simulation::accept_velocities(const StepProblem& problem, const StepSolution& solution) {
  bool some = false;
  double dropped = 0.0;
  for (int b : system_.free_blocks()) {
    const Unknowns d = solution.of(system_, b), v = problem.velocity(b), zero = Unknowns::Zero();
    Unknowns at_end = problem.statics ? zero : scheme_->velocity_at_end(b, problem.dt, d, v);
    Unknowns next = problem.statics ? zero : scheme_->next_velocity(b, problem.dt, d, v);
    if (!problem.statics && !enforcement_->is_explicit() && has_come_to_rest(problem, b, next)) {
      dropped += 0.5 * system_.block(b).mass.dot(next.cwiseAbs2());
      at_end = next = zero;
    }
    output_velocity_[b] = at_end;
    system_.set_velocity(b, next);
    if (!problem.statics) scheme_->record(b, problem.dt, d, v);
    some = some || !next.isZero(0.0);
  }
  ledger_.scheme += dropped;
  return some;
}

void Simulation::accept(const StepProblem& problem, const StepSolution& solution) {
  if (books_steps_) ledger_ += step_ledger_;
  const bool may_be_still = moves_nothing(problem, solution) && !cuts_.has_cut_at_entry() && system_.resting_blocks().empty();
  const bool may_be_struck = !problem.statics && !enforcement_->has_elastic_contacts();
  const std::vector<Blow> struck = may_be_struck ? blows(problem, solution) : std::vector<Blow>();
  const bool contacts_change = accept_contacts(solution), some_move = accept_velocities(problem, solution);
  for (int b : system_.free_blocks()) system_.advance(b, solution.of(system_, b));
  for (const Blow& blow : struck) end_of_blow(blow);
  if (!problem.statics) scheme_->accept(problem.dt);
  enforcement_->is_explicit() ? take_end_of_explicit_step(problem, solution) : book_kinetic_energy(0.0);
  time_ += problem.dt;
  ++step_counters_.steps;
  count_moves();
  if (!problem.statics) {
    friction_work_ += solution.friction_work;
    lagging_friction_work_ += solution.lagging_friction_work;
  }
  if (solution.eased) ++step_counters_.eased;
  if (solution.dissipative) ++step_counters_.dissipative;
  failed_attempts_ = 0;
  // The contact that the step has come to may be new to a pair that has hardly moved.
  if (cuts_.has_cut_at_entry()) detector_.look_again();
  cuts_.accept(ledger_);
  contacts_current_ = false;
  still_step_ = may_be_still && !contacts_change && !some_move ? problem.dt : 0.0;
}

bool Simulation::accept_contacts(const StepSolution& solution) {
  const bool elastic = enforcement_->has_elastic_contacts();
  bool some_change = false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Contact& c = contacts_[i];
    const Contact start = c;
    c.status = solution.contacts.status(i);
    c.bonded = stays_bonded(joints_.joint(c.joint), c.bonded, c.status);
    c.slack = solution.contacts.slack(i);
    c.gap += solution.contacts.gap_change(i);
    c.normal_force = c.shear_force = c.elastic_slip = c.stored_energy = 0.0;
    if (enforcement_->is_explicit()) book_crossing(c, solution.contacts[i], start);
    if (c.status != ContactStatus::open) {
      const CarriedForces f = solution.contacts.forces(i);
      const double kn = solution.contacts.normal_stiffness(i), ks = solution.contacts.shear_stiffness(i);
      c.normal_force = f.normal;
      c.shear_force = f.shear;
      c.elastic_slip = -f.elastic_shear / ks;
      if (elastic) c.stored_energy = -c.crossing_energy + stored_energy(kn, ks, f.elastic_normal, f.elastic_shear);
      max_penetration_ = std::max(max_penetration_, -c.gap);
    }
    some_change = some_change || !(c == start);
  }
  return some_change;
}

void Simulation::book_crossing(Contact& contact, const ContactOutcome& outcome, const Contact& start) {
  const double before = contact.crossing_energy;
  contact.crossing_energy = 0.0;
  const bool is_open = contact.status == ContactStatus::open;
  if (is_open) {
    contact.normal_force = outcome.forces.normal;
    contact.shear_force = outcome.forces.shear;
    contact.crossing_energy = outcome.crossing_energy;
    contact.stored_energy = -contact.crossing_energy;
  } else if (ContactStrength(joints_.joint(contact.joint), contact).tension == 0.0) {
    contact.crossing_energy =
        start.status == ContactStatus::open ? closing_energy(outcome.normal_stiffness, start.stretch(), contact.stretch()) : before;
  }
  ledger_.contact_springs -= contact.crossing_energy - before;
  ledger_.scheme += contact.crossing_energy - before;
}

void Simulation::load_loop() {
  if (loop_is_loaded_ && contacts_current_) return;
  approach_step_.reset();
  if (!loop_is_loaded_ || !renew_loop()) {
    moving_contacts();
    loop_->load(present_problem(scene_.step.dt, false));
    collected_contact_energy_ = moving_contact_energy();
    loop_is_loaded_ = true;
    ++step_counters_.loads;
    note_memory();
  }
  double& smallest = step_counters_.smallest_critical_step;
  smallest = smallest > 0.0 ? std::min(smallest, loop_->critical_step()) : loop_->critical_step();
}

/// Renews the list of contacts under the running loop; false if the loop is to take over everything anew.
bool Simulation::renew_loop() {
  if (!scene_.method.skip_reload || !loop_->can_renew()) return false;
  loop_->store_blocks(system_);
  if (detector_.needs_search(system_)) return false;
  {
    const Stopwatch watch(stage_times_.detection);
    loop_->store_contacts(contacts_);
    contacts_current_ = true;
    if (!detector_.update(system_, joints_, contacts_)) {
      loop_->keep();
      return true;
    }
  }
  const StepProblem p = present_problem(scene_.step.dt, false);
  for (const DetectionChange& change : detector_.changes()) {
    for (int i = change.after.begin; i < change.after.end; ++i) store_energy(p, contacts_[i]);
  }
  loop_->renew(p, detector_.changes());
  loop_is_ahead_ = true;  // its energies are
  ++step_counters_.loads_skipped;
  return true;
}

double Simulation::approach_step() {
  if (!approach_step_) {
    loop_->store_blocks(system_);
    approach_step_ =
        approach_bound_.step(system_, joints_, detector_.candidate_pairs(), loop_->approach(), contact_skin_, scene_.method.step_fraction);
  }
  return *approach_step_;
}

std::string Simulation::too_deep() {
  const auto found = loop_->too_deep();
  if (!found) return {};
  const Contact& c = contacts_[found->contact];
  // The closure of an impact falls with the root of the stiffness.
  const double wanted = closure_of_thickness * found->limit / DepthLimits::part, factor = found->depth / wanted;
  return fmt::format(
      "the springs are too soft for these blocks: a corner of \"{}\" has come {:.2g} m into \"{}\", which is {:.2g} m thick there; "
      "joint[{}].normal_stiffness_pa_per_m = {:.2g} or more would be a remedy",
      scene_.blocks[c.vertex_block].name, found->depth, scene_.blocks[c.edge_block].name, found->limit / DepthLimits::part, c.joint,
      joints_.joint(c.joint).normal_stiffness * factor * factor);
}

double Simulation::critical_step() {
  load_loop();
  return loop_->critical_step();
}

double Simulation::longest_stable_step(MassDamping damping) {
  load_loop();
  const double stable = scene_.method.step_fraction * loop_->critical_step(damping == MassDamping::local ? scene_.method.local_damping : 0.0);
  const double longest = loop_->is_fast() ? std::min(stable, approach_step()) : stable;
  // Each change of the step has its price.
  if (longest < held_step_ || longest > worthwhile_growth * held_step_) held_step_ = longest;
  return held_step_;
}

StepResult Simulation::explicit_step(double h, MassDamping damping, bool any_length) {
  move_base(h, false);
  load_loop();
  StepResult result;
  const double span = 1.0 / (h * scheme_->inertia(h));
  const auto move = [&](double fast_step) {
    return loop_->move(h, span, external_.base_acceleration(), scene_.step.max_displacement, fast_step, damping, scene_.method.local_damping);
  };
  // What the step would do is known only now.
  constexpr double any = std::numeric_limits<double>::infinity(), rounding = 1.0 + tolerance::rounding_of_times;
  Move moved = move(any_length ? any : rounding * approach_step_.value_or(0.0));
  if (moved == Move::too_fast) moved = move(rounding * approach_step());
  if (moved == Move::past_list || moved == Move::too_fast) {
    contacts_current_ &= moved != Move::past_list;
    result.relisted = true;
    return result;
  }
  if (moved == Move::too_far) {
    result.reason = "a block moved farther in one step than step.max_displacement_m";
    ++step_counters_.cuts;
    return result;
  }
  loop_->follow_contacts();
  loop_is_ahead_ = true;
  result.reason = too_deep();
  result.stops = !result.reason.empty();
  scheme_->accept(h);
  time_ += h;
  ++step_counters_.steps;
  step_counters_.longest_step = std::max(step_counters_.longest_step, h);
  result.accepted = true;
  result.unbalanced_force = loop_->last_unbalanced_force();
  result.lost_strength = loop_->lost_strength();
  if (loop_->moved_beyond_skin()) contacts_current_ = false;
  count_moves();
  if (!system_.resting_blocks().empty()) {
    loop_->rest_forces(resting_.pushes(system_));
    resting_.judge(system_, h);
    wake_by_forces(Resting::Urgency::any);
  }
  return result;
}

void Simulation::keep_bonds(bool keep) {
  take_back();
  keep_bonds_ = keep;
}

void Simulation::judge_bonds() {
  for (Contact& c : contacts()) c.bonded = stays_bonded(joints_.joint(c.joint), c.bonded, c.status);
}

double Simulation::unbalanced_force() {
  load_loop();
  return loop_->unbalanced_force();
}

bool Simulation::advance_explicitly(double dt) {
  const double smallest = scene_.step.smallest_fraction * dt;
  double remaining = dt, longest = 0.0, part = 1.0;
  for (long steps = 0; remaining > 0.0;) {  // equal ones, of the remaining time
    const double now = part * std::min(longest_stable_step(scene_.method.damping), dt);
    if (steps == 0 || now != longest) {
      longest = now;
      // A quotient that is whole but for rounding stays whole.
      steps = std::max(1L, std::lround(std::ceil(remaining / longest * (1.0 - tolerance::rounding_of_times))));
    }
    const double h = remaining / static_cast<double>(steps);
    if (!system_.resting_blocks().empty() && move_base(h, false)) {  // the step may be too long for those that it woke
      steps = 0;
      continue;
    }
    StepResult result;
    {
      const Stopwatch watch(stage_times_.solution);
      result = explicit_step(h, scene_.method.damping);
    }
    if (result.relisted) {
      steps = 0;
      continue;
    }
    if (result.stops) {
      reason_ = result.reason;
      break;
    }
    if (result.accepted) {
      remaining = --steps > 0 ? remaining - h : 0.0;
      part = std::min(1.0, 2.0 * part);
      continue;
    }
    part *= enforcement_->step_cut(scene_.method);
    if (part * longest < smallest) {
      reason_ = result.reason;
      break;
    }
  }
  collect();
  rest_after(dt);
  return remaining == 0.0;
}

bool Simulation::advance(double dt) {
  if (loop_) return advance_explicitly(dt);
  if (begins_ != is_beginning()) restart_scheme();
  const bool adaptive = scene_.step.adaptive && !scene_.method.statics;
  double remaining = dt, trial = adaptive ? control_.step(dt) : dt;
  const double smallest = scene_.step.smallest_fraction * dt;
  const double limit = part_of_limit * scene_.step.max_displacement;
  bool ended_at_entry = false;  // the last attempt was cut there: what comes next has its contact and may be long
  while (remaining > 0.0) {
    trial = std::min(trial, remaining);
    // Blocks that move on as they did must not exceed the largest displacement; equal parts of what remains cost least and suit every scheme.
    if (last_speed_ * trial > scene_.step.max_displacement) trial = std::max(remaining / std::ceil(last_speed_ * remaining / limit), smallest);
    const double now = scene_.method.statics ? trial : scheme_->stage(trial);
    const StepResult result = step(now, scene_.method.statics);
    if (result.accepted) {
      last_speed_ = result.moved / now;
      // A rest below rounding is no step.
      remaining = remaining - now > tolerance::rounding_of_times * dt ? remaining - now : 0.0;
      if (scheme_->is_within_step()) continue;
      if (adaptive) control_.accepted(trial, result.error);
      trial = adaptive ? control_.step(dt) : ended_at_entry ? remaining : 2.0 * trial;
      ended_at_entry = false;
      continue;
    }
    scheme_->abandon_step();
    ended_at_entry = result.ends_at_entry;
    if (result.too_wrong) {
      control_.refused(trial, result.error);
      trial = control_.step(dt);
    } else {
      trial *= result.part > 0.0 ? result.part : enforcement_->step_cut(scene_.method);
      if (adaptive) control_.shorten(trial);
    }
    if (trial < smallest) {
      reason_ = result.reason;
      return false;
    }
  }
  rest_after(dt);
  return true;
}

bool Simulation::is_beginning() const {
  return scene_.method.first_integrator && time_ < scene_.method.first_integrator_time * (1.0 - tolerance::rounding_of_times);
}

std::unique_ptr<TimeScheme> Simulation::make_scheme() const {
  std::unique_ptr<TimeScheme> scheme = enforcement_->make_time_scheme(scene_.method);  // for its complaints, too
  return begins_ ? enforcement_->make_time_scheme(method_at_first(scene_.method)) : std::move(scheme);
}

void Simulation::restart_scheme() {
  take_back();
  // A new scheme starts from whole-step velocities.
  for (int b : system_.free_blocks()) system_.set_velocity(b, output_velocity_[b]);
  begins_ = is_beginning();
  scheme_ = make_scheme();
  start_kinetic_energy_ = system_.kinetic_energy() + kinetic_ahead_ - ledger_.kinetic;
}

void Simulation::change_method(const MethodInput& method) {
  take_back();
  scene_.method = method;
  enforcement_ = make_enforcement(method);
  loop_ = enforcement_->is_explicit() ? std::make_unique<CentralDifference>(contact_skin_) : nullptr;
  restart_scheme();
}

void Simulation::come_to_rest() {
  take_back();
  const double dropped = system_.kinetic_energy() + kinetic_ahead_;
  kinetic_ahead_ = 0.0;
  ledger_.scheme += dropped;
  ledger_.kinetic -= dropped;
  system_.stop();
  output_velocity_ = system_.state().velocity;
  restart_scheme();
}

void Simulation::restart_clock() {
  take_back();
  time_ = 0.0;
  ledger_ = EnergyLedger();
  kinetic_ahead_ = 0.0;
  cuts_.restart_ledger();
  books_steps_ = true;
  max_penetration_ = friction_work_ = lagging_friction_work_ = 0.0;
  restart_scheme();
}

void Simulation::restore_velocities() {
  take_back();
  for (std::size_t b = 0; b < scene_.blocks.size(); ++b) output_velocity_[b] = BlockSystem::velocity_at_start(scene_.blocks[b]);
}

Simulation::Snapshot Simulation::save() {
  contacts();
  Snapshot snapshot{system_.state(), contacts_};
  snapshot.blocks.velocity = output_velocity_;
  return snapshot;
}

void Simulation::restore(const Snapshot& snapshot) {
  take_back();
  system_.restore(snapshot.blocks);
  contacts_ = snapshot.contacts;
  detector_.forget();
  may_rest_ = false;  // what is known of quiet blocks and their contacts is of another state
  contacts_current_ = true;
  output_velocity_ = snapshot.blocks.velocity;
  failed_attempts_ = 0;
  cuts_.forget();
  last_speed_ = held_step_ = 0.0;
  if (loop_) loop_ = std::make_unique<CentralDifference>(contact_skin_);
  restart_scheme();
}

bool Simulation::fits(const Snapshot& snapshot) const {
  const BlockSystem::State &own = system_.state(), &other = snapshot.blocks;
  return other.displacement.size() == own.displacement.size() && other.velocity.size() == own.velocity.size() && other.arm.size() == own.arm.size() &&
         other.point_arm.size() == own.point_arm.size() && Detector::contacts_fit(system_, joints_, snapshot.contacts);
}

void Simulation::exchange(Archive& archive) {
  archive(system_, resting_, may_rest_, external_, joints_, base_moves_, keep_bonds_, detector_, contacts_, contacts_current_, output_velocity_,
          time_, reason_, ledger_, start_kinetic_energy_, kinetic_ahead_, collected_contact_energy_, max_penetration_, friction_work_,
          lagging_friction_work_, step_counters_, failed_attempts_, cuts_, last_speed_, still_step_, step_ledger_, control_, begins_, approach_step_,
          held_step_);
  archive.require(detector_.fits(system_, joints_, contacts_), "the saved state has contacts of blocks that are not there");
  if (archive.reading()) scheme_ = make_scheme();
  scheme_->exchange(archive);
  enforcement_->exchange(archive);
  if (loop_) {
    loop_->exchange(archive, joints_, external_);
    archive(loop_is_ahead_, loop_is_loaded_);
  }
}

}  // namespace openclose
