// Polygons that an engine can take.
#pragma once

#include <vector>

#include "openclose/geometry/polygon.h"

namespace openclose::peers {

/// The polygon itself where it is convex and has at most `most` vertices, else triangles by cutting off ears.
/// \param polygon  simple, counter-clockwise, without vertices on a straight line  \throws std::runtime_error if no ear is found
std::vector<Polygon> convex_pieces(const Polygon& polygon, std::size_t most);

}  // namespace openclose::peers
