// What the commands share that read a scene: the options of the command line, the scene with its warnings, and what a scene must say for each use.
#pragma once

#include <string>
#include <vector>

#include "messages.h"
#include "openclose/analysis/drawn_overlaps.h"
#include "openclose/io/result_picture.h"
#include "openclose/io/results.h"
#include "openclose/io/summary.h"
#include "openclose/scene/scene.h"

namespace openclose {

struct Options {
  std::string scene_file;
  std::string folder;
  std::string blocks_file;
  std::string drawing_file;
  std::string spectrum_file;
  std::string restart_file;
  std::string results;
  std::string key;
  bool page = false, schema = false;
  DrawingRequest drawing;
  std::vector<std::string> overrides;
  bool quiet = false;
  mutable std::string work;  ///< what the memory is needed for, should there be too little
  bool json = false;
};

struct Loaded {
  Scene scene;
  std::vector<std::string> warnings;

  /// Of what the command leaves unused.
  void warn(const std::string& text);
  /// Warns of drawn overlaps, see judge_drawn_overlaps(); throws InputError where they decide the answer.
  void judge_overlaps(Simulation& simulation, FirstMotion first_motion);
};

FirstMotion first_motion_of_run(const Scene& scene);

/// Prints what the reader warns of.
Loaded load(const Options& options);
/// That of the command line, or the one named after the scene, and after the load that is increased.
OutputFolder output_folder(const Options& options);
/// For the shell of who has stopped the command: how to begin it again.
std::string command_to_repeat(const std::string& command, const Options& options, const OutputFolder& folder);
/// The same: how to go on from its checkpoint.
std::string command_to_go_on(const std::string& command, const Options& options, const OutputFolder& folder);
/// Removes what an earlier analysis has left in the folder; of one that goes on from a checkpoint there only what came at its end.
void make_room(const OutputFolder& folder, const Options& options);
/// What no result may replace. The checkpoint that a run goes on from is one of its own results.
std::vector<std::string> files_read(const Options& options, const Scene& scene);

/// Throws InputError where a scene does not say what `run` has to know.
void require_run(const Scene& scene);
/// Throws InputError for blocks that do not have the start that the scene asks for; found out on a copy, before any file is written.
void require_start(const Scene& scene);
/// Throws InputError where a scene does not say what `fos` has to know.
void require_strength_reduction(const Scene& scene);

/// With what the command line said and what has been warned of.
Summary summary_of(const std::string& command, const Options& options, const Loaded& loaded);

}  // namespace openclose
