#include "openclose/analysis/bent_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "openclose/contact/ground_outline.h"
#include "openclose/law/joint_law.h"
#include "openclose/statics/frozen_system.h"
#include "openclose/statics/joint_sections.h"

namespace openclose {

std::string bent_joints_in_words(const Simulation& simulation) {
  const JointTable& joints = simulation.joints();
  if (!joints.has_tension()) return {};
  std::vector<Contact> contacts;
  simulation.state().contacts.for_each([&](const Contact& contact) { contacts.push_back(contact); });
  const double gap = closed_gap * frozen_length_unit(simulation.scene());
  const GroundOutline ground(simulation.system());
  std::vector<Joined> joined;
  for (const Contact& contact : contacts) joined.push_back(joined_at(simulation.system(), ground, contact, gap));
  const std::vector<double> pulls =
      pulls_at_edges(joint_sections(simulation.system(), ground, contacts, joined, gap), contacts.size(), [&](int i) -> EndOfJoint {
        const Contact& contact = contacts[i];
        const ContactStrength strength(joints.joint(contact.joint), contact);
        return {contact.normal_force, contact.status == ContactStatus::open ? 0.0 : strength.tension, contact.length * contact.joint_state.joined};
      });
  constexpr double rounding = 1e-6;  // [-]
  const auto count = std::ranges::count_if(pulls, [](double pull) { return pull > 1.0 + rounding; });
  if (count == 0) return {};
  return fmt::format(
      "at {} contacts joints are bent by up to {:.2g} times what cracks them from their edge (N/L + 6 M/L^2 over tensile_strength_pa): in a motion "
      "each end of a joint parts by itself; fos at small displacements counts it",
      count, std::ranges::max(pulls));
}

}  // namespace openclose
