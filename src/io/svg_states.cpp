// Drawings of all states of a result, for a film or a report: svg/0000.svg is the drawing of the first one.
#include <fmt/format.h>

#include "openclose/io/formats.h"
#include "openclose/io/result_picture.h"
#include "openclose/io/state_table.h"

namespace openclose {

void write_svg(const OutputFolder& folder) {
  const StateTable outlines(folder.path_of("blocks.csv"), {"block"});
  int number = 0;
  for (const std::string& state : outlines.states()) {
    DrawingRequest request;
    request.state = state;
    folder.write_format_file("svg", fmt::format("{:04}.svg", number++), svg_drawing(picture_of_results(folder.path(), request)));
  }
}

}  // namespace openclose
