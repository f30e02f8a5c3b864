// The forms in which results are written beside the tables, chosen by output.formats. A new one is a source file like svg_states.cpp, and in
// formats.cpp its declaration and its line in the list.
#pragma once

#include <string>
#include <vector>

#include "openclose/core/error.h"
#include "openclose/io/output_folder.h"

namespace openclose {

struct OutputFormat {
  const char* name;     ///< the word in output.formats, and the folder for its files within that of the results
  const char* summary;  ///< for the page of keys
  const char* files;    ///< regular expression of the names that it gives: these are removed before the next results come, and no others
  /// Makes the files from the tables of the folder, when the analysis has ended. Throws WriteError if one cannot be written to its end.
  void (*write)(const OutputFolder& folder);
};

const std::vector<OutputFormat>& output_formats();

/// Throws InputError for a name that no format has.
void require_formats(const std::vector<std::string>& names, const SourceLocation& where);

void write_formats(const std::vector<std::string>& names, const OutputFolder& folder);

}  // namespace openclose
