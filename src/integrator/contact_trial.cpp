#include "openclose/integrator/contact_trial.h"

#include <algorithm>
#include <cmath>

#include "openclose/integrator/enforcement.h"

namespace openclose {
namespace {

/// What the contacts of a step need of a block.
struct BlockPlace {
  Vec2 centroid;  ///< [m]
  int place;
};

std::vector<BlockPlace> places_of(const BlockSystem& system) {
  std::vector<BlockPlace> places(system.block_count());
  for (int b = 0; b < system.block_count(); ++b) {
    const int equation = system.block(b).equation;
    places[b] = {system.centroid(b), equation >= 0 ? equation : system.free_count()};
  }
  return places;
}

/// Sets all batches up to begin().
void lay_out(const StepProblem& problem, const SpringsOf& springs, std::vector<ContactBatch>& batches) {
  const std::size_t count = problem.contacts.size();
  resize_closely(batches, (count + batch_size - 1) / batch_size);
  const std::vector<BlockPlace> places = places_of(problem.system);
  for (std::size_t c = 0; c < count; ++c) {
    ContactBatch& batch = batches[c / batch_size];
    const int k = static_cast<int>(c % batch_size);
    const Contact& contact = problem.contacts[c];
    const BlockPlace &vertex = places[contact.vertex_block], &edge = places[contact.edge_block];
    batch.set_places(k, vertex.place, edge.place);
    batch.set_geometry(k, ContactPlace(problem.system, contact, vertex.centroid, edge.centroid));
    batch.set_strength(k, ContactStrength(problem.joints.joint(contact.joint), contact));
    batch.set_springs(k, springs(c));
  }
  for (std::size_t at = count; at < batch_size * batches.size(); ++at) {
    const int k = static_cast<int>(at % batch_size);
    batches.back().copy(k, ContactBatch(), 0);
    batches.back().set_places(k, problem.system.free_count(), problem.system.free_count());
  }
}

}  // namespace

void ContactTrial::prepare(const StepProblem& problem, const SpringsOf& springs) {
  forget_step();
  count_ = problem.contacts.size();
  lay_out(problem, springs, batches_);
  averages_path_ = problem.averages_path();
  start_force_ = begin(batches_);
  make_room();
  moves_.assign(static_cast<std::size_t>(problem.system.free_count()) + 1, BlockMove());
}

void ContactTrial::make_room() {
  resize_closely(trials_, batches_.size());
  branches_.assign(batch_size * batches_.size(), 0);
}

void ContactTrial::forget_step() {
  std::vector<ElasticBatch>().swap(elastic_);  // steps have parts of their own meanwhile
  start_forces_.clear();
  paths_.clear();
  slack_.clear();
}

void ContactTrial::clear() {
  forget_step();
  count_ = 0;
}

void ContactTrial::set_springs(const std::vector<ContactSprings>& springs) {
  forget_step();
  start_force_ = 0.0;
  for (std::size_t c = 0; c < count_; ++c) {
    const ContactSprings& s = springs[c];
    start(c).set_springs(lane(c), s);
    start_force_ = std::max({start_force_, s.shift - s.normal * (s.gap - s.target), std::abs(s.initial_shear)});
  }
}

double ContactTrial::evaluate(std::vector<ForceRow>& rows) {
  return openclose::evaluate(averages_path_, ramp_, batches_, moves_.data(), trials_, branches_, rows);
}

void ContactTrial::add_stiffness(const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix) const {
  openclose::add_stiffness(batches_, moves_.data(), trials_, branches_, tangent, slots, matrix);
}

ContactSprings ContactTrial::seen_springs(std::size_t c) const {
  ContactSprings springs = this->springs(c);
  if (averages_path()) {
    // The same force at the start of the step.
    springs.shift -= 0.5 * springs.normal * springs.gap;
    springs.normal *= 0.5;
    springs.shear *= 0.5;
  }
  return springs;
}

void ContactTrial::replace_forces(std::size_t c, const ContactForces& forces) {
  trial(c).set_forces(lane(c), forces);
  branches_[c] = branch(forces);
}

void ContactTrial::hold(const std::vector<double>& holds, bool friction_lags) {
  for (std::size_t c = 0; c < count_; ++c) {
    if (holds[c] == 0.0 || status(c) == ContactStatus::sticking) continue;
    const ContactBatch& contact = start(c);
    TrialBatch& at = trial(c);
    const int k = lane(c);
    at.shear_by_slip[k] -= holds[c] * contact.shear[k];
    if (status(c) == ContactStatus::open) at.normal_by_gap[k] -= holds[c] * contact.normal[k];
    if (friction_lags) at.shear_by_gap[k] = 0.0;
  }
}

void ContactTrial::set(std::size_t c, const CarriedForces& forces, double gap_change, double slip_change) {
  elastic_.resize(trials_.size());
  const int k = lane(c);
  TrialBatch& at = trial(c);
  at.gap_change[k] = gap_change;
  at.slip_change[k] = slip_change;
  at.normal[k] = forces.normal;
  at.shear[k] = forces.shear;
  elastic_[c / batch_size].normal[k] = forces.elastic_normal;
  elastic_[c / batch_size].shear[k] = forces.elastic_shear;
  branches_[c] = branch(forces);
}

void ContactTrial::find_elastic() {
  elastic_.resize(trials_.size());
  openclose::find_elastic(ramp_, batches_, trials_, elastic_);
}

void ContactTrial::find_paths() {
  for (std::size_t c = 0; c < count_; ++c) {
    const ContactSprings springs = this->springs(c);
    const double gap = gap_change(c), slip = slip_change(c);
    const PathAverage path = path_average(springs, strength(c), gap, slip, springs.dissipation);
    paths_.push_back({path.mean.normal, path.mean.shear, path.energies, force_pose(c)});
    set(c, path.end, gap, slip);
  }
}

void ContactTrial::finish() {
  averages_path() ? find_paths() : find_elastic();
}

void ContactTrial::keep_start_forces() {
  for (std::size_t c = 0; c < count_; ++c) start_forces_.push_back(forces(c));
}

}  // namespace openclose
