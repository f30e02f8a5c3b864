// Texts of the user in messages, which stay one line whatever is in them.
#pragma once

#include <string>
#include <string_view>

namespace openclose {

/// Also the end of a line, which would end a message, and the character 0, which would cut it off.
bool is_control(char character);

/// The text with its control characters as \x and their code.
std::string on_one_line(std::string_view text);

}  // namespace openclose
