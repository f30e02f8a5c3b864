// The contacts of an increment (balance.h) four at a time: how gaps and slips change with a displacement, what the contacts carry then, and the sums
// of it by blocks. The kernels are compiled once for every processor and once for wide registers; every number is computed by the same operations in
// the same order as for one contact.
#pragma once

#include <cstddef>
#include <vector>

#include "openclose/core/packs.h"
#include "openclose/statics/frozen_state.h"

namespace openclose {

/// What a contact's shear force is bounded by during an increment.
enum class ShearLaw {
  coulomb,  ///< by the strength at the normal force of the same increment
  fixed,    ///< by given bounds: a convex problem
  elastic,  ///< by nothing: neither slips nor opens; a convex problem
};

/// What four contacts start the increment with.
struct IncrementSprings {
  Lanes gap{}, shear{};                         ///< at the start
  Lanes normal_stiffness{}, shear_stiffness{};  ///< [-]
  Lanes friction{}, cohesion{}, tension{};      ///< as in ContactStrength
  Lanes bound{};                                ///< of ShearLaw::fixed
};

/// What four contacts carry at the end, and the derivatives by the changes of gap and slip.
struct ResponsePack {
  Lanes normal{}, shear{};
  Lanes normal_by_gap{}, shear_by_gap{}, shear_by_slip{};
};

/// The same of one contact.
struct ContactResponse {
  double normal = 0.0, shear = 0.0;
  double normal_by_gap = 0.0, shear_by_gap = 0.0, shear_by_slip = 0.0;

  ContactStatus status() const {
    return normal_by_gap == 0.0 ? ContactStatus::open : shear_by_slip == 0.0 ? ContactStatus::sliding : ContactStatus::sticking;
  }
};

/// Four contacts; what is not set carries nothing and adds nothing.
struct IncrementPack {
  IncrementSprings springs;
  Lanes normal_a[3]{}, normal_b[3]{}, shear_a[3]{}, shear_b[3]{};  ///< as in FrozenContact; 0 of a fixed block
  int a[batch_size]{}, b[batch_size]{};                            ///< rows of the blocks, a fixed one being the row after the last
};

/// Changes of gap and slip at the start of a search and along its way.
struct SearchPack {
  Lanes gap{}, slip{}, opening{}, slipping{};
};

class IncrementPacks {
 public:
  explicit IncrementPacks(const FrozenSystem& system);

  /// The state of contact i at the start.
  void start(std::size_t i, const FrozenContactState& state);
  void set_strength(std::size_t i, const ContactStrength& strength);
  /// Of ShearLaw::fixed: what the strength allows at a normal force.
  void set_bound_of(std::size_t i, double normal);

  /// The responses to a displacement.
  /// \param motion  three numbers a block and three zeros for fixed ones
  /// \param force   the same, to which what contacts carry is added; what is added in the last three means nothing
  void evaluate(const double* motion, ShearLaw law, double* force);
  /// The same as evaluate(), and the contacts go on from where that brings them.
  void follow(const double* motion, ShearLaw law, double* force);
  /// [-] Gap of a contact at the start.
  double gap(std::size_t i) const { return packs_[i / batch_size].springs.gap[i % batch_size]; }
  /// Of the last evaluation.
  ContactResponse response(std::size_t i) const;

  /// A search starts from the displacement `motion`, along another one, `way`.
  void begin_search(const double* motion, const double* way);
  /// Takes the derivative of the work of all contacts, by the part of the way of the search, from a number, in the order of the contacts.
  double subtract_power(double from, double part, ShearLaw law) const;

 private:
  std::vector<IncrementPack> packs_;
  std::vector<ResponsePack> responses_;
  std::vector<SearchPack> ways_;
};

}  // namespace openclose
