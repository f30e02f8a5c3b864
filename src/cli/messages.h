// What is told on standard error, and whether what was told on standard output has got there.
#pragma once

#include <string>
#include <vector>

namespace openclose {

/// "openclose: " and the text. A line that cannot be written (its file is on a full disk, too) is lost: it must not end what has a result.
void print_message(const std::string& text);
void print_warnings(const std::vector<std::string>& warnings);

/// Throws InputError for a file of another ending: a name that is left out, or mistaken for another option's, would write over a scene or a table.
void require_ending(const std::string& file, const std::string& ending, const std::string& noun);

/// Whether a write to standard output has failed.
bool has_lost_output();
/// The exit status of a command that ends with this one: broken off, with a message, if something on standard output could not be written.
int status_after_output(int status);

}  // namespace openclose
