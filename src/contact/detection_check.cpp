// Whether the state of a detector that was read from a file can be one that was written.
#include <algorithm>
#include <utility>

#include "openclose/contact/detection.h"
#include "openclose/contact/joint_table.h"

namespace openclose {
namespace {

bool is_index(int i, std::size_t size) {
  return i >= 0 && static_cast<std::size_t>(i) < size;
}

bool has_vertex(const BlockSystem& system, int block, int vertex) {
  if (!is_index(block, static_cast<std::size_t>(system.block_count()))) return false;
  const auto& b = system.block(block);
  return vertex >= b.first_vertex && vertex < b.first_vertex + b.vertex_count;
}

/// Whether the pairs of a list have all of the contacts among them, one after another, each its own.
template <class PairList>
bool are_shared_out(const PairList& list, const std::vector<Contact>& contacts) {
  int at = 0;
  for (std::size_t i = 0; i < list.pairs.size(); ++i) {
    const ContactRange range = list.ranges[i];
    if (range.begin != at || range.end < at) return false;
    for (; at < range.end; ++at) {
      if (std::pair<int, int>(std::minmax(contacts[at].vertex_block, contacts[at].edge_block)) != list.pairs[i]) return false;
    }
  }
  return static_cast<std::size_t>(at) == contacts.size();
}

}  // namespace

bool Detector::contacts_fit(const BlockSystem& system, const JointTable& joints, const std::vector<Contact>& contacts) {
  return std::all_of(contacts.begin(), contacts.end(), [&](const Contact& c) {
    return has_vertex(system, c.vertex_block, c.vertex) && has_vertex(system, c.edge_block, c.edge) && c.vertex_block != c.edge_block &&
           is_index(c.joint, static_cast<std::size_t>(joints.count())) && c.status <= ContactStatus::sliding;
  });
}

bool Detector::pairs_fit(const BlockSystem& system, const PairList& list, std::size_t contacts) {
  const int blocks = system.block_count();
  return list.states.size() == list.pairs.size() && list.ranges.size() == list.pairs.size() &&
         std::ranges::all_of(list.pairs, [&](const auto& pair) { return pair.first >= 0 && pair.first < pair.second && pair.second < blocks; }) &&
         std::ranges::all_of(list.ranges, [&](const Range& range) {
           return range.begin >= 0 && range.begin <= range.end && static_cast<std::size_t>(range.end) <= contacts;
         });
}

/// Lists are there for all blocks or for none.
bool Detector::lists_of_blocks_fit(std::size_t blocks) const {
  const auto fits = [blocks](const auto& list) { return list.empty() || list.size() == blocks; };
  if (!fits(searched_at_) || !fits(searched_moving_at_) || !fits(places_) || ways_.size() != places_.size()) return false;
  if (searched_at_.empty() && !candidates_.pairs.empty()) return false;
  if (pairs_of_start_.empty()) return candidates_.pairs.empty() && pairs_of_.empty();
  if (pairs_of_start_.size() != blocks + 1 || pairs_of_start_.front() != 0 || !std::is_sorted(pairs_of_start_.begin(), pairs_of_start_.end()))
    return false;
  return static_cast<std::size_t>(pairs_of_start_.back()) == pairs_of_.size() &&
         std::all_of(pairs_of_.begin(), pairs_of_.end(), [&](int pair) { return is_index(pair, candidates_.pairs.size()); });
}

bool Detector::fits(const BlockSystem& system, const JointTable& joints, const ContactSet& contacts) const {
  if (!lists_of_blocks_fit(static_cast<std::size_t>(system.block_count())) || !pairs_fit(system, candidates_, contacts.moving.size()) ||
      !pairs_fit(system, resting_, contacts.resting.size()) || !contacts_fit(system, joints, contacts.moving) ||
      !contacts_fit(system, joints, contacts.resting))
    return false;
  // What others have changed is found anew.
  if (forgotten_) return true;
  return std::ranges::is_sorted(candidates_.pairs) && are_shared_out(candidates_, contacts.moving) && are_shared_out(resting_, contacts.resting);
}

}  // namespace openclose
