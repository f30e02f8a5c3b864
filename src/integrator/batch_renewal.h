// The contacts of a step in batches, where most of them are those of the last step: springs and strength, which follow from joint, bond, length and
// blocks, and from the duration of the step, are worked out anew only where one of these has changed.
#pragma once

#include <optional>
#include <vector>

#include "openclose/integrator/contact_batch.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

/// The springs of the contacts of a step.
class SpringSource {
 public:
  virtual ~SpringSource() = default;
  virtual ContactSprings make(std::size_t c) const = 0;
  /// Those of all contacts, where they are at hand.
  virtual const ContactSprings* list() const { return nullptr; }
  /// Whether gap, target and initial_shear are those of joint_springs(), shift is 0, and all else follows from nothing but the contact's joint,
  /// length and blocks and from the problem's dt, statics, end_weight and averages_path().
  virtual bool last() const = 0;
};

/// As they stand in a list.
class GivenSprings final : public SpringSource {
 public:
  explicit GivenSprings(const std::vector<ContactSprings>& list) : list_(list) {}
  ContactSprings make(std::size_t c) const override { return list_[c]; }
  const ContactSprings* list() const override { return list_.data(); }
  bool last() const override { return false; }

 private:
  const std::vector<ContactSprings>& list_;
};

/// Serves one system of blocks and one table of joints: masses and stiffnesses are taken to stay, strengths to follow from the table's reduction.
class BatchRenewal {
 public:
  /// Sets all batches up to begin(). The places of blocks are their equations; those without have the one that comes after these.
  /// \param starts  the batches as the last call has left them, but for gaps and forces at the start
  void renew(const StepProblem& problem, const SpringSource& springs, ContactStarts& starts);
  /// The batches are not as the last call has left them.
  void forget() { owners_.clear(); }
  std::size_t bytes() const { return bytes_of(owners_); }

 private:
  struct Step {
    double dt = 0.0, end_weight = 0.0;
    bool statics = false, averages_path = false;
    std::optional<double> reduction;
    bool operator==(const Step&) const = default;
  };
  /// What the contacts of a step need of a block.
  struct BlockPlace {
    Vec2 centroid;  ///< [m]
    int place;
  };
  /// Whose springs and strength they are; the blocks tell the joint.
  struct Owner {
    double length = 0.0;
    int vertex_block = -1;
    int edge_block = -1;  ///< where the joint is not bonded minus this minus 2: no numbers of the others

    Owner() = default;
    explicit Owner(const Contact& contact)
        : length(contact.length), vertex_block(contact.vertex_block), edge_block(contact.bonded ? contact.edge_block : -2 - contact.edge_block) {}
    bool operator==(const Owner&) const = default;
  };

  static std::vector<BlockPlace> places_of(const BlockSystem& system);

  Step step_;
  std::vector<Owner> owners_;  ///< of the contacts of the last step, none where their springs do not last
};

}  // namespace openclose
