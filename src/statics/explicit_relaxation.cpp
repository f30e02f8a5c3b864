#include "openclose/statics/explicit_relaxation.h"

#include <algorithm>
#include <cmath>

#include "openclose/statics/relaxation.h"
#include "openclose/statics/weakening_pace.h"

namespace openclose {
namespace {

/// Unit of time: with the inertia of the constructor no frequency is above 1, so that this is half the critical step. A contact that closes in a
/// step then returns at most what it has taken.
constexpr double time_step = 1.0;
constexpr long steps_between_checks = 100;
constexpr long first_judgement = 20000;  ///< steps; most systems settle in a tenth of them
constexpr long between_judgements = 4;   ///< [-] ratio of the steps at two of them
constexpr double most_travel = 1e3;      ///< in closures: what has gone so far from its last equilibrium moves on

/// Rows of the stiffness matrix of closed, sticking contacts by the sums of their magnitudes: a bound of its eigenvalues over them (Gershgorin).
std::vector<BlockVector> stiffness_sums(const FrozenSystem& system) {
  std::vector<BlockVector> sums(system.blocks().size(), BlockVector::Zero());
  for (const FrozenContact& c : system.contacts()) {
    const double normal_way = (c.a >= 0 ? c.normal_a.lpNorm<1>() : 0.0) + (c.b >= 0 ? c.normal_b.lpNorm<1>() : 0.0);
    const double shear_way = (c.a >= 0 ? c.shear_a.lpNorm<1>() : 0.0) + (c.b >= 0 ? c.shear_b.lpNorm<1>() : 0.0);
    if (c.a >= 0) sums[c.a] += c.normal_stiffness * normal_way * c.normal_a.cwiseAbs() + c.shear_stiffness * shear_way * c.shear_a.cwiseAbs();
    if (c.b >= 0) sums[c.b] += c.normal_stiffness * normal_way * c.normal_b.cwiseAbs() + c.shear_stiffness * shear_way * c.shear_b.cwiseAbs();
  }
  for (const FrozenSupport& s : system.supports()) sums[s.row] += s.stiffness * s.direction.lpNorm<1>() * s.direction.cwiseAbs();
  return sums;
}

}  // namespace

ExplicitRelaxation::ExplicitRelaxation(const FrozenSystem& system, const FrozenStrength& strength, double local_damping, long most_steps)
    : system_(system),
      strength_(strength),
      local_damping_(local_damping),
      most_steps_(most_steps),
      inertia_(stiffness_sums(system)),
      contacts_(system) {
  // What no spring holds in a direction has its own mass there.
  for (std::size_t b = 0; b < inertia_.size(); ++b) {
    for (int k = 0; k < 3; ++k) {
      if (!(inertia_[b][k] > 0.0)) inertia_[b][k] = std::max(system.blocks()[b].mass[k], system.blocks()[b].weight);
    }
  }
}

RelaxationResult ExplicitRelaxation::bonded_state() {
  return settle(FrozenState(system_), ShearLaw::elastic, Effort::full);
}

/// On the way waves open contacts that equilibrium keeps closed, so joints keep their bonds until rest; what is open or slides there loses them, and
/// the rest settles again.
RelaxationResult ExplicitRelaxation::relax(const FrozenState& from, Effort effort) {
  RelaxationResult result = settle(from, ShearLaw::coulomb, effort);
  FrozenState start = from;
  WeakeningPace pace;
  pace.restart(from.contacts.size());
  while (result.end == RelaxationEnd::stable) {
    note_slip(start, result.state);
    pace.prolong(strength_, result.state, true);
    const double lost = lose_strength(strength_, result.state);
    if (lost == 0.0 || (lost < 1.0 && check_equilibrium(system_, strength_, result.state).holds())) break;
    // Bonds are lost one by one and no more than there are; what goes little by little may go on without end.
    if (lost < 1.0 && result.steps >= share_of(effort, most_steps_)) {
      result.end = RelaxationEnd::undecided;
      break;
    }
    const long steps = result.steps;
    start = result.state;
    result = settle(start, ShearLaw::coulomb, effort);
    result.steps += steps;
  }
  if (result.end == RelaxationEnd::stable) pace.give_back(system_.closure_unit(), result.state);
  result.travel = std::max(result.travel, farthest_between(result.state, from));
  return result;
}

void ExplicitRelaxation::note_slip(const FrozenState& from, FrozenState& state) const {
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const FrozenContact& c = system_.contacts()[i];
    FrozenContactState& now = state.contacts[i];
    if (!strength_.can_lose(i, now.joint_state)) continue;
    double slip = 0.0;
    if (c.a >= 0) slip += c.shear_a.dot(state.displacement[c.a] - from.displacement[c.a]);
    if (c.b >= 0) slip += c.shear_b.dot(state.displacement[c.b] - from.displacement[c.b]);
    FrozenContactState whole = now;
    whole.shear = from.contacts[i].shear - c.shear_stiffness * slip;
    if (now.status == ContactStatus::sticking && !is_within_strength(strengths_[i], whole)) now.status = ContactStatus::sliding;
    now.slip = (now.shear - whole.shear) / c.shear_stiffness;
  }
}

