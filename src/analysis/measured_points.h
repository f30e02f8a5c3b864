// The points whose motion a run tells.
#pragma once

#include <string>
#include <vector>

#include "openclose/analysis/simulation.h"

namespace openclose {

/// Motion of a measured point since time 0.
struct PointMotion {
  std::string name;
  Vec2 displacement = Vec2::Zero();  ///< [m]
  double rotation = 0.0;             ///< [rad]
  Vec2 velocity = Vec2::Zero();      ///< [m/s]
  double angular_velocity = 0.0;     ///< [rad/s]
};

/// The measured points of a scene; without any, the centroids of the free blocks.
class MeasuredPoints {
 public:
  explicit MeasuredPoints(Simulation& simulation);
  /// Displacements count from here.
  void restart();
  std::vector<PointMotion> motions() const;
  /// From where displacements count; the points themselves are the scene's.
  void exchange(Archive& archive) {
    for (Point& p : points_) archive(p.start_arm, p.start_displacement);
  }
  double first_displacement() const { return points_.empty() ? 0.0 : displacement(points_.front()).norm(); }  ///< [m] of the first point
  double largest_displacement() const;                                                                        ///< [m]

 private:
  struct Point {
    std::string name;
    int number;  ///< of the system's followed points
    Vec2 start_arm;
    Motion::Unknowns start_displacement;
  };
  Vec2 displacement(const Point& point) const;

  const Simulation& simulation_;  // const: the explicit loop goes on after it has been asked
  std::vector<Point> points_;
};

}  // namespace openclose
