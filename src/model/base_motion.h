// Motion of the ground on which the fixed blocks and the anchors of supports stand. Coordinates move with it: a block of mass m feels the body force
// -m a(t), and all displacements and velocities are relative to the base.
#pragma once

#include <optional>

#include "openclose/scene/scene.h"

namespace openclose {

class BaseMotion {
 public:
  /// Without input the base rests.
  explicit BaseMotion(std::optional<BaseMotionInput> input) : input_(std::move(input)) {}

  /// [m/s2] Change of the base's velocity between two times [s], over their difference: exact, whatever pulses, waves and pieces of a record lie
  /// between them. The base begins to move at time 0. `to` must be after `from`.
  Vec2 mean_acceleration(double from, double to) const;

 private:
  std::optional<BaseMotionInput> input_;
};

}  // namespace openclose
