// The springs of all contacts of a step, where most of them are those of the last step: what depends on joint, length and blocks, and on the duration
// of the step, is worked out anew only where one of these has changed.
#pragma once

#include <vector>

#include "openclose/integrator/enforcement.h"

namespace openclose {

/// Serves one system of blocks and one table of joints; their masses and stiffnesses are taken to stay.
template <int N>
class SpringList {
 public:
  /// \param make  gives the springs of one contact: gap and initial_shear as joint_springs() does, all else from nothing but the contact's joint,
  /// length
  ///              and blocks and from the problem's dt, statics, end_weight and averages_path()
  template <typename Make>
  void renew(const StepProblem<N>& problem, const Make& make) {
    const Step step{problem.dt, problem.end_weight, problem.statics, problem.averages_path()};
    if (!(step == step_)) owners_.clear();
    step_ = step;
    resize_closely(owners_, problem.contacts.size());
    resize_closely(springs_, problem.contacts.size());
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      const Contact& contact = problem.contacts[c];
      const Owner owner{contact.length, contact.joint, contact.vertex_block, contact.edge_block};
      ContactSprings& s = springs_[c];
      if (owner == owners_[c]) {
        s.gap = contact.gap;
        s.initial_shear = -s.shear * contact.elastic_slip;
      } else {
        owners_[c] = owner;
        s = make(contact);
      }
    }
  }

  const std::vector<ContactSprings>& springs() const { return springs_; }
  std::size_t bytes() const { return bytes_of(owners_, springs_); }
  /// For this step.
  void set_dissipation(double dissipation) {
    for (ContactSprings& s : springs_) s.dissipation = dissipation;
    owners_.clear();
  }

 private:
  struct Step {
    double dt = 0.0, end_weight = 0.0;
    bool statics = false, averages_path = false;
    bool operator==(const Step&) const = default;
  };
  /// Whose springs they are.
  struct Owner {
    double length = 0.0;
    int joint = -1, vertex_block = -1, edge_block = -1;
    bool operator==(const Owner&) const = default;
  };

  Step step_;
  std::vector<Owner> owners_;
  std::vector<ContactSprings> springs_;
};

}  // namespace openclose
