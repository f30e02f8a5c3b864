// The explicit method's loop: central difference over rigid blocks on the joint's own springs, the same steps as dem.cpp takes one by one.
//
//   v(t + h/2) = v(t - h/2) + h a(t),  M a = F(x(t)) + damping force,  x(t + h) = x(t) + h v(t + h/2)
//
// A step is two passes, over the blocks (motion) and over the contacts (forces). It searches nothing, allocates nothing and copies no state: it works
// on arrays of its own, which load() takes from the block system and store_*() give back when somebody asks. Between two loads
//   - a block is what has changed since the load: displacement, cosine - 1 and sine of its rotation (once a block, not a contact), in one line of
//   cache;
//   - a contact is one record with all its constants, in the order of the list; gap and slip follow from
//       gap = gap_0 + (n - n_0) . w_0 + n . D,   slip = (t - t_0) . w_0 + t . D,   D = u_v - u_e + (R_v - 1) r_v
//     (r_v arm of the corner, w_0 from the edge's centroid to the corner, both at the load), free of cancellation and exact whatever the rotation;
//   - contacts too far apart to close before they are renewed are left out. Each step is known before it is taken: where it might close one of them,
//     all are loaded anew, which also finds the critical step with those that it may close.
// moved_beyond_skin() tells when blocks may have moved by the skin against each other since the list was last looked through: then it
// is to be renewed. It adds up the largest speed of each step, and looks at the blocks only when that sum has reached the skin.
//
// When some pairs of blocks have got their contacts anew, renew() exchanges those and leaves the others as they are. What is loaded then is laid down
// as it would have been at the last load: the block's turn and way since then are taken off again, so that one pose serves all contacts of a block.
// The bound of the critical step follows contact by contact.
//
// Damping of the motion: `local` (Cundall, 1987, as in UDEC) adds -alpha |F| sign(v) to every component of the unbalanced force F, which takes
// nothing from steady motion. `automatic` (Cundall, 1982, as in UDEC's adaptive global damping) adds -beta M v, beta rising or falling from step to
// step by a constant factor so that the power it takes is half the rate at which the kinetic energy changes.
#pragma once

#include <optional>
#include <vector>

#include "openclose/contact/detection.h"
#include "openclose/core/packs.h"
#include "openclose/integrator/critical_step.h"
#include "openclose/integrator/depth_limits.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

/// Where energy went in the steps since the last question [J]; signs and meaning as in analysis/energy_ledger.h.
struct ExplicitEnergies {
  double gravity = 0.0, base_motion = 0.0, loads = 0.0, support_springs = 0.0;
  double friction = 0.0, contact_damping = 0.0, mass_damping = 0.0, scheme = 0.0, redefinition = 0.0;
  double turnover = 0.0;

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g, h, i, j] = *this;
    archive(a, b, c, d, e, f, g, h, i, j);
  }
};

/// What has become of a step.
enum class Move : unsigned char {
  taken,
  too_far,    ///< a block would have moved farther than it may
  too_fast,   ///< two blocks would have moved by more than the skin against each other in a step longer than such a one may be
  past_list,  ///< contacts that were left out as too far apart might have closed: the list is to be loaded anew, and the step chosen again
};

class CentralDifference {
 public:
  using Unknowns = Motion::Unknowns;

  /// \param skin [m] by which blocks may move against each other before the list of contacts is to be renewed
  /// \param fours  false: links one by one; the results are the same to the last bit
  explicit CentralDifference(double skin, bool fours = true) : skin_(skin), fours_(fours) {}

  /// Takes over blocks, velocities of the middle of the last step, contacts with their history, and the forces they carry now.
  void load(const StepProblem& problem);
  /// False if contacts that were left out as too far apart may close in the step to come: then all is to be loaded anew.
  bool can_renew() const { return !list_is_short_; }
  /// Exchanges contacts: those that stood at `before` in the list are gone, those at `after` have come, the others carry on. The positions of the
  /// system are those of the loop.
  void renew(const StepProblem& problem, const std::vector<DetectionChange>& changes);
  /// The list of contacts stays as it is, for another way of the skin.
  void keep();

  /// Moves the blocks by a step of h; `span` is the time between the middles of the last and this step, `base` the mean acceleration of the base over
  /// it [m/s2]. Unless the step is taken, nothing has changed.
  /// \param limit      [m] for a block
  /// \param fast_step  [s] longest step in which two blocks may move by more than the skin against each other
  Move move(double h, double span, const Vec2& base, double limit, double fast_step, MassDamping damping, double local_damping);
  /// Brings gaps, forces and energies to the new positions. To be called after every move().
  void follow_contacts();

