#include "openclose/scene/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <type_traits>

#include "openclose/scene/angle.h"
#include "openclose/scene/median_size.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

/// What materials, loads and motions have, with room of an order of magnitude and more, for models and for units of model tests. Of vectors the
/// length is judged; 0 is always meant.
struct Usual {
  std::string_view key;
  double low, high;
  std::string_view what;
};

constexpr std::array usual_numbers{
    Usual{"density_kg_per_m3", 50.0, 1e5, "foam has 15 to 30, rock 2,000 to 3,000 (a unit weight of 2e4 to 3e4 N/m3), the heaviest metal 22,600"},
    Usual{"normal_stiffness_pa_per_m", 1e3, 1e15, "joints in rock have 1e7 to 1e12"},
    Usual{"shear_stiffness_pa_per_m", 1e3, 1e15, "joints in rock have 1e6 to 1e12"},
    Usual{"friction_angle_deg", 0.0, 80.0, "rough joints reach 70; cohesion_pa and tensile_strength_pa bond blocks"},
    Usual{"residual_friction_angle_deg", 0.0, 80.0, "rough joints reach 70"},
    Usual{"slip_weakening_distance_m", 0.0, 1.0, "rock joints lose their peak within millimetres to centimetres"},
    Usual{"cohesion_pa", 0.0, 1e10, "intact rock has up to 1e8"},
    Usual{"tensile_strength_pa", 0.0, 1e10, "intact rock has up to 5e7"},
    Usual{"damping_ratio", 0.0, 10.0, "1 is critical"},
    Usual{"velocity_m_per_s", 0.0, 1e3, "falling rock reaches 100"},
    Usual{"angular_velocity_rad_per_s", 0.0, 1e4, "falling rock reaches 100"},
    Usual{"force_n", 0.0, 1e12, "a metre of the highest dam carries 1e8 of water"},
    Usual{"stiffness_n_per_m", 0.0, 1e15, "a bolt has 1e7 to 1e9"},
    Usual{"pressure_pa", 0.0, 1e9, "foundations have 1e5 to 1e6, 100 m of water 1e6"},
    Usual{"shear_pa", 0.0, 1e9, "foundations have less than 1e6"},
    Usual{"acceleration_m_per_s2", 0.0, 1e3, "earthquakes reach 20, machines and blasts some hundred"},
    Usual{"frequency_hz", 1e-4, 1e4, "earthquakes have 0.1 to 30, blasts up to 1,000"},
};

/// [-] Of a block's size: the closure of a joint under the block's own weight, from which on it is no joint between blocks but a cushion.
constexpr double deepest_closure_of_size = 0.1;

/// Writes a warning for each number that is hardly meant.
class Judge {
 public:
  Judge(const Scene& scene, std::vector<std::string>& warnings) : scene_(scene), warnings_(warnings), size_(median_size(scene.blocks)) {}

  void look_at(const Material& material) {
    owner_ = "material " + in_quotes(material.name);
    judge("density_kg_per_m3", material.density);
  }
  void look_at(const JointProperties& joint) {
    owner_ = joint.has_materials() ? fmt::format("joint of {} and {}", name(joint.materials[0]), name(joint.materials[1]))
                                   : "joint " + in_quotes(joint.name);
    const std::size_t before = warnings_.size();
    visit_joint_keys(joint, *this);
    if (warnings_.size() == before) judge_closure(joint);
    judge_gain_by_slip(joint);
  }

  template <class AnyForce>
  void look_at(const AnyForce& force) {
    const std::string name = force.name.empty() ? "" : fmt::format(" \"{}\"", force.name);
    owner_ = fmt::format("{}{} on \"{}\"", force.table().name, name, scene_.blocks[force.block].name);
    AnyForce::visit_keys(force, *this);
  }
  /// The fastest of them alone: a wrong unit is that of all.
  void look_at(const std::vector<BlockInput>& blocks) {
    const auto speed = [](const BlockInput& block) { return block.velocity.norm(); };
    const auto turn = [](const BlockInput& block) { return std::abs(block.angular_velocity); };
    const BlockInput &fastest = *std::ranges::max_element(blocks, {}, speed), &turning = *std::ranges::max_element(blocks, {}, turn);
    owner_ = fmt::format("block \"{}\"", fastest.name);
    judge("velocity_m_per_s", speed(fastest), "length of velocity_m_per_s");
    owner_ = fmt::format("block \"{}\"", turning.name);
    judge("angular_velocity_rad_per_s", turning.angular_velocity);
  }
  void look_at(const BaseMotionInput& motion) {
    owner_ = "base_motion";
    if (motion.kind == BaseMotionKind::harmonic) {
      judge("frequency_hz", motion.frequency);
      judge("acceleration_m_per_s2", motion.factor * motion.amplitude.norm(), "factor times the length of amplitude_m_per_s2");
    }
    double largest = 0.0;
    for (const BasePulse& pulse : motion.pulses) largest = std::max(largest, pulse.acceleration.norm());
    for (const AccelerationRecord* record : {&motion.horizontal, &motion.vertical}) {
      for (const double acceleration : record->accelerations) largest = std::max(largest, std::abs(acceleration));
    }
    judge("acceleration_m_per_s2", motion.factor * largest, "factor times the largest acceleration");
  }

