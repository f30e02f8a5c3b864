#include "openclose/analysis/explicit_stepper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [-] By which explicit steps may become longer before they do.
constexpr double worthwhile_growth = 1.1;

/// [-] Closure of an impact over the thickness of what it meets, to be aimed at with stiffer springs: a tenth is what dem promises to resolve.
constexpr double closure_of_thickness = 0.1;

}  // namespace

void ExplicitStepper::collect() {
  if (!is_ahead_) return;
  is_ahead_ = false;
  loop_->store_blocks(state_.system);
  for (int b : state_.system.free_blocks()) state_.output_velocity[b] = loop_->velocity_at_end(state_.system.block(b).equation);
  loop_->store_contacts(state_.contacts.moving);
  loop_->store_far_gaps(state_.system, state_.contacts.moving);
  state_.max_penetration = std::max(state_.max_penetration, loop_->max_penetration());
  state_.ledger += loop_->take_energies();
  const double stored = state_.moving_contact_energy();
  state_.ledger.contact_springs += stored - collected_contact_energy_;
  collected_contact_energy_ = stored;
  state_.book_kinetic_energy(loop_->kinetic_ahead());
}

void ExplicitStepper::forget() {
  held_step_ = 0.0;
  loop_ = std::make_unique<CentralDifference>(state_.lengths.contact_skin);
  is_ahead_ = false;
  loaded_since_ = never;
}

void ExplicitStepper::load() {
  if (is_loaded() && state_.contacts_current) return;
  approach_step_.reset();
  if (!is_loaded() || !renew()) {
    collect();
    state_.find_contacts();
    loop_->load(state_.problem(state_.scene.step.dt, false));
    collected_contact_energy_ = state_.moving_contact_energy();
    loaded_since_ = state_.changes;
    ++state_.counters.loads;
    state_.note_memory(loop_->memory());
  }
  double& smallest = state_.counters.smallest_critical_step;
  smallest = smallest > 0.0 ? std::min(smallest, loop_->critical_step()) : loop_->critical_step();
}

bool ExplicitStepper::renew() {
  if (!state_.scene.method.skip_reload || !loop_->can_renew()) return false;
  loop_->store_blocks(state_.system);
  if (state_.detector.needs_search(state_.system)) return false;
  {
    const Stopwatch watch(state_.stage_times.detection);
    loop_->store_contacts(state_.contacts.moving);
    state_.contacts_current = true;
    if (!state_.detector.update(state_.system, state_.joints, state_.contacts)) {
      loop_->keep();
      return true;
    }
  }
  state_.store_changed_energies();
  loop_->renew(state_.problem(state_.scene.step.dt, false), state_.detector.changes());
  is_ahead_ = true;  // its energies are
  ++state_.counters.loads_skipped;
  return true;
}

double ExplicitStepper::approach_step() {
  if (!approach_step_) {
    loop_->store_blocks(state_.system);
    approach_step_ = approach_bound_.step(state_.system, state_.joints, state_.detector.candidate_pairs(), loop_->approach(),
                                          state_.lengths.contact_skin, state_.scene.method.step_fraction);
  }
  return *approach_step_;
}

std::string ExplicitStepper::too_deep() {
  const auto found = loop_->too_deep();
  if (!found) return {};
  const Contact& c = state_.contacts.moving[found->contact];
  // The closure of an impact falls with the root of the stiffness.
  const double wanted = closure_of_thickness * found->limit / DepthLimits::part, factor = found->depth / wanted;
  return fmt::format(
      "the springs are too soft for these blocks: a corner of \"{}\" has come {:.2g} m into \"{}\", which is {:.2g} m thick there; "
      "joint[{}].normal_stiffness_pa_per_m = {:.2g} or more would be a remedy",
      state_.scene.blocks[c.vertex_block].name, found->depth, state_.scene.blocks[c.edge_block].name, found->limit / DepthLimits::part, c.joint,
      state_.joints.joint(c.joint).normal_stiffness * factor * factor);
}

double ExplicitStepper::critical_step() {
  load();
  collect();
  return loop_->critical_step();
}

double ExplicitStepper::unbalanced_force(double heaviest) {
  load();
  return loop_->unbalanced_force(heaviest);
}

double ExplicitStepper::longest_stable_step(MassDamping damping) {
  load();
  const MethodInput& method = state_.scene.method;
  const double stable = method.step_fraction * loop_->critical_step(damping == MassDamping::local ? method.local_damping : 0.0);
  const double found_in_time = loop_->is_fast() ? approach_step() : std::numeric_limits<double>::infinity();
  const auto longest = [&](double way) { return std::min({stable, found_in_time, loop_->step_within(way)}); };
  // Each change of the step has its price; blocks may become faster before the next one.
  const double limit = state_.lengths.longest_displacement, with_room = longest(limit / worthwhile_growth);
  if (longest(limit) < held_step_ || with_room > worthwhile_growth * held_step_) held_step_ = with_room;
  return held_step_;
}

