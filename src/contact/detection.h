// Which vertices of all blocks face which edges: pairs of blocks that may touch, and their contacts (narrow_phase.h), with the history of those that
// live on.
//
// Which pairs are looked at: each block adds up a bound on its way, with what its turning does where it can touch others. A pair in which something
// may still move by s before it is due cannot become so while each of its blocks goes less than s/2; so only the pairs of blocks that have gone as
// far as one of their pairs allows are looked at.
//
// What is not done again: candidate pairs are searched anew only when a block has moved beyond search_skin; a pair's contacts are found anew only
// when a point of one of its blocks near the other may have moved by contact_skin relative to it since they last were, or a tenth of it where a pair
// that shares a block is due (so that what one loses and another gains is found at once and history can pass between them); those of a pair without
// contacts, which the line along an edge keeps apart, when it may have moved what is beyond reach of that. Blocks that move together are not redone.
// Contacts of other pairs stay as they are; their gaps are the caller's to carry on. Contacts are kept to reach + contact_skin, so that none comes
// within reach unseen; a corner that comes over the end of an edge is found at most contact_skin late, and lengths are off by less than it. A corner
// that may come off the end of its edge is due before it does: its gap is measured from the line along the edge, into which a block that turns
// beyond the end goes by a part of its way, and rigid contacts have locked blocks on that.
//
// Blocks at rest (BlockSystem::is_at_rest) move as little as fixed ones do: pairs of which neither block moves are set aside with their contacts by
// divide(), are not looked at in a step, and come back as they were when one of the two is woken. A search leaves them out; they stay complete as
// long as neither block has gone farther than the skin allows from where it was when it was last searched for with all others.
#pragma once

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "openclose/contact/block_shapes.h"
#include "openclose/contact/contact.h"
#include "openclose/contact/contact_index.h"
#include "openclose/contact/contact_set.h"
#include "openclose/contact/history.h"
#include "openclose/contact/joint_table.h"
#include "openclose/contact/number_set.h"
#include "openclose/core/memory.h"
#include "openclose/core/tolerance.h"
#include "openclose/model/block_system.h"

namespace openclose {

/// What may be left as it is, and how far blocks may move before it is not; see above.
struct DetectionSkips {
  bool search = true;                               ///< false: everything is redone in every step
  bool narrow_phase = true;                         ///< false: all candidate pairs are redone in every step
  bool looks = true;                                ///< false: all pairs are looked at in every step, whether or not they may be due
  double contact_skin = tolerance::contact_skin_m;  ///< [m]
  double search_skin = tolerance::search_skin_m;    ///< [m]
};

struct DetectionCounters {
  long searches = 0;               ///< broad-phase searches made
  long searches_skipped = 0;       ///< steps that reused the candidates
  long narrow_phases = 0;          ///< pairs whose contacts were found anew, over all steps
  long narrow_phases_skipped = 0;  ///< pairs whose contacts stayed as they were
  long looks = 0;                  ///< pairs whose motion was looked at, over all steps
  long looks_skipped = 0;          ///< pairs whose blocks had not gone far enough for that
  long transfers = 0;              ///< contacts that inherited their history from another vertex-edge pair

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g] = *this;
    archive(a, b, c, d, e, f, g);
  }
};

/// The contacts of a pair of blocks were found anew: those at `before` in the list as it was are now those at `after`.
struct DetectionChange {
  int pair;  ///< of the candidates
  ContactRange before, after;
};

class GroundOutline;
class NarrowPhase;

class Detector {
 public:
  /// \param reach [m] open contacts are kept up to this gap: at least what two vertices can approach each other within a step
  explicit Detector(double reach, const DetectionSkips& skips = {}, InheritedForces forces = InheritedForces::as_they_were);
  Detector(Detector&&) noexcept = default;  // and no copy: the index points into the contacts at rest

  /// Contacts of the present positions; false if their list stays as it is. `contacts` are those of the last call, with the history of the last step;
  /// those of blocks that move are renewed where needed. Whoever adds to them or takes from them calls forget() first.
  /// Only what touches in the very first call is bonded: those joints exist in the rock; surfaces that meet later have no cohesion unless it is
  /// ductile.
  /// \param present  where the blocks are, if `system` has them where they are expected: gaps are those of `present`, and what has not gone behind an
  ///                 edge there is met by it however deep it is behind it in `system`. Null: `system` has them where they are.
  bool update(const BlockSystem& system, const JointTable& joints, ContactSet& contacts, const BlockSystem* present = nullptr);

  /// Which blocks are at rest has changed: contacts of pairs of which a block moves now, and of those of which none moves any more, change sides.
  void divide(const BlockSystem& system, ContactSet& contacts);

  /// What the last update() has renewed, in the order of the list, pairs without contacts before and after left out. Where it has searched, contacts
  /// may also have gone whose blocks are no pair any more.
  const std::vector<DetectionChange>& changes() const { return changes_; }
  /// Whether the next update() searches for pairs.
  bool needs_search(const BlockSystem& system) const { return forgotten_ || !skips_.search || moved_beyond_search_skin(system); }

  /// Pairs of blocks, at least one of them free, that may come within reach before something has moved beyond the skin: their boxes, with reach and
  /// skin, overlap, and no line along an edge of one of them keeps them as far apart. Renewed only when something moved beyond the skin.
  const std::vector<std::pair<int, int>>& candidate_pairs() const { return candidates_.pairs; }
  const DetectionCounters& counters() const { return counters_; }
  /// After an update().
  const GroundOutline& ground() const { return *ground_; }
  /// Whether there has been an update(), the first of which decides what is bonded.
  bool knows_bonds() const { return !first_; }

