#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "commands.h"
#include "machine_output.h"
#include "openclose/analysis/loose_blocks.h"
#include "openclose/analysis/spectrum.h"
#include "openclose/core/error.h"
#include "openclose/core/process.h"
#include "openclose/io/text_files.h"
#include "openclose/scene/check.h"

namespace openclose {
namespace {

/// Throws InputError for what `run` or `fos` would refuse. A scene without step or end is one for `fos`, or gets them from the command line.
void require_use(const Scene& scene) {
  require_strength_reduction(scene);
  if (scene.step.dt <= 0.0 || scene.end_time <= 0.0) return;
  require_run(scene);
  require_start(scene);
}

void write_spectrum(Simulation& simulation, const std::string& file) {
  const Scene& scene = simulation.scene();
  std::error_code unknown;
  if (std::filesystem::equivalent(file, scene.where.file, unknown))
    throw InputError({file, 0}, "", "this is the scene that is being checked", "another file to write to");
  if (scene.step.dt <= 0.0)
    throw InputError(scene.where, "step.dt_s", "missing", "a step in seconds, here or with --dt: --spectrum asks for its matrix");
  const Spectrum s = spectrum(simulation, scene.step.dt);
  write_files({{file, fmt::format("lowest_rad_per_s,highest_rad_per_s,critical_step_s,condition_number\n{:.17g},{:.17g},{:.17g},{:.17g}\n", s.lowest,
                                  s.highest, 2.0 / s.highest, s.condition)}});
}

}  // namespace

int check_command(const Options& options) {
  Loaded loaded = load(options);
  require_memory(loaded.scene, available_memory());
  Simulation simulation(std::move(loaded.scene));
  require_use(simulation.scene());
  const bool is_for_run = simulation.scene().step.dt > 0.0 && simulation.scene().end_time > 0.0;
  loaded.judge_overlaps(simulation, is_for_run ? first_motion_of_run(simulation.scene()) : FirstMotion::settling);
  const auto& system = simulation.system();
  double area = 0.0, free_area = 0.0;
  for (const auto& block : system.blocks()) area += block.area;
  for (const int b : system.free_blocks()) free_area += system.block(b).area;
  const std::string loose = loose_blocks_in_words(simulation.scene());
  if (options.json) {
    nlohmann::ordered_json found = {{"scene", options.scene_file},
                                    {"blocks", system.block_count()},
                                    {"free_blocks", system.free_count()},
                                    {"area_m2", area},
                                    {"free_area_m2", free_area},
                                    {"contacts", simulation.change_contacts().size()},
                                    {"method", simulation.scene().method.contact}};
    if (simulation.is_explicit() && std::isfinite(simulation.explicit_stepper()->critical_step()))
      found["critical_step_s"] = simulation.explicit_stepper()->critical_step();
    if (!loose.empty()) found["loose_blocks"] = loose;
    if (!options.spectrum_file.empty()) write_spectrum(simulation, options.spectrum_file);
    print_json(exit_success, found);
    return exit_success;
  }
  fmt::print("{}: {} blocks, {} of them free, {:.6g} m2 ({:.6g} m2 free); {} contacts within reach at the start; method {}\n", options.scene_file,
             system.block_count(), system.free_count(), area, free_area, simulation.change_contacts().size(), simulation.scene().method.contact);
  if (const auto& cutting = simulation.scene().cutting; cutting && cutting->dangling_ends > 0)
    fmt::print(
        "{} ends of joints lead to no other joint and were cut back, see the drawing of cut; the key bridge keeps them as rock that can break\n",
        cutting->dangling_ends);
  if (simulation.is_explicit()) {
    const double critical = simulation.explicit_stepper()->critical_step();
    if (std::isfinite(critical)) {
      fmt::print("critical step {:.6g} s; the longest step taken is {:.6g} s\n", critical,
                 simulation.explicit_stepper()->longest_stable_step(simulation.scene().method.damping));
    } else {
      fmt::print("no critical step, since no contact or support is there; the longest step taken is step.dt_s\n");
    }
  }
  if (!loose.empty()) fmt::print("{}\n", loose);
  if (!options.spectrum_file.empty()) write_spectrum(simulation, options.spectrum_file);
  return exit_success;
}

}  // namespace openclose
