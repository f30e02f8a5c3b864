// The contacts of a step: how they stand at its start, where they are at a trial displacement of the blocks, what they carry there and on which piece
// of their law they are; at the end of the step, what they did. The solution of a step owns them, its solver works on them, and whoever asks what the
// step did to a contact reads it here. Four at a time, in the batches of contact_batch.h; one by one for those who ask.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "openclose/contact/mean_pose.h"
#include "openclose/core/memory.h"
#include "openclose/core/tolerance.h"
#include "openclose/integrator/contact_batch.h"
#include "openclose/integrator/contact_layout.h"
#include "openclose/integrator/parts.h"
#include "openclose/law/path_average.h"

namespace openclose {

/// [-] Rounding errors of this many units in the last place may meet in one residual: a dozen products and sums per contact.
inline constexpr double rounding_units = 16.0;
inline constexpr double rounding_of_sums = rounding_units * std::numeric_limits<double>::epsilon();

/// What one contact did in a step: what the energy ledger and the contact's history need of it.
struct ContactOutcome {
  double normal_stiffness = 0.0, shear_stiffness = 0.0;  ///< [N/m] of its springs
  CarriedForces forces;                                  ///< at the end of the step
  ContactPose pose;                                      ///< whose gradients carried these forces in the equation of motion
};

/// What one contact carried on the average of a step, for schemes that average over its path.
struct PathOutcome {
  double normal = 0.0, shear = 0.0;  ///< [N]
  PathEnergies energies;
  ContactPose pose;  ///< the mean one, whose gradients carried the forces
};

class ContactTrial {
 public:
  /// Lays out those of a step, at its start.
  void prepare(const StepProblem& problem, const SpringSource& springs);
  /// The same contacts with springs that differ only in what they carry at the start, in the gaps they keep and in their stiffness.
  void set_springs(const std::vector<ContactSprings>& springs);
  /// Those of a part of another system, whose places are given by place(of the whole).
  /// \return the places of the blocks of each
  template <class Place>
  std::vector<std::pair<int, int>> take_part(const ContactTrial& whole, const Part& part, const Place& place);
  /// None, with most of the memory for the next step.
  void clear();

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  /// [N] Largest force of a spring at the start of the step, pulling ones not counted.
  double largest_force_at_start() const { return start_force_; }
  /// [-] Part of the cohesion over which it comes in, in what is evaluated from now on: see ShearLimit.
  void set_cohesion_ramp(double ramp) { ramp_ = ramp; }

  // For those who solve the step.
  /// By the present moves. Adds to the rows; returns [N] the largest force.
  double evaluate(std::vector<ForceRow>& rows);
  void add_stiffness(const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix) const;
  bool averages_path() const { return step_forces_ == StepForces::averaged; }
  StepForces step_forces() const { return step_forces_; }
  std::vector<BlockMove>& moves() { return moves_; }
  const std::vector<BlockMove>& moves() const { return moves_; }
  /// Of all contacts, and of the places of the last batch that have none.
  std::vector<Branch>& branches() { return branches_; }
  const std::vector<Branch>& branches() const { return branches_; }
  std::vector<ContactBatch>& batches() { return batches_; }
  const std::vector<ContactBatch>& batches() const { return batches_; }
  const std::vector<TrialBatch>& trials() const { return trials_; }
  // Contact c of the problem is one of the lanes of its batch.
  static int lane(std::size_t c) { return static_cast<int>(c % batch_size); }
  ContactBatch& start(std::size_t c) { return batches_[c / batch_size]; }
  const ContactBatch& start(std::size_t c) const { return batches_[c / batch_size]; }
  TrialBatch& trial(std::size_t c) { return trials_[c / batch_size]; }
  const TrialBatch& trial(std::size_t c) const { return trials_[c / batch_size]; }
  /// Places of its two blocks.
  std::pair<int, int> places(std::size_t c) const { return {start(c).vertex_place(lane(c)), start(c).edge_place(lane(c))}; }
  /// The forces act along its normal and tangent, at its arms.
  ContactPose force_pose(std::size_t c) const { return averages_path() ? mean_pose(start(c).start(lane(c)), pose(c)) : pose(c); }
  ContactStrength strength(std::size_t c) const { return start(c).strength(lane(c)); }
  /// With the gap counted from their target.
  ContactSprings springs(std::size_t c) const { return start(c).springs(lane(c)); }
  /// What a step sees of them while the contact stays closed: half of them, if it averages over its path.
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

  // What contact c did in the step.
  ContactOutcome operator[](std::size_t c) const { return {normal_stiffness(c), shear_stiffness(c), forces(c), pose(c)}; }
  ContactStatus status(std::size_t c) const { return openclose::status(branches_[c]); }
  CarriedForces forces(std::size_t c) const {
    const int k = lane(c);
    const ElasticBatch& elastic = elastic_[c / batch_size];
    return {status(c), trial(c).normal[k], trial(c).shear[k], elastic.normal[k], elastic.shear[k]};
  }
  ContactPose pose(std::size_t c) const {
    ContactPose pose = start(c).pose(lane(c), moves_);
    pose.gap_change = gap_change(c);  // of `shi` they are linear in the motion; else the same numbers, not worked out again
    pose.slip_change = slip_change(c);
    return pose;
  }
  ContactPose pose_at_start(std::size_t c) const { return {start(c).start(lane(c)), {}, {}}; }
  double gap_change(std::size_t c) const { return trial(c).gap_change[lane(c)]; }    ///< [m]
  double slip_change(std::size_t c) const { return trial(c).slip_change[lane(c)]; }  ///< [m]
  double normal_stiffness(std::size_t c) const { return start(c).normal[lane(c)]; }  ///< [N/m]
  double shear_stiffness(std::size_t c) const { return start(c).shear[lane(c)]; }    ///< [N/m]
  double slack(std::size_t c) const { return slack_.empty() ? 0.0 : slack_[c]; }     ///< [m] see Contact
  /// Forces that entered with weight 1 - theta: of every contact, or none for theta = 1.
  const std::vector<CarriedForces>& start_forces() const { return start_forces_; }
  /// Mean forces that entered instead of those at the end; empty for other schemes.
  const std::vector<PathOutcome>& paths() const { return paths_; }

  Memory memory() const;

 private:
  void make_room();
  void forget_step();
  void find_paths();

  double ramp_ = tolerance::cohesion_ramp;       ///< [-]
  std::size_t count_ = 0;                        ///< the last batch may have lanes without a contact
  double start_force_ = 0.0;                     ///< [N]
  std::vector<ContactBatch> batches_;            ///< in the order of the problem's list
  std::vector<BlockMove> moves_;                 ///< at the trial displacement: of the rows, of others that a part sees, and of what stays
  StepForces step_forces_ = StepForces::at_end;  ///< what trials_ has
  std::vector<TrialBatch> trials_;
  std::vector<Branch> branches_;
  std::vector<ElasticBatch> elastic_;
  std::vector<CarriedForces> start_forces_;
  std::vector<PathOutcome> paths_;
  std::vector<double> slack_;  ///< [m] of all, or empty where there is none
};

template <class Place>
std::vector<std::pair<int, int>> ContactTrial::take_part(const ContactTrial& whole, const Part& part, const Place& place) {
  step_forces_ = whole.step_forces_;
  ramp_ = whole.ramp_;
  count_ = part.contacts.size();
  batches_.assign((count_ + batch_size - 1) / batch_size, ContactBatch());
  std::vector<std::pair<int, int>> ends;
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
    ends.emplace_back(vertex, edge);
  }
  make_room();
  return ends;
}

}  // namespace openclose
