#include "openclose/scene/plausibility.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <type_traits>

#include "openclose/scene/angle.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

/// What materials have, with room of an order of magnitude and more, for models and for units of model tests.
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
    Usual{"cohesion_pa", 0.0, 1e10, "intact rock has up to 1e8"},
    Usual{"tensile_strength_pa", 0.0, 1e10, "intact rock has up to 5e7"},
    Usual{"damping_ratio", 0.0, 10.0, "1 is critical"},
};

/// Writes a warning for each number that is none of a material.
class Judge {
 public:
  Judge(const Scene& scene, std::vector<std::string>& warnings) : scene_(scene), warnings_(warnings) {}

  void look_at(const Material& material) {
    owner_ = "material " + in_quotes(material.name);
    judge("density_kg_per_m3", material.density);
  }
  void look_at(const JointProperties& joint) {
    owner_ = joint.has_materials() ? fmt::format("joint of {} and {}", name(joint.materials[0]), name(joint.materials[1]))
                                   : "joint " + in_quotes(joint.name);
    visit_joint_keys(joint, *this);
  }

  template <typename T, typename Accepted>
  void operator()(const Key& key, const T& member, const Accepted&) {
    constexpr bool is_angle = std::is_same_v<Accepted, Degrees>;
    if constexpr (std::is_same_v<T, double>) {
      judge(key.name, is_angle ? degrees(member) : member);
    } else if constexpr (std::is_same_v<T, std::optional<double>>) {
      if (member) judge(key.name, is_angle ? degrees(*member) : *member);
    }
  }

 private:
  std::string name(int material) const { return in_quotes(scene_.materials[material].name); }

  void judge(std::string_view key, double value) {
    for (const Usual& usual : usual_numbers) {
      if (usual.key != key || (value >= usual.low && value <= usual.high)) continue;
      warnings_.push_back(fmt::format("{}: {}: {} = {} is hardly meant: {}", scene_.where.file, owner_, key, value, usual.what));
    }
  }

  const Scene& scene_;
  std::vector<std::string>& warnings_;
  std::string owner_;
};

}  // namespace

std::vector<std::string> implausible_numbers(const Scene& scene) {
  std::vector<std::string> warnings;
  Judge judge(scene, warnings);
  for (const Material& material : scene.materials) judge.look_at(material);
  for (const JointProperties& joint : scene.joints) judge.look_at(joint);
  return warnings;
}

}  // namespace openclose
