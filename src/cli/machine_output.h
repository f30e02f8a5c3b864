// --json: one JSON object on standard output in place of text, for programs that run this one. Errors go there, too, besides their line on standard
// error; "exit_status" is in all of them.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>

namespace openclose {

/// Programs have no use for text: --json is --quiet as well.
void add_json_flag(CLI::App& app, bool& json, bool& quiet);

/// Before anything is parsed, so that what cannot be parsed is reported in the same form.
bool wants_json(int argc, char** argv);

/// The object with its exit status.
void print_json(int status, const nlohmann::ordered_json& object);

void print_json_error(int status, const std::string& message);

/// summary.json of a folder with the path of the folder.
void print_json_results(int status, const std::string& folder);

/// A table that this program has written as a list of objects; numbers where a field is one, null where it is empty.
nlohmann::ordered_json json_of_table(const std::string& csv);

}  // namespace openclose
