#include "openclose/integrator/contact_layout.h"

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

}  // namespace

void lay_out(const StepProblem& problem, const SpringSource& springs, std::vector<ContactBatch>& batches) {
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
    batch.set_springs(k, springs.make(c));
  }
  for (std::size_t at = count; at < batch_size * batches.size(); ++at) {
    const int k = static_cast<int>(at % batch_size);
    batches.back().copy(k, ContactBatch(), 0);
    batches.back().set_places(k, problem.system.free_count(), problem.system.free_count());
  }
}

}  // namespace openclose
