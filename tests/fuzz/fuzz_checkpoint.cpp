// The reader of checkpoints. A checkpoint is made of a small scene and forged: the first byte says what was saved and by which contact method, the
// others are edits of six bytes: two say where, four are written there; the check sum is put right. So inputs keep their meaning when the format
// changes. What is read is put into a simulation, a run or a search, which goes on.
#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "harness.h"
#include "openclose/analysis/run.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/io/checkpoint.h"
#include "openclose/scene/reader.h"
#include "openclose_traps.h"
#include "saved_states.h"

using namespace openclose;

namespace {

/// A forged velocity may ask for steps as short as they may become, and who goes on waits for them: that is no fault of the reader, and steps are not
/// cut as far here.
constexpr const char* text =
    "[[material]]\nname = 'rock'\ndensity_kg_per_m3 = 2700\n"
    "[[joint]]\nmaterials = ['rock', 'rock']\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 1e9\nfriction_angle_deg = 30\n"
    "[[block]]\nname = 'base'\nmaterial = 'rock'\nfixed = true\nvertices_m = [[-5, -1], [5, -1], [5, 0], [-5, 0]]\n"
    "[[block]]\nname = 'low'\nmaterial = 'rock'\nvertices_m = [[-1, 0], [1, 0], [1, 1], [-1, 1]]\nvelocity_m_per_s = [1, 0]\n"
    "[[block]]\nname = 'high'\nmaterial = 'rock'\nvertices_m = [[-0.5, 1], [0.5, 1], [0.5, 2], [-0.5, 2]]\n"
    "[method]\nstart = 'unloaded'\n[step]\ndt_s = 1e-3\n[end]\ntime_s = 0.02\n[solver]\nsmallest_fraction = 1e-3\n";
/// Of blocks that have come to rest, and of one that still moves.
constexpr const char* resting =
    "[[block]]\nname = 'still'\nmaterial = 'rock'\nvertices_m = [[3, 0], [4, 0], [4, 1], [3, 1]]\n"
    "[[block]]\nname = 'on it'\nmaterial = 'rock'\nvertices_m = [[3, 1], [4, 1], [4, 2], [3, 2]]\n"
    "[[load]]\nname = 'push'\nblock = 'low'\npoint_m = [-1, 0.5]\nforce_n = [1e3, 0]\n"
    "[[support]]\nblock = 'high'\npoint_m = [0, 2]\nstiffness_n_per_m = [1e5, 0]\n";
constexpr int steps_before = 5, steps_until_rest = 15, steps_after = 3;
/// [s] How far dem goes on at first, and [-] by how much farther each time, as long as one step of its own is enough: a forged stiffness may make
/// that as short as it likes, and who goes on waits, which is no fault of the reader. At most that part of a step of the scene, one as the scene is.
constexpr double first_of_dem = 1e-150, growth_for_dem = 1e3, part_for_dem = 0.01;
/// What a search asks between two pieces of its work, so often.
constexpr int questions_after = 200;
constexpr std::size_t bytes_of_sum = 8;  ///< at the end of a checkpoint

struct Original {
  Scene scene;
  std::string bytes;
  void (*go_on)(const Scene& scene, std::string state);
};

std::string saved(const Scene& scene, double time, std::string state, const char* command = "run") {
  return checkpoint_bytes(scene, {time, {}, std::move(state), command});
}

void go_on_with_dem(Simulation& simulation) {
  const double longest = part_for_dem * simulation.scene().step.dt;
  const long& steps = simulation.state().counters.steps;
  int left = steps_after;
  for (double dt = first_of_dem; left > 0; dt *= growth_for_dem) {
    const long before = steps;
    if (!simulation.advance(std::min(dt, longest)) || steps > before + 1) return;
    if (dt >= longest) --left;
  }
}

void go_on_with_steps(const Scene& scene, std::string saved) {
  Archive state(std::move(saved));
  Simulation simulation(scene);
  simulation.allow_resting();
  state(simulation);
  if (scene.method.contact == "dem") return go_on_with_dem(simulation);
  for (int i = 0; i < steps_after; ++i) {
    if (!simulation.advance(scene.step.dt)) return;
  }
}

Original steps_of(const Scene& scene, int steps) {
  Simulation simulation(scene);
  simulation.allow_resting();
  for (int i = 0; i < steps; ++i) require_promise(simulation.advance(scene.step.dt), "the scene of the checkpoint can be run");
  Archive state;
  state(simulation);
  return {scene, saved(scene, simulation.time(), state.take()), &go_on_with_steps};
}

Original steps_of(const std::string& method) {
  return steps_of(scene_of_text(text, "scene.toml", {"method.contact=" + method}), steps_before);
}

Original rest_of(const std::string& method) {
  const std::vector<std::string> overrides = {"method.contact=" + method, "solver.skip_resting=true", "rest.time_s=0.002", "rest.displacement_m=5e-4",
                                              "rest.acceleration_m_per_s2=1e3"};
  Original made = steps_of(scene_of_text(std::string(text) + resting, "scene.toml", overrides), steps_until_rest);
  Archive state(checkpoint_of_bytes(made.bytes, "checkpoint.bin", made.scene).state);
  Simulation simulation(made.scene);
  state(simulation);
  require_promise(!simulation.system().resting_blocks().empty(), "blocks of the scene of the checkpoint come to rest");
  return made;
}

void go_on_with_run(const Scene& scene, std::string saved) {
  Archive state(std::move(saved));
  Simulation simulation(scene);
  MeasuredPoints points(simulation);
  ResumedRun run(simulation, state);
  state(points);
  RunObserver observer;
  int steps = 0;
  observer.stops = [&] { return ++steps >= steps_after; };
  observer.output = [&](const Simulation&) { points.motions(); };
  run.go_on(observer);
}

/// The first checkpoint of a run, with its watch, its measured points and its milestones.
Original run_of(const std::vector<std::string>& overrides, bool is_stopped_in_its_start) {
  const std::string measured = "[[measured_point]]\nname = 'top'\nblock = 'high'\npoint_m = [0, 2]\n";
  Original made{scene_of_text(text + measured, "scene.toml", overrides), {}, &go_on_with_run};
  Simulation simulation(made.scene);
  MeasuredPoints points(simulation);
  RunObserver observer;
  observer.checkpoint = [&](Archive& state, const Simulation& s) {
    if (!made.bytes.empty()) return;
    state(points);
    made.bytes = saved(made.scene, is_stopped_in_its_start ? 0.0 : s.time(), state.take());
  };
  observer.settling = [&](double) {
    if (is_stopped_in_its_start) throw Stopped();
  };
  run(simulation, observer);
  require_promise(!made.bytes.empty(), "a run leaves checkpoints");
  return made;
}

Original run_of(const std::string& method) {
  return run_of({"method.contact=" + method, "output.checkpoint_every_s=0.005", "output.milestones_m=[1e-6, 1]"}, false);
}

Original start_of(const std::string& method) {
  return run_of({"method.contact=" + method, "method.start=settled", "settle.first_dt_s=1e-4", "settle.max_steps=4", "solver.max_iterations=12"},
                true);
}

void go_on_with_search(const Scene& scene, std::string saved) {
  Simulation simulation(scene);
  SearchObserver observer;
  int questions = 0;
  observer.interruption = [&] {
    if (++questions >= questions_after) throw Stopped();
  };
  observer.progress = [&](double) { observer.interruption(); };
  resume_search(simulation, observer, std::move(saved));
}

Original search_of(const std::string& method, const std::string& definition) {
  const std::vector<std::string> overrides = {"method.contact=" + method, "strength_reduction.definition=" + definition,
                                              "gravity_m_per_s2=[2, -9.81]", "strength_reduction.width=0.1", "settle.failure_displacement_m=0.05"};
  Original made{scene_of_text(text, "scene.toml", overrides), {}, &go_on_with_search};
  Simulation simulation(made.scene);
  SearchObserver observer;
  constexpr int trials = 3;  // so that there is a stable state among what is saved
  int done = 0;
  observer.done = [&](std::string state) {
    if (++done <= trials) made.bytes = saved(made.scene, 0.0, std::move(state), "fos");
  };
  factor_of_safety(simulation, observer);
  require_promise(!made.bytes.empty(), "a search leaves checkpoints");
  return made;
}

const std::vector<Original>& originals() {
  static const std::vector<Original> made{steps_of("soft"),
                                          steps_of("hard"),
                                          steps_of("shi"),
                                          steps_of("dem"),
                                          rest_of("soft"),
                                          rest_of("dem"),
                                          rest_of("hard"),
                                          run_of("soft"),
                                          run_of("dem"),
                                          search_of("soft", "small_displacements"),
                                          search_of("dem", "small_displacements"),
                                          search_of("soft", "large_displacements"),
                                          search_of("dem", "large_displacements"),
                                          start_of("soft"),
                                          start_of("hard")};
  return made;
}

std::string forged(std::string bytes, const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t edit = 6, written = 4;
  bytes.resize(bytes.size() - bytes_of_sum);
  for (; size >= edit; data += edit, size -= edit) {
    const std::size_t at = (data[0] + 256u * data[1]) % bytes.size();
    std::memcpy(bytes.data() + at, data + edit - written, std::min(written, bytes.size() - at));
  }
  if (size == 1) bytes.resize(bytes.size() * data[0] / 256u);  // what is left over cuts the file off
  append_check_sum(bytes);
  return bytes;
}

}  // namespace

int count_of_saved_states() {
  return static_cast<int>(originals().size());
}

std::size_t bytes_of_saved_state(int number) {
  return originals()[number].bytes.size() - bytes_of_sum;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const NonStop non_stop;  // forged numbers overflow, which is to be refused where it shows
  const Original& of = originals()[data[0] % originals().size()];
  try {
    of.go_on(of.scene, checkpoint_of_bytes(forged(of.bytes, data + 1, size - 1), "checkpoint.bin", of.scene).state);
  } catch (const InputError&) {
  } catch (const DamagedState&) {
  }
  return 0;
}
