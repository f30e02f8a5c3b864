// Where the contacts of a step are in their batches. In motion many are kept that are open: within each group of contacts that follow each other in
// the list those that are likely to be closed come first, so that whole batches of the others add nothing and are passed over. A group is small, so
// that contacts stay near their neighbours and those of another group stay where they are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "openclose/contact/contact.h"

namespace openclose {

class ContactOrder {
 public:
  /// As in the list.
  void keep(std::size_t count) {
    within_.resize(count);
    for (std::size_t c = 0; c < count; ++c) within_[c] = static_cast<unsigned char>(c % group_size);
  }
  /// Closed ones first. Depends on nothing but the contacts at the start of the step: a run that goes on from a checkpoint adds up in the same order.
  void pack(const std::vector<Contact>& contacts) {
    within_.resize(contacts.size());
    for (std::size_t first = 0; first < contacts.size(); first += group_size) {
      const std::size_t end = std::min(contacts.size(), first + group_size);
      unsigned closed = 0, open = 0;
      for (std::size_t c = first; c < end; ++c) open += is_closed(contacts[c]) ? 1 : 0;
      for (std::size_t c = first; c < end; ++c) within_[c] = static_cast<unsigned char>(is_closed(contacts[c]) ? closed++ : open++);
    }
  }

  std::size_t size() const { return within_.size(); }
  /// Place of contact c; below size().
  std::size_t operator[](std::size_t c) const { return c / group_size * group_size + within_[c]; }
  std::size_t bytes() const { return within_.capacity(); }

 private:
  /// With one batch of both kinds in most groups a sixteenth of the batches is mixed.
  static constexpr std::size_t group_size = 64;
  static bool is_closed(const Contact& contact) { return contact.status != ContactStatus::open || contact.stretch() <= 0.0; }

  std::vector<unsigned char> within_;  ///< place in its group
};

}  // namespace openclose
