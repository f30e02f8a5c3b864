// Springs of hard contacts: how stiff they are, and the gaps that they pull contacts to.
#pragma once

#include "openclose/integrator/enforcement.h"

namespace openclose {

/// [-] Part of the tolerance by which closed contacts may stay apart from zero; what earlier steps have left beyond it is pushed back, by no more
/// than the rest in a step: redundant contacts that have different gaps then ask for motions that exclude each other by less than what is tolerated.
inline constexpr double kept_penetration = 0.5, recovered_penetration = 1.0 - kept_penetration;
/// [-] Multiple of the tolerance that redundant contacts in motion may be left with, off the gaps that they are held at.
inline constexpr double incompatible_gaps = 3.0;

/// [N/m] In the equations of the step, of the heavier block, which is not fixed.
double inertia_at(const StepProblem& problem, const Contact& contact);

/// [m] What the gap of a closed contact is held at. In a step that has been cut short, what is pushed back would throw blocks apart: it has a speed,
/// too.
double held_gap(const StepProblem& problem, const Contact& contact);

/// Springs of a motion, in proportion to the contact's length: what rigid contacts leave undetermined is shared as the springs of a joint would.
/// \param ratio  [-] of the stiffness over the inertia, of a contact that is half as long as the block's radius
ContactSprings hard_springs_of_inertia(const StepProblem& problem, const Contact& contact, double ratio);

/// Springs of statics: those of the joint times a factor [-], or with a least stiffness [N/m], in the ratio of the joint's normal and shear
/// stiffness.
ContactSprings hard_springs_of_joint(const StepProblem& problem, const Contact& contact, double factor, double least);

}  // namespace openclose
