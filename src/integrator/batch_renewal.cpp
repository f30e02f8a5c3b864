#include "openclose/integrator/batch_renewal.h"

#include <algorithm>

namespace openclose {

std::vector<BatchRenewal::BlockPlace> BatchRenewal::places_of(const BlockSystem& system) {
  std::vector<BlockPlace> places(system.block_count());
  for (int b = 0; b < system.block_count(); ++b) {
    const int equation = system.block(b).equation;
    places[b] = {system.centroid(b), equation >= 0 ? equation : system.free_count()};
  }
  return places;
}

void BatchRenewal::renew(const StepProblem& problem, const SpringSource& springs, ContactStarts& starts) {
  std::vector<ContactBatch>& batches = starts.batches;
  const Step step{problem.dt, problem.end_weight, problem.statics, problem.averages_path(), problem.joints.reduction()};
  const bool last = springs.last();
  if (!last || !(step == step_)) owners_.clear();
  step_ = step;
  const std::size_t count = starts.count = problem.contacts.size();
  if (last) resize_closely(owners_, count);
  resize_closely(batches, (count + batch_size - 1) / batch_size);
  const Contact* const contacts = problem.contacts.data();
  const std::vector<BlockPlace> place_of = places_of(problem.system);
  const BlockPlace* const places = place_of.data();
  const ContactSprings* const given = springs.list();
  Owner* const owners = owners_.data();
  for (std::size_t c = 0; c < count; ++c) {
    ContactBatch& batch = batches[c / batch_size];
    const int k = static_cast<int>(c % batch_size);
    const Contact& contact = contacts[c];
    const BlockPlace &vertex = places[contact.vertex_block], &edge = places[contact.edge_block];
    batch.set_places(k, vertex.place, edge.place);
    batch.set_geometry(k, ContactPlace(problem.system, contact, vertex.centroid, edge.centroid));
    if (last) {
      const Owner owner(contact);
      if (owner == owners[c]) {
        batch.set_start(k, contact);
        continue;
      }
      owners[c] = owner;
    }
    batch.set_strength(k, ContactStrength(problem.joints.joint(contact.joint), contact));
    if (given) {
      batch.set_springs(k, given[c]);
    } else {
      batch.set_springs(k, springs.make(c));
    }
  }
  for (std::size_t at = count; at < batch_size * batches.size(); ++at) {
    const int k = static_cast<int>(at % batch_size);
    batches.back().copy(k, ContactBatch(), 0);
    batches.back().set_places(k, problem.system.free_count(), problem.system.free_count());
  }
}

}  // namespace openclose
