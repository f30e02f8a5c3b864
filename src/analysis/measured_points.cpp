#include "openclose/analysis/measured_points.h"

#include <algorithm>

namespace openclose {

MeasuredPoints::MeasuredPoints(Simulation& simulation) : simulation_(simulation) {
  const Scene& scene = simulation.scene();
  BlockSystem& system = simulation.change_system();
  const auto follow = [&](const std::string& name, int block, const Vec2& position) {
    points_.push_back({name, system.follow_point(block, position), Vec2::Zero(), Motion::Unknowns::Zero()});
  };
  for (const MeasuredPoint& p : scene.measured_points) follow(p.name, p.block, p.point);
  if (points_.empty()) {
    for (int b : system.free_blocks()) follow(scene.blocks[b].name, b, system.block(b).reference_centroid + system.origin());
  }
  restart();
}

void MeasuredPoints::restart() {
  const auto& system = simulation_.system();
  for (Point& p : points_) {
    p.start_displacement = system.displacement(system.point_block(p.number));
    p.start_arm = system.point_arm(p.number);
  }
}

Vec2 MeasuredPoints::displacement(const Point& point) const {
  const auto& system = simulation_.system();
  const auto moved = (system.displacement(system.point_block(point.number)) - point.start_displacement).eval();
  return Motion::translation(moved) + (system.point_arm(point.number) - point.start_arm);
}

std::vector<PointMotion> MeasuredPoints::motions() const {
  const auto& system = simulation_.system();
  std::vector<PointMotion> list;
  for (const Point& p : points_) {
    const int b = system.point_block(p.number);
    const auto moved = (system.displacement(b) - p.start_displacement).eval();
    const auto velocity = simulation_.velocity(b);
    PointMotion m;
    m.name = p.name;
    m.displacement = displacement(p);
    m.rotation = Motion::rotation(moved);
    m.angular_velocity = Motion::rotation(velocity);
    m.velocity = Motion::translation(velocity) + Motion::rotation(velocity) * perpendicular(system.point_arm(p.number));
    list.push_back(m);
  }
  return list;
}

double MeasuredPoints::largest_displacement() const {
  double largest = 0.0;
  for (const Point& p : points_) largest = std::max(largest, displacement(p).norm());
  return largest;
}

}  // namespace openclose
