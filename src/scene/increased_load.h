// The load that `fos` increases instead of reducing the strength. strength_reduction.increase names it:
//   gravity_x, gravity_y   a body force on all blocks, to the right or upwards: the multiplier times the magnitude of gravity, over the mass
//   another name           all [[load]] and [[surcharge]] of that name: the multiplier times what the scene gives them
// A minus before the name turns the load around. All other loads stay as they are.
#pragma once

#include <string_view>

#include "openclose/scene/scene.h"

namespace openclose {

/// Whether a name stands for gravity in a direction.
bool names_gravity(std::string_view name);

/// The scene with the load that it increases multiplied [-]: at 0 it is not there. As it is, where no load is named.
Scene with_increased_load(Scene scene, double multiplier);

/// Throws InputError for a load that is not there, and for a limit of the search below which it has nothing to do.
void require_increased_load(const Scene& scene);

}  // namespace openclose
