// Which blocks may be left alone because they are at rest, and when they may not any more. One rule for all methods, in three numbers of the scene:
// a time T, a displacement d and an acceleration a.
//
// To rest: a block has been quiet for T when in all that time no point of it was farther than d from where it was at the beginning, and none was
// accelerated by more than a on the average of a step (a block at the top of its flight is neither). It is put to rest when it touches something and
// all blocks that it touches have been quiet for as long, or are fixed or at rest themselves: around what moves there is always a layer of blocks
// that follow it. Blocks are put to rest in batches, T apart, because other unknowns mean another pattern of the matrix.
//
// To wake: what all contacts together do to the block differs from what they did when it was put to rest, and the mean of this change, fading with
// the time constant T, exceeds mass times a (moments count at the block's radius). Forces between two blocks at rest stay as they are. The block is
// woken together with those at rest that it touches, and with others that come close to the limit: few changes of many blocks cost less than many of
// few. A step that passes the limit several times over, an impact, is done again with these blocks, and if that is not enough with twice as many
// layers, counted through blocks that move, too, so that a push through a long chain takes few repetitions, wherever it rests. Explicit steps start
// from the forces: blocks are woken before the step in which an impact would move them.
//
// What is left out: a resting block is denied a velocity of a T at most in what passes quickly, and an acceleration of a in what lasts; held by
// springs k it would have moved by mass a/k under that. A block that creeps by less than d in T stands still.
#pragma once

#include <vector>

#include "openclose/contact/contact_set.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

class Resting {
 public:
  using Unknowns = Motion::Unknowns;

  Resting(const RestInput& input, const BlockSystem& system);

  /// After a step of dt [s] that has ended with these velocities, per block.
  void follow(const BlockSystem& system, const std::vector<Unknowns>& velocities, double dt);
  /// No block has been quiet up to now.
  void disturb(const BlockSystem& system);
  /// Blocks to be put to rest now; `contacts` are those of the blocks that move.
  std::vector<int> quiet_blocks(const BlockSystem& system, const std::vector<Contact>& contacts);

  /// These blocks have been put to rest, the contacts still being divided as before: what holds them now is what is to hold them from now on.
  void keep_forces(const BlockSystem& system, const std::vector<int>& blocks, const ContactSet& contacts);
  /// Blocks have been put to rest or woken: works out which part of that is to come from blocks that move.
  void divide(const BlockSystem& system, const std::vector<Contact>& resting_contacts);

  /// [N, N m] To be filled with what the blocks at rest, in their order, get from blocks that move at the end of a step.
  std::vector<Unknowns>& pushes(const BlockSystem& system);
  /// Takes up the pushes of a step of dt that may have to be done again.
  void judge(const BlockSystem& system, double dt);
  enum class Urgency {
    any,       ///< to be woken after the step
    in_haste,  ///< before it, which is to be done again
  };
  /// Blocks that the step wakes, with layers of those at rest that they touch.
  std::vector<int> woken(const BlockSystem& system, const ContactSet& contacts, Urgency urgency);
  /// The step that was judged counts.
  void accept(const BlockSystem& system);

  void exchange(Archive& archive) { archive(anchor_, velocity_, quiet_, since_, held_, change_, awaited_, layers_); }
  /// Whether what was read is of these blocks.
  bool fits(const BlockSystem& system) const;

 private:
  RestInput input_;
  // Per block. Those of moving ones:
  std::vector<Unknowns> anchor_;    ///< [m, m, rad] displacement where it began to be quiet
  std::vector<Unknowns> velocity_;  ///< at the end of the last step
  std::vector<double> quiet_;       ///< [s] for how long
  // Those of blocks at rest [N, N m]:
  std::vector<Unknowns> held_;    ///< by all contacts when it was put to rest
  std::vector<Unknowns> change_;  ///< fading mean

  double since_ = 0.0;             ///< [s] blocks were last put to rest
  std::vector<Unknowns> awaited_;  ///< per block at rest, in their order: which part of held_ is to come from blocks that move
  std::vector<Unknowns> pushes_, judged_;
  int layers_ = 1;
};

}  // namespace openclose
