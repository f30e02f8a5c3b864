#include "openclose/integrator/step_contacts.h"

#include <algorithm>
#include <cmath>

namespace openclose {

void StepContacts::prepare(const StepProblem& problem, const SpringSource& springs) {
  count_ = problem.contacts.size();
  openclose::lay_out(problem, springs, *starts_);
  step_forces_ = problem.averages_path() ? StepForces::averaged : StepForces::at_end;
  start_force_ = begin(batches());
  make_room();
  moves_.assign(static_cast<std::size_t>(problem.system.free_count()) + 1, BlockMove());
}

void StepContacts::make_room() {
  resize_closely(trials_, batches().size());
  branches_.assign(batch_size * batches().size(), 0);
}

void StepContacts::set_springs(const std::vector<ContactSprings>& springs) {
  start_force_ = 0.0;
  for (std::size_t c = 0; c < count_; ++c) {
    const ContactSprings& s = springs[c];
    batches()[c / batch_size].set_springs(lane(c), s);
    start_force_ = std::max({start_force_, s.shift - s.normal * (s.gap - s.target), std::abs(s.initial_shear)});
  }
}

double StepContacts::evaluate(std::vector<ForceRow>& rows) {
  return openclose::evaluate(step_forces_, ramp_, batches(), moves_.data(), rounding_of_sums, trials_, branches_, rows);
}

void StepContacts::add_stiffness(const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix) const {
  openclose::add_stiffness(batches(), moves_.data(), trials_, branches_, tangent, slots, matrix);
}

ContactSprings StepContacts::seen_springs(std::size_t c) const {
  ContactSprings springs = this->springs(c);
  if (averages_path()) {
    // The same force at the start of the step.
    springs.shift -= 0.5 * springs.normal * springs.gap;
    springs.normal *= 0.5;
    springs.shear *= 0.5;
  }
  return springs;
}

void StepContacts::set_forces(std::size_t c, const ContactForces& forces) {
  trial(c).set_forces(lane(c), forces);
  branches_[c] = branch(forces);
}

void StepContacts::hold(const std::vector<double>& holds, bool friction_lags) {
  for (std::size_t c = 0; c < count_; ++c) {
    if (holds[c] == 0.0 || status(branches_[c]) == ContactStatus::sticking) continue;
    const ContactBatch& contact = start(c);
    TrialBatch& at = trial(c);
    const int k = lane(c);
    at.shear_by_slip[k] -= holds[c] * contact.shear[k];
    if (status(branches_[c]) == ContactStatus::open) at.normal_by_gap[k] -= holds[c] * contact.normal[k];
    if (friction_lags) at.shear_by_gap[k] = 0.0;
  }
}

std::vector<ElasticBatch> StepContacts::report_paths(StepSolution& solution) {
  std::vector<ElasticBatch> elastic(trials_.size());
  for (std::size_t c = 0; c < count_; ++c) {
    const ContactSprings springs = this->springs(c);
    TrialBatch& at = trial(c);
    const int k = lane(c);
    const PathAverage path = path_average(springs, strength(c), at.gap_change[k], at.slip_change[k], springs.dissipation);
    solution.paths.push_back({path.mean.normal, path.mean.shear, path.energies, force_pose(c)});
    at.normal[k] = path.end.normal;
    at.shear[k] = path.end.shear;
    elastic[c / batch_size].normal[k] = path.end.elastic_normal;
    elastic[c / batch_size].shear[k] = path.end.elastic_shear;
    branches_[c] = branch(path.end);
  }
  return elastic;
}

std::vector<ElasticBatch> StepContacts::elastic_parts() const {
  std::vector<ElasticBatch> elastic(trials_.size());
  find_elastic(ramp_, batches(), trials_, elastic);
  return elastic;
}

void StepContacts::lend(StepSolution& solution) {
  solution.paths.clear();
  solution.contacts.borrow(starts_, moves_, trials_, branches_, averages_path() ? report_paths(solution) : elastic_parts());
}

void StepContacts::take_back(ContactOutcomes& outcomes) {
  outcomes.give_back(moves_, trials_, branches_);
  if (starts_.use_count() > 1) starts_ = std::make_shared<ContactStarts>(*starts_);
}

Memory StepContacts::memory() const {
  Memory of;
  of.blocks = bytes_of(moves_);
  of.contacts = bytes_of(trials_, branches_) + starts_->bytes();
  return of;
}

void StepContacts::report_start(StepSolution& solution) const {
  solution.start_contacts.copy(starts_, moves_, trials_, branches_, elastic_parts());
}

}  // namespace openclose
