// Gap and slip of a contact as functions of the unknowns of its two blocks, with exact first derivatives (for Shi's linear rotation they are exact
// where the step starts).
//
// With p the vertex, e the first point of the edge, n its outward normal, t its direction: gap g = n . (p - e), slip s = t . (p - e), the edge
// turning with its block. Their gradients are the generalised forces of unit forces n, t on the vertex's block and -n, -t on the edge's block, both
// at p: action and reaction share one line, so that contacts never change the angular momentum.
#pragma once

#include <cmath>

#include "openclose/contact/contact.h"
#include "openclose/core/packs.h"
#include "openclose/model/block_system.h"

namespace openclose {

/// Motion of one block within a step, its sines computed once for all its contacts.
struct BlockMove {
  Vec2 translation = Vec2::Zero();  ///< [m]
  double sine = 0.0;                ///< of the rotation
  double versine = 0.0;             ///< 1 - cosine, free of cancellation
  double edge_sine = 0.0;           ///< of the angle by which the edges' directions turn
  double edge_versine = 0.0;
  double bound = 0.0;   ///< [m] no point of the block moves farther than this
  double unused = 0.0;  ///< the kernels load four numbers at a time

  BlockMove() = default;  ///< no motion
  /// \param radius  [m] of the block, for the bound
  BlockMove(const Motion::Unknowns& d, RotationKind kind, double radius)
      : translation(Motion::translation(d)), bound(Motion::displacement_bound(d, radius)) {
    const double angle = Motion::rotation(d);
    // A linearly rotated edge also grows; its direction turns by the arc tangent.
    const SineCosine half(0.5 * (kind == RotationKind::exact ? angle : std::atan(angle)));
    edge_sine = 2.0 * half.sine * half.cosine;
    edge_versine = 2.0 * half.sine * half.sine;
    sine = kind == RotationKind::exact ? edge_sine : angle;
    versine = kind == RotationKind::exact ? edge_versine : 0.0;
  }

  Vec2 displacement(const Vec2& arm) const { return translation + (sine * perpendicular(arm) - versine * arm); }
};

/// Where a contact is, as the system has it.
struct ContactPlace {
  Vec2 vertex_arm, end_arm, lever;  ///< [m] as in ContactStart
  Vec2 edge;                        ///< [m] from e to the edge's other end

  ContactPlace() = default;
  ContactPlace(const BlockSystem& system, const Contact& contact)
      : ContactPlace(system, contact, system.centroid(contact.vertex_block), system.centroid(contact.edge_block)) {}
  /// With the centroids of its two blocks.
  ContactPlace(const BlockSystem& system, const Contact& contact, const Vec2& vertex_centroid, const Vec2& edge_centroid)
      : vertex_arm(system.arm(contact.vertex)),
        end_arm(system.arm(contact.edge)),
        lever((vertex_centroid + vertex_arm) - (edge_centroid + end_arm)),
        edge(system.arm(system.next(contact.edge)) - end_arm) {}
};

/// A contact at the start of a step.
struct ContactStart {
  Vec2 normal;
  Vec2 vertex_arm;  ///< [m] from the centroid of the vertex's block to p
  Vec2 end_arm;     ///< [m] from the centroid of the edge's block to e
  Vec2 lever;       ///< [m] from e to p

  ContactStart() = default;
  explicit ContactStart(const ContactPlace& at)
      : normal(-perpendicular(at.edge.normalized())), vertex_arm(at.vertex_arm), end_arm(at.end_arm), lever(at.lever) {}
  ContactStart(const BlockSystem& system, const Contact& contact) : ContactStart(ContactPlace(system, contact)) {}
};

/// A contact at a trial position.
struct ContactPose {
  Vec2 normal = Vec2::Zero();
  Vec2 vertex_arm = Vec2::Zero(), edge_arm = Vec2::Zero();  ///< [m] from the centroids of the two blocks to p
  double gap_change = 0.0;                                  ///< [m] since the start of the step, free of cancellation
  double slip_change = 0.0;                                 ///< [m]

  ContactPose() = default;
  ContactPose(const ContactStart& start, const BlockMove& vertex, const BlockMove& edge) { set(start, vertex, edge); }

