#include "openclose/report/report.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "openclose/core/error.h"
#include "openclose/report/page_data.h"
#include "openclose/report/page_files.h"

namespace openclose {
namespace {

void replace(std::string& text, std::string_view mark, std::string_view with) {
  const std::size_t place = text.find(mark);
  if (place == std::string::npos) throw std::logic_error("page.html has no " + std::string(mark));
  text.replace(place, mark.size(), with);
}

/// No text of a scene can end the element of the page in which the data stand, nor begin another one.
std::string harmless(const std::string& json_text) {
  std::string text;
  text.reserve(json_text.size());
  for (const char c : json_text) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

Report report_of_results(const std::string& folder, const ReportRequest& request) {
  Report report;
  try {
    const std::string data = page_data(folder, request, report).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    report.html = embedded_page;
    replace(report.html, "{{style}}", embedded_style);
    std::string scripts;
    for (const char* script : embedded_scripts) scripts += script;
    replace(report.html, "{{scripts}}", scripts);
    replace(report.html, "{{data}}", harmless(data));
  } catch (const nlohmann::json::exception&) {
    throw InputError({folder + "/summary.json", 0}, "", "this is not what openclose writes of a run or fos",
                     "the results of this version of openclose");
  }
  return report;
}

}  // namespace openclose
