// What the contacts of a FrozenSystem carry and where its blocks are; what the joints can carry at a strength reduction factor.
#pragma once

#include <vector>

#include "openclose/law/joint_law.h"
#include "openclose/statics/frozen_system.h"

namespace openclose {

/// Forces and memory of one contact.
struct FrozenContactState {
  double gap = 0.0;     ///< in closures; the normal spring's stretch
  double normal = 0.0;  ///< compression positive
  double shear = 0.0;   ///< also what the shear spring remembers
  double slip = 0.0;    ///< in closures: of friction, since slip last took strength from the joint
  JointState joint_state;
  ContactStatus status = ContactStatus::sticking;

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f] = *this;
    archive(a, b, c, d, e, f);
    archive.require(status <= ContactStatus::sliding, "the saved state has a contact with a status that there is not");
  }
};

struct FrozenState {
  std::vector<FrozenContactState> contacts;
  std::vector<double> supports;           ///< force of each along its direction
  std::vector<BlockVector> displacement;  ///< in closures, since the drawing

  FrozenState() = default;
  explicit FrozenState(const FrozenSystem& system)
      : contacts(system.contacts().size()), supports(system.supports().size(), 0.0), displacement(system.blocks().size(), BlockVector::Zero()) {}

  void exchange(Archive& archive) {
    auto& [a, b, c] = *this;
    archive(a, b, c);
  }
  /// Whether one that was read is of these blocks.
  bool fits(const FrozenSystem& system) const {
    return contacts.size() == system.contacts().size() && supports.size() == system.supports().size() &&
           displacement.size() == system.blocks().size();
  }
};

/// Strengths of all contacts at a factor, over the unit of force.
class FrozenStrength {
 public:
  FrozenStrength(const FrozenSystem& system, const Scene& scene);
  /// Divides tan(friction angle), cohesion and tensile strength by the factor.
  void reduce(double factor);
  double factor() const { return factor_; }
  /// Of contact i, with what the state of its joint leaves it.
  ContactStrength of(std::size_t i, const JointState& state) const;
  /// What is left of the joint after a state of the contact.
  /// \param slip  in closures
  JointState joint_after(std::size_t i, const FrozenContactState& state, double slip) const;
  bool can_lose(std::size_t i, const JointState& state) const;
  /// See joint_sections.h.
  std::vector<double> pulls_at_edges(const FrozenState& state) const;
  /// Whether the joint has strength that goes with the length of slip and not with the first one.
  bool weakens_along_slip(std::size_t i, const JointState& state) const;
  double loss(std::size_t i, const JointState& before, const JointState& after) const;
  bool has_tension() const { return joints_.has_tension(); }

 private:
  const FrozenSystem& system_;
  JointTable joints_;
  double factor_ = 1.0;
};

/// Whether the slip of a state takes strength from joints, or what they lose by slip waits until the blocks are at rest. Bonds that slip breaks at
/// once are broken in either case.
enum class SlipOfState { counts, waits };
/// Takes from joints the strength that the states of their contacts do not leave them.
/// \return [-] the largest loss of a joint, see loss() in joint_law.h
double lose_strength(const FrozenStrength& strength, FrozenState& state, SlipOfState slip = SlipOfState::counts);

/// In closures: the largest component of what blocks have moved between two states.
double farthest_between(const FrozenState& a, const FrozenState& b);

/// The unbalanced force of each block: load, contacts and supports.
std::vector<BlockVector> unbalanced_forces(const FrozenSystem& system, const FrozenState& state);
/// The sum of the magnitudes of the forces on each block: the scale of what rounding leaves of their sum.
std::vector<double> force_magnitudes(const FrozenSystem& system, const FrozenState& state);

}  // namespace openclose
