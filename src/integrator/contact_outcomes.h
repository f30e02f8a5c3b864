// What the contacts of a step did. They are laid out four at a time, as Newton's method evaluates them, so that it need not write them down a second
// time: it lends its batches until its next step.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "openclose/core/memory.h"
#include "openclose/integrator/contact_batch.h"

namespace openclose {

/// What one contact did in a step: what the energy ledger and the contact's history need of it.
struct ContactOutcome {
  double normal_stiffness = 0.0, shear_stiffness = 0.0;  ///< [N/m] of its springs
  CarriedForces forces;                                  ///< at the end of the step
  ContactPose pose;                                      ///< whose gradients carried these forces in the equation of motion
  double crossing_energy = 0.0;                          ///< [J] `dem`, of a contact that opens: see crossing_energy.h

  ContactOutcome() = default;
  ContactOutcome(const ContactSprings& springs, const CarriedForces& carried, const ContactPose& at)
      : normal_stiffness(springs.normal), shear_stiffness(springs.shear), forces(carried), pose(at) {}
};

class ContactOutcomes {
 public:
  std::size_t size() const { return starts_ ? starts_->count : list_.size(); }
  bool empty() const { return size() == 0; }

  ContactOutcome operator[](std::size_t c) const {
    if (!starts_) return list_[c];
    ContactOutcome o;
    o.normal_stiffness = normal_stiffness(c);
    o.shear_stiffness = shear_stiffness(c);
    o.forces = forces(c);
    o.pose = pose(c);
    return o;
  }
  ContactStatus status(std::size_t c) const { return starts_ ? openclose::status(branches_[c]) : list_[c].forces.status; }
  CarriedForces forces(std::size_t c) const {
    if (!starts_) return list_[c].forces;
    const int k = lane(c);
    const ElasticBatch& elastic = elastic_[c / batch_size];
    return {openclose::status(branches_[c]), trial(c).normal[k], trial(c).shear[k], elastic.normal[k], elastic.shear[k]};
  }
  ContactPose pose(std::size_t c) const {
    if (!starts_) return list_[c].pose;
    ContactPose pose = start(c).pose(lane(c), moves_);
    pose.gap_change = trial(c).gap_change[lane(c)];  // the same numbers, not worked out again
    pose.slip_change = trial(c).slip_change[lane(c)];
    return pose;
  }
  double gap_change(std::size_t c) const { return starts_ ? of_trial(c, &TrialBatch::gap_change) : list_[c].pose.gap_change; }       ///< [m]
  double slip_change(std::size_t c) const { return starts_ ? of_trial(c, &TrialBatch::slip_change) : list_[c].pose.slip_change; }    ///< [m]
  double normal_stiffness(std::size_t c) const { return starts_ ? of_start(c, &ContactBatch::normal) : list_[c].normal_stiffness; }  ///< [N/m]
  double shear_stiffness(std::size_t c) const { return starts_ ? of_start(c, &ContactBatch::shear) : list_[c].shear_stiffness; }     ///< [N/m]
  double slack(std::size_t c) const { return slack_.empty() ? 0.0 : slack_[c]; }  ///< [m] see Contact
  void set_slack(std::size_t c, double slack) {
    slack_.resize(size());
    slack_[c] = slack;
  }

  /// Without what others have, too.
  Memory memory() const {
    Memory of;
    of.blocks = bytes_of(moves_);
    of.contacts = bytes_of(trials_, branches_, elastic_, list_, slack_) + (starts_.use_count() == 1 ? starts_->bytes() : 0);
    return of;
  }

  /// Empty again, with most of its memory for the next step.
  void clear() {
    starts_.reset();
    std::vector<ElasticBatch>().swap(elastic_);  // steps have parts of their own meanwhile
    list_.clear();
    slack_.clear();
  }
  /// For methods without batches.
  void push_back(const ContactOutcome& o) { list_.push_back(o); }

  /// Newton's batches, lent with where they start, which is shared, and the moves of their blocks.
  void borrow(std::shared_ptr<const ContactStarts> starts, std::vector<BlockMove>& moves, std::vector<TrialBatch>& trials,
              std::vector<Branch>& branches, std::vector<ElasticBatch> elastic) {
    clear();
    starts_ = std::move(starts);
    moves_.swap(moves);
    trials_.swap(trials);
    branches_.swap(branches);
    elastic_ = std::move(elastic);
  }
  /// A copy of them.
  void copy(std::shared_ptr<const ContactStarts> starts, const std::vector<BlockMove>& moves, const std::vector<TrialBatch>& trials,
            const std::vector<Branch>& branches, std::vector<ElasticBatch> elastic) {
    clear();
    starts_ = std::move(starts);
    moves_ = moves;
    trials_ = trials;
    branches_ = branches;
    elastic_ = std::move(elastic);
  }
  /// What was lent is given back; empty again.
  void give_back(std::vector<BlockMove>& moves, std::vector<TrialBatch>& trials, std::vector<Branch>& branches) {
    moves_.swap(moves);
    trials_.swap(trials);
    branches_.swap(branches);
    clear();
  }

 private:
  static int lane(std::size_t c) { return static_cast<int>(c % batch_size); }
  const ContactBatch& start(std::size_t c) const { return starts_->batches[c / batch_size]; }
  const TrialBatch& trial(std::size_t c) const { return trials_[c / batch_size]; }
  double of_start(std::size_t c, Lanes ContactBatch::*member) const { return (start(c).*member)[lane(c)]; }
  double of_trial(std::size_t c, Lanes TrialBatch::*member) const { return (trial(c).*member)[lane(c)]; }

  std::shared_ptr<const ContactStarts> starts_;  ///< null where the outcomes stand in the list
  std::vector<BlockMove> moves_;                 ///< by places of blocks
  std::vector<TrialBatch> trials_;
  std::vector<Branch> branches_;
  std::vector<ElasticBatch> elastic_;
  std::vector<ContactOutcome> list_;
  std::vector<double> slack_;  ///< [m] of all, or empty where there is none
};

}  // namespace openclose
