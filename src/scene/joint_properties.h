// What the user wrote of a joint, and its rows: reader, writer, docs/keys.md and the schema go through them. What a contact carries with these
// parameters is said in law/joint_law.h, which solvers ask for strength.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "openclose/scene/key.h"

namespace openclose {

/// What happens to the cohesion of a joint that has failed; its tensile strength is gone once it has opened, whatever this says.
enum class CohesionBehaviour { ductile, lost_on_opening, lost_on_slip };

inline constexpr std::array cohesion_behaviour_words{
    Word{"ductile", CohesionBehaviour::ductile, "kept for ever"},
    Word{"lost_on_opening", CohesionBehaviour::lost_on_opening, "gone once the contact has opened"},
    Word{"lost_on_slip", CohesionBehaviour::lost_on_slip, "gone once the contact has slipped or opened"},
};

/// Mohr-Coulomb joint with tension cut-off: for an unordered pair of materials, for the seams that name it, or for both.
struct JointProperties {
  static constexpr int no_material = -1;

  std::string name;                ///< empty: no seam can name it
  std::array<int, 2> materials{};  ///< indices into Scene::materials, or twice no_material
  double normal_stiffness = 0.0;   ///< [Pa/m]
  double shear_stiffness = 0.0;    ///< [Pa/m]
  double friction_angle = 0.0;     ///< [rad]
  double cohesion = 0.0;           ///< [Pa]
  double tensile_strength = 0.0;   ///< [Pa]
  CohesionBehaviour cohesion_behaviour = CohesionBehaviour::ductile;
  /// [rad] Of a contact whose bond is broken, by slip too if it is below the friction angle; absent: that angle, and slip breaks no bond for it.
  std::optional<double> residual_friction_angle;
  /// [m] Slip over which joints that weaken by slip lose, linearly, what it takes from them; 0: the first slip takes all.
  double slip_weakening_distance = 0.0;
  double damping_ratio = 0.0;  ///< [-] of dashpots parallel to the springs, see law/joint_law.h

  bool has_materials() const { return materials[0] != no_material; }
  bool softens() const { return residual_friction_angle && *residual_friction_angle < friction_angle; }
  bool weakens_by_slip() const { return softens() || cohesion_behaviour == CohesionBehaviour::lost_on_slip; }
  /// Tangents of both friction angles, cohesion and tensile strength divided by a strength reduction factor.
  JointProperties reduced_by(double factor) const {
    JointProperties weaker = *this;
    weaker.friction_angle = std::atan(std::tan(friction_angle) / factor);
    if (residual_friction_angle) weaker.residual_friction_angle = std::atan(std::tan(*residual_friction_angle) / factor);
    weaker.cohesion = cohesion / factor;
    weaker.tensile_strength = tensile_strength / factor;
    return weaker;
  }
};

/// The keys of [[joint]], but for its name and its two materials.
template <class Joint, class Visitor>
void visit_joint_keys(Joint& j, Visitor& visit) {
  visit({.name = "normal_stiffness_pa_per_m", .says = "of the springs across the joint, for a square metre of it", .required = true},
        j.normal_stiffness, positive);
  visit({.name = "shear_stiffness_pa_per_m", .says = "of the springs along it", .required = true}, j.shear_stiffness, positive);
  visit({.name = "friction_angle_deg", .says = "of Mohr and Coulomb's law", .required = true}, j.friction_angle,
        Degrees{{.low = 0.0, .high = 90.0, .low_included = true}});
  visit({"cohesion_pa", "of Mohr and Coulomb's law"}, j.cohesion, not_negative);
  visit({"tensile_strength_pa", "gone once the joint has opened"}, j.tensile_strength, not_negative);
  visit({"cohesion_behaviour", "when the cohesion is lost, if ever"}, j.cohesion_behaviour, cohesion_behaviour_words);
  visit({"residual_friction_angle_deg",
         "at most the friction angle: of a contact that has slipped or opened, for good, and of contacts that form later; the tensile strength, and "
         "cohesion that is not ductile, go with the difference",
         "the friction angle"},
        j.residual_friction_angle, Degrees{{.low = 0.0, .high = 90.0, .low_included = true}});
  visit(
      {"slip_weakening_distance_m",
       "slip over which friction falls to residual_friction_angle_deg, and cohesion that is lost on slip to nothing, linearly; slip to and fro adds "
       "up; rock joints have millimetres to centimetres; 0: at the first slip"},
      j.slip_weakening_distance, not_negative);
  visit({"damping_ratio", "dashpots beside the joint's springs, see [methods](methods.md)"}, j.damping_ratio, not_negative);
}

/// Why a value cannot be, beside what its own range says, and what can: of a key that the file gives.
struct JointContradiction {
  std::string_view key, read, accepted;
};
/// The first contradiction between the values of a joint, if there is one.
inline std::optional<JointContradiction> contradiction_in(const JointProperties& joint) {
  if (joint.residual_friction_angle && *joint.residual_friction_angle > joint.friction_angle)
    return JointContradiction{"residual_friction_angle_deg", "it is above the friction angle", "an angle up to friction_angle_deg"};
  if (joint.softens() && joint.cohesion_behaviour == CohesionBehaviour::lost_on_opening) {
    return JointContradiction{"cohesion_behaviour", "with a lower residual friction angle slip breaks the bond, and this cohesion would go with it",
                              "\"ductile\" or \"lost_on_slip\", or no residual_friction_angle_deg"};
  }
  const bool loses_by_slip = joint.softens() || (joint.weakens_by_slip() && (joint.cohesion > 0.0 || joint.tensile_strength > 0.0));
  if (joint.slip_weakening_distance > 0.0 && !loses_by_slip) {
    return JointContradiction{
        "slip_weakening_distance_m", "slip takes no strength from this joint",
        "0, or a residual_friction_angle_deg below friction_angle_deg, or a cohesion_pa with cohesion_behaviour = \"lost_on_slip\""};
  }
  return std::nullopt;
}

}  // namespace openclose
