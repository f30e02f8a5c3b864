// The files of src/report/page as the build has put them into the program (cmake/embed_files.cmake).
#pragma once

namespace openclose {

extern const char* const embedded_page;
extern const char* const embedded_style;
extern const char* const embedded_scripts;

}  // namespace openclose
