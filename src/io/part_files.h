// Files that are written as a whole: until they are complete they have ".part" after their names, so that nobody takes a part for the whole.
#pragma once

#include <fstream>
#include <string>
#include <string_view>

namespace openclose {

inline constexpr std::string_view part_ending = ".part";

/// What a file is called until it is complete.
std::string part_of(std::string path);

/// Links that lead nowhere are there, too: what is written under their names would go where they lead.
bool is_at(const std::string& path);

/// Empty if there is none.
std::string content_of(const std::string& path);

std::string first_line(const std::string& text);

/// A file that was not there before, whatever is at its path by now. \return whether it could be made
bool make_new(const std::string& path);

/// In place of what is there, which is ours. Throws WriteError if it cannot be made any more.
/// \param path  that the file has when it is complete
std::ofstream open_new(const std::string& path, const std::string& path_until_then);

/// Closes a file after its last line and gives it its name; throws WriteError if anything of it was not written (a full disk, say) or if the file has
/// been removed.
void finish(std::ofstream& file, const std::string& path);
/// The same for a file that has had its name from the beginning.
void finish_growing(std::ofstream& file, const std::string& path);

}  // namespace openclose