  /// In single numbers: vectors of two cost more in shuffling than they save.
  void set(const ContactStart& start, const BlockMove& vertex, const BlockMove& edge) {
    const double n0x = start.normal.x(), n0y = start.normal.y(), lx = start.lever.x(), ly = start.lever.y();
    const double ax = start.vertex_arm.x(), ay = start.vertex_arm.y(), ex = start.end_arm.x(), ey = start.end_arm.y();
    const double dnx = -edge.edge_sine * n0y - edge.edge_versine * n0x, dny = edge.edge_sine * n0x - edge.edge_versine * n0y;
    const double nx = n0x + dnx, ny = n0y + dny;
    const double turn_x = -vertex.sine * ay - vertex.versine * ax, turn_y = vertex.sine * ax - vertex.versine * ay;
    // p against the centroid of the edge's block, then against e.
    const double shift_x = (vertex.translation.x() - edge.translation.x()) + turn_x,
                 shift_y = (vertex.translation.y() - edge.translation.y()) + turn_y;
    const double apart_x = shift_x + (edge.sine * ey + edge.versine * ex), apart_y = shift_y - (edge.sine * ex - edge.versine * ey);
    gap_change = (dnx * lx + dny * ly) + (nx * apart_x + ny * apart_y);
    slip_change = (dnx * ly - dny * lx) + (nx * apart_y - ny * apart_x);
    normal = {nx, ny};
    vertex_arm = {ax + turn_x, ay + turn_y};
    edge_arm = {(ex + lx) + shift_x, (ey + ly) + shift_y};
  }
  Vec2 tangent() const { return perpendicular(normal); }

  /// [J/N] Work of unit forces along normal and tangent when the blocks of vertex and edge move by these: the products with the gradients of gap and
  /// slip.
  double normal_way(const Motion::Unknowns& vertex, const Motion::Unknowns& edge) const { return way(normal, vertex, edge); }
  double shear_way(const Motion::Unknowns& vertex, const Motion::Unknowns& edge) const { return way(tangent(), vertex, edge); }

 private:
  double way(const Vec2& direction, const Motion::Unknowns& vertex, const Motion::Unknowns& edge) const {
    return Motion::gradient(vertex_arm, direction).dot(vertex) - Motion::gradient(edge_arm, direction).dot(edge);
  }
};

/// Where and in which directions the forces of a contact act, of four contacts for Real = Lanes.
template <class Real>
struct ForcePlace {
  Real normal_x, normal_y;
  Real vertex_arm_x, vertex_arm_y, edge_arm_x, edge_arm_y;  ///< [m]
};
inline ForcePlace<double> force_place(const ContactPose& pose) {
  return {pose.normal.x(), pose.normal.y(), pose.vertex_arm.x(), pose.vertex_arm.y(), pose.edge_arm.x(), pose.edge_arm.y()};
}

/// What the forces of a contact do to its blocks. The one place of these formulas, for one contact and for four; in single numbers, because vectors
/// of two cost more in shuffling than they save.
template <class Real>
struct ContactPush {
  Real x, y;                ///< [N] on the vertex's block; the edge's gets as much the other way
  Real on_vertex, on_edge;  ///< [N m] moment on the vertex's block, and the one that is to be taken from the edge's

  OPENCLOSE_KERNEL ContactPush(Real normal, Real shear, const ForcePlace<Real>& at)
      : x(normal * at.normal_x - shear * at.normal_y),
        y(normal * at.normal_y + shear * at.normal_x),
        on_vertex(at.vertex_arm_x * y - at.vertex_arm_y * x),
        on_edge(at.edge_arm_x * y - at.edge_arm_y * x) {}
};

/// Hands the forces of a contact [N] to its blocks: push(block, generalised force).
template <class F>
void push_apart(const Contact& contact, const ContactPose& at, double normal, double shear, F push) {
  const ContactPush<double> f(normal, shear, force_place(at));
  push(contact.vertex_block, Motion::Unknowns(f.x, f.y, f.on_vertex));
  push(contact.edge_block, Motion::Unknowns(-f.x, -f.y, -f.on_edge));
}

struct ContactKinematics {
  using Unknowns = Motion::Unknowns;

  Vec2 normal, tangent;                 ///< at the trial position
  Vec2 vertex_arm, edge_arm;            ///< [m] from the centroids of the two blocks to p
  double gap_change = 0.0;              ///< [m] since the start of the step, free of cancellation
  double slip_change = 0.0;             ///< [m]
  Unknowns normal_vertex, normal_edge;  ///< gradient of the gap by the unknowns of either block
  Unknowns shear_vertex, shear_edge;    ///< gradient of the slip

  /// Kinematics after the two blocks have moved by d_vertex, d_edge from the system's present state.
  ContactKinematics(const BlockSystem& system, const Contact& contact, const Unknowns& d_vertex, const Unknowns& d_edge);
  explicit ContactKinematics(const ContactPose& pose);
};

}  // namespace openclose