Move ExplicitStepper::move(double h, MassDamping damping, bool any_length) {
  const double span = 1.0 / (h * state_.scheme->inertia(h));
  const auto with = [&](double fast_step) {
    return loop_->move(h, span, state_.external.base_acceleration(), state_.lengths.longest_displacement, fast_step, damping,
                       state_.scene.method.local_damping);
  };
  // What the step would do is known only now.
  constexpr double any = std::numeric_limits<double>::infinity(), rounding = 1.0 + tolerance::rounding_of_times;
  const Move moved = with(any_length ? any : rounding * approach_step_.value_or(0.0));
  return moved == Move::too_fast ? with(rounding * approach_step()) : moved;
}

StepResult ExplicitStepper::step(double h, MassDamping damping, bool any_length) {
  if (state_.move_base(h, false)) {
    collect();
    state_.wake_all();
  }
  load();
  const Move moved = move(h, damping, any_length);
  if (moved == Move::taken) return take(h);
  StepResult result;
  if (moved == Move::too_far) {
    result.reason = "a block moved farther in one step than step.max_displacement_m";
    ++state_.counters.cuts;
  } else {
    state_.contacts_current &= moved != Move::past_list;
    result.relisted = true;
  }
  return result;
}

StepResult ExplicitStepper::take(double h) {
  loop_->follow_contacts();
  is_ahead_ = true;
  StepResult result;
  result.reason = too_deep();
  result.stops = !result.reason.empty();
  state_.scheme->accept(h);
  state_.time += h;
  StepCounters& counters = state_.counters;
  ++counters.steps;
  counters.longest_step = std::max(counters.longest_step, h);
  result.accepted = true;
  result.unbalanced_force = loop_->last_unbalanced_force();
  result.lost_strength = loop_->lost_strength();
  if (loop_->moved_beyond_skin()) state_.contacts_current = false;
  state_.count_moves();
  if (!state_.system.resting_blocks().empty()) wake_by_forces(h);
  return result;
}

void ExplicitStepper::wake_by_forces(double h) {
  loop_->rest_forces(state_.resting.pushes(state_.system));
  state_.resting.judge(state_.system, h);
  const std::vector<int> woken = state_.to_wake(Resting::Urgency::any);
  if (woken.empty()) return;
  collect();
  state_.wake(woken);
}

StepResult ExplicitStepper::step_of_any_length(double h) {
  StepResult taken = step(h, state_.scene.method.damping, true);
  while (taken.relisted) taken = step(h, state_.scene.method.damping, true);
  collect();
  return taken;
}

bool ExplicitStepper::advance(double dt) {
  const MassDamping damping = state_.scene.method.damping;
  double remaining = dt, longest = 0.0, part = 1.0;
  for (long steps = 0; remaining > 0.0;) {  // equal ones, of the remaining time
    const double now = part * std::min(longest_stable_step(damping), dt);
    if (!(now > std::numeric_limits<double>::epsilon() * dt)) {  // no sum of times would grow by it
      state_.reason = fmt::format("the stable step of the springs, {:.2g} s, is nothing beside step.dt_s; softer joints would be a remedy", now);
      break;
    }
    if (steps == 0 || now != longest) {
      longest = now;
      // A quotient that is whole but for rounding stays whole.
      steps = std::max(1L, std::lround(std::ceil(remaining / longest * (1.0 - tolerance::rounding_of_times))));
    }
    const double h = remaining / static_cast<double>(steps);
    if (!state_.system.resting_blocks().empty() && state_.move_base(h, false)) {  // the step may be too long for those that it wakes
      collect();
      state_.wake_all();
      steps = 0;
      continue;
    }
    StepResult result;
    {
      const Stopwatch watch(state_.stage_times.solution);
      result = step(h, damping);
    }
    if (result.relisted) {
      steps = 0;
      continue;
    }
    if (result.stops) {
      state_.reason = result.reason;
      break;
    }
    if (result.accepted) {
      remaining = --steps > 0 ? remaining - h : 0.0;
      part = std::min(1.0, 2.0 * part);
      continue;
    }
    part *= state_.enforcement->step_cut(state_.scene.method);
    if (part < state_.scene.step.smallest_fraction) {
      state_.reason = result.reason;
      break;
    }
  }
  collect();
  state_.rest_after(dt);
  return remaining == 0.0;
}

void ExplicitStepper::exchange(Archive& archive) {
  bool loaded = is_loaded();
  archive(collected_contact_energy_, approach_step_, held_step_, is_ahead_, loaded);
  loaded_since_ = loaded ? state_.changes : never;
  loop_->exchange(archive, state_.joints, state_.external);
  // What is not loaded is loaded before it is used.
  archive.require(loaded ? loop_->fits(state_.system, state_.contacts.moving.size()) : !is_ahead_,
                  "the saved state has explicit steps of other blocks or contacts");
}

}  // namespace openclose
