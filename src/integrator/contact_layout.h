// The contacts of a step in batches of four, as they are at its start.
#pragma once

#include <vector>

#include "openclose/integrator/contact_batch.h"

namespace openclose {

struct StepProblem;

/// The springs of the contacts of a step.
class SpringSource {
 public:
  virtual ~SpringSource() = default;
  virtual ContactSprings make(std::size_t c) const = 0;
};

/// As they stand in a list.
class GivenSprings final : public SpringSource {
 public:
  explicit GivenSprings(const std::vector<ContactSprings>& list) : list_(list) {}
  ContactSprings make(std::size_t c) const override { return list_[c]; }

 private:
  const std::vector<ContactSprings>& list_;
};

/// Sets all batches up to begin(). The places of blocks are their equations; those without have the one that comes after these.
void lay_out(const StepProblem& problem, const SpringSource& springs, std::vector<ContactBatch>& batches);

}  // namespace openclose
