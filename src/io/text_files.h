// Texts that are written all together or not at all, and never over what somebody has written or edited.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "openclose/io/seal.h"

namespace openclose {

struct TextFile {
  std::string path;
  std::string text;
  bool replaces_ours = false;  ///< the caller has looked at what stands there: openclose has written it
  Seal seal = Seal::none;      ///< its last line, which is added to the text
};

/// A field of a row of a table: quoted if it holds what would break the row.
std::string csv_field(const std::string& text);

/// Writes whole files, with the folders they need: all of them, or none and no folder. Old ones are replaced only when all new ones are complete;
/// until then these have ".part" after their names. Throws InputError if a file cannot be made, if something with its name and ".part" is there, or
/// if it is there and is not as openclose has written it, which its seal tells, or its first line where it has none; WriteError if one cannot be
/// written to its end.
void write_files(const std::vector<TextFile>& files);

/// Of a file that begins like this: removes what write_files() leaves of it where it is killed, and no other file of that name.
void remove_left_part(const std::string& path, std::string_view start);

/// Throws InputError as write_files() would of files with such seals, or that begin like these: to be asked before anything is computed.
void require_replaceable(const std::vector<TextFile>& files);

}  // namespace openclose
