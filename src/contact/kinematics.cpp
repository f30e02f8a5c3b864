#include "openclose/contact/kinematics.h"

namespace openclose {

ContactKinematics::ContactKinematics(const BlockSystem& system, const Contact& contact, const Unknowns& d_vertex, const Unknowns& d_edge)
    : ContactKinematics(ContactPose(ContactStart(system, contact),
                                    BlockMove(d_vertex, system.rotation_kind(), system.block(contact.vertex_block).radius),
                                    BlockMove(d_edge, system.rotation_kind(), system.block(contact.edge_block).radius))) {}

ContactKinematics::ContactKinematics(const ContactPose& pose)
    : normal(pose.normal),
      tangent(pose.tangent()),
      vertex_arm(pose.vertex_arm),
      edge_arm(pose.edge_arm),
      gap_change(pose.gap_change),
      slip_change(pose.slip_change),
      normal_vertex(Motion::gradient(vertex_arm, normal)),
      normal_edge(-Motion::gradient(edge_arm, normal)),
      shear_vertex(Motion::gradient(vertex_arm, tangent)),
      shear_edge(-Motion::gradient(edge_arm, tangent)) {}

ContactKinematics::Hessian ContactKinematics::hessian(const Vec2& m) const {
  // m . (p - e) depends on the rotation of the edge's block through m and through the lever of p: see the derivation of ContactKinematics.
  Hessian h{Motion::hessian(vertex_arm, m), Matrix::Zero(), Motion::hessian(edge_arm, m)};
  constexpr int r = Motion::rotation_index;
  const Vec2 turned = perpendicular(m);
  h.vertex_edge.block<2, 1>(0, r) = turned;
  h.vertex_edge(r, r) = m.dot(vertex_arm);
  h.edge_edge.block<2, 1>(0, r) = -turned;
  h.edge_edge.block<1, 2>(r, 0) = -turned.transpose();
  return h;
}

}  // namespace openclose
