// What is drawn of a folder of results.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "openclose/io/drawing.h"

namespace openclose {

/// What the colours of the blocks tell.
enum class BlockColour {
  material,
  displacement,  ///< of the centroid since the drawing
  velocity,      ///< of the centroid; of the mechanism of a factor of safety a fraction of the fastest
  state,         ///< whether something slides on it, holds it, or nothing touches it
};

struct DrawingRequest {
  std::optional<std::string> state;   ///< absent: the mechanism of a factor of safety, or its stable state, or the last one
  std::optional<BlockColour> colour;  ///< absent: velocity for a mechanism, else material
  bool forces = false;
  bool cracks = false;
};

/// The names of what a command line may ask for, in the order of the enumeration.
const std::vector<std::string>& block_colour_names();

/// Throws InputError, which names what is accepted, if the folder is none of results, has no such state, or lacks what is asked for in this state.
Picture picture_of_results(const std::string& folder, const DrawingRequest& request);

}  // namespace openclose
