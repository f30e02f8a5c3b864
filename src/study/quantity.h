// A number that says what has come of a case, named as a person would: POINT.displacement_m, energy.kinetic_j, max_penetration_m.
#pragma once

#include <optional>
#include <string>

#include "openclose/scene/scene.h"

namespace openclose {

/// What is taken where nobody names a quantity: the displacement of the first measured point, else the largest of a block.
std::string usual_quantity(const Scene& scene);

/// Throws InputError if the results of this scene will not have the quantity.
void require_quantity(const std::string& quantity, const Scene& scene);

/// The last value in a folder of results; none where it is not written.
///   POINT.COLUMN       of history.csv, besides its columns displacement_m and velocity_m_per_s, the lengths of the vectors
///   energy.COLUMN      of energy.csv
///   largest_displacement_m, max_penetration_m
std::optional<double> quantity_in(const std::string& folder, const std::string& quantity);

}  // namespace openclose
