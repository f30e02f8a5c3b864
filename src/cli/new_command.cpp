#include "new_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>

#include "machine_output.h"
#include "messages.h"
#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/draft/drafts.h"
#include "openclose/draft/written_heading.h"
#include "openclose/io/text_files.h"
#include "openclose/scene/check.h"
#include "openclose/scene/reader.h"
#include "option_errors.h"

namespace openclose {
namespace {

struct NewOptions {
  std::string kind;
  std::map<std::string, double> dimensions;
  std::string file;
  bool quiet = false, json = false;
};

std::vector<std::string> names_of_drafts() {
  std::vector<std::string> names;
  for (const Draft& draft : drafts()) names.emplace_back(draft.name);
  return names;
}

/// "--height-m" of "height_m".
std::string option_of(std::string_view dimension) {
  std::string option = "--" + std::string(dimension);
  std::ranges::replace(option, '_', '-');
  return option;
}

/// A file that is there is replaced only as long as nobody has edited it: it is the beginning of somebody's work.
bool is_unedited(const std::string& path) {
  if (!is_regular_file(path)) return false;
  std::ifstream stream(path, std::ios::binary);
  return is_as_written(std::string{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()});
}

int new_command(const NewOptions& options) {
  const auto draft = std::ranges::find(drafts(), std::string_view(options.kind), &Draft::name);
  const std::string file = options.file.empty() ? options.kind + ".toml" : options.file;
  const std::string text = with_heading(scene_from(*draft, options.dimensions));
  const bool is_there = openclose::is_there(file);
  if (is_there && !is_unedited(file))
    throw InputError({file, 0}, "", "is there, and is not as openclose new has written it", "-o with the name of a new file");
  const Scene scene = scene_of_text(text, file);
  const std::vector<std::string> warnings = check_scene(scene);
  write_files({{file, text, is_there}});
  print_warnings(warnings);
  if (options.json) print_json(exit_success, {{"kind", options.kind}, {"blocks", scene.blocks.size()}, {"warnings", warnings}, {"written", {file}}});
  if (!options.quiet)
    fmt::print("{}: {}, {}; edit it, then: openclose check {}, openclose fos {}\n", file, draft->summary, size_of(scene), file, file);
  return exit_success;
}

}  // namespace

void add_new(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<NewOptions>();
  CLI::App* command = app.add_subcommand("new", "write a scene to begin with, with a comment on every key");
  std::string kinds;
  for (const Draft& draft : drafts()) kinds += fmt::format("{}{} ({})", kinds.empty() ? "" : ", ", draft.name, draft.summary);
  command->add_option("kind", options->kind, "what is drawn: " + kinds)->required()->check(one_of(names_of_drafts()));
  std::map<std::string, std::string> help_of;
  std::map<std::string, bool> is_whole;
  std::vector<std::string> in_order;
  for (const Draft& draft : drafts()) {
    for (const Dimension& dimension : draft.dimensions) {
      const std::string name(dimension.name);
      std::string& help = help_of[name];
      if (help.empty()) in_order.push_back(name);
      is_whole[name] = dimension.is_whole;
      help += fmt::format("{}{}: {} (default: {})", help.empty() ? "" : "; ", draft.name, dimension.says, dimension.value);
    }
  }
  for (const std::string& name : in_order) {
    CLI::Option* option = command->add_option_function<double>(
        option_of(name), [options, name](const double& value) { options->dimensions[name] = value; }, help_of[name]);
    if (is_whole[name]) option->type_name("INT");
  }
  command->add_option("-o,--output", options->file, "scene file to write (default: the kind and .toml); one that has been edited is never replaced");
  command->add_flag("-q,--quiet", options->quiet, "print nothing but warnings and errors");
  add_json_flag(*command, options->json, options->quiet);
  command->callback([options, &chosen] { chosen = [options] { return new_command(*options); }; });
}

}  // namespace openclose
