// The contacts in the loop of the explicit method, one record each with all its constants, in the order of the list. Gap and slip follow from
//   gap = gap_0 + (n - n_0) . w_0 + n . D,   slip = (t - t_0) . w_0 + t . D,   D = u_v - u_e + (R_v - 1) r_v
// (r_v arm of the corner, w_0 from the edge's centroid to the corner, both at the load), free of cancellation and exact whatever the rotation.
// Contacts too far apart to close before they are renewed are left out.
//
// When some pairs of blocks have got their contacts anew, renew() exchanges those and leaves the others as they are. What is loaded then is laid down
// as it would have been at the last load: the block's turn and way since then are taken off again, so that one pose serves all contacts of a block.
// The bound of the critical step follows contact by contact.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "openclose/contact/detection.h"
#include "openclose/core/packs.h"
#include "openclose/integrator/critical_step.h"
#include "openclose/integrator/depth_limits.h"
#include "openclose/integrator/explicit_blocks.h"
#include "openclose/integrator/link_formulas.h"

namespace openclose {

class ExplicitLinks {
 public:
  /// Between these blocks, to whose forces and energies theirs are added; both must outlive the links.
  ExplicitLinks(ExplicitBlocks& blocks, EnergyLedger& energies) : blocks_(blocks), energies_(energies) {}

  /// Takes over contacts with their history, and adds what they carry now to the forces.
  /// \param approach  [m] up to which they are listed
  void load(const StepProblem& problem, double approach);
  /// Exchanges contacts: those that stood at `before` in the list are gone, those at `after` have come, the others carry on.
  void renew(const StepProblem& problem, const std::vector<DetectionChange>& changes);
  /// Brings gaps, forces and energies to the blocks' new positions.
  void follow();
  /// What contacts owe because this step [s] is not as long as the one before, see crossing_energy.h.
  void book_step_change(double before, double now, const Vec2& base);

  /// What carries more than it can, see depth_limits.h.
  struct TooDeep {
    int contact;          ///< in the list
    double depth, limit;  ///< [m]
  };
  std::optional<TooDeep> too_deep();
  /// Blocks have moved by so much [m] against each other.
  void come_nearer(double way) { room_ -= way; }
  double approach() const { return approach_; }
  /// [s] Of the contacts that may close before they are renewed, with local damping of this share.
  double critical_step(double local_damping) { return critical_step_.step(local_damping); }
  bool lost_strength() const { return lost_strength_; }        ///< a joint has lost its bond in the last step
  double max_penetration() const { return max_penetration_; }  ///< [m] since the load

  /// Gap and history of the contacts, in the order of the list; of those that are too far apart nothing changes but the gap, see store_far_gaps().
  void store(std::vector<Contact>& contacts) const;
  /// Gaps of the contacts that were left out, at the positions of the system.
  void store_far_gaps(const BlockSystem& system, std::vector<Contact>& contacts) const;

  Memory memory() const;
  void exchange(Archive& archive, const JointTable& joints);
  /// Whether what was read is of so many contacts between blocks that there are.
  bool fits(std::size_t contacts) const;

 private:
  /// In the order in which four links are fetched, four numbers of each at a time.
  struct alignas(64) Link {
    double arm_x, arm_y;        ///< [m] corner from its centroid, at the load
    double across_x, across_y;  ///< [m] corner from the edge's centroid, at the load
    double normal_x, normal_y;  ///< at the load
    double loaded_gap;
    double normal_stiffness, shear_stiffness, per_shear_stiffness;
    double normal_dashpot, shear_dashpot;
    ContactStrength strength;
    // History, at the present position.
    double gap, slip, stretch;  ///< gap from where the normal spring rests, slip since the load, stretch of the shear spring
    double normal, shear, viscous_shear;
    double crossing_energy;  ///< [J] see crossing_energy.h
    int vertex_slot, edge_slot;
    float rest_gap;  ///< [m] for the depth alone, of which seven digits are enough
    ContactStatus status;
    bool breakable;  ///< strength that it can lose

    void exchange(Archive& archive) {
      auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y] = *this;
      archive(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y);
    }
  };
  /// What a step does not need of a contact.
  struct LinkRest {
    int joint, contact;               ///< in the table, in the list (negative: in none, see close_ranks())
    double normal_x, normal_y;        ///< in the frame of the corner's block
    double edge_arm_x, edge_arm_y;    ///< [m] from the edge's centroid to the corner, in the frame of the edge's block
    double vertex_share, edge_share;  ///< see critical_step.h
    double rest_gap;                  ///< [m]
    double depth_limit;               ///< [m]
    double length;                    ///< [m] tributary
    JointState joint_state;