  template <typename T, typename Accepted>
  void operator()(const Key& key, const T& member, const Accepted&) {
    constexpr bool is_angle = std::is_same_v<Accepted, Degrees>;
    if constexpr (std::is_same_v<T, double>) {
      judge(key.name, is_angle ? degrees(member) : member);
    } else if constexpr (std::is_same_v<T, std::optional<double>>) {
      if (member) judge(key.name, is_angle ? degrees(*member) : *member);
    } else if constexpr (std::is_same_v<T, Vec2>) {
      judge(key.name, member.norm(), fmt::format("length of {}", key.name));
    }
  }

 private:
  std::string name(int material) const { return in_quotes(scene_.materials[material].name); }

  /// [kg/m3] Of the heavier of its materials, or of any that a named joint may come between.
  double density_at(const JointProperties& joint) const {
    if (joint.has_materials()) return std::max(scene_.materials[joint.materials[0]].density, scene_.materials[joint.materials[1]].density);
    return std::ranges::max(scene_.materials, {}, &Material::density).density;
  }

  /// Of springs that are soft enough for blocks to sink into each other.
  void judge_closure(const JointProperties& joint) {
    if (!size_) return;
    const double closure = density_at(joint) * scene_.gravity.norm() * *size_ / joint.normal_stiffness;
    if (closure <= deepest_closure_of_size * *size_) return;
    warnings_.push_back(
        fmt::format("{}: {}: normal_stiffness_pa_per_m = {} is hardly meant: under its own weight a block of {:.2g} m, the median of the free ones, "
                    "sinks {:.2g} m into the one below",
                    scene_.where.file, owner_, joint.normal_stiffness, *size_, closure));
  }

  /// Of a line of Mohr and Coulomb that turns about its cohesion as slip takes friction: on the side of tension it rises.
  void judge_gain_by_slip(const JointProperties& joint) {
    const bool pulls_with_less_friction = joint.softens() && joint.slip_weakening_distance > 0.0 && joint.tensile_strength > 0.0;
    if (!pulls_with_less_friction || joint.cohesion == 0.0 || joint.cohesion_behaviour != CohesionBehaviour::ductile) return;
    const double lost = std::tan(joint.friction_angle) - std::tan(*joint.residual_friction_angle);
    warnings_.push_back(
        fmt::format("{}: {}: slip takes its friction and leaves cohesion and tensile strength, so that it bears up to {:.4g} Pa more shear where it "
                    "pulls while it slips over slip_weakening_distance_m; with cohesion_behaviour = \"lost_on_slip\" it never does",
                    scene_.where.file, owner_, joint.tensile_strength * lost));
  }

  /// \param told_as  what it is called in the scene, if not by the key whose usual numbers are its own
  void judge(std::string_view key, double value, std::string_view told_as = "") {
    for (const Usual& usual : usual_numbers) {
      const double size = std::abs(value);
      if (usual.key != key || size == 0.0 || (size >= usual.low && size <= usual.high)) continue;
      warnings_.push_back(
          fmt::format("{}: {}: {} = {} is hardly meant: {}", scene_.where.file, owner_, told_as.empty() ? key : told_as, value, usual.what));
    }
  }

  const Scene& scene_;
  std::vector<std::string>& warnings_;
  std::optional<double> size_;  ///< [m] of the median free block
  std::string owner_;
};

}  // namespace

std::vector<std::string> implausible_numbers(const Scene& scene) {
  std::vector<std::string> warnings;
  Judge judge(scene, warnings);
  for (const Material& material : scene.materials) judge.look_at(material);
  for (const JointProperties& joint : scene.joints) judge.look_at(joint);
  if (!scene.blocks.empty()) judge.look_at(scene.blocks);
  for_each_force(scene, [&](const auto& force) { judge.look_at(force); });
  if (scene.base_motion) judge.look_at(*scene.base_motion);
  return warnings;
}

}  // namespace openclose
