// Forces on blocks that do not come from contacts: gravity, the motion of the base, constant forces at points, springs that hold points.
#pragma once

#include <vector>

#include "openclose/model/base_motion.h"
#include "openclose/model/block_system.h"

namespace openclose {

class ExternalForces {
 public:
  using Unknowns = Motion::Unknowns;
  using Matrix = Motion::Matrix;

  struct PointForce {
    int point = 0;                  ///< followed point of the system
    Vec2 force = Vec2::Zero();      ///< [N] constant part
    Vec2 stiffness = Vec2::Zero();  ///< [N/m] of springs in x and y
    Vec2 anchor = Vec2::Zero();     ///< [m] where the springs are slack, relative to the system's origin
  };

  /// Makes `system` follow the points of the scene's loads and supports.
  ExternalForces(const Scene& scene, BlockSystem& system);

  /// The forces of the next step are those of a base that moves as it does between these times [s]: what they give the blocks is exactly the change
  /// of the base's velocity.
  void move_base(double from, double to) { base_acceleration_ = base_motion_.mean_acceleration(from, to); }
  void hold_base() { base_acceleration_.setZero(); }
  void exchange(Archive& archive) { archive(base_acceleration_); }
  const Vec2& base_acceleration() const { return base_acceleration_; }  ///< [m/s2] mean over these times

  Unknowns weight(const BlockSystem& system, int b) const;      ///< [N]
  Unknowns base_force(const BlockSystem& system, int b) const;  ///< [N] minus mass times acceleration of the base
  /// Forces of gravity, base, loads and supports on block b after it has moved by d from the system's present state.
  Unknowns force(const BlockSystem& system, int b, const Unknowns& d) const;
  /// Minus the derivative of force() by d.
  Matrix stiffness(const BlockSystem& system, int b, const Unknowns& d) const;

  /// One of these forces as it is at the start of a step, and what it changes by with d in the first order.
  static Unknowns linear_force(const BlockSystem& system, const PointForce& f, const Unknowns& d);

  /// The mean of such forces over a step to d, along a straight path and in the mean geometry: their work is the product with d, exactly for
  /// translations and to the third order in the rotation.
  Unknowns mean_force(const BlockSystem& system, int b, const Unknowns& d) const;
  /// Minus the derivative of mean_force() by d.
  Matrix mean_stiffness(const BlockSystem& system, int b, const Unknowns& d) const;

  /// [N] sum of the magnitudes of these forces on block b, the scale of what rounding leaves of their sum, which may cancel.
  double magnitude(const BlockSystem& system, int b, const Unknowns& d) const;
  /// [N] what the springs' forces change by when coordinates change by their own size: times the rounding unit, the noise of that force.
  double spring_scale(const BlockSystem& system, int b) const;

  /// False: force() does not depend on d.
  bool has_point_forces(int b) const { return !of_blocks_.empty() && !(of_blocks_[b].loads.empty() && of_blocks_[b].supports.empty()); }
  const std::vector<PointForce>& loads() const { return loads_; }
  const std::vector<PointForce>& supports() const { return supports_; }
  const Vec2& gravity() const { return gravity_; }

 private:
  template <class F>
  void for_each_point_force(int b, F f) const {
    if (of_blocks_.empty()) return;
    for (int i : of_blocks_[b].loads) f(loads_[i]);
    for (int i : of_blocks_[b].supports) f(supports_[i]);
  }
  static Matrix stiffness(const PointForce& f, const Vec2& arm, const Vec2& stretch);
  /// Those at a block, by their numbers.
  struct PointForces {
    std::vector<int> loads, supports;
  };

  Vec2 gravity_;
  BaseMotion base_motion_;
  Vec2 base_acceleration_ = Vec2::Zero();
  std::vector<PointForce> loads_, supports_;
  std::vector<PointForces> of_blocks_;  ///< empty without any
};

}  // namespace openclose
