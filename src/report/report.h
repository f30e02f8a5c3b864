// The results of a run or of a factor of safety as one HTML page that needs nothing else: no network, no file beside it.
//
// The page is src/report/page (HTML, CSS and JavaScript as a browser reads them), with the results in it as JSON; page_data.h says what that holds.
#pragma once

#include <cstddef>
#include <string>

namespace openclose {

struct ReportRequest {
  /// [bytes] Where all states would take more, contacts are left out of some, evenly, and then states. A browser opens a page of this size within
  /// some seconds.
  std::size_t most_bytes = 100'000'000;
};

struct Report {
  std::string html;
  std::string answer;                ///< one line; empty where the run has not ended
  std::size_t states = 0;            ///< shown
  std::size_t left_out = 0;          ///< states that were left out, so that the page does not become too large
  std::size_t without_contacts = 0;  ///< states that are shown without their contacts, for the same reason
};

/// Throws InputError, which names what is accepted, if the folder is none of results.
Report report_of_results(const std::string& folder, const ReportRequest& request = {});

}  // namespace openclose
