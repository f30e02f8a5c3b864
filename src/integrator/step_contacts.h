// What the contacts of a step did in it, for the ledger, the local error and the history of each contact: one by one, from the batches of
// contact_batch.h, in which the step is solved.
#pragma once

#include <utility>
#include <vector>

#include "openclose/contact/mean_pose.h"
#include "openclose/core/memory.h"
#include "openclose/integrator/contact_batch.h"
#include "openclose/law/path_average.h"

namespace openclose {

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

class StepContacts {
 public:
  std::size_t size() const { return count_; }
  bool averages_path() const { return averages_path_; }
  const std::vector<ContactBatch>& batches() const { return batches_; }
  const std::vector<BlockMove>& moves() const { return moves_; }
  const std::vector<TrialBatch>& trials() const { return trials_; }
  /// Of all contacts, and of the places of the last batch that have none.
  const std::vector<Branch>& branches() const { return branches_; }
  // Contact c of the problem is one of the lanes of its batch.
  static int lane(std::size_t c) { return static_cast<int>(c % batch_size); }
  const ContactBatch& start(std::size_t c) const { return batches_[c / batch_size]; }
  const TrialBatch& trial(std::size_t c) const { return trials_[c / batch_size]; }

  /// Places of its two blocks.
  std::pair<int, int> places(std::size_t c) const { return {start(c).vertex_place(lane(c)), start(c).edge_place(lane(c))}; }
  ContactStrength strength(std::size_t c) const { return start(c).strength(lane(c)); }
  /// With the gap counted from their target.
  ContactSprings springs(std::size_t c) const { return start(c).springs(lane(c)); }
  double normal_stiffness(std::size_t c) const { return start(c).normal[lane(c)]; }  ///< [N/m]
  double shear_stiffness(std::size_t c) const { return start(c).shear[lane(c)]; }    ///< [N/m]
  ContactPose pose_at_start(std::size_t c) const { return {start(c).start(lane(c)), {}, {}}; }

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
  /// The forces act along its normal and tangent, at its arms.
  ContactPose force_pose(std::size_t c) const { return averages_path() ? mean_pose(start(c).start(lane(c)), pose(c)) : pose(c); }
  double gap_change(std::size_t c) const { return trial(c).gap_change[lane(c)]; }    ///< [m]
  double slip_change(std::size_t c) const { return trial(c).slip_change[lane(c)]; }  ///< [m]
  double slack(std::size_t c) const { return slack_.empty() ? 0.0 : slack_[c]; }     ///< [m] see Contact
  /// Forces that entered with weight 1 - theta: of every contact, or none for theta = 1.
  const std::vector<CarriedForces>& start_forces() const { return start_forces_; }
  /// Mean forces that entered instead of those at the end; empty for other schemes.
  const std::vector<PathOutcome>& paths() const { return paths_; }

  Memory memory() const {
    Memory of;
    of.blocks = bytes_of(moves_);
    of.contacts = bytes_of(batches_, trials_, branches_, elastic_, start_forces_, paths_, slack_);
    return of;
  }

 protected:
  std::size_t count_ = 0;              ///< the last batch may have lanes without a contact
  bool averages_path_ = false;         ///< what trials_ has: means over the path of the step, or forces at its end
  std::vector<ContactBatch> batches_;  ///< in the order of the problem's list
  std::vector<BlockMove> moves_;       ///< at the trial displacement: of the rows, of others that a part sees, and of what stays
  std::vector<TrialBatch> trials_;
  std::vector<Branch> branches_;
  std::vector<ElasticBatch> elastic_;
  std::vector<CarriedForces> start_forces_;
  std::vector<PathOutcome> paths_;
  std::vector<double> slack_;  ///< [m] of all, or empty where there is none
};

}  // namespace openclose