  /// [m] Up to which contacts are listed.
  double approach() const { return approach_; }
  /// Whether two blocks may have moved by more than the skin against each other in the last step, or in one that was not taken.
  bool is_fast() const { return step_ahead_ > skin_; }
  /// What carries more than it can, see depth_limits.h.
  struct TooDeep {
    int contact;          ///< in the list
    double depth, limit;  ///< [m]
  };
  std::optional<TooDeep> too_deep();

  bool moved_beyond_skin();
  /// [s] Of the contacts that may close before they are renewed, with local damping of this share.
  double critical_step(double local_damping = 0.0) { return critical_step_.step(local_damping); }
  double last_unbalanced_force() const;                        ///< [N] largest force on a block when the last step began
  double unbalanced_force() const;                             ///< [N] now; a pass over the blocks
  bool lost_strength() const { return lost_strength_; }        ///< a contact has lost cohesion or tensile strength in the last step
  double max_penetration() const { return max_penetration_; }  ///< [m] since the load

  /// [N, N m] What the contacts do to each of the blocks that were at rest at the load, in the system's order.
  void rest_forces(std::vector<Unknowns>& forces) const;

  /// Moves the blocks of the system to where they are now, with the velocities of the middle of the last step.
  void store_blocks(BlockSystem& system) const;
  /// Velocity of a free block at the end of the last step, half a step after the middle that the loop has: by the forces that act there now, because
  /// those of the step before may be of an impact that is over.
  Unknowns velocity_at_end(int equation) const;
  /// Gap and history of the contacts, in the order of the list; of those that are too far apart nothing changes but the gap, see store_far_gaps().
  void store_contacts(std::vector<Contact>& contacts) const;
  /// Gaps of the contacts that were left out, at the positions of the system.
  void store_far_gaps(const BlockSystem& system, std::vector<Contact>& contacts) const;
  /// [J] What contacts, loads and supports add to the kinetic energy from the middle of the last step to the present moment, where springs store what
  /// the ledger says: half of what they do in a step as long, which makes v(-1/2) M v(+1/2)/2 of it. So the energy of linear vibration stays exactly
  /// as it is. The work of gravity and base is counted up to the middle of the step.
  double kinetic_ahead() const;
  ExplicitEnergies take_energies();

  Memory memory() const;

  /// All of it; joints and external forces are those that load() was given.
  void exchange(Archive& archive, const JointTable& joints, const ExternalForces& external);

 private:
  struct alignas(32) Pose {
    double x = 0.0, y = 0.0;  ///< [m] displacement since the load
    double cos_minus_1 = 0.0, sin = 0.0;

    void exchange(Archive& archive) {
      auto& [a, b, c, d] = *this;
      archive(a, b, c, d);
    }
  };
  struct alignas(32) Rate {
    double x = 0.0, y = 0.0, turn = 0.0;  ///< velocity [m/s, m/s, rad/s], or force [N, N, N m]
    double angle = 0.0;                   ///< [rad] since the load; of velocities only

    void exchange(Archive& archive) {
      auto& [a, b, c, d] = *this;
      archive(a, b, c, d);
    }
  };
  struct Inertia {
    double mass, moment;          ///< [kg], [kg m2]
    double per_mass, per_moment;  ///< their inverses
    double turns;                 ///< 0 if the rotation is locked, else 1
    double weight_x, weight_y;    ///< [N]
    double radius;                ///< [m]

    void exchange(Archive& archive) {
      auto& [a, b, c, d, e, f, g, h] = *this;
      archive(a, b, c, d, e, f, g, h);
    }
  };
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
    bool bonded, breakable;

