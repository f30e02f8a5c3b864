// Scenes to begin with: what `openclose new` writes. A draft is a source with its dimensions, declared in all_drafts.h, and its line in drafts.cpp.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "openclose/draft/dimensions.h"

namespace openclose {

struct Draft {
  std::string_view name;
  std::string_view summary;  ///< what it is of, in a few words
  std::vector<Dimension> dimensions;
  std::string (*write)(const Dimensions&);  ///< the text of the scene
};

const std::vector<Draft>& drafts();

/// The text of a scene, which has been read and checked. Throws InputError, about the command line, for a dimension that the draft has not or that is
/// out of range, and for dimensions that make no scene together.
/// \param asked  values by the names of dimensions
std::string scene_from(const Draft& draft, const std::map<std::string, double>& asked);

}  // namespace openclose
