#include "openclose/contact/kinematics.h"

namespace openclose {

template <int N>
ContactKinematics<N>::ContactKinematics(const BlockSystem<N>& system, const Contact& contact, const Unknowns& d_vertex, const Unknowns& d_edge)
    : ContactKinematics(ContactPose<N>(ContactStart<N>(system, contact),
                                       BlockMove<N>(d_vertex, system.rotation_kind(), system.block(contact.vertex_block).radius),
                                       BlockMove<N>(d_edge, system.rotation_kind(), system.block(contact.edge_block).radius))) {}

template <int N>
ContactKinematics<N>::ContactKinematics(const ContactPose<N>& pose)
    : normal(pose.normal),
      tangent(pose.tangent()),
      vertex_arm(pose.vertex_arm),
      edge_arm(pose.edge_arm),
      gap_change(pose.gap_change),
      slip_change(pose.slip_change),
      normal_vertex(Motion<N>::gradient(vertex_arm, normal)),
      normal_edge(-Motion<N>::gradient(edge_arm, normal)),
      shear_vertex(Motion<N>::gradient(vertex_arm, tangent)),
      shear_edge(-Motion<N>::gradient(edge_arm, tangent)) {}

template <int N>
ContactPose<N> ContactKinematics<N>::pose() const {
  ContactPose<N> p;
  p.normal = normal;
  p.vertex_arm = vertex_arm;
  p.edge_arm = edge_arm;
  p.gap_change = gap_change;
  p.slip_change = slip_change;
  return p;
}

template <int N>
typename ContactKinematics<N>::Hessian ContactKinematics<N>::hessian(const Vec2& m) const {
  // m . (p - e) depends on the rotation of the edge's block through m and through the lever of p: see the derivation of ContactKinematics.
  Hessian h{Motion<N>::hessian(vertex_arm, m), Matrix::Zero(), Motion<N>::hessian(edge_arm, m)};
  constexpr int r = Motion<N>::rotation_index;
  const Vec2 turned = perpendicular(m);
  h.vertex_edge.template block<2, 1>(0, r) = turned;
  h.vertex_edge(r, r) = m.dot(vertex_arm);
  h.edge_edge.template block<2, 1>(0, r) = -turned;
  h.edge_edge.template block<1, 2>(r, 0) = -turned.transpose();
  return h;
}

template struct ContactKinematics<3>;

}  // namespace openclose
