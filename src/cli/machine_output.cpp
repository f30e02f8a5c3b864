#include "machine_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>

#include "openclose/report/page_tables.h"

namespace openclose {

using nlohmann::ordered_json;

void add_json_flag(CLI::App& app, bool& json, bool& quiet) {
  app.add_flag_callback(
      "--json", [&json, &quiet] { json = quiet = true; }, "print one JSON object instead of text, errors included");
}

bool wants_json(int argc, char** argv) {
  return std::any_of(argv, argv + argc, [](const char* word) { return std::strcmp(word, "--json") == 0; });
}

void print_json(int status, const ordered_json& object) {
  ordered_json all = {{"exit_status", status}};
  all.update(object);
  // Not by what throws: errors come this way, too, and main looks at the end whether all has been written.
  std::fputs((all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n").c_str(), stdout);
}

void print_json_error(int status, const std::string& message) {
  print_json(status, {{"error", message}});
}

void print_json_results(int status, const std::string& folder) {
  ordered_json results = {{"folder", folder}};
  std::ifstream file(folder + "/summary.json");
  const ordered_json summary = ordered_json::parse(file, nullptr, false);
  if (summary.is_object()) results.update(summary);
  print_json(status, results);
}

ordered_json json_of_table(const std::string& csv) {
  std::istringstream table(csv);
  return rows_in(table);
}

}  // namespace openclose
