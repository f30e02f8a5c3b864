// Texts of the user in quotes, for messages.
#pragma once

#include <string>
#include <string_view>

#include "openclose/core/escaped.h"

namespace openclose {

/// The text, or both of its ends if it is longer than anything that people write.
std::string shortened(std::string_view text);

/// A text of the user in quotes, shortened and its control characters escaped.
std::string in_quotes(std::string_view text);

}  // namespace openclose
