// What the contacts of a step did. They are laid out four at a time, as Newton's method evaluates them, so that it need not write them down a second
// time: it lends its batches until its next step.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "openclose/integrator/contact_batch.h"
#include "openclose/integrator/contact_order.h"

namespace openclose {

/// What one contact did in a step: what the energy ledger and the contact's history need of it.
template <int N>
struct ContactOutcome {
  double normal_stiffness = 0.0, shear_stiffness = 0.0;  ///< [N/m] of its springs
  CarriedForces forces;                                  ///< at the end of the step
  ContactPose<N> pose;                                   ///< whose gradients carried these forces in the equation of motion

  ContactOutcome() = default;
  ContactOutcome(const ContactSprings& springs, const CarriedForces& carried, const ContactPose<N>& at)
      : normal_stiffness(springs.normal), shear_stiffness(springs.shear), forces(carried), pose(at) {}
};

template <int N>
class ContactOutcomes {
  static_assert(N == 3, "contacts are laid out in batches for rigid blocks");

 public:
  std::size_t size() const { return stiffness_.size(); }
  bool empty() const { return stiffness_.empty(); }

  ContactOutcome<N> operator[](std::size_t c) const {
    ContactOutcome<N> o;
    o.normal_stiffness = stiffness_[c].normal;
    o.shear_stiffness = stiffness_[c].shear;
    o.forces = forces(c);
    o.pose = pose(c);
    return o;
  }
  ContactStatus status(std::size_t c) const { return openclose::status(branches_[order_[c]]); }
  CarriedForces forces(std::size_t c) const { return batch(c).carried(lane(c), branches_[order_[c]]); }
  ContactPose<N> pose(std::size_t c) const { return batch(c).pose(lane(c)); }
  double gap_change(std::size_t c) const { return batch(c).gap_change[lane(c)]; }  ///< [m]
  double normal_stiffness(std::size_t c) const { return stiffness_[c].normal; }    ///< [N/m]
  double shear_stiffness(std::size_t c) const { return stiffness_[c].shear; }      ///< [N/m]
  double slack(std::size_t c) const { return slack_.empty() ? 0.0 : slack_[c]; }   ///< [m] see Contact
  void set_slack(std::size_t c, double slack) {
    slack_.resize(size());
    slack_[c] = slack;
  }

  std::size_t bytes() const { return bytes_of(trials_, branches_, stiffness_, slack_) + order_.bytes(); }

  /// Empty again, with its memory for the next step.
  void clear() {
    stiffness_.clear();
    slack_.clear();
    order_.clear();
  }
  void push_back(const ContactOutcome<N>& o) {
    const std::size_t c = size();
    stiffness_.push_back({o.normal_stiffness, o.shear_stiffness});
    order_.push_back();
    if (c / batch_size == trials_.size()) trials_.emplace_back();
    if (c >= branches_.size()) branches_.push_back(0);
    trials_[c / batch_size].set_pose(lane(c), o.pose);
    trials_[c / batch_size].set_carried(lane(c), o.forces);
    branches_[c] = branch(o.forces);
  }

  /// Newton's batches, lent with the stiffness of the contacts in them.
  /// \param starts  of the same contacts
  void borrow(std::vector<TrialBatch>& trials, std::vector<Branch>& branches, const ContactOrder& order, const std::vector<ContactBatch>& starts) {
    trials_.swap(trials);
    branches_.swap(branches);
    take_stiffness(order, starts);
  }
  /// A copy of them.
  void copy(const std::vector<TrialBatch>& trials, const std::vector<Branch>& branches, const ContactOrder& order,
            const std::vector<ContactBatch>& starts) {
    trials_ = trials;
    branches_ = branches;
    take_stiffness(order, starts);
  }
  /// What was lent is given back; empty again.
  void give_back(std::vector<TrialBatch>& trials, std::vector<Branch>& branches) {
    trials_.swap(trials);
    branches_.swap(branches);
    clear();
  }

 private:
  struct Stiffness {
    double normal, shear;
  };

  void take_stiffness(const ContactOrder& order, const std::vector<ContactBatch>& starts) {
    clear();
    order_ = order;
    resize_closely(stiffness_, order.size());
    for (std::size_t c = 0; c < order.size(); ++c) {
      const ContactBatch& start = starts[order[c] / batch_size];
      stiffness_[c] = {start.normal[lane(c)], start.shear[lane(c)]};
    }
  }
  int lane(std::size_t c) const { return static_cast<int>(order_[c] % batch_size); }
  const TrialBatch& batch(std::size_t c) const { return trials_[order_[c] / batch_size]; }

  std::vector<TrialBatch> trials_;  ///< at least as many as there are contacts
  std::vector<Branch> branches_;
  ContactOrder order_;                ///< of these
  std::vector<Stiffness> stiffness_;  ///< [N/m]
  std::vector<double> slack_;         ///< [m] of all, or empty where there is none
};

}  // namespace openclose
