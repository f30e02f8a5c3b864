// The contacts of a step as its solver works on them: how they stand at its start, where they are at a trial displacement of the blocks, what they
// carry there and on which piece of their law they are. The solution of a step owns them; whoever asks what the step did to a contact knows them as
// StepContacts.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/parts.h"
#include "openclose/integrator/step_contacts.h"

namespace openclose {

struct StepProblem;

/// The springs of contact c of a step.
using SpringsOf = std::function<ContactSprings(std::size_t c)>;
/// As they stand in a list, which must outlive what is returned.
inline SpringsOf springs_in(const std::vector<ContactSprings>& list) {
  return [&list](std::size_t c) { return list[c]; };
}

class ContactTrial : public StepContacts {
 public:
  /// Lays out those of a step, at its start. The places of blocks are their equations; those without have the one that comes after these.
  void prepare(const StepProblem& problem, const SpringsOf& springs);
  /// The same contacts with springs that differ only in what they carry at the start, in the gaps they keep and in their stiffness.
  void set_springs(const std::vector<ContactSprings>& springs);
  /// Those of a part of another system, whose places are given by place(of the whole).
  template <class Place>
  void take_part(const ContactTrial& whole, const Part& part, const Place& place);
  /// None, with most of the memory for the next step.
  void clear();
  /// [-] Part of the cohesion over which it comes in, in what is evaluated from now on: see ShearLimit.
  void set_cohesion_ramp(double ramp) { ramp_ = ramp; }

  using StepContacts::batches;
  std::vector<ContactBatch>& batches() { return batches_; }
  using StepContacts::branches;
  std::vector<Branch>& branches() { return branches_; }
  using StepContacts::moves;
  std::vector<BlockMove>& moves() { return moves_; }
  using StepContacts::start;
  ContactBatch& start(std::size_t c) { return batches_[c / batch_size]; }
  using StepContacts::trial;
  TrialBatch& trial(std::size_t c) { return trials_[c / batch_size]; }

  /// [N] Largest force of a spring at the start of the step, pulling ones not counted.
  double largest_force_at_start() const { return start_force_; }
  /// By the present moves. Adds to the rows; returns [N] the largest force.
  double evaluate(std::vector<ForceRow>& rows);
  void add_stiffness(const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix) const;
  /// What a step sees of the springs of contact c while it stays closed: half of them, if it averages over its path.
  ContactSprings seen_springs(std::size_t c) const;
  /// Contact c carries these forces in the next linear solve.
  void replace_forces(std::size_t c, const ContactForces& forces);
  /// Contacts that slide or are open keep a part of their springs in the next linear solve.
  /// \param holds          [-] the part, of all contacts
  /// \param friction_lags  leaves out for them that friction follows the normal force
  void hold(const std::vector<double>& holds, bool friction_lags);

  // What only the end of a step asks for.
  /// Of batches that were evaluated: the springs' parts of the forces and, where these are means over the path, what is carried at its end in their
  /// place.
  void finish();
  /// For methods that work contact by contact: contact c carries these forces after these changes of gap and slip [m].
  void set(std::size_t c, const CarriedForces& forces, double gap_change, double slip_change);
  /// The springs' parts of forces that were evaluated at their end.
  void find_elastic();
  /// The present forces, with the springs' parts, are those with which the step starts.
  void keep_start_forces();
  void set_slack(std::size_t c, double slack) {
    slack_.resize(count_);
    slack_[c] = slack;
  }

 private:
  void make_room();
  void forget_step();
  void find_paths();

  double ramp_ = tolerance::cohesion_ramp;  ///< [-]
  double start_force_ = 0.0;                ///< [N]
};

template <class Place>
void ContactTrial::take_part(const ContactTrial& whole, const Part& part, const Place& place) {
  averages_path_ = whole.averages_path_;
  ramp_ = whole.ramp_;
  count_ = part.contacts.size();
  batches_.assign((count_ + batch_size - 1) / batch_size, ContactBatch());
  const int nobody = place(static_cast<int>(whole.moves_.size()) - 1);
  for (std::size_t c = 0; c < batch_size * batches_.size(); ++c) {
    ContactBatch& batch = batches_[c / batch_size];
    const int k = lane(c);
    batch.set_places(k, nobody, nobody);
    if (c >= count_) continue;
    const auto of_whole = static_cast<std::size_t>(part.contacts[c]);
    batch.copy(k, whole.start(of_whole), lane(of_whole));
    const auto [vertex_of_whole, edge_of_whole] = whole.places(of_whole);
    const int vertex = place(vertex_of_whole), edge = place(edge_of_whole);
    batch.set_places(k, vertex, edge);
  }
  make_room();
}

}  // namespace openclose
