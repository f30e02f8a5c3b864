// The reader of checkpoints. A checkpoint is made of a small scene and forged: the first byte says of which contact method it is, the others are
// edits of six bytes: two say where, four are written there; the check sum is put right. So inputs keep their meaning when the format changes. What
// is read is put into a simulation, which goes on.
#include <cstring>
#include <string>

#include "harness.h"
#include "openclose/analysis/run.h"
#include "openclose/io/checkpoint.h"
#include "openclose/scene/reader.h"

using namespace openclose;

namespace {

constexpr const char* text =
    "[[material]]\nname = 'rock'\ndensity_kg_per_m3 = 2700\n"
    "[[joint]]\nmaterials = ['rock', 'rock']\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 1e9\nfriction_angle_deg = 30\n"
    "[[block]]\nname = 'base'\nmaterial = 'rock'\nfixed = true\nvertices_m = [[-5, -1], [5, -1], [5, 0], [-5, 0]]\n"
    "[[block]]\nname = 'low'\nmaterial = 'rock'\nvertices_m = [[-1, 0], [1, 0], [1, 1], [-1, 1]]\nvelocity_m_per_s = [1, 0]\n"
    "[[block]]\nname = 'high'\nmaterial = 'rock'\nvertices_m = [[-0.5, 1], [0.5, 1], [0.5, 2], [-0.5, 2]]\n"
    "[method]\nstart = 'unloaded'\n[step]\ndt_s = 1e-3\n[end]\ntime_s = 0.02\n";
constexpr int steps_before = 5, steps_after = 3;

struct Original {
  Scene scene;
  std::string bytes;
};

Original original_of(const std::string& method) {
  Original made{scene_of_text(text, "scene.toml", {"method.contact=" + method}), {}};
  Simulation simulation(made.scene);
  for (int i = 0; i < steps_before; ++i) require_promise(simulation.advance(made.scene.step.dt), "the scene of the checkpoint can be run");
  Archive state;
  state(simulation);
  made.bytes = checkpoint_bytes(made.scene, {simulation.time(), {}, state.take()});
  return made;
}

const Original& original(int kind) {
  static const Original made[] = {original_of("soft"), original_of("hard"), original_of("shi")};
  return made[kind % 3];
}

void go_on(const Scene& scene, const std::string& bytes) {
  Archive state(checkpoint_of_bytes(bytes, "checkpoint.bin", scene).state);
  Simulation simulation(scene);
  state(simulation);
  for (int i = 0; i < steps_after; ++i) {
    if (!simulation.advance(scene.step.dt)) return;
  }
}

std::string forged(std::string bytes, const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t edit = 6, written = 4, sum = 8;
  bytes.resize(bytes.size() - sum);
  for (; size >= edit; data += edit, size -= edit) {
    const std::size_t at = (data[0] + 256u * data[1]) % bytes.size();
    std::memcpy(bytes.data() + at, data + edit - written, std::min(written, bytes.size() - at));
  }
  if (size == 1) bytes.resize(bytes.size() * data[0] / 256u);  // what is left over cuts the file off
  append_check_sum(bytes);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Original& of = original(data[0]);
  try {
    go_on(of.scene, forged(of.bytes, data + 1, size - 1));
  } catch (const InputError&) {
  } catch (const DamagedState&) {
  }
  return 0;
}
