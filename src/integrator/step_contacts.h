// The contacts of a step while it is solved for: where they are at a trial displacement of the blocks, what they carry there and on which piece of
// their law they are. Four at a time, in the batches of contact_batch.h; one by one for those who ask.
#pragma once

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/contact_batch.h"
#include "openclose/integrator/contact_layout.h"
#include "openclose/integrator/enforcement.h"
#include "openclose/integrator/parts.h"

namespace openclose {

/// [-] Rounding errors of this many units in the last place may meet in one residual: a dozen products and sums per contact.
inline constexpr double rounding_units = 16.0;
inline constexpr double rounding_of_sums = rounding_units * std::numeric_limits<double>::epsilon();

class StepContacts {
 public:
  /// Lays out those of a step, at its start.
  void prepare(const StepProblem& problem, const SpringSource& springs);
  /// The same contacts with springs that differ only in what they carry at the start, in the gaps they keep and in their stiffness.
  void set_springs(const std::vector<ContactSprings>& springs);
  /// Those of a part of another system, whose places are given by place(of the whole).
  /// \return the places of the blocks of each
  template <class Place>
  std::vector<std::pair<int, int>> take_part(const StepContacts& whole, const Part& part, const Place& place);
  /// [N] Largest force of a spring at the start of the step, pulling ones not counted.
  double largest_force_at_start() const { return start_force_; }
  /// [-] Part of the cohesion over which it comes in, in what is evaluated from now on: see ShearLimit.
  void set_cohesion_ramp(double ramp) { ramp_ = ramp; }

  /// By the present moves. Adds to the rows; returns [N] the largest force.
  double evaluate(std::vector<ForceRow>& rows);
  void add_stiffness(const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix) const;

  std::size_t count() const { return count_; }
  bool averages_path() const { return step_forces_ == StepForces::averaged; }
  StepForces step_forces() const { return step_forces_; }
  std::vector<BlockMove>& moves() { return moves_; }
  const std::vector<BlockMove>& moves() const { return moves_; }
  /// Of all contacts, and of the places of the last batch that have none.
  std::vector<Branch>& branches() { return branches_; }
  const std::vector<Branch>& branches() const { return branches_; }
  std::vector<ContactBatch>& batches() { return starts_->batches; }
  const std::vector<ContactBatch>& batches() const { return starts_->batches; }
  const std::vector<TrialBatch>& trials() const { return trials_; }
  // Contact c of the problem is one of the lanes of its batch.
  static int lane(std::size_t c) { return static_cast<int>(c % batch_size); }
  const ContactBatch& start(std::size_t c) const { return starts_->batches[c / batch_size]; }
  TrialBatch& trial(std::size_t c) { return trials_[c / batch_size]; }
  const TrialBatch& trial(std::size_t c) const { return trials_[c / batch_size]; }
  /// Places of its two blocks.
  std::pair<int, int> places(std::size_t c) const { return {start(c).vertex_place(lane(c)), start(c).edge_place(lane(c))}; }
  ContactForces forces(std::size_t c) const { return trial(c).forces(lane(c), branches_[c]); }
  ContactPose pose(std::size_t c) const { return start(c).pose(lane(c), moves_); }
  /// The forces act along its normal and tangent, at its arms.
  ContactPose force_pose(std::size_t c) const { return averages_path() ? mean_pose(start(c).start(lane(c)), pose(c)) : pose(c); }
  ContactStrength strength(std::size_t c) const { return start(c).strength(lane(c)); }
  /// With the gap counted from their target.
  ContactSprings springs(std::size_t c) const { return start(c).springs(lane(c)); }
  /// What a step sees of them while the contact stays closed: half of them, if it averages over its path.
  ContactSprings seen_springs(std::size_t c) const;

  /// Contact c carries these forces in the next linear solve.
  void set_forces(std::size_t c, const ContactForces& forces);
  /// Contacts that slide or are open keep a part of their springs in the next linear solve.
  /// \param holds          [-] the part, of all contacts
  /// \param friction_lags  leaves out for them that friction follows the normal force
  void hold(const std::vector<double>& holds, bool friction_lags);

  /// The solution has the contacts' outcomes from here until the next step.
  void lend(StepSolution& solution);
  /// Takes back what outcomes have, so that the next step can be laid out in it.
  void take_back(ContactOutcomes& outcomes);
  /// What contacts carry at the start of the step goes to the solution.
  void report_start(StepSolution& solution) const;

  Memory memory() const;

 private:
  void make_room();
  /// The means over the path go to the solution, the forces at its end take their place.
  std::vector<ElasticBatch> report_paths(StepSolution& solution);
  std::vector<ElasticBatch> elastic_parts() const;

  double ramp_ = tolerance::cohesion_ramp;  ///< [-]
  std::size_t count_ = 0;
  double start_force_ = 0.0;  ///< [N]
  /// Of the problem's contacts, in statics in the order of the list. Steps that are known by their outcomes have them, too: where they still do,
  /// the next step has others.
  std::shared_ptr<ContactStarts> starts_ = std::make_shared<ContactStarts>();
  std::vector<BlockMove> moves_;                 ///< at the trial displacement: of the rows, of others that a part sees, and of what stays
  StepForces step_forces_ = StepForces::at_end;  ///< what trials_ has
  std::vector<TrialBatch> trials_;
  std::vector<Branch> branches_;
};

template <class Place>
std::vector<std::pair<int, int>> StepContacts::take_part(const StepContacts& whole, const Part& part, const Place& place) {
  step_forces_ = whole.step_forces_;
  ramp_ = whole.ramp_;
  count_ = part.contacts.size();
  batches().assign((count_ + batch_size - 1) / batch_size, ContactBatch());
  std::vector<std::pair<int, int>> ends;
  const int nobody = place(static_cast<int>(whole.moves_.size()) - 1);
  for (std::size_t c = 0; c < batch_size * batches().size(); ++c) {
    ContactBatch& batch = batches()[c / batch_size];
    const int k = lane(c);
    batch.set_places(k, nobody, nobody);
    if (c >= count_) continue;
    const auto of_whole = static_cast<std::size_t>(part.contacts[c]);
    batch.copy(k, whole.start(of_whole), lane(of_whole));
    const auto [vertex_of_whole, edge_of_whole] = whole.places(of_whole);
    const int vertex = place(vertex_of_whole), edge = place(edge_of_whole);
    batch.set_places(k, vertex, edge);
    ends.emplace_back(vertex, edge);
  }
  make_room();
  return ends;
}

}  // namespace openclose