  /// Blocks or contacts were changed by others: the next update() searches and finds everything anew.
  void forget() { forgotten_ = true; }
  /// The next update() finds the contacts of all pairs anew, however little they have moved.
  void look_again() { looks_again_ = true; }
  /// Of candidates and contacts at rest, and of what an update has left of its working memory.
  Memory memory() const;
  /// What decides when something is found anew.
  void exchange(Archive& archive);
  /// Whether everything that was read, and these contacts beside it, is of blocks, vertices, joints, pairs and contacts that there are.
  bool fits(const BlockSystem& system, const JointTable& joints, const ContactSet& contacts) const;
  /// Whether contacts that were read for a detector that knows nothing are of blocks, vertices and joints that there are.
  static bool contacts_fit(const BlockSystem& system, const JointTable& joints, const std::vector<Contact>& contacts);

 private:
  using Unknowns = BlockSystem::Unknowns;
  using Range = ContactRange;
  struct Place {
    double x, y, turn;  ///< [m, m, rad] of a centroid
    double radius;      ///< [m]

    void exchange(Archive& archive) {
      auto& [a, b, c, d] = *this;
      archive(a, b, c, d);
    }
  };
  /// How far a block has gone, see above.
  struct Way {
    double arm = 0.0;      ///< [m] by which a rotation counts
    double gone = 0.0;     ///< [m]
    double look_at = 0.0;  ///< [m] with `gone` below it no pair of the block can be due

    void exchange(Archive& archive) {
      auto& [a, b, c] = *this;
      archive(a, b, c);
    }
  };
  /// A pair when its contacts were last found; no numbers where they never were.
  struct PairState {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double x = unknown, y = unknown;             ///< [m] of the first centroid from the second
    double first_turn = 0.0, second_turn = 0.0;  ///< [rad]
    double room = 0.0;                           ///< [m] as far as something may move before they are found again

    void exchange(Archive& archive) {
      auto& [a, b, c, d, e] = *this;
      archive(a, b, c, d, e);
    }
  };
  /// Neighbours in the list that stay so.
  struct Run {
    int from, to, size;
  };
  enum class Due : unsigned char { no, moved, yes };
  /// Pairs, and which part of a list of contacts is theirs.
  struct PairList {
    std::vector<std::pair<int, int>> pairs;
    std::vector<PairState> states;
    std::vector<Range> ranges;

    void reserve(std::size_t count);
    /// Moves pair i of another list with its contacts behind these.
    void take(const PairList& other, std::size_t i, const std::vector<Contact>& from, std::vector<Contact>& to);
    template <class F>
    void remove_if(F leaves, std::vector<Contact>& contacts);

    void exchange(Archive& archive) {
      auto& [a, b, c] = *this;
      archive(a, b, c);
    }
  };

  static bool pairs_fit(const BlockSystem& system, const PairList& list, std::size_t contacts);
  bool lists_of_blocks_fit(std::size_t blocks) const;
  bool moved_beyond_search_skin(const BlockSystem& system) const;
  void search(const BlockSystem& system);
  void locate(const std::vector<Contact>& contacts);
  static Place place(const BlockSystem& system, int b);
  double relative_way(const PairState& then, const Place& first, const Place& second) const;
  Due due(int pair, double way) const;
  void list_pairs_of_blocks(int blocks);
  void follow_blocks(const BlockSystem& system, bool all);
  template <class F>
  void for_pairs_of(const std::vector<int>& blocks, const std::vector<char>& is_among_them, F f) const;
  void look_again_before(int pair, double way);
  bool mark_due_pairs(const BlockSystem& system, bool all);
  bool passes_corners_on(const BlockSystem& system, int pair) const;
  void find_blocks_of_due_pairs();
  const std::vector<int>& pairs_around_due_ones();
  void redo(const JointTable& joints, const BlockSystem& system, int pair, NarrowPhase& narrow, const std::vector<Contact>& before);
  void put_in_place(std::vector<Contact>& contacts, bool orphans);
  void find_kept_runs();
  void let_go_of_working_memory();

  double reach_;
  DetectionSkips skips_;
  InheritedForces forces_;
  bool first_ = true;
  bool forgotten_ = true, looks_again_ = false;
  bool moved_by_others_ = false;                ///< before this update()
  PairList candidates_;                         ///< of which a block moves, in order; their contacts as the last update() left them
  PairList resting_;                            ///< set aside, in any order
  std::vector<Unknowns> searched_at_;           ///< displacements of the blocks in the last search
  std::vector<Unknowns> searched_moving_at_;    ///< in the last one before which they were not at rest; empty while none is
  std::vector<Place> places_;                   ///< of the blocks in the last update()
  std::vector<Way> ways_;                       ///< of the blocks
  std::vector<int> pairs_of_start_, pairs_of_;  ///< of the blocks: pairs_of_[pairs_of_start_[b]] to before that of b + 1
  std::vector<DetectionChange> changes_;
  DetectionCounters counters_;

  std::shared_ptr<const GroundOutline> ground_;  ///< of the first update()

  // Working memory of update().
  BlockShapes shapes_;
  ContactIndex index_;
  std::vector<int> restless_, in_due_pairs_;  ///< blocks: whose pairs are looked at; of pairs that are due
  std::vector<char> is_restless_, in_due_pair_;
  std::vector<int> due_pairs_, around_due_;  ///< in order
  NumberSet marks_;                          ///< pairs
  std::vector<Contact> found_;               ///< of the pairs that are due
  std::vector<Run> kept_;                    ///< contacts of other pairs, where the list is renewed
  std::vector<char> lives_on_;               ///< old contacts of a pair
  std::vector<std::size_t> born_;            ///< positions among those that were found
  std::vector<int> gone_;                    ///< positions in the old list
};

}  // namespace openclose
