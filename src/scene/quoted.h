// Texts of the user in messages, which stay one line whatever is in them.
#pragma once

#include <string>
#include <string_view>

namespace openclose {

/// Also the end of a line, which would end a message.
bool is_control(char character);

/// Control characters as \x and their code.
std::string escaped(std::string_view text);

/// The text, or both of its ends if it is longer than anything that people write.
std::string shortened(std::string_view text);

/// A text of the user in quotes, shortened and its control characters escaped.
std::string in_quotes(std::string_view text);

}  // namespace openclose
