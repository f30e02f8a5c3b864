// The files of src/report/page as the build has put them into the program (cmake/embed_files.cmake).
#pragma once

#include <span>

namespace openclose {

extern const char* const embedded_page;
extern const char* const embedded_style;
extern const std::span<const char* const> embedded_scripts;  ///< one after the other, each ends with its line

}  // namespace openclose
