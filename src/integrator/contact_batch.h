// The contacts of a step four at a time: where they are at a trial displacement, what they carry there, and their stiffness.
//
// The formulas are those of ContactPose, spring_slider() and ContactStiffness, operation by operation, so that every number is the same to the last
// bit; forces and stiffness are added up in the order of the contacts, forces in two parts. The kernels are compiled once for every
// processor and once for wide registers, with the same results.
//
// Schemes that average over the path of the step have the mean forces of path_average() instead, which act in the mean_pose(). Contacts that are open
// or stick all the way are taken four at a time, the others one by one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "openclose/contact/contact.h"
#include "openclose/contact/kinematics.h"
#include "openclose/core/packs.h"
#include "openclose/law/joint_law.h"
#include "openclose/linear/block_matrix.h"

namespace openclose {

/// The piece of its law that a contact is on: its status, minus it when sliding backward.
using Branch = signed char;
/// \param backward  of a contact that slides
constexpr Branch branch(ContactStatus status, bool backward = false) {
  const int piece = static_cast<int>(status);
  return static_cast<Branch>(backward ? -piece : piece);
}
inline Branch branch(const CarriedForces& f) {
  return branch(f.status, f.status == ContactStatus::sliding && f.shear < 0.0);
}
inline ContactStatus status(Branch b) {
  return static_cast<ContactStatus>(b < 0 ? -b : b);
}

inline constexpr unsigned doubles_of_move = sizeof(BlockMove) / sizeof(double);

/// Four contacts at the start of a step: set one by one, then begin(). What is not set carries nothing and adds nothing.
struct ContactBatch {
  Lanes normal_x{}, normal_y{}, lever_x{}, lever_y{}, vertex_arm_x{}, vertex_arm_y{}, end_arm_x{}, end_arm_y{};  // as in StartNumbers
  Lanes normal{}, shear{}, gap_off_target{}, shift{}, initial_shear{}, normal_damping{}, shear_damping{};        // as in ContactSprings
  Lanes friction{}, cohesion{}, tension{};                                                                       // as in ContactStrength
  Lanes dissipation{};                                                                                           ///< of path_average()
  /// Of their blocks, in the lists of moves and of sums alike: the place times the doubles of a move, from which the kernels address either at once.
  unsigned vertex_at[batch_size] = {}, edge_at[batch_size] = {};

  /// \param vertex, edge  places of the blocks
  void set_places(int lane, int vertex, int edge) {
    vertex_at[lane] = doubles_of_move * static_cast<unsigned>(vertex);
    edge_at[lane] = doubles_of_move * static_cast<unsigned>(edge);
  }
  int vertex_place(int lane) const { return static_cast<int>(vertex_at[lane] / doubles_of_move); }
  int edge_place(int lane) const { return static_cast<int>(edge_at[lane] / doubles_of_move); }
  void set_geometry(int lane, const ContactPlace& at) {
    // The edge, until its normal is known.
    set(lane,
        StartNumbers{at.edge.x(), at.edge.y(), at.vertex_arm.x(), at.vertex_arm.y(), at.end_arm.x(), at.end_arm.y(), at.lever.x(), at.lever.y()});
  }
  void set_strength(int lane, const ContactStrength& strength) { set(lane, strength); }
  void set_springs(int lane, const ContactSprings& springs) {
    set(lane, springs);
    gap_off_target[lane] -= springs.target;
  }
  /// All but the places.
  void copy(int lane, const ContactBatch& other, int from) {
    set(lane, other.start(from));
    set(lane, other.strength(from));
    set(lane, other.springs(from));
  }
  StartNumbers start(int lane) const { return get<StartNumbers>(lane); }
  /// \param moves  of the blocks, by their places
  ContactPose pose(int lane, const std::vector<BlockMove>& moves) const { return {start(lane), moves[vertex_place(lane)], moves[edge_place(lane)]}; }
  ContactStrength strength(int lane) const { return get<ContactStrength>(lane); }
  /// Those that were set, with the gap counted from their target.
  ContactSprings springs(int lane) const { return get<ContactSprings>(lane); }

