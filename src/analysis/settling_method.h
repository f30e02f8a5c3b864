// A motion that starts from rest may have its equilibrium found by another method than its own: run.settled_by.
#pragma once

#include "openclose/scene/scene.h"

namespace openclose {

/// Whether the start "settled" is found by another method than that of the motion.
bool is_settled_by_another(const Scene& scene);
/// The method that finds it: where it is another one, with what is chosen for every method, and the defaults of what is only for that of the motion.
MethodInput settling_method(const Scene& scene);
/// Throws InputError if run.settled_by cannot find the equilibrium that the motion starts from.
void require_settling_method(const Scene& scene);

}  // namespace openclose
