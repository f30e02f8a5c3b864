#include "openclose/analysis/simulation_state.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "openclose/analysis/solved_step.h"
#include "openclose/core/tolerance.h"
#include "openclose/integrator/integrators.h"
#include "openclose/integrator/registry.h"
#include "openclose/scene/median_size.h"

namespace openclose {

namespace {

LengthsOfBlocks lengths_of(const Scene& scene) {
  LengthsOfBlocks lengths(scene.blocks);
  lengths.contact_skin = scene.method.contact_skin.value_or(lengths.contact_skin);
  lengths.longest_displacement = scene.step.max_displacement.value_or(lengths.longest_displacement);
  return lengths;
}

}  // namespace

LengthsOfBlocks::LengthsOfBlocks(const std::vector<BlockInput>& blocks) {
  const std::optional<double> size = median_size(blocks);
  if (!size) return;
  contact_skin = std::min(contact_skin, tolerance::contact_skin_of_size * *size);
  search_skin = std::min(search_skin, tolerance::search_skin_of_size * *size);
  longest_displacement = std::min(longest_displacement, tolerance::longest_displacement_of_size * *size);
}

SimulationState::SimulationState(Scene scene_to_follow, std::unique_ptr<Enforcement> own)
    : scene(std::move(scene_to_follow)),
      lengths(lengths_of(scene)),
      system(scene),
      external(scene, system),
      joints(scene),
      enforcement(own ? std::move(own) : make_enforcement(scene.method)),
      begins(scene.method.first_integrator.has_value()),
      // Two vertices may approach each other by the largest displacement each.
      detector(2.0 * lengths.longest_displacement,
               {scene.method.skip_search, scene.method.skip_narrow_phase && enforcement->follows_gaps(), scene.method.skip_looks,
                lengths.contact_skin, lengths.search_skin},
               enforcement->has_elastic_contacts() ? InheritedForces::as_they_were : InheritedForces::at_same_pressure),
      output_velocity(system.state().velocity),
      resting(scene.rest, system),
      start_kinetic_energy(system.kinetic_energy()),
      bytes_of_scene_(bytes_of_blocks(scene)) {
  make_scheme();
}

void SimulationState::take_back() {
  note_change();
  wake_all();
}

bool SimulationState::search(double lead) {
  // What touches in the drawing is found there.
  if (lead == 0.0 || !detector.knows_bonds()) return detector.update(system, joints, contacts);
  BlockSystem ahead = system;
  for (int b : system.free_blocks()) ahead.advance(b, lead * system.velocity(b));
  return detector.update(ahead, joints, contacts, &system);
}

void SimulationState::find_contacts(double lead) {
  if (contacts_current) return;
  const Stopwatch watch(stage_times.detection);
  const bool elastic = enforcement->has_elastic_contacts();
  const double before = elastic ? moving_contact_energy() : 0.0;
  contacts_current = true;
  if (!search(lead) || !elastic) return;
  store_changed_energies();
  const double change = moving_contact_energy() - before;
  ledger.redefinition -= change;
  ledger.contact_springs += change;
}

void SimulationState::store_changed_energies() {
  const StepProblem p = problem(scene.step.dt, false);
  for (const DetectionChange& change : detector.changes()) {
    for (int i = change.after.begin; i < change.after.end; ++i) store_energy(p, contacts.moving[i]);
  }
}

void SimulationState::store_energy(const StepProblem& problem, Contact& contact) const {
  const ContactSprings springs = enforcement->springs(problem, contact);
  const ContactForces f = spring_slider(springs, ContactStrength(joints.joint(contact.joint), contact), 0.0, 0.0);
  contact.stored_energy = openclose::stored_energy(springs.normal, springs.shear, f.normal, springs.initial_shear) - contact.crossing_energy;
}

StepProblem SimulationState::problem(double dt, bool statics) const {
  StepProblem p{system, external, joints, contacts.moving, scene.method};
  p.dt = dt;
  p.statics = statics;
  // A search for a factor may have no step in time; what it needs of a problem then does not depend on inertia.
  if (dt > 0.0) p.inertia = statics ? 2.0 / (dt * dt) : scheme->inertia(dt);
  p.end_weight = statics ? 1.0 : scheme->end_weight();
  p.bonds = bonds;
  p.longest_displacement = lengths.longest_displacement;
  if (!statics) p.scheme = scheme.get();
  return p;
}

bool SimulationState::move_base(double dt, bool statics) {
  const TimeSpan span = scheme->span_of_velocities(dt);
  if (base_moves && !statics) {
    external.move_base(time + span.from, time + span.to);
  } else {
    external.hold_base();
  }
  scheme->move_base(external.base_acceleration());
  return !external.base_acceleration().isZero(0.0) && !system.resting_blocks().empty();
}

void SimulationState::rest_after(double dt) {
  if (!may_rest) return;
  if (external.base_acceleration().isZero(0.0)) {
    resting.follow(system, output_velocity, dt);
  } else {
    resting.disturb(system);
  }
  const std::vector<int> quiet = resting.quiet_blocks(system, contacts.moving);
  if (quiet.empty()) return;
  note_change();
  const double before = system.kinetic_energy();
  system.put_to_rest(quiet);
  const double dropped = before - system.kinetic_energy();
  ledger.scheme += dropped;
  ledger.kinetic -= dropped;
  for (const int b : quiet) {
    output_velocity[b].setZero();
    scheme->forget(b);
  }
  resting.keep_forces(system, quiet, contacts);
  counters.put_to_rest += static_cast<long>(quiet.size());
  divide();
}

void SimulationState::wake(const std::vector<int>& blocks) {
  if (blocks.empty()) return;
  note_change();
  system.wake(blocks);
  contacts_current = false;
  divide();
}

void SimulationState::divide() {
  detector.divide(system, contacts);
  resting.divide(system, contacts.resting);
}

std::vector<int> SimulationState::to_wake(Resting::Urgency urgency) {
  if (system.resting_blocks().empty()) return {};
  std::vector<int> woken = resting.woken(system, contacts, urgency);
  if (urgency == Resting::Urgency::any) resting.accept(system);
  counters.woken += static_cast<long>(woken.size());
  return woken;
}

bool SimulationState::is_beginning() const {
  return scene.method.first_integrator && time < scene.method.first_integrator_time * (1.0 - tolerance::rounding_of_times);
}

void SimulationState::make_scheme() {
  scheme = enforcement->make_time_scheme(scene.method);  // for its complaints, too
  if (begins) scheme = enforcement->make_time_scheme(method_at_first(scene.method));
}

void SimulationState::restart_scheme() {
  take_back();
  for (int b : system.free_blocks()) system.set_velocity(b, output_velocity[b]);
  begins = is_beginning();
  make_scheme();
  start_kinetic_energy = system.kinetic_energy() + kinetic_ahead - ledger.kinetic;
}

double SimulationState::moving_contact_energy() const {
  double energy = 0.0;
  for (const Contact& c : contacts.moving) energy += c.stored_energy;
  return energy;
}

double SimulationState::stored_contact_energy() const {
  double energy = 0.0;
  contacts.for_each([&](const Contact& c) { energy += c.stored_energy; });
  return energy;
}

double SimulationState::force_scale() const {
  double scale = 0.0;
  for (int b : system.free_blocks()) scale = std::max(scale, external.weight(system, b).norm());
  if (scale > 0.0) return scale;
  for (const auto& element : external.elements()) {
    if (element->account() == ForceAccount::loads) scale = std::max(scale, element->magnitude(element->path(system, Unknowns::Zero())));
  }
  for (const Contact& c : contacts.moving) scale = std::max({scale, c.normal_force, std::abs(c.shear_force)});
  return scale > 0.0 ? scale : 1.0;
}

void SimulationState::book_kinetic_energy(double ahead) {
  ledger.scheme -= ahead - kinetic_ahead;
  kinetic_ahead = ahead;
  ledger.kinetic = system.kinetic_energy() + ahead - start_kinetic_energy;
}

void SimulationState::count_moves() {
  counters.block_steps += system.free_count();
  counters.block_steps_skipped += static_cast<long>(system.resting_blocks().size());
}

void SimulationState::note_memory(const Memory& of_stepper) {
  Memory now = enforcement->memory() + detector.memory() + of_stepper;
  now.blocks += bytes_of_scene_ + system.bytes() + bytes_of(output_velocity);
  now.contacts += contacts.bytes();
  memory.grow_to(now);
}

void SimulationState::judge(const Archive& archive) const {
  archive.require(detector.fits(system, joints, contacts), "the saved state has contacts of blocks that are not there");
  archive.require(resting.fits(system) && output_velocity.size() == system.blocks().size() && bonds <= Bonds::last_unparted,
                  "the saved state is of other blocks");
  archive.require(
      std::isfinite(time) && system.state().is_finite() && std::ranges::all_of(output_velocity, [](const Unknowns& v) { return v.allFinite(); }),
      "the saved state has blocks without a finite position or velocity");
  archive.require(ledger.is_finite() && std::isfinite(start_kinetic_energy) && std::isfinite(kinetic_ahead),
                  "the saved state has energies that are no numbers");
  archive.require(!joints.reduction() || (std::isfinite(*joints.reduction()) && *joints.reduction() > 0.0),
                  "the saved state has joints without a strength");
}

void SimulationState::exchange(Archive& archive) {
  archive(system, resting, may_rest, external, joints, base_moves, bonds, detector, contacts, contacts_current, output_velocity, time, reason, ledger,
          start_kinetic_energy, kinetic_ahead, max_penetration, friction_work, lagging_friction_work, fastest_weakening, counters, begins);
  judge(archive);
  if (archive.reading()) make_scheme();
  scheme->exchange(archive);
  enforcement->exchange(archive);
}

}  // namespace openclose
