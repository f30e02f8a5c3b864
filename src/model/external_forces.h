// Forces on blocks that do not come from contacts: gravity, the motion of the base, and force elements (loads, supports, ...).
#pragma once

#include <memory>
#include <vector>

#include "openclose/model/base_motion.h"
#include "openclose/model/block_system.h"
#include "openclose/model/force_elements.h"

namespace openclose {

class ExternalForces {
 public:
  using Unknowns = Motion::Unknowns;
  using Matrix = Motion::Matrix;

  /// Makes `system` follow the points of the scene's forces.
  ExternalForces(const Scene& scene, BlockSystem& system);

  /// The forces of the next step are those of a base that moves as it does between these times [s]: what they give the blocks is exactly the change
  /// of the base's velocity.
  void move_base(double from, double to) { base_acceleration_ = base_motion_.mean_acceleration(from, to); }
  void hold_base() { base_acceleration_.setZero(); }
  void exchange(Archive& archive) { archive(base_acceleration_); }
  const Vec2& base_acceleration() const { return base_acceleration_; }  ///< [m/s2] mean over these times

  Unknowns weight(const BlockSystem& system, int b) const;      ///< [N]
  Unknowns base_force(const BlockSystem& system, int b) const;  ///< [N] minus mass times acceleration of the base
  /// Forces of gravity, base and elements on block b after it has moved by d from the system's present state.
  Unknowns force(const BlockSystem& system, int b, const Unknowns& d) const;
  /// Minus the derivative of force() by d.
  Matrix stiffness(const BlockSystem& system, int b, const Unknowns& d) const;

  /// The symmetric part of the stiffness at the present state, for bounds of time steps and frequencies.
  Matrix symmetric_stiffness(const BlockSystem& system, int b) const;

  /// The mean of these forces over a step to d, along a straight path.
  Unknowns mean_force(const BlockSystem& system, int b, const Unknowns& d) const;
  /// Minus the derivative of mean_force() by d.
  Matrix mean_stiffness(const BlockSystem& system, int b, const Unknowns& d) const;

  /// [N] sum of the magnitudes of these forces on block b, the scale of what rounding leaves of their sum, which may cancel.
  double magnitude(const BlockSystem& system, int b, const Unknowns& d) const;
  /// [N] what forces of springs change by when coordinates change by their own size: times the rounding unit, the noise of that force.
  double spring_scale(const BlockSystem& system, int b) const;

  /// False: force() does not depend on d.
  bool has_elements(int b) const { return !of_blocks_.empty() && !of_blocks_[b].empty(); }
  const std::vector<std::unique_ptr<const ForceElement>>& elements() const { return elements_; }
  /// f(element) for those of block b.
  template <class F>
  void for_each_element(int b, F f) const {
    if (of_blocks_.empty()) return;
    for (const ForceElement* element : of_blocks_[b]) f(*element);
  }
  const Vec2& gravity() const { return gravity_; }

 private:
  Vec2 gravity_;
  BaseMotion base_motion_;
  Vec2 base_acceleration_ = Vec2::Zero();
  std::vector<std::unique_ptr<const ForceElement>> elements_;
  std::vector<std::vector<const ForceElement*>> of_blocks_;  ///< empty without any
};

}  // namespace openclose
