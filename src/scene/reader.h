// Reads a scene file.
#pragma once

#include <string>
#include <vector>

#include "openclose/scene/scene.h"

namespace openclose {

/// Reads a TOML scene. Everything is checked that can be checked about a single entry; check_scene looks at the blocks together.
/// \param path       of a regular file
/// \param overrides  "KEY=VALUE", in order, each replacing a value of the file (see apply_override)
/// Throws InputError, one line that names file, line, key, what was read and what is accepted.
Scene read_scene(const std::string& path, const std::vector<std::string>& overrides = {});
/// The same for the text of a file.
/// \param path  what errors call it; records that the scene names are looked for in its folder
Scene scene_of_text(const std::string& text, const std::string& path, const std::vector<std::string>& overrides = {});

}  // namespace openclose
