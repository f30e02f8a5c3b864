// The lists of pairs and contacts as an update leaves them: those that are found anew go in place of those before, and those that come to rest or
// wake go from list to list.
#include <algorithm>
#include <utility>
#include <vector>

#include "openclose/contact/detection.h"

namespace openclose {

/// Where the contacts of pairs that are not due go; candidates_.ranges are those of the new list from then on.
void Detector::find_kept_runs() {
  kept_.clear();
  auto change = changes_.begin();
  int end = 0;
  for (std::size_t i = 0; i < candidates_.pairs.size(); ++i) {
    const bool changed = change != changes_.end() && change->pair == static_cast<int>(i);
    const Range old = candidates_.ranges[i];
    const int size = changed ? change++->after.size() : old.size();
    candidates_.ranges[i] = {end, end + size};
    end += size;
    if (changed || size == 0) continue;
    const bool goes_on =
        !kept_.empty() && kept_.back().from + kept_.back().size == old.begin && kept_.back().to + kept_.back().size == candidates_.ranges[i].begin;
    if (goes_on) {
      kept_.back().size += size;
    } else {
      kept_.push_back({old.begin, candidates_.ranges[i].begin, size});
    }
  }
}

/// Puts what was found in place of what was there. What stays is moved within the list: first what goes forward, from the front, then what goes back,
/// from the end, so that nothing is written over that has still to be moved.
void Detector::put_in_place(std::vector<Contact>& contacts, bool orphans) {
  const std::vector<Contact> found = std::move(found_);  // so that it is gone in the end
  found_.clear();
  const auto put = [&](const Range& from, const Range& to) {
    std::copy(found.begin() + from.begin, found.begin() + from.end, contacts.begin() + to.begin);
  };
  const auto same_number = [](const DetectionChange& c) { return c.before.size() == c.after.size(); };
  if (!orphans && std::all_of(changes_.begin(), changes_.end(), same_number)) {
    for (DetectionChange& change : changes_) {
      put(change.after, change.before);
      change.after = change.before;
    }
    return;
  }
  find_kept_runs();
  const std::size_t count = candidates_.ranges.empty() ? 0 : candidates_.ranges.back().end;
  if (kept_.empty()) {
    if (contacts.capacity() < count) std::vector<Contact>().swap(contacts);  // before there is room for those that come
    contacts = found;
  } else {
    if (contacts.size() < count) resize_closely(contacts, count);  // so that it need not move each time that a few contacts come
    const auto at = [&](int i) { return contacts.begin() + i; };
    for (const Run& run : kept_) {
      if (run.to < run.from) std::copy(at(run.from), at(run.from + run.size), at(run.to));
    }
    for (auto run = kept_.rbegin(); run != kept_.rend(); ++run) {
      if (run->to > run->from) std::copy_backward(at(run->from), at(run->from + run->size), at(run->to + run->size));
    }
    contacts.resize(count);
    for (const DetectionChange& change : changes_) put(change.after, candidates_.ranges[change.pair]);
  }
  for (DetectionChange& change : changes_) change.after = candidates_.ranges[change.pair];
}

void Detector::PairList::reserve(std::size_t count) {
  pairs.reserve(count);
  states.reserve(count);
  ranges.reserve(count);
}

void Detector::PairList::take(const PairList& other, std::size_t i, const std::vector<Contact>& from, std::vector<Contact>& to) {
  const Range range = other.ranges[i];
  const int begin = static_cast<int>(to.size());
  pairs.push_back(other.pairs[i]);
  states.push_back(other.states[i]);
  ranges.push_back({begin, begin + range.size()});
  to.insert(to.end(), from.begin() + range.begin, from.begin() + range.end);
}

template <class F>
void Detector::PairList::remove_if(F leaves, std::vector<Contact>& contacts) {
  std::size_t kept = 0;
  int end = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (leaves(pairs[k])) continue;
    const Range from = ranges[k], to{end, end + from.size()};
    if (from.begin != to.begin) std::copy(contacts.begin() + from.begin, contacts.begin() + from.end, contacts.begin() + to.begin);
    pairs[kept] = pairs[k];
    states[kept] = states[k];
    ranges[kept++] = to;
    end = to.end;
  }
  pairs.resize(kept);
  states.resize(kept);
  ranges.resize(kept);
  contacts.resize(end);
}

void Detector::divide(const BlockSystem& system, ContactSet& contacts) {
  const auto moves = [&](const std::pair<int, int>& pair) {
    return system.block(pair.first).equation >= 0 || system.block(pair.second).equation >= 0;
  };
  std::vector<int> woken;
  std::size_t more = 0;  // contacts
  for (std::size_t k = 0; k < resting_.pairs.size(); ++k) {
    if (!moves(resting_.pairs[k])) continue;
    woken.push_back(static_cast<int>(k));
    more += resting_.ranges[k].size();
    // When to look at this pair has not been followed.
    for (const int b : {resting_.pairs[k].first, resting_.pairs[k].second}) ways_[b].look_at = ways_[b].gone;
  }
  std::sort(woken.begin(), woken.end(), [&](int i, int j) { return resting_.pairs[i] < resting_.pairs[j]; });

  // Those that move stay in order.
  const PairList before = std::move(candidates_);
  const std::vector<Contact> moved = std::move(contacts.moving);
  candidates_ = {};
  candidates_.reserve(before.pairs.size() + woken.size());
  contacts.moving.clear();
  contacts.moving.reserve(moved.size() + more);
  auto next = woken.begin();
  for (std::size_t i = 0; i <= before.pairs.size(); ++i) {
    for (; next != woken.end() && (i == before.pairs.size() || resting_.pairs[*next] < before.pairs[i]); ++next)
      candidates_.take(resting_, static_cast<std::size_t>(*next), contacts.resting, contacts.moving);
    if (i == before.pairs.size()) break;
    if (moves(before.pairs[i])) {
      candidates_.take(before, i, moved, contacts.moving);
    } else {
      resting_.take(before, i, moved, contacts.resting);
    }
  }
  if (!woken.empty()) resting_.remove_if(moves, contacts.resting);
  list_pairs_of_blocks(system.block_count());
  index_.forget_resting();
}

}  // namespace openclose
