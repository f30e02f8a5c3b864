// From the vertices in the file to the polygon of a block.
#pragma once

#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"
#include "openclose/scene/table.h"

namespace openclose {

inline constexpr Range coordinate{-tolerance::farthest_coordinate_m, tolerance::farthest_coordinate_m, true, true};
/// [m] From the end of a joint: no farther than coordinates go.
inline constexpr Range joint_end_reach{.low = 0.0, .high = tolerance::farthest_coordinate_m, .low_included = true, .high_included = true};

/// The polygon made counter-clockwise and rid of repeated vertices and straight corners. Throws InputError for fewer than three vertices, for
/// edges that meet, and for slivers thinner than tolerance::thinnest_block_m.
/// \param value    where the vertices stand
/// \param written  the vertices as they were read
/// \param noun     what the polygon is meant for, in the error about slivers
Polygon outline(const Value& value, const Polygon& written, const std::string& noun = "block");

/// Throws InputError if the point is outside the polygon by more than tolerance::farthest_point_outside_block_m.
void require_inside(const Value& value, const Vec2& point, const Polygon& polygon, const std::string& block_name);

}  // namespace openclose
