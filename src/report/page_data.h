// What the page of results holds as JSON.
//
// Arrays of numbers are base64 of little-endian float64, float32, int32 or uint8, as their names end: _f8, _f4, _i4, _u1. What is large (motions,
// contacts) has seven digits; places are metres from `origin`, so that no digit is lost far from the origin of the scene.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "openclose/report/report.h"

namespace openclose {

/// \param report  gets the answer and the numbers of states
/// Throws InputError if the folder is none of results, nlohmann::json::exception if its summary is something else than openclose writes.
nlohmann::json page_data(const std::string& folder, const ReportRequest& request, Report& report);

}  // namespace openclose
