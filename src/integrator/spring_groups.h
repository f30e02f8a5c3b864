// Blocks that hang together by their contacts, and what the springs of hard contacts are to be multiplied with in each of these groups.
#pragma once

#include <vector>

#include "openclose/integrator/enforcement.h"

namespace openclose {

/// What happens in one group changes nothing in another one: blocks that are fixed do not hang groups together.
class SpringGroups {
 public:
  /// \param stiffness_over_inertia  [-] of what a contact's spring shall have, as a mean of the contacts around a block by their length, over the
  ///                                inertia of the block in the equations of the step
  SpringGroups(const StepProblem& problem, double stiffness_over_inertia);

  /// [-] At least 1: what the springs of the joints are to be multiplied with for that.
  double factor(const Contact& contact) const { return group(contact).factor; }
  /// [Pa/m] Normal stiffness, of the joints of the group.
  double stiffest_joint(const Contact& contact) const { return group(contact).stiffest_joint; }

 private:
  struct Group {
    double factor = 1.0, stiffest_joint = 0.0;
  };

  void unite();
  int first_of(int equation);
  const Group& group(const Contact& contact) const { return groups_[first_[equation_of(contact)]]; }
  /// Of one of its blocks that is free.
  int equation_of(const Contact& contact) const;

  const StepProblem& problem_;
  std::vector<int> first_;     ///< by equations of the blocks: one that stands for its group
  std::vector<Group> groups_;  ///< by these
};

}  // namespace openclose