 private:
  /// Calls visit(four numbers, one of them) for what a batch has of the numbers of a contact.
  template <class Batch, class Numbers, class Visit>
  static void visit_numbers(Batch& four, Numbers& one, const Visit& visit);
  template <class Numbers>
  void set(int lane, const Numbers& numbers) {
    visit_numbers(*this, numbers, [lane](Lanes& four, double one) { four[lane] = one; });
  }
  template <class Numbers>
  Numbers get(int lane) const {
    Numbers numbers;
    visit_numbers(*this, numbers, [lane](const Lanes& four, double& one) { one = four[lane]; });
    return numbers;
  }
};

template <class Batch, class Numbers, class Visit>
void ContactBatch::visit_numbers(Batch& four, Numbers& one, const Visit& visit) {
  static_assert(sizeof(ContactBatch) == 19 * sizeof(Lanes) + 2 * sizeof(vertex_at), "one line here for each member");
  if constexpr (std::is_same_v<std::remove_const_t<Numbers>, StartNumbers>) {
    visit(four.normal_x, one.normal_x);
    visit(four.normal_y, one.normal_y);
    visit(four.vertex_arm_x, one.vertex_arm_x);
    visit(four.vertex_arm_y, one.vertex_arm_y);
    visit(four.end_arm_x, one.end_arm_x);
    visit(four.end_arm_y, one.end_arm_y);
    visit(four.lever_x, one.lever_x);
    visit(four.lever_y, one.lever_y);
  } else if constexpr (std::is_same_v<std::remove_const_t<Numbers>, ContactStrength>) {
    visit(four.friction, one.friction);
    visit(four.cohesion, one.cohesion);
    visit(four.tension, one.tension);
  } else {
    visit(four.normal, one.normal);
    visit(four.shear, one.shear);
    visit(four.gap_off_target, one.gap);
    visit(four.shift, one.shift);
    visit(four.initial_shear, one.initial_shear);
    visit(four.normal_damping, one.normal_damping);
    visit(four.shear_damping, one.shear_damping);
    visit(four.dissipation, one.dissipation);
  }
}

/// What contacts carry at the trial displacement, or means of it, and the derivatives of these forces. Where they are then follows from their start
/// and the moves of their blocks.
struct TrialBatch {
  Lanes gap_change{}, slip_change{};                                          // as in ContactPose
  Lanes normal{}, shear{}, normal_by_gap{}, shear_by_gap{}, shear_by_slip{};  // as in ContactForces

  void set_forces(int lane, const ContactForces& forces);
};

/// The springs' parts of the forces that contacts carry, which only the end of a step asks for.
struct ElasticBatch {
  Lanes normal{}, shear{};
};

/// Sum of the contact forces on a block: force [N, N], moment [N m], and [N] what rounding leaves in it. In two parts, because contacts that follow
/// each other in the list touch the same blocks and would wait for each other's sum.
struct ForceRow {
  Lanes sums{};          ///< of the contacts in the first and third lanes of their batches
  Lanes of_odd_lanes{};  ///< of the others
};

/// Where in a matrix a contact's stiffness goes to beside the diagonal: slots, that of nobody where a block is fixed.
struct ContactSlots {
  int vertex_edge, edge_vertex;
};

struct MatrixSlots {
  std::vector<ContactSlots> of_contacts;  ///< of every place of a batch
  std::vector<int> diagonals;             ///< by the places of blocks, that of nobody where one is fixed
};

/// Which tangent is added up.
struct BatchTangent {
  bool averaged;                 ///< forces are means over the path of the step
  bool exact;                    ///< with the slip's and the geometric terms, which are not symmetric
  double end_weight;             ///< [-] theta
  double static_slip_stiffness;  ///< [-] part of the shear stiffness that sliding contacts keep in the other tangent
  bool open_ones_too;            ///< contacts that are open at the end of the step may have a stiffness, too
};

/// Works out, of contacts that have just been set, what is the same operations for all: their normals. Returns [N] the largest force of
/// a spring at the start of the step, pulling ones not counted.
double begin(std::vector<ContactBatch>& contacts);
/// Fills trials and branches; adds to the rows. Returns [N] the largest force.
/// \param averaged  the forces are means over the path of the step, see path_average.h, instead of those at its end
/// \param ramp   [-] see ShearLimit; means have the usual one
/// \param moves  of all blocks; a place of rows for each
double evaluate(bool averaged, double ramp, const std::vector<ContactBatch>& contacts, const BlockMove* moves, std::vector<TrialBatch>& trials,
                std::vector<Branch>& branches, std::vector<ForceRow>& rows);
/// Of forces at the end of the step.
/// \param ramp, trials  with which and to what they were evaluated
void find_elastic(double ramp, const std::vector<ContactBatch>& contacts, const std::vector<TrialBatch>& trials, std::vector<ElasticBatch>& elastic);
/// Adds the stiffness of all contacts to the matrix.
/// \param moves  with which the trials were evaluated
void add_stiffness(const std::vector<ContactBatch>& contacts, const BlockMove* moves, const std::vector<TrialBatch>& trials,
                   const std::vector<Branch>& branches, const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix);

}  // namespace openclose
