// Gap and slip of a contact as functions of the unknowns of its two blocks, with exact first and second derivatives (for Shi's linear
// rotation they are exact where the step starts).
//
// With p the vertex, e the first point of the edge, n its outward normal, t its direction: gap g = n . (p - e), slip s = t . (p - e), the edge
// turning with its block. Their gradients are the generalised forces of unit forces n, t on the vertex's block and -n, -t on the edge's block, both
// at p: action and reaction share one line, so that contacts never change the angular momentum.
#pragma once

#include "openclose/contact/contact.h"
#include "openclose/model/block_system.h"

namespace openclose {

template <int N>
struct ContactKinematics {
  using Unknowns = typename Motion<N>::Unknowns;
  using Matrix = typename Motion<N>::Matrix;

  Vec2 normal, tangent;                 ///< at the trial position
  Vec2 vertex_arm, edge_arm;            ///< [m] from the centroids of the two blocks to p
  double gap_change = 0.0;              ///< [m] since the start of the step, free of cancellation
  double slip_change = 0.0;             ///< [m]
  Unknowns normal_vertex, normal_edge;  ///< gradient of the gap by the unknowns of either block
  Unknowns shear_vertex, shear_edge;    ///< gradient of the slip

  /// Kinematics after the two blocks have moved by d_vertex, d_edge from the system's present state.
  ContactKinematics(const BlockSystem<N>& system, const Contact& contact, const Unknowns& d_vertex, const Unknowns& d_edge);

  /// Second derivatives of m . (p - e), m turning with the edge's block: blocks (vertex, vertex), (vertex, edge), (edge, edge).
  struct Hessian {
    Matrix vertex_vertex, vertex_edge, edge_edge;
  };
  Hessian hessian(const Vec2& m) const;
};

extern template struct ContactKinematics<3>;

}  // namespace openclose
