// Directions of contact forces that belong to a whole step: normal, tangent and both levers are means of those at its start and its end.
//
// With nb, tb the mean normal and tangent, rb the mean arm of the vertex and cb the mean of p - (centroid of the edge's block), unit forces act with
// [nb, rb x nb] on the vertex's block and -[nb, cb x nb] on the edge's. Both act at the mean of the two places of p, so that with velocities
// v0 + v1 = 2 d/dt the angular momentum of the two blocks stays to rounding. The work of these forces is their product with the change of gap and
// slip, exactly for translations and to the third order in the rotations of the step.
#pragma once

#include "openclose/contact/kinematics.h"

namespace openclose {

template <int N>
struct MeanKinematics {
  using Unknowns = typename Motion<N>::Unknowns;
  using Matrix = typename Motion<N>::Matrix;

  Vec2 vertex_arm, edge_arm;  ///< [m] rb, cb
  Vec2 normal, tangent;       ///< shorter than unit vectors where the edge turns
  Unknowns normal_vertex, normal_edge;
  Unknowns shear_vertex, shear_edge;

  /// `end`: after the step that the system is at the start of; exact rotation.
  MeanKinematics(const BlockSystem<N>& system, const Contact& contact, const ContactKinematics<N>& end);

  /// Derivatives by the unknowns of what constant forces N, T put on the two blocks: rows are the block that is pushed.
  struct Derivative {
    Matrix vertex_vertex = Matrix::Zero(), vertex_edge = Matrix::Zero();
    Matrix edge_vertex = Matrix::Zero(), edge_edge = Matrix::Zero();
  };
  Derivative derivative(const ContactKinematics<N>& end, double normal_force, double shear_force) const;
};

extern template struct MeanKinematics<3>;

}  // namespace openclose
