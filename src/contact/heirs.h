// A contact has a past: what it carries, whether it is bonded. Where a corner goes on to another edge under another name, the past goes with it.
#pragma once

#include <vector>

#include "openclose/contact/contact.h"
#include "openclose/contact/history.h"
#include "openclose/model/block_system.h"

namespace openclose {

/// Contacts that are new inherit from those of the same corner that are gone, each of which has one heir at most.
/// \param before  the list as it was; those that have an heir lose their length
/// \param gone    places in it
/// \param found   among which new ones are
/// \param born    their places; sorted by length
/// \return how many inherit
int pass_on_history(const BlockSystem& system, std::vector<Contact>& before, const std::vector<int>& gone, std::vector<Contact>& found,
                    std::vector<std::size_t>& born, InheritedForces forces);

}  // namespace openclose
