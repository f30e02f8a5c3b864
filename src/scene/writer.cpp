#include "openclose/scene/writer.h"

#include <fmt/format.h>

#include <string_view>

#include "openclose/scene/angle.h"
#include "openclose/scene/keys.h"
#include "openclose/scene/names.h"
#include "openclose/scene/toml_text.h"

namespace openclose {
namespace {

class Text {
 public:
  void header(std::string_view header) { text_ += fmt::format("\n{}\n", header); }
  void raw_line(std::string_view key, std::string_view value) { text_ += fmt::format("{} = {}\n", key, value); }
  template <typename T>
  void line(std::string_view key, const T& value) {
    raw_line(key, toml(value));
  }
  template <typename T>
  void line_unless(const T& absent, std::string_view key, const T& value) {
    if (value != absent) line(key, value);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void write_materials(Text& text, const Scene& scene) {
  for (const Material& material : scene.materials) {
    text.header("[[material]]");
    text.line("name", std::string_view(material.name));
    text.line("density_kg_per_m3", material.density);
  }
}

void write_joints(Text& text, const Scene& scene) {
  for (const JointProperties& joint : scene.joints) {
    text.header("[[joint]]");
    if (!joint.name.empty()) text.line("name", std::string_view(joint.name));
    if (joint.has_materials())
      text.line("materials", std::vector<std::string_view>{scene.materials[joint.materials[0]].name, scene.materials[joint.materials[1]].name});
    for (const KeyEntry& entry : joint_entries(joint)) {
      if (entry.value) text.raw_line(entry.key.name, *entry.value);
    }
  }
}

void write_blocks(Text& text, const Scene& scene) {
  for (const BlockInput& block : scene.blocks) {
    text.header("[[block]]");
    text.line("name", std::string_view(block.name));
    text.line("material", std::string_view(scene.materials[block.material].name));
    text.line("vertices_m", block.vertices);
    text.line_unless(false, "fixed", block.fixed);
    text.line_unless(false, "rotation_locked", block.rotation_locked);
    text.line_unless(Vec2(0.0, 0.0), "velocity_m_per_s", block.velocity);
    text.line_unless(0.0, "angular_velocity_rad_per_s", block.angular_velocity);
    if (block.edge_joints.empty()) continue;
    std::vector<std::string_view> joints;
    for (const int joint : block.edge_joints) joints.push_back(joint == BlockInput::by_materials ? std::string_view() : scene.joints[joint].name);
    text.line("edge_joints", joints);
  }
}

void write_points(Text& text, const Scene& scene) {
  for (const std::vector<KeyEntry>& force : force_entries(scene)) {
    text.header(fmt::format("[[{}]]", force.front().table.name));
    for (const KeyEntry& entry : force) {
      if (entry.value) text.raw_line(entry.key.name, *entry.value);
    }
  }
  for (const MeasuredPoint& measured : scene.measured_points) {
    text.header("[[measured_point]]");
    text.line("name", std::string_view(measured.name));
    text.line("block", std::string_view(scene.blocks[measured.block].name));
    text.line("point_m", measured.point);
  }
  for (const MeasuredContact& measured : scene.measured_contacts) {
    text.header("[[measured_contact]]");
    text.line("name", std::string_view(measured.name));
    text.line("block_a", std::string_view(scene.blocks[measured.block_a].name));
    text.line("block_b", std::string_view(scene.blocks[measured.block_b].name));
    text.line("point_m", measured.point);
  }
}

void write_record(Text& text, const std::string& direction, const AccelerationRecord& record) {
  if (record.times.empty()) return;
  text.line(direction + "_time_s", record.times);
  text.line(direction + "_m_per_s2", record.accelerations);
}

void write_base_motion(Text& text, const BaseMotionInput& motion) {
  text.header("[base_motion]");
  text.line("kind", word_for(base_motion_words, motion.kind));
  text.line("factor", motion.factor);
  switch (motion.kind) {
    case BaseMotionKind::pulses:
      for (const BasePulse& pulse : motion.pulses) {
        text.header("[[base_motion.pulse]]");
        text.line("start_s", pulse.start);
        text.line("duration_s", pulse.duration);
        text.line("acceleration_m_per_s2", pulse.acceleration);
      }
      break;
    case BaseMotionKind::harmonic:
      text.line("amplitude_m_per_s2", motion.amplitude);
      text.line("frequency_hz", motion.frequency);
      text.line("phase_deg", degrees(motion.phase));
      break;
    case BaseMotionKind::record:
      write_record(text, "horizontal", motion.horizontal);
      write_record(text, "vertical", motion.vertical);
      break;
  }
}

/// What the tables of keys hold, but for the keys that may change on a restart if they are to be left out.
void write_keys(Text& text, const Scene& scene, bool with_changeable) {
  std::string_view table;
  for (const KeyEntry& entry : key_entries(scene)) {
    if (entry.table.name != table) text.header(fmt::format("[{}]", entry.table.name));
    table = entry.table.name;
    if (entry.value && (with_changeable || !entry.key.may_change_on_restart)) text.raw_line(entry.key.name, *entry.value);
  }
}

std::string written(const Scene& scene, bool with_changeable) {
  Text text;
  if (with_changeable) text.line("title", std::string_view(scene.title));
  text.line("gravity_m_per_s2", scene.gravity);
  write_materials(text, scene);
  write_joints(text, scene);
  write_blocks(text, scene);
  write_points(text, scene);
  if (scene.base_motion) write_base_motion(text, *scene.base_motion);
  write_keys(text, scene, with_changeable);
  return text.text();
}

}  // namespace

std::string write_scene(const Scene& scene) {
  return written(scene, true);
}

std::string write_fixed_part(const Scene& scene) {
  return written(scene, false);
}

}  // namespace openclose
