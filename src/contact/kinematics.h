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
  double x = 0.0, y = 0.0;  ///< [m] translation
  double sine = 0.0;        ///< of the rotation
  double versine = 0.0;     ///< 1 - cosine, free of cancellation
  double edge_sine = 0.0;   ///< of the angle by which the edges' directions turn
  double edge_versine = 0.0;
  double bound = 0.0;   ///< [m] no point of the block moves farther than this
  double unused = 0.0;  ///< the kernels load four numbers at a time

  BlockMove() = default;  ///< no motion
  /// \param radius  [m] of the block, for the bound
  BlockMove(const Motion::Unknowns& d, RotationKind kind, double radius) : x(d.x()), y(d.y()), bound(Motion::displacement_bound(d, radius)) {
    const double angle = Motion::rotation(d);
    // A linearly rotated edge also grows; its direction turns by the arc tangent.
    const SineCosine half(0.5 * (kind == RotationKind::exact ? angle : std::atan(angle)));
    edge_sine = 2.0 * half.sine * half.cosine;
    edge_versine = 2.0 * half.sine * half.sine;
    sine = kind == RotationKind::exact ? edge_sine : angle;
    versine = kind == RotationKind::exact ? edge_versine : 0.0;
  }

  Vec2 displacement(const Vec2& arm) const { return Vec2(x, y) + (sine * perpendicular(arm) - versine * arm); }
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

/// A contact at the start of a step, in single numbers: vectors of two cost more in shuffling than they save.
struct StartNumbers {
  double normal_x = 0.0, normal_y = 0.0;
  double vertex_arm_x = 0.0, vertex_arm_y = 0.0, end_arm_x = 0.0, end_arm_y = 0.0, lever_x = 0.0, lever_y = 0.0;  ///< [m] as in ContactStart
};

/// Where and in which directions the forces of a contact act, of four contacts for Real = Lanes.
template <class Real>
struct ForcePlace {
  Real normal_x, normal_y;
  Real vertex_arm_x, vertex_arm_y, edge_arm_x, edge_arm_y;  ///< [m]
};

/// A contact at a trial position, as ContactPose. The one place of these formulas, for one contact and for four.
template <class Real>
struct MovedContact {
  ForcePlace<Real> at;
  Real gap_change, slip_change;  ///< [m]

  /// \param c  with the members of StartNumbers
  /// \param vertex, edge  of its blocks, with the members of BlockMove
  template <class Start, class Move>
  OPENCLOSE_KERNEL MovedContact(const Start& c, const Move& vertex, const Move& edge) {
    const Real dnx = -edge.edge_sine * c.normal_y - edge.edge_versine * c.normal_x,
               dny = edge.edge_sine * c.normal_x - edge.edge_versine * c.normal_y;
    const Real nx = c.normal_x + dnx, ny = c.normal_y + dny;
    const Real turn_x = -vertex.sine * c.vertex_arm_y - vertex.versine * c.vertex_arm_x,
               turn_y = vertex.sine * c.vertex_arm_x - vertex.versine * c.vertex_arm_y;
    // p against the centroid of the edge's block, then against e.
    const Real shift_x = (vertex.x - edge.x) + turn_x, shift_y = (vertex.y - edge.y) + turn_y;
    const Real apart_x = shift_x + (edge.sine * c.end_arm_y + edge.versine * c.end_arm_x),
               apart_y = shift_y - (edge.sine * c.end_arm_x - edge.versine * c.end_arm_y);
    gap_change = (dnx * c.lever_x + dny * c.lever_y) + (nx * apart_x + ny * apart_y);
    slip_change = (dnx * c.lever_y - dny * c.lever_x) + (nx * apart_y - ny * apart_x);
    at = {nx, ny, c.vertex_arm_x + turn_x, c.vertex_arm_y + turn_y, (c.end_arm_x + c.lever_x) + shift_x, (c.end_arm_y + c.lever_y) + shift_y};
  }
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
  operator StartNumbers() const { return {normal.x(), normal.y(), vertex_arm.x(), vertex_arm.y(), end_arm.x(), end_arm.y(), lever.x(), lever.y()}; }
};

/// A contact at a trial position.
struct ContactPose {
  Vec2 normal = Vec2::Zero();
  Vec2 vertex_arm = Vec2::Zero(), edge_arm = Vec2::Zero();  ///< [m] from the centroids of the two blocks to p
  double gap_change = 0.0;                                  ///< [m] since the start of the step, free of cancellation
  double slip_change = 0.0;                                 ///< [m]

  ContactPose() = default;
  explicit ContactPose(const ForcePlace<double>& at)
      : normal(at.normal_x, at.normal_y), vertex_arm(at.vertex_arm_x, at.vertex_arm_y), edge_arm(at.edge_arm_x, at.edge_arm_y) {}
  ContactPose(const StartNumbers& start, const BlockMove& vertex, const BlockMove& edge) {
    const MovedContact<double> moved(start, vertex, edge);
    *this = ContactPose(moved.at);
    gap_change = moved.gap_change;
    slip_change = moved.slip_change;
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
