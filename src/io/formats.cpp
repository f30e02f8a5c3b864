#include "openclose/io/formats.h"

#include <fmt/format.h>

#include <algorithm>

namespace openclose {

void write_vtk(const OutputFolder& folder);
void write_svg(const OutputFolder& folder);

const std::vector<OutputFormat>& output_formats() {
  static const std::vector<OutputFormat> list{
      {"vtk", "the states for ParaView", "(blocks|contacts)(\\.pvd|_[0-9]{4,}_[a-z0-9_=.+-]+\\.vtu)", &write_vtk},
      {"svg", "a drawing of every state", "[0-9]{4,}\\.svg", &write_svg},
  };
  return list;
}

void require_formats(const std::vector<std::string>& names, const SourceLocation& where) {
  std::string known;
  for (const OutputFormat& format : output_formats()) known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", format.name);
  for (const std::string& name : names) {
    if (std::ranges::count(output_formats(), name, &OutputFormat::name) == 0)
      throw InputError(where, "output.formats", fmt::format("\"{}\" is no known form of results", name), known);
  }
}

void write_formats(const std::vector<std::string>& names, const OutputFolder& folder) {
  for (const OutputFormat& format : output_formats()) {
    if (std::ranges::count(names, format.name) > 0) format.write(folder);
  }
}

}  // namespace openclose