    void exchange(Archive& archive) {
      auto& [a, b, c, d, e, f, g, h, i, j, k, l] = *this;
      archive(a, b, c, d, e, f, g, h, i, j, k, l);
    }
  };
  using Place = LinkPlace<double>;
  /// A contact on its way to other positions.
  struct Crossing {
    double normal_before, shear_before;  ///< [N]
    double gap, slip;                    ///< [m] after the step, in the step
    bool is_open;                        ///< after it
  };
  /// Sums of what the links of a step take, and the deepest of them.
  struct LinkSums {
    double friction, damping, scheme, deepest;
  };
  struct FourLinks;
  struct FourForces;

  void add(const StepProblem& problem, int contact);
  std::pair<Link, LinkRest> make(const StepProblem& problem, int contact);
  void begin_forces(Link& link, const Contact& contact);
  void add_parts(const Link& link, const LinkRest& rest, double sign);
  void take(int slot);
  void renumber(const std::vector<DetectionChange>& changes);
  void close_ranks();
  // In the innermost loop; as calls they cost more than what they do.
  [[gnu::always_inline]] inline Place place(const Link& link) const;
  [[gnu::always_inline]] inline void push(const Link& link, const Place& now);
  [[gnu::always_inline]] inline ForceTrials trials(const Link& link, const Place& now, double elastic_shear) const;
  /// [N] In the normal spring.
  double carry_now(Link& link, const Place& at);
  void settle_crossing(Link& link, const Crossing& crossing, double& normal, double& shear, double& scheme);
  /// \param slip  [m] of friction in the step
  void lose_strength(Link& link, LinkRest& rest, double slip, const Place& at);
  static double stored_energy(const Link& link);
  template <bool damped>
  [[gnu::always_inline]] inline void follow_four(Link* links, LinkSums& sums);
  [[gnu::always_inline]] inline void settle_crossings(Link* links, const FourLinks& four, FourForces& forces, double (&scheme)[batch_size]);
  [[gnu::always_inline]] inline void store_four(Link* links, const FourForces& forces);
  [[gnu::always_inline]] inline void lose_strengths(Link* links, const FourLinks& four, FourForces& forces);
  [[gnu::always_inline]] inline void push_four(const FourLinks& four, const FourForces& forces);
  template <bool damped>
  [[gnu::always_inline]] inline void follow_all(LinkSums& sums);
  void follow_damped(LinkSums& sums);
  void follow_undamped(LinkSums& sums);

  ExplicitBlocks& blocks_;
  EnergyLedger& energies_;
  std::vector<Link> links_;     ///< a whole number of fours
  std::vector<LinkRest> rest_;  ///< of the links
  std::vector<int> link_of_;    ///< per contact of the list; -1: too far apart
  std::vector<int> renumbered_;
  std::vector<int> free_;                     ///< links of contacts that are being exchanged, pair by pair
  std::vector<std::size_t> free_ends_;        ///< of the pairs in that list
  std::size_t next_free_ = 0, free_end_ = 0;  ///< of the present pair
  const JointTable* joints_ = nullptr;
  bool damped_ = false, lost_strength_ = false;
  CriticalStepBound critical_step_;
  double approach_ = 0.0, max_penetration_ = 0.0;
  double share_ = 1.0;  ///< [-] square of the longest step over the critical one, for crossing_energy.h
  DepthLimits depth_limits_;
  double room_ = 0.0;  ///< [m] by which blocks may still move against each other before a contact can be deeper than its limit
};

inline ExplicitLinks::Place ExplicitLinks::place(const Link& link) const {
  return link_place<double>(blocks_.pose(link.vertex_slot), blocks_.pose(link.edge_slot), link);
}

inline ForceTrials ExplicitLinks::trials(const Link& link, const Place& now, double elastic_shear) const {
  const LinkRate<double> rate = link_rate<double>(blocks_.rate(link.vertex_slot), blocks_.rate(link.edge_slot), now.at);
  return {-link.normal_stiffness * now.gap, -link.normal_dashpot * rate.normal, elastic_shear, -link.shear_dashpot * rate.shear};
}

inline void ExplicitLinks::push(const Link& link, const Place& now) {
  const ContactPush<double> push(link.normal, link.shear, now.at);
  ExplicitRate& v = blocks_.forces()[link.vertex_slot];
  v.x += push.x;
  v.y += push.y;
  v.turn += push.on_vertex;
  ExplicitRate& e = blocks_.forces()[link.edge_slot];
  e.x -= push.x;
  e.y -= push.y;
  e.turn -= push.on_edge;
}

}  // namespace openclose
