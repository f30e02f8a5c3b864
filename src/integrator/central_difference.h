// The explicit method's loop: central difference over rigid blocks on the joint's own springs.
//
//   v(t + h/2) = v(t - h/2) + h a(t),  M a = F(x(t)) + damping force,  x(t + h) = x(t) + h v(t + h/2)
//
// A step is two passes, over the blocks (motion, explicit_blocks.h) and over the contacts (forces, explicit_links.h). It searches nothing, allocates
// nothing and copies no state: it works on arrays of its own, which load() takes from the block system and store_*() give back when somebody asks.
// Each step is known before it is taken: where it might close a contact that was left out as too far apart, all are to be loaded anew, which also
// finds the critical step with those that it may close.
// moved_beyond_skin() tells when blocks may have moved by the skin against each other since the list was last looked through: then it is to be
// renewed. It adds up the largest speed of each step, and looks at the blocks only when that sum has reached the skin.
//
// Damping of the motion: `local` (Cundall, 1987, as in UDEC) adds -alpha |F| sign(v) to every component of the unbalanced force F, which takes
// nothing from steady motion. `automatic` (Cundall, 1982, as in UDEC's adaptive global damping) adds -beta M v, beta rising or falling from step to
// step by a constant factor so that the power it takes is half the rate at which the kinetic energy changes.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "openclose/integrator/explicit_links.h"

namespace openclose {

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
  explicit CentralDifference(double skin) : skin_(skin), links_(blocks_, energies_) {}
  CentralDifference(const CentralDifference&) = delete;
  CentralDifference& operator=(const CentralDifference&) = delete;

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
  double approach() const { return links_.approach(); }
  /// Whether two blocks may have moved by more than the skin against each other in the last step, or in one that was not taken.
  bool is_fast() const { return step_ahead_ > skin_; }
  /// [s] In which no block moves by more than this [m], at the speeds of the last step or of one that was not taken; infinite before the first.
  double step_within(double way) const { return fastest_ > 0.0 ? way / fastest_ : std::numeric_limits<double>::infinity(); }
  std::optional<ExplicitLinks::TooDeep> too_deep() { return links_.too_deep(); }

  bool moved_beyond_skin();
  /// [s] Of the contacts that may close before they are renewed, with local damping of this share.
  double critical_step(double local_damping = 0.0) { return links_.critical_step(local_damping); }
  double last_unbalanced_force() const;  ///< [N] largest force on a block when the last step began
  /// [N] Now, see ExplicitBlocks; a pass over the blocks.
  double unbalanced_force(double heaviest) const { return blocks_.unbalanced_force(heaviest); }
  bool lost_strength() const { return links_.lost_strength(); }        ///< a joint has lost its bond in the last step
  double max_penetration() const { return links_.max_penetration(); }  ///< [m] since the load

  /// [N, N m] What the contacts do to each of the blocks that were at rest at the load, in the system's order.
  void rest_forces(std::vector<Unknowns>& forces) const { blocks_.rest_forces(forces); }

  /// Moves the blocks of the system to where they are now, with the velocities of the middle of the last step.
  void store_blocks(BlockSystem& system) const { blocks_.store(system); }
  /// Velocity of a free block at the end of the last step, half a step after the middle that the loop has: by the forces that act there now, because
  /// those of the step before may be of an impact that is over.
  Unknowns velocity_at_end(int equation) const { return blocks_.velocity_at_end(equation, motion_); }
  /// Gap and history of the contacts, in the order of the list; of those that are too far apart nothing changes but the gap, see store_far_gaps().
  void store_contacts(std::vector<Contact>& contacts) const { links_.store(contacts); }
  /// Gaps of the contacts that were left out, at the positions of the system.
  void store_far_gaps(const BlockSystem& system, std::vector<Contact>& contacts) const { links_.store_far_gaps(system, contacts); }
  /// [J] What contacts, loads and supports add to the kinetic energy from the middle of the last step to the present moment, where springs store what
  /// the ledger says: half of what they do in a step as long, which makes v(-1/2) M v(+1/2)/2 of it. So the energy of linear vibration stays exactly
  /// as it is. The work of gravity and base is counted up to the middle of the step.
  double kinetic_ahead() const;
  EnergyLedger take_energies();

  Memory memory() const;

  /// All of it; joints and external forces are those that load() was given.
  void exchange(Archive& archive, const JointTable& joints, const ExternalForces& external);
  /// Whether what was read is of these blocks, of so many contacts between them, and of their external forces.
  bool fits(const BlockSystem& system, std::size_t contacts) const;

 private:
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

  void load_elements(const StepProblem& problem);
  void add_element_forces(bool step);
  void adapt(const ExplicitBlocks::Work& work);

  double skin_;  ///< [m]
  ExplicitBlocks blocks_;
  EnergyLedger energies_;
  ExplicitLinks links_;
  std::vector<ElementWay> elements_;
  const ExternalForces* external_ = nullptr;
  ExplicitMotion motion_{0.0, 0.0, Vec2::Zero(), 0.0, 0.0};  ///< of the last step
  double moved_ = 0.0;                                       ///< [m] against each other since the list was found to be good, at most
  double unbalanced_square_ = 0.0;                           ///< [N2]
  double step_ahead_ = 0.0;     ///< [m] by which two blocks may have approached in the last step, or in one that was not taken
  double fastest_ = 0.0;        ///< [m/s] of a block in the same
  bool list_is_short_ = false;  ///< such a step might have closed contacts that were left out
};

}  // namespace openclose
