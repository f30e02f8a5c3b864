// Second derivatives of a contact's gap and slip and its stiffness, written plainly: what the kernels of src/integrator/contact_batch.cpp are
// compared with, and what is itself compared with difference quotients (tests/contact).
#pragma once

#include "openclose/contact/kinematics.h"

namespace openclose::test {

/// Second derivatives of m . (p - e), m turning with the edge's block: blocks (vertex, vertex), (vertex, edge), (edge, edge).
struct ContactHessian {
  Motion::Matrix vertex_vertex, vertex_edge, edge_edge;

  ContactHessian(const ContactKinematics& at, const Vec2& m)
      : vertex_vertex(Motion::hessian(at.vertex_arm, m)), vertex_edge(Motion::Matrix::Zero()), edge_edge(Motion::hessian(at.edge_arm, m)) {
    // m . (p - e) depends on the rotation of the edge's block through m and through the lever of p: see the derivation of ContactKinematics.
    constexpr int r = Motion::rotation_index;
    const Vec2 turned = perpendicular(m);
    vertex_edge.block<2, 1>(0, r) = turned;
    vertex_edge(r, r) = m.dot(at.vertex_arm);
    edge_edge.block<2, 1>(0, r) = -turned;
    edge_edge.block<1, 2>(r, 0) = -turned.transpose();
  }
};

/// Stiffness of a contact: the four blocks of minus the derivative of the generalised forces by the unknowns. The force f acts at p on the vertex's
/// block and -f on the edge's, at its arms; `by_shift` is minus its derivative by the displacement of p against the edge's block, `turning` the
/// part of it that turns with that block (for second derivatives; zero leaves them out).
struct ContactStiffness {
  using Block = Motion::Matrix;
  double shift_xx, shift_xy, shift_yx, shift_yy;  ///< [N/m]
  Vec2 force_vertex_arm, force_edge_arm;          ///< [m] where the force acts
  Vec2 vertex_arm, edge_arm;                      ///< [m] of the contact's motion: the same, unless the force is a mean over a path
  Vec2 turning = Vec2::Zero();                    ///< [N]
  Vec2 on_arms = Vec2::Zero();                    ///< [N] the part of the force whose arms follow the motion; zero with `turning`

  void add_to_vertex(Block& k) const { add(k, 1.0, force_vertex_arm, vertex_arm, on_arms.dot(vertex_arm), Vec2::Zero(), Vec2::Zero()); }
  void add_to_edge(Block& k) const {
    add(k, 1.0, force_edge_arm, edge_arm, turning.dot(force_edge_arm), perpendicular(turning), perpendicular(on_arms));
  }
  void add_to_vertex_edge(Block& k) const {
    add(k, -1.0, force_vertex_arm, edge_arm, -turning.dot(force_vertex_arm), -perpendicular(turning), Vec2::Zero());
  }
  void add_to_edge_vertex(Block& k) const {
    add(k, -1.0, force_edge_arm, vertex_arm, -on_arms.dot(vertex_arm), Vec2::Zero(), -perpendicular(on_arms));
  }

 private:
  /// sign J(force_arm)' shift J(path_arm), J(r) = [1, perpendicular(r)], and the second derivatives: corner, rotation column, rotation row.
  void add(Block& k, double sign, const Vec2& force_arm, const Vec2& path_arm, double corner, const Vec2& column, const Vec2& row) const {
    const double column_x = shift_xy * path_arm.x() - shift_xx * path_arm.y(), column_y = shift_yy * path_arm.x() - shift_yx * path_arm.y();
    const double row_x = shift_yx * force_arm.x() - shift_xx * force_arm.y(), row_y = shift_yy * force_arm.x() - shift_xy * force_arm.y();
    k(0, 0) += sign * shift_xx;
    k(1, 0) += sign * shift_yx;
    k(2, 0) += sign * row_x + row.x();
    k(0, 1) += sign * shift_xy;
    k(1, 1) += sign * shift_yy;
    k(2, 1) += sign * row_y + row.y();
    k(0, 2) += sign * column_x + column.x();
    k(1, 2) += sign * column_y + column.y();
    k(2, 2) += sign * (force_arm.x() * column_y - force_arm.y() * column_x) + corner;
  }
};

}  // namespace openclose::test
