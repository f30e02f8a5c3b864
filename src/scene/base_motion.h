// Reading of [base_motion].
#pragma once

#include "openclose/scene/scene.h"
#include "openclose/scene/table.h"

namespace openclose {

/// \param scene_file  records are looked for from its folder
BaseMotionInput read_base_motion(Table table, const std::string& scene_file);

}  // namespace openclose