    void exchange(Archive& archive) {
      auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z] = *this;
      archive(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z);
    }
  };
  /// What a step does not need of a contact.
  struct LinkRest {
    int joint, contact;               ///< in the table, in the list (negative: cleared)
    double normal_x, normal_y;        ///< in the frame of the corner's block
    double edge_arm_x, edge_arm_y;    ///< [m] from the edge's centroid to the corner, in the frame of the edge's block
    double vertex_share, edge_share;  ///< see critical_step.h
    double rest_gap;                  ///< [m]
    double depth_limit;               ///< [m]

    void exchange(Archive& archive) {
      auto& [a, b, c, d, e, f, g, h, i, j] = *this;
      archive(a, b, c, d, e, f, g, h, i, j);
    }
  };
  /// A force element on its way.
  struct ElementWay {
    int element;  ///< of the external forces
    int slot;
    ElementPath path;  ///< since the load

    void exchange(Archive& archive) {
      archive(element, slot, path.d);
      for (PointPath& p : path.points) archive(p.position, p.arm, p.moved, p.end_arm);
    }
  };
  struct Place {
    double gap, slip;
    double normal_x, normal_y, arm_x, arm_y, across_x, across_y;
  };

  void load_blocks(const StepProblem& problem);
  void load_contacts(const StepProblem& problem);
  void load_elements(const StepProblem& problem);
  void add_link(const StepProblem& problem, int contact);
  void take_link(int slot);
  void add_parts(const Link& link, const LinkRest& rest, double sign);
  void renumber(const std::vector<DetectionChange>& changes);
  void clear_link(int entry);
  void remove_cleared_links();
  // In the innermost loop; as calls they cost more than what they do.
  [[gnu::always_inline]] inline Place place(const Link& link) const;
  [[gnu::always_inline]] inline void push(const Link& link, const Place& at);
  [[gnu::always_inline]] inline ForceTrials trials(const Link& link, const Place& at, double elastic_shear) const;
  /// [N] In the normal spring.
  double carry_now(Link& link, const Place& at);
  /// A contact on its way to other positions.
  struct Crossing {
    double normal_before, shear_before;  ///< [N]
    double gap, slip;                    ///< [m] after the step, in the step
    bool is_open;                        ///< after it
  };
  /// What contacts owe because this step is not as long as the one before, see crossing_energy.h.
  void book_step_change(double before, double now, const Vec2& base);
  void settle_crossing(Link& link, const Crossing& crossing, double& normal, double& shear, double& scheme);
  void lose_strength(Link& link, const TabulatedJoint& joint, const Place& at);
  static double stored_energy(const Link& link);
  /// Whether nothing but gap and slip of a contact changes in a step that leaves it open.
  static bool rests(const Link& link) {
    return link.status == ContactStatus::open && link.stretch == 0.0 && link.normal == 0.0 && link.shear == 0.0 && !link.breakable;
  }
  void begin_forces();
  void add_element_forces(bool step);
  /// Sums of what the links of a step take, and the deepest of them.
  struct LinkSums {
    double friction, damping, scheme, deepest;
  };
  template <bool damped>
  [[gnu::always_inline]] inline void follow_link(Link& link, LinkSums& sums);
  /// The same for four links, to the last bit; false, and nothing has changed, if one of them may lose its strength.
  template <bool damped>
  [[gnu::always_inline]] inline bool follow_four(Link* links, LinkSums& sums);
  template <bool damped>
  [[gnu::always_inline]] inline void follow_all(LinkSums& sums);
  void follow_damped(LinkSums& sums);
  void follow_undamped(LinkSums& sums);
  void follow_links(bool damped);
  double force_squared(std::size_t i) const;  ///< [N2] on a block, a moment counting at the block's radius
  void adapt(double taken, double kinetic_change, double h);

  std::vector<Pose> poses_;  ///< per free block, one for all that are fixed, and then per block at rest
  std::vector<Rate> rates_, next_rates_, forces_;
  std::vector<Inertia> inertia_;
  std::vector<int> blocks_;          ///< of the system, per free block
  std::vector<int> rest_slot_;       ///< per block of the system; of others than those at rest the one of fixed blocks
  std::vector<Unknowns> loaded_at_;  ///< displacement of the free blocks at the load
  std::vector<Link> links_;
  std::vector<LinkRest> rest_;  ///< of the links
  std::vector<int> link_of_;    ///< per contact of the list; -1: too far apart
  std::vector<int> renumbered_;
  std::vector<int> free_;                     ///< links of contacts that are being exchanged, pair by pair
  std::vector<std::size_t> free_ends_;        ///< of the pairs in that list
  std::size_t next_free_ = 0, free_end_ = 0;  ///< of the present pair
  int cleared_ = 0;                           ///< links that are no contact's
  struct Way {
    double x, y, angle;

    void exchange(Archive& archive) {
      auto& [a, b, c] = *this;
      archive(a, b, c);
    }
  };
  std::vector<Way> kept_at_;  ///< since the load, where the list was last found to be good
  std::vector<ElementWay> elements_;
  const JointTable* joints_ = nullptr;
  const ExternalForces* external_ = nullptr;
  ExplicitEnergies energies_;
  bool damped_ = false, lost_strength_ = false;
  double skin_;  ///< [m]
  bool fours_;
  CriticalStepBound critical_step_;
  double approach_ = 0.0, moved_ = 0.0, unbalanced_ = 0.0, max_penetration_ = 0.0;
  double step_ahead_ = 0.0;     ///< [m] by which two blocks may have approached in the last step, or in one that was not taken
  bool list_is_short_ = false;  ///< such a step might have closed contacts that were left out
  double share_ = 1.0;          ///< [-] square of the longest step over the critical one, for crossing_energy.h
  DepthLimits depth_limits_;
  double room_ = 0.0;         ///< [m] by which blocks may still move against each other before a contact can be deeper than its limit
  double h_ = 0.0;            ///< [s] the last step
  Vec2 base_ = Vec2::Zero();  ///< [m/s2] in it
  double local_damping_ = 0.0, viscous_ = 0.0;  ///< [-], [1/s] in it
};

}  // namespace openclose
