// What the commands have in common that run a scene many times.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "openclose/study/cases.h"

namespace openclose {

struct CaseOptions {
  std::string scene_file;
  std::string folder;
  std::vector<std::string> overrides;
  int jobs = 0;
  bool quiet = false, json = false;
};

void add_case_options(CLI::App& app, CaseOptions& options);

/// \param kind  of the folder where none is named: results/<name of the scene>-<kind>
CaseOrder case_order(const CaseOptions& options, const std::string& command, const std::string& kind);

}  // namespace openclose
