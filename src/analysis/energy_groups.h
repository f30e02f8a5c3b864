// Energy that was not there, for each group of blocks by itself: what moves far away, or is heavy, hides nothing of what a step creates elsewhere.
//
// A group is of all blocks that have been candidates of contact with each other; fixed blocks join none. Its mechanical energy (kinetic, gravity,
// springs of contacts and supports) can only fall, since no block outside can give it any: the rise above the least value that it has had was
// created. Groups with loads are left out, and all where the base moves or the method is explicit: what is done to them from outside is in the ledger
// of the whole alone, which Watch compares with the energy of the whole.
#pragma once

#include <vector>

#include "openclose/analysis/simulation.h"

namespace openclose {

class EnergyGroups {
 public:
  /// \param undetermined_length  [m] to which the method tells places
  void begin(const Simulation& simulation, double undetermined_length);
  /// After every step: blocks that have become candidates are of one group from now on.
  void follow(const Simulation& simulation);

  struct Worst {
    double created = 0.0, scale = 0.0;  ///< [J] the rise, and the energy there was to move the group and what the method leaves undetermined
    double part = 0.0;                  ///< [-] of the two
    int block = -1, blocks = 0;         ///< its fastest block, and how many there are

    void exchange(Archive& archive) { archive(created, scale, part, block, blocks); }
  };
  /// The group whose rise is the largest part of its energy; none where all blocks are one group, of which the ledger tells more.
  /// \param most  [-] of it may be created: what is undetermined counts by it
  Worst worst(const Simulation& simulation, double most);

  void exchange(Archive& archive);
  bool fits(const Simulation& simulation) const { return group_.size() == static_cast<std::size_t>(simulation.system().block_count()); }

 private:
  /// Of the blocks' places and velocities at one moment. Velocities of the whole steps and of the scheme belong to different times with some schemes:
  /// what rises with both of them was created.
  struct Energies {
    double of_output = 0.0, of_scheme = 0.0;  ///< [J]
    Energies& operator+=(const Energies& other) {
      of_output += other.of_output, of_scheme += other.of_scheme;
      return *this;
    }
  };
  struct Group {
    Energies lowest;
    double start = 0.0;     ///< [J] kinetic and in springs
    double released = 0.0;  ///< [J] by blocks that lie lower, the most so far
    double weight = 0.0;    ///< [N]
    bool has_loads = false;

    void exchange(Archive& archive) { archive(lowest.of_output, lowest.of_scheme, start, released, weight, has_loads); }
  };

  int root(int block);
  void unite(int a, int b);
  void unite_candidates(const Simulation& simulation);
  /// Per block, of the group that it is the root of: the energies now, and what its blocks that lie lower have released.
  void sum(const Simulation& simulation);

  std::vector<int> group_;     ///< of a block: another block of its group, or itself, see root()
  std::vector<Group> groups_;  ///< of roots
  std::vector<Vec2> start_;    ///< [m] displacement of the blocks at the start
  long searches_ = -1;         ///< for candidates, as far as they are followed
  int count_ = 0;              ///< of groups
  double undetermined_length_ = 0.0;
  std::vector<Energies> energies_;
  std::vector<double> released_, kinetic_;
};

}  // namespace openclose
