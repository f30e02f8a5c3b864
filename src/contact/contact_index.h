// The contacts as they were before some of them are found anew, by pair and by corner: all those of the blocks whose pairs are due.
#pragma once

#include <algorithm>
#include <vector>

#include "openclose/contact/contact.h"
#include "openclose/core/memory.h"
#include "openclose/model/block_system.h"

namespace openclose {

/// Positions [begin, end) in a list of contacts.
struct ContactRange {
  int begin = 0, end = 0;
  int size() const { return end - begin; }

  void exchange(Archive& archive) {
    auto& [a, b] = *this;
    archive(a, b);
  }
};

class ContactIndex {
 public:
  void begin(const BlockSystem& system, const std::vector<Contact>& contacts, const std::vector<Contact>& resting) {
    system_ = &system;
    contacts_ = &contacts;
    if (!knows_resting_) {
      first_.assign(system.state().arm.size(), -1);
      entries_.clear();
      deepest_ = 0.0;
      for (const Contact& c : resting) add(c);
      resting_first_ = first_;
      resting_entries_ = entries_.size();
      resting_deepest_ = deepest_;
      knows_resting_ = true;
    }
    first_ = resting_first_;
    deepest_ = resting_deepest_;
    entries_.resize(resting_entries_);
  }
  /// The contacts of one pair of blocks, in ascending order.
  void add(const ContactRange& range) {
    for (int i = range.begin; i < range.end; ++i) add((*contacts_)[i]);
  }
  /// Gives back what the contacts that move have taken.
  void let_go() {
    entries_.resize(resting_entries_);
    entries_.shrink_to_fit();
  }
  std::size_t bytes() const { return bytes_of(first_, entries_, resting_first_); }
  /// Other contacts are at rest than before.
  void forget_resting() { knows_resting_ = false; }

  /// Looks at the contacts of one pair of blocks.
  void select(const ContactRange& range) { range_ = range; }
  bool has_any() const { return range_.size() > 0; }
  /// Position in the list, or -1; of the selected pair.
  int find(int vertex, int edge) const {
    for (int i = range_.begin; i < range_.end; ++i) {
      if ((*contacts_)[i].vertex == vertex && (*contacts_)[i].edge == edge) return i;
    }
    return -1;
  }
  bool was_closed(int vertex, int edge) const {
    const int i = find(vertex, edge);
    return i >= 0 && (*contacts_)[i].status != ContactStatus::open;
  }
  /// [m] length over which the contact is closed.
  double closed_length(int vertex, int edge) const { return was_closed(vertex, edge) ? (*contacts_)[find(vertex, edge)].length : 0.0; }
  /// Whether this vertex or one of its two edges is in contact, with any block.
  bool closed(int vertex) const { return first_[vertex] >= 0; }
  /// [m] The largest closure of all contacts.
  double deepest() const { return deepest_; }
  /// Closed contacts of this vertex and those on its two edges.
  template <class F>
  void for_closed(int vertex, F f) const {
    for (int i = first_[vertex]; i >= 0; i = entries_[i].next) f(*entries_[i].contact);
  }

 private:
  struct Entry {
    const Contact* contact = nullptr;
    int next = -1;
  };

  void add(const Contact& contact) {
    if (contact.status == ContactStatus::open) return;
    deepest_ = std::max(deepest_, -contact.gap);
    for (const int corner : {contact.vertex, contact.edge, system_->next(contact.edge)}) {
      entries_.push_back({&contact, first_[corner]});
      first_[corner] = static_cast<int>(entries_.size()) - 1;
    }
  }

  const BlockSystem* system_ = nullptr;
  const std::vector<Contact>* contacts_ = nullptr;
  ContactRange range_;
  std::vector<int> first_;      ///< per vertex, in entries_; -1 without any
  std::vector<Entry> entries_;  ///< closed contacts of one vertex, of the ends of their edges too, chained
  double deepest_ = 0.0;        ///< [m]
  bool knows_resting_ = false;
  std::vector<int> resting_first_;   ///< of contacts at rest alone, which stand first among the entries
  std::size_t resting_entries_ = 0;  ///< number of these
  double resting_deepest_ = 0.0;     ///< [m]
};

}  // namespace openclose
