// A drawing of the blocks of a scene.
#pragma once

#include <string>

#include "openclose/scene/scene.h"

namespace openclose {

/// The blocks as an SVG document: one polygon each, with the block's name as its tooltip; a colour for each material, named below;
/// fixed blocks darker and dotted; the title above, a scale bar of a round length in metres.
std::string svg_drawing(const Scene& scene);

}  // namespace openclose
