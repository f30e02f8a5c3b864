// The program's watch over a run: it says when what the run computes cannot be right any more, whichever method computes it.
//
// Three things no right run shows:
//   - energy that was not there. The mechanical energy E = kinetic + gravity + springs + loads + base motion (the work of loads and of the base
//   counted
//     as energy that is given back) can only fall. Created energy is the largest of: the rise of E above the least value it has had; and what the
//     ledger's entries that no physics stands for have released: contact updates, impacts of rigid contacts, friction of springs, the time scheme,
//     and the imbalance. It is compared with the energy that there was to move anything: kinetic energy and springs at the start, what blocks that
//     lie lower have lost in height, and the work of loads and base. The rise is also compared for each group of blocks by itself, see
//     energy_groups.h.
//   - blocks in each other. Springs close by a small part of a block's width; deeper, corners come nearer to other edges than to the one they came in
//     through. Measured by the closed contacts and, because a block may pass into another one without a contact, by the depth of their overlap.
//   - blocks that move faster, or lie higher, than all of that energy could make them. This one uses positions and velocities alone, not the ledger.
//
// Checks come after every step at first, later after every second, fourth, ... so that each doubling of the run has 64 of them, whatever its length.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "openclose/analysis/energy_groups.h"
#include "openclose/analysis/simulation.h"

namespace openclose {

namespace watch_bound {

/// [-] Created energy over the energy there was. Rounding and the tolerances of Newton's method leave less than 1e-6; what time integration does to
/// the energy of single bounces with method's default steps stays below this; creation that grows passes every bound, so that its size matters
/// little.
inline constexpr double created_energy = 0.01;
/// [-] The same of a group of blocks by itself, for which no step is cut, and of the whole by friction, which `shi` takes from the iteration before.
/// Both are warned of beyond the bound of the whole; where more than this is created not even the first digit of ways and speeds is known.
inline constexpr double created_energy_of_part = 0.1;
/// [-] Of the energy there was, taken by dashpots: a hundredth of it is half a hundredth of the speeds.
inline constexpr double noticeable_damping = 0.01;
/// [-] Closure or overlap over the width of the narrower block, 2 area / perimeter (half a square's side). A corner that is this deep is still nearer
/// to the edge it came in through than to any other one of a convex block, whose inscribed circle has at least half this width as its radius.
inline constexpr double penetration = 0.25;
/// [-] Rigid contacts are held to solver.gap_tolerance_m: so many times that, and what the drawing has, is what is found of several steps and of
/// corners that are noticed at the end of one.
inline constexpr double gap_tolerances = 10.0;

}  // namespace watch_bound

/// The worst that a run has shown so far.
struct WatchReport {
  long checks = 0;
  double created_energy = 0.0;    ///< [-] see watch_bound::created_energy; of the whole or of a group, whichever is more
  double available_energy = 0.0;  ///< [J] what it is a part of
  double penetration = 0.0;       ///< [-] see watch_bound::penetration; of closed contacts
  double overlap = 0.0;           ///< [-] the same, of polygons
  double depth = 0.0;             ///< [m] the deeper of the two
  double reach = 0.0;             ///< [-] kinetic energy and rise of a single block over the energy there was

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g] = *this;
    archive(a, b, c, d, e, f, g);
  }
};

/// Of what `shi` takes from the iteration before.
inline constexpr const char* soft_instead_of_shi =
    "method.contact = \"soft\" would be a remedy, a smaller step.dt_s only where this share falls with it";

