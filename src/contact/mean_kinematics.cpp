#include "openclose/contact/mean_kinematics.h"

namespace openclose {

template <int N>
MeanKinematics<N>::MeanKinematics(const BlockSystem<N>& system, const Contact& contact, const ContactKinematics<N>& end) {
  const Vec2& arm_p = system.arm(contact.vertex);
  const Vec2 p = system.centroid(contact.vertex_block) + arm_p;
  const Vec2 tangent_0 = (system.arm(system.next(contact.edge)) - system.arm(contact.edge)).normalized();
  vertex_arm = 0.5 * (arm_p + end.vertex_arm);
  edge_arm = 0.5 * ((p - system.centroid(contact.edge_block)) + end.edge_arm);
  tangent = 0.5 * (tangent_0 + end.tangent);
  normal = -perpendicular(tangent);
  normal_vertex = Motion<N>::gradient(vertex_arm, normal);
  normal_edge = -Motion<N>::gradient(edge_arm, normal);
  shear_vertex = Motion<N>::gradient(vertex_arm, tangent);
  shear_edge = -Motion<N>::gradient(edge_arm, tangent);
}

template <int N>
typename MeanKinematics<N>::Derivative MeanKinematics<N>::derivative(const ContactKinematics<N>& end, double normal_force, double shear_force) const {
  constexpr int r = Motion<N>::rotation_index;
  const Vec2 force = normal_force * normal + shear_force * tangent;
  // The force turns with the edge by half its rotation, the levers by half of what they do at the end.
  const Vec2 turning = 0.5 * perpendicular(normal_force * end.normal + shear_force * end.tangent);
  const double vertex_lever = 0.5 * cross(perpendicular(end.vertex_arm), force);
  Derivative d;
  d.vertex_vertex(r, r) = vertex_lever;
  d.vertex_edge.template block<2, 1>(0, r) = turning;
  d.vertex_edge(r, r) = cross(vertex_arm, turning);
  const Vec2 translation_lever = 0.5 * Vec2(force.y(), -force.x());  // derivative of (u x force)/2 by u
  d.edge_vertex.template block<1, 2>(r, 0) = -translation_lever.transpose();
  d.edge_vertex(r, r) = -vertex_lever;
  d.edge_edge.template block<2, 1>(0, r) = -turning;
  d.edge_edge.template block<1, 2>(r, 0) = translation_lever.transpose();
  d.edge_edge(r, r) = -cross(edge_arm, turning);
  return d;
}

template struct MeanKinematics<3>;

}  // namespace openclose
