#include "openclose/analysis/measured_contacts.h"

namespace openclose {
namespace {

bool lies_on(const Contact& contact, const DrawnJoint& joint, const BlockSystem& system) {
  const auto on = [&](int vertex_block, int edge_block, int edge) {
    return contact.vertex_block == vertex_block && contact.edge_block == edge_block && contact.edge == system.block(edge_block).first_vertex + edge;
  };
  return on(joint.block_a, joint.block_b, joint.edge_b) || on(joint.block_b, joint.block_a, joint.edge_a);
}

}  // namespace

MeasuredContacts::MeasuredContacts(const Scene& scene) {
  for (const MeasuredContact& m : scene.measured_contacts) joints_.push_back(joint_at(scene, m.block_a, m.block_b, m.point));
}

std::vector<ContactMotion> MeasuredContacts::motions(const Simulation& simulation) const {
  if (joints_.empty()) return {};
  const BlockSystem& system = simulation.system();
  std::vector<ContactMotion> list;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const JointGap gap = joint_motion(joints_[i], system).from;
    ContactMotion m;
    m.name = simulation.scene().measured_contacts[i].name;
    m.gap = gap.opening;
    m.slip = gap.slip;
    int sliding = 0;
    simulation.state().contacts.for_each([&](const Contact& c) {
      if (c.status == ContactStatus::open || !lies_on(c, joints_[i], system)) return;
      m.normal_force += c.normal_force;
      // Along opposite edges: the force on a along that of b is the one on b along that of a.
      m.shear_force += c.shear_force;
      ++m.closed;
      if (c.status == ContactStatus::sliding) ++sliding;
    });
    if (m.closed > 0) m.status = sliding == m.closed ? ContactStatus::sliding : ContactStatus::sticking;
    list.push_back(m);
  }
  return list;
}

}  // namespace openclose