class Watch {
 public:
  /// The run starts from the state that the simulation is in; its ledger is empty. Returns what check_at_end() does, but for energies.
  std::string begin(const Simulation& simulation);
  /// Whether a check is due after this step, counted from 1. It depends on nothing but that number, so that a run which goes on from a checkpoint to
  /// another end is checked where it would have been.
  static bool is_due(long step);
  /// With rigid contacts after every step: what goes into another block there comes out of it again within some steps, and nothing else tells.
  bool is_due(const Simulation& simulation, long step) const;
  /// After every step.
  void follow(const Simulation& simulation) { groups_.follow(simulation); }
  /// Empty while nothing is wrong, else what is, with the remedy. Of the pairs of blocks that may overlap each check looks at some, in turns; with
  /// rigid contacts at all.
  std::string check(const Simulation& simulation);
  /// The same with all pairs.
  std::string check_at_end(const Simulation& simulation);
  const WatchReport& report() const { return report_; }
  /// What may be wrong though nothing is refused for it, in sentences.
  std::vector<std::string> warnings(const Simulation& simulation) const;
  /// [J] What may be created, as of the last check.
  double creatable_energy() const { return watch_bound::created_energy * energy_scale(); }
  void exchange(Archive& archive) {
    archive(report_, energy_at_start_, released_, work_, lowest_energy_, most_friction_, driven_, undetermined_energy_, start_, depth_at_start_,
            next_pair_, widths_, convex_, groups_, worst_group_);
  }
  /// Whether what was read is of as many blocks.
  bool fits(const Simulation& simulation) const;

 private:
  std::string check(const Simulation& simulation, std::size_t first_pair, std::size_t pairs);
  void find_widths(const Simulation& simulation);
  /// [m] To which blocks may be in each other, the narrower one having this width [m].
  double allowed_depth(const Simulation& simulation, double narrower) const;
  std::string too_deep(const Simulation& simulation, int a, int b, double depth, double allowed) const;
  /// What holds these blocks apart.
  std::string held_apart(const Simulation& simulation, std::initializer_list<int> blocks) const;
  /// What makes the energy of contacts more exact.
  std::string better_energy(const Simulation& simulation) const;
  static bool is_rigid(const Simulation& simulation);
  void follow_energy(const Simulation& simulation);
  std::string check_finite(const Simulation& simulation) const;
  std::string check_energy(const Simulation& simulation);
  std::string check_groups(const Simulation& simulation);
  std::string check_friction(const Simulation& simulation);
  /// How much energy a group has created.
  static std::string in_words(const Simulation& simulation, const EnergyGroups::Worst& worst);
  std::string check_reach(const Simulation& simulation);
  /// Where blocks are: the contacts, and so many pairs from this one on. Nothing while all have been looked at since something has moved.
  std::string check_places(const Simulation& simulation, std::size_t first_pair, std::size_t pairs);
  std::string check_contacts(const Simulation& simulation);
  std::string check_overlaps(const Simulation& simulation, std::size_t first_pair, std::size_t pairs);
  /// [J] Of which a part may be created: that of the energy there was, and more by what the method leaves undetermined.
  double energy_scale() const { return report_.available_energy + undetermined_energy_ / watch_bound::created_energy; }

  WatchReport report_;
  double energy_at_start_ = 0.0;      ///< [J] kinetic and in springs
  double released_ = 0.0;             ///< [J] by blocks that lie lower, the most so far
  double work_ = 0.0;                 ///< [J] of loads and base, the most so far
  double lowest_energy_ = 0.0;        ///< [J] mechanical, against that at the start
  double most_friction_ = 0.0;        ///< [J] that it has taken
  double driven_ = 0.0;               ///< [J] by friction, the most so far
  double undetermined_energy_ = 0.0;  ///< [J] weights of all blocks over the length to which the method tells places
  std::vector<Vec2> start_;           ///< [m] displacement of the blocks at the start
  double depth_at_start_ = 0.0;       ///< [m] of blocks in each other
  std::size_t next_pair_ = 0;
  long seen_after_ = -1;  ///< steps in which something moved, and other changes, when all places were looked at the last time
  EnergyGroups groups_;
  EnergyGroups::Worst worst_group_;       ///< so far
  std::vector<double> widths_;            ///< [m] of the blocks
  std::vector<char> convex_;              ///< of the blocks
  std::vector<double> energies_, falls_;  ///< [J] of the blocks in this check: kinetic, and lost in height
};

}  // namespace openclose
