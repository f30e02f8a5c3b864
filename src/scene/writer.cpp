#include "openclose/scene/writer.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "openclose/scene/angle.h"
#include "openclose/scene/names.h"

namespace openclose {
namespace {

std::string toml(double number) {
  // TOML knows no signed zero among its integers.
  return number == 0.0 && std::signbit(number) ? "-0.0" : fmt::format("{}", number);
}
std::string toml(int number) {
  return fmt::format("{}", number);
}
std::string toml(bool flag) {
  return flag ? "true" : "false";
}
std::string toml(const Vec2& vector) {
  return fmt::format("[{}, {}]", toml(vector.x()), toml(vector.y()));
}

std::string toml(std::string_view text) {
  std::string literal = "\"";
  for (const char character : text) {
    if (static_cast<unsigned char>(character) < 0x20 || character == 0x7f) {
      literal += fmt::format("\\u{:04X}", static_cast<unsigned char>(character));
    } else {
      if (character == '"' || character == '\\') literal += '\\';
      literal += character;
    }
  }
  return literal + '"';
}

template <typename T>
std::string toml(const std::vector<T>& list) {
  std::vector<std::string> items;
  for (const T& item : list) items.push_back(toml(item));
  return fmt::format("[{}]", fmt::join(items, ", "));
}

class Text {
 public:
  void header(std::string_view header) { text_ += fmt::format("\n{}\n", header); }
  template <typename T>
  void line(std::string_view key, const T& value) {
    text_ += fmt::format("{} = {}\n", key, toml(value));
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
    text.line("materials", std::vector<std::string_view>{scene.materials[joint.materials[0]].name, scene.materials[joint.materials[1]].name});
    text.line("normal_stiffness_pa_per_m", joint.normal_stiffness);
    text.line("shear_stiffness_pa_per_m", joint.shear_stiffness);
    text.line("friction_angle_deg", degrees(joint.friction_angle));
    text.line_unless(0.0, "cohesion_pa", joint.cohesion);
    text.line_unless(0.0, "tensile_strength_pa", joint.tensile_strength);
    text.line("cohesion_behaviour", word_for(cohesion_behaviour_words, joint.cohesion_behaviour));
    text.line_unless(0.0, "damping_ratio", joint.damping_ratio);
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
  }
}

void write_points(Text& text, const Scene& scene) {
  for (const Support& support : scene.supports) {
    text.header("[[support]]");
    text.line("block", std::string_view(scene.blocks[support.block].name));
    text.line("point_m", support.point);
    text.line("stiffness_n_per_m", support.stiffness);
  }
  for (const Load& load : scene.loads) {
    text.header("[[load]]");
    text.line("block", std::string_view(scene.blocks[load.block].name));
    text.line("point_m", load.point);
    text.line("force_n", load.force);
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

void write_method(Text& text, const MethodInput& method) {
  text.header("[method]");
  text.line("contact", std::string_view(method.contact));
  if (method.integrator) text.line("integrator", std::string_view(*method.integrator));
  if (method.theta) text.line("theta", *method.theta);
  if (method.rho_inf) text.line("rho_inf", *method.rho_inf);
  if (method.dissipation) text.line("dissipation", *method.dissipation);
  if (method.first_integrator) {
    text.line("first_integrator", std::string_view(*method.first_integrator));
    text.line("first_integrator_s", method.first_integrator_time);
  }
  text.line("rotation", word_for(rotation_words, method.rotation));
  text.line("start", word_for(start_words, method.start));
  text.line("statics", method.statics);
  text.line("residual_tolerance", method.residual_tolerance);
  text.line("max_iterations", method.max_iterations);
  text.line("linear_solver", word_for(linear_solver_words, method.linear_solver));
  text.line("static_solver", word_for(static_solver_words, method.static_solver));
  text.line("skip_search", method.skip_search);
  text.line("skip_narrow_phase", method.skip_narrow_phase);
  text.line("skip_looks", method.skip_looks);
  if (method.contact_skin) text.line("contact_skin_m", *method.contact_skin);
  text.line("skip_reload", method.skip_reload);
  text.line("skip_factorisation", method.skip_factorisation);
  text.line("skip_symbolic", method.skip_symbolic);
  text.line("skip_balanced", method.skip_balanced);
  text.line("skip_unmoved", method.skip_unmoved);
  text.line("skip_resting", method.skip_resting);
  text.line("threads", method.threads);
  text.line("gap_tolerance_m", method.gap_tolerance);
  if (method.penalty) text.line("penalty_pa_per_m", *method.penalty);
  text.line("penalty_shear_ratio", method.penalty_shear_ratio);
  if (method.penetration_tolerance) text.line("penetration_tolerance_m", *method.penetration_tolerance);
  text.line("closing_tolerance_m", method.closing_tolerance);
  text.line("max_open_close_iterations", method.max_open_close_iterations);
  text.line("step_cut", method.step_cut);
  text.line("step_fraction", method.step_fraction);
  text.line("damping", word_for(mass_damping_words, method.damping));
  text.line("local_damping", method.local_damping);
}

void write_run(Text& text, const Scene& scene) {
  text.header("[step]");
  text.line_unless(0.0, "dt_s", scene.step.dt);
  text.line("max_displacement_m", scene.step.max_displacement);
  text.line("smallest_fraction", scene.step.smallest_fraction);
  text.line("adaptive", scene.step.adaptive);
  text.line("error_tolerance_m", scene.step.error_tolerance);
  text.line("look_ahead", scene.step.look_ahead);
  text.header("[rest]");
  text.line("time_s", scene.rest.time);
  text.line("displacement_m", scene.rest.displacement);
  text.line("acceleration_m_per_s2", scene.rest.acceleration);
  text.header("[run]");
  text.line("strength_reduction_factor", scene.run_strength_reduction_factor);
  if (scene.settled_by) text.line("settled_by", std::string_view(*scene.settled_by));
  text.header("[end]");
  text.line("time_s", scene.end_time);
  if (scene.end_displacement) text.line("displacement_m", *scene.end_displacement);
  text.header("[output]");
  text.line("every_s", scene.output_every);
  text.line("checkpoint_every_s", scene.checkpoint_every);
  text.line("milestones_m", scene.milestones);
  text.line("snapshots_s", scene.snapshot_times);
  text.line("snapshots_every_s", scene.snapshots_every);
  text.line("vtk", scene.vtk);
}

void write_statics(Text& text, const SettleInput& settle, const StrengthReductionInput& reduction) {
  text.header("[settle]");
  text.line("criterion", word_for(settle_criterion_words, settle.criterion));
  text.line("unbalanced_fraction", settle.unbalanced_fraction);
  text.line("first_dt_s", settle.first_dt);
  text.line("max_steps", settle.max_steps);
  text.line("max_explicit_steps", settle.max_explicit_steps);
  text.line("keep_bonds", settle.keep_bonds);
  text.line("failure_displacement_m", settle.failure_displacement);
  text.line("relative_displacement", settle.relative_displacement);
  text.line("steady_steps", settle.steady_steps);
  text.line("max_time_steps", settle.max_time_steps);
  text.line("unbalanced_force_n", settle.unbalanced_force);
  text.header("[strength_reduction]");
  text.line("definition", word_for(factor_definition_words, reduction.definition));
  text.line("limit_analysis", reduction.limit_analysis);
  text.line("width", reduction.width);
  text.line("upper_limit", reduction.upper_limit);
  text.line("curve", reduction.curve);
  if (reduction.curve_time) text.line("curve_time_s", *reduction.curve_time);
}

}  // namespace

std::string write_scene(const Scene& scene) {
  Text text;
  text.line("title", std::string_view(scene.title));
  text.line("gravity_m_per_s2", scene.gravity);
  write_materials(text, scene);
  write_joints(text, scene);
  write_blocks(text, scene);
  write_points(text, scene);
  if (scene.base_motion) write_base_motion(text, *scene.base_motion);
  write_method(text, scene.method);
  write_run(text, scene);
  write_statics(text, scene.settle, scene.strength_reduction);
  return text.text();
}

}  // namespace openclose