/// What `dem` has not brought to rest is judged by the viscous increments from the same state: nothing counts as failed without a mechanism.
bool ExplicitRelaxation::fails(const FrozenState& from, ShearLaw law, Effort effort, RelaxationResult& result) const {
  Relaxation judge(system_, strength_, IncrementRule::newton);
  judge.set_interruption(interruption_);
  RelaxationResult judged = law == ShearLaw::elastic ? judge.bonded_state() : judge.relax(from, effort);
  if (judged.end != RelaxationEnd::mechanism) return false;
  result.end = RelaxationEnd::mechanism;
  result.mechanism = std::move(judged.mechanism);
  result.state = std::move(judged.state);  // in which joints may have broken
  return true;
}

RelaxationResult ExplicitRelaxation::settle(const FrozenState& from, ShearLaw law, Effort effort) {
  RelaxationResult result;
  result.state = from;
  begin(from, law);
  long judgement = first_judgement;
  bool was_away = false;
  while (result.steps < share_of(effort, most_steps_)) {
    if (interruption_) interruption_();
    for (long k = 0; k < steps_between_checks; ++k) move(law, result.state);
    read_contacts(result.state);
    result.steps += steps_between_checks;
    steps_ += steps_between_checks;
    result.travel = farthest_between(result.state, from);
    const EquilibriumCheck check = check_equilibrium(system_, strength_, result.state);
    if (law == ShearLaw::elastic ? check.in_balance() : check.holds()) {
      result.end = RelaxationEnd::stable;
      return result;
    }
    const bool escaped = !(result.travel <= most_travel);
    if (result.steps >= judgement || (escaped && !was_away)) {
      if (fails(from, law, effort, result)) return result;
      judgement *= between_judgements;
    }
    was_away |= escaped;
    // Springs alone bring back what is elastic, from however far away: a slender column sways by a thousand closures and more.
    if (escaped && !(law == ShearLaw::elastic && std::isfinite(result.travel))) {
      result.end = RelaxationEnd::escaped;
      return result;
    }
  }
  return result;
}

void ExplicitRelaxation::begin(const FrozenState& from, ShearLaw law) {
  velocity_ = force_ = Eigen::VectorXd::Zero(3 * (system_.rows() + 1));
  strengths_.clear();
  for (std::size_t i = 0; i < from.contacts.size(); ++i) {
    strengths_.push_back(strength_.of(i, from.contacts[i].joint_state));
    contacts_.set_strength(i, strengths_[i]);
    contacts_.start(i, from.contacts[i]);
  }
  contacts_.evaluate(velocity_.data(), law, force_.data());
}

/// One step: forces move the blocks, and their motion gives the next forces.
void ExplicitRelaxation::move(ShearLaw law, FrozenState& state) {
  for (std::size_t i = 0; i < state.supports.size(); ++i) {
    force_.segment<3>(3 * system_.supports()[i].row) += state.supports[i] * system_.supports()[i].direction;
  }
  for (int b = 0; b < system_.rows(); ++b) {
    const BlockVector force = system_.blocks()[b].load + force_.segment<3>(3 * b);
    for (int k = 0; k < 3; ++k) {
      double& v = velocity_[3 * b + k];
      const double damping = v == 0.0 ? 0.0 : std::copysign(local_damping_ * std::abs(force[k]), v);
      v += time_step * (force[k] - damping) / inertia_[b][k];
    }
    state.displacement[b] += time_step * velocity_.segment<3>(3 * b);
  }
  force_.setZero();
  static_assert(time_step == 1.0, "contacts follow the velocities");
  contacts_.follow(velocity_.data(), law, force_.data());
  for (std::size_t i = 0; i < state.supports.size(); ++i) {
    const FrozenSupport& s = system_.supports()[i];
    state.supports[i] -= s.stiffness * time_step * s.direction.dot(velocity_.segment<3>(3 * s.row));
  }
}

void ExplicitRelaxation::read_contacts(FrozenState& state) const {
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const ContactResponse r = contacts_.response(i);
    FrozenContactState& s = state.contacts[i];
    s.gap = contacts_.gap(i);
    s.normal = r.normal;
    s.shear = r.shear;
    s.status = r.status();
  }
}

}  // namespace openclose
