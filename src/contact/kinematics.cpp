#include "openclose/contact/kinematics.h"

#include <cmath>

namespace openclose {

template <int N>
ContactKinematics<N>::ContactKinematics(const BlockSystem<N>& system, const Contact& contact, const Unknowns& d_vertex, const Unknowns& d_edge) {
  const RotationKind kind = system.rotation_kind();
  const Vec2& arm_p = system.arm(contact.vertex);
  const Vec2& arm_e = system.arm(contact.edge);
  const Vec2 p = system.centroid(contact.vertex_block) + arm_p;
  const Vec2 e = system.centroid(contact.edge_block) + arm_e;
  const Vec2 tangent_0 = (system.arm(system.next(contact.edge)) - arm_e).normalized();
  const Vec2 normal_0 = -perpendicular(tangent_0);

  const Vec2 move_p = Motion<N>::displacement(d_vertex, arm_p, kind);
  const Vec2 move_e = Motion<N>::displacement(d_edge, arm_e, kind);
  // A linearly rotated edge also grows; its direction turns by the arc tangent.
  const double turn = kind == RotationKind::exact ? Motion<N>::rotation(d_edge) : std::atan(Motion<N>::rotation(d_edge));
  const Vec2 normal_change = Motion<N>::turned_by(turn, normal_0, RotationKind::exact);
  normal = normal_0 + normal_change;
  tangent = perpendicular(normal);
  gap_change = normal_change.dot(p - e) + normal.dot(move_p - move_e);
  slip_change = perpendicular(normal_change).dot(p - e) + tangent.dot(move_p - move_e);

  vertex_arm = arm_p + Motion<N>::turned_by(Motion<N>::rotation(d_vertex), arm_p, kind);
  edge_arm = (p - system.centroid(contact.edge_block)) + (move_p - Motion<N>::translation(d_edge));
  normal_vertex = Motion<N>::gradient(vertex_arm, normal);
  normal_edge = -Motion<N>::gradient(edge_arm, normal);
  shear_vertex = Motion<N>::gradient(vertex_arm, tangent);
  shear_edge = -Motion<N>::gradient(edge_arm, tangent);
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
