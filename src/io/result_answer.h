// The answer of a run or of a factor of safety in one line, as drawings and pages of results have it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace openclose {

/// \param summary  summary.json of a run or of a factor of safety; throws nlohmann::json::exception if it is something else
std::string answer_of(const nlohmann::json& summary);

}  // namespace openclose
