#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "machine_output.h"
#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/io/drawing.h"
#include "openclose/io/text_files.h"
#include "openclose/scene/angle.h"
#include "openclose/scene/writer.h"

namespace openclose {

namespace {

/// "dip 30 degrees to the left", "are horizontal", "are vertical". \param dip  [deg]
std::string dip_in_words(double dip) {
  constexpr double rounding = 1e-6;  // [deg]
  if (std::abs(dip) <= rounding) return "are horizontal";
  if (90.0 - std::abs(dip) <= rounding) return "are vertical";
  return fmt::format("dip {:.3g} degrees to the {}", std::abs(dip), dip > 0.0 ? "left" : "right");
}

nlohmann::ordered_json json_of(const std::vector<SetInSection>& sets) {
  auto list = nlohmann::ordered_json::array();
  for (const SetInSection& set : sets) list.push_back({{"joint_set", set.place}, {"dip_deg", degrees(set.dip)}, {"spacing_m", set.spacing}});
  return list;
}

}  // namespace

int cut_command(const Options& options) {
  const Loaded loaded = load(options);
  if (!loaded.scene.cutting) throw InputError(loaded.scene.where, "domain", "the scene has none", "a scene with a [domain] to cut");
  const CuttingSummary& cutting = *loaded.scene.cutting;
  const std::filesystem::path stem = std::filesystem::path(options.scene_file).stem();
  const std::string file = options.blocks_file.empty() ? "results/" + stem.string() + "/blocks.toml" : options.blocks_file;
  const std::string drawing = options.drawing_file.empty() ? std::filesystem::path(file).replace_extension(".svg").string() : options.drawing_file;
  for (const std::string& written : {file, drawing}) {
    std::error_code unknown;
    if (std::filesystem::equivalent(written, options.scene_file, unknown)) {
      throw InputError({written, 0}, "", "this is the scene that is being cut", "another file to write to");
    }
  }
  const auto place_of = [](const std::string& path) {
    std::error_code unknown;
    const std::filesystem::path place = std::filesystem::weakly_canonical(absolute_path(path), unknown);
    return unknown ? absolute_path(path).lexically_normal() : place;
  };
  if (place_of(file) == place_of(drawing)) {
    throw InputError({file, 0}, "", "the blocks and their drawing cannot be the same file",
                     "-o with the name of a scene (.toml), --svg with that of the drawing");
  }
  write_files({{file, "# Blocks that openclose has cut.\n" + write_scene(loaded.scene), false, Seal::hash},
               {drawing, svg_drawing(picture_of(loaded.scene)), false, Seal::xml}});
  if (options.json) {
    print_json(exit_success, {{"scene", options.scene_file},
                              {"blocks", cutting.blocks},
                              {"traces", cutting.traces},
                              {"area_m2", cutting.area},
                              {"domain_area_m2", cutting.domain_area},
                              {"smallest_block_m2", cutting.smallest_block},
                              {"slivers_merged", cutting.slivers_merged},
                              {"dangling_ends", cutting.dangling_ends},
                              {"sets_in_section", json_of(cutting.sets_in_section)},
                              {"written", {file, drawing}}});
  }
  if (options.quiet) return exit_success;
  const auto fixed = std::count_if(loaded.scene.blocks.begin(), loaded.scene.blocks.end(), [](const BlockInput& block) { return block.fixed; });
  fmt::print("{}: {} blocks cut by {} traces, {:.9g} m2 (domain {:.9g} m2), smallest {:.3g} m2; {} of {} blocks fixed\n", options.scene_file,
             cutting.blocks, cutting.traces, cutting.area, cutting.domain_area, cutting.smallest_block, fixed, loaded.scene.blocks.size());
  // So that one sees whether the section was meant.
  for (const SetInSection& set : cutting.sets_in_section)
    fmt::print("joint set of {}: in the section its joints {} and lie {:.4g} m apart\n", set.place, dip_in_words(degrees(set.dip)), set.spacing);
  fmt::print("{} slivers merged ({:.3g} m2), {} dangling ends dropped; written to {} and {}\n", cutting.slivers_merged, cutting.slivers_area,
             cutting.dangling_ends, file, drawing);
  return exit_success;
}

namespace {

/// A scene has no state to choose: its blocks as they are written or cut, with what holds and pushes them.
int draw_scene(Options options) {
  const DrawingRequest& request = options.drawing;
  if (request.state || request.colour || request.forces || request.cracks)
    throw InputError({options.results, 0}, "draw", "a scene has no states, forces and openings to choose from",
                     "no --state, --colour, --forces or --cracks, or the folder of a run or fos");
  options.scene_file = options.results;
  const Loaded loaded = load(options);
  const std::string file =
      options.drawing_file.empty() ? std::filesystem::path(options.scene_file).replace_extension(".svg").string() : options.drawing_file;
  require_ending(file, ".svg", "drawing");
  write_files({{file, svg_drawing(picture_of(loaded.scene)), false, Seal::xml}});
  if (options.json) print_json(exit_success, {{"scene", options.scene_file}, {"blocks", loaded.scene.blocks.size()}, {"written", {file}}});
  if (!options.quiet) fmt::print("{}: {} blocks drawn; written to {}\n", options.scene_file, loaded.scene.blocks.size(), file);
  return exit_success;
}

}  // namespace

int draw_command(const Options& options) {
  if (is_regular_file(options.results)) return draw_scene(options);
  if (!is_there(options.results))
    throw InputError({options.results, 0}, "", "there is no such folder or file",
                     "the folder of a run or fos, results/<name of the scene> by default, or a scene");
  const std::string file = options.drawing_file.empty() ? options.results + "/drawing.svg" : options.drawing_file;
  require_ending(file, ".svg", "drawing");
  const Picture picture = picture_of_results(options.results, options.drawing);
  write_files({{file, svg_drawing(picture), false, Seal::xml}});
  if (options.json)
    print_json(exit_success, {{"results", options.results}, {"blocks", picture.blocks.size()}, {"notes", picture.notes}, {"written", {file}}});
  if (!options.quiet) fmt::print("{}: {} blocks drawn; {}; written to {}\n", options.results, picture.blocks.size(), picture.notes.front(), file);
  return exit_success;
}

}  // namespace openclose
