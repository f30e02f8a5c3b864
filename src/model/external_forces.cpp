#include "openclose/model/external_forces.h"

namespace openclose {

ExternalForces::ExternalForces(const Scene& scene, BlockSystem& system) : gravity_(scene.gravity), base_motion_(scene.base_motion) {
  if (!scene.loads.empty() || !scene.supports.empty()) of_blocks_.resize(scene.blocks.size());
  for (const Load& load : scene.loads) {
    of_blocks_[load.block].loads.push_back(static_cast<int>(loads_.size()));
    loads_.push_back({system.follow_point(load.block, load.point), load.force, Vec2::Zero(), Vec2::Zero()});
  }
  for (const Support& support : scene.supports) {
    of_blocks_[support.block].supports.push_back(static_cast<int>(supports_.size()));
    const int point = system.follow_point(support.block, support.point);
    supports_.push_back({point, Vec2::Zero(), support.stiffness, system.point_position(point)});
  }
}

ExternalForces::Unknowns ExternalForces::weight(const BlockSystem& system, int b) const {
  return Motion::gradient(Vec2::Zero(), system.block(b).mass[0] * gravity_);
}

ExternalForces::Unknowns ExternalForces::base_force(const BlockSystem& system, int b) const {
  return Motion::gradient(Vec2::Zero(), -system.block(b).mass[0] * base_acceleration_);
}

ExternalForces::Unknowns ExternalForces::force(const BlockSystem& system, int b, const Unknowns& d) const {
  Unknowns total = weight(system, b) + base_force(system, b);
  for_each_point_force(b, [&](const PointForce& f) {
    const Vec2 moved = Motion::displacement(d, system.point_arm(f.point), system.rotation_kind());
    const Vec2 stretch = (system.point_position(f.point) - f.anchor) + moved;
    const Vec2 arm = system.point_arm(f.point) + moved - Motion::translation(d);
    total += Motion::gradient(arm, f.force - f.stiffness.cwiseProduct(stretch));
  });
  return total;
}

ExternalForces::Matrix ExternalForces::stiffness(const BlockSystem& system, int b, const Unknowns& d) const {
  Matrix total = Matrix::Zero();
  for_each_point_force(b, [&](const PointForce& f) {
    const Vec2 moved = Motion::displacement(d, system.point_arm(f.point), system.rotation_kind());
    const Vec2 stretch = (system.point_position(f.point) - f.anchor) + moved;
    total += stiffness(f, system.point_arm(f.point) + moved - Motion::translation(d), stretch);
  });
  return total;
}

ExternalForces::Matrix ExternalForces::stiffness(const PointForce& f, const Vec2& arm, const Vec2& stretch) {
  const Unknowns gx = Motion::gradient(arm, {1.0, 0.0}), gy = Motion::gradient(arm, {0.0, 1.0});
  return f.stiffness.x() * gx * gx.transpose() + f.stiffness.y() * gy * gy.transpose() -
         Motion::hessian(arm, f.force - f.stiffness.cwiseProduct(stretch));
}

ExternalForces::Unknowns ExternalForces::linear_force(const BlockSystem& system, const PointForce& f, const Unknowns& d) {
  const Vec2 arm = system.point_arm(f.point), stretch = system.point_position(f.point) - f.anchor;
  return Motion::gradient(arm, f.force - f.stiffness.cwiseProduct(stretch)) - stiffness(f, arm, stretch) * d;
}

ExternalForces::Unknowns ExternalForces::mean_force(const BlockSystem& system, int b, const Unknowns& d) const {
  Unknowns total = weight(system, b) + base_force(system, b);
  for_each_point_force(b, [&](const PointForce& f) {
    const Vec2 moved = Motion::displacement(d, system.point_arm(f.point), system.rotation_kind());
    const Vec2 stretch = (system.point_position(f.point) - f.anchor) + 0.5 * moved;
    const Vec2 arm = system.point_arm(f.point) + 0.5 * (moved - Motion::translation(d));
    total += Motion::gradient(arm, f.force - f.stiffness.cwiseProduct(stretch));
  });
  return total;
}

ExternalForces::Matrix ExternalForces::mean_stiffness(const BlockSystem& system, int b, const Unknowns& d) const {
  Matrix total = Matrix::Zero();
  for_each_point_force(b, [&](const PointForce& f) {
    const Vec2 moved = Motion::displacement(d, system.point_arm(f.point), system.rotation_kind());
    const Vec2 stretch = (system.point_position(f.point) - f.anchor) + 0.5 * moved;
    const Vec2 turned = moved - Motion::translation(d);
    const Vec2 end_arm = system.point_arm(f.point) + turned, arm = system.point_arm(f.point) + 0.5 * turned;
    const Unknowns gx = Motion::gradient(end_arm, {1.0, 0.0}), gy = Motion::gradient(end_arm, {0.0, 1.0});
    total += 0.5 * f.stiffness.x() * Motion::gradient(arm, {1.0, 0.0}) * gx.transpose();
    total += 0.5 * f.stiffness.y() * Motion::gradient(arm, {0.0, 1.0}) * gy.transpose();
    total -= 0.5 * Motion::hessian(end_arm, f.force - f.stiffness.cwiseProduct(stretch));
  });
  return total;
}

double ExternalForces::magnitude(const BlockSystem& system, int b, const Unknowns& d) const {
  double total = weight(system, b).norm() + base_force(system, b).norm();
  for_each_point_force(b, [&](const PointForce& f) {
    const Vec2 moved = Motion::displacement(d, system.point_arm(f.point), system.rotation_kind());
    const Vec2 stretch = (system.point_position(f.point) - f.anchor) + moved;
    total += f.force.norm() + f.stiffness.cwiseProduct(stretch).norm();
  });
  return total;
}

double ExternalForces::spring_scale(const BlockSystem& system, int b) const {
  double total = 0.0;
  for_each_point_force(b, [&](const PointForce& f) { total += f.stiffness.maxCoeff() * (f.anchor.norm() + system.point_position(f.point).norm()); });
  return total;
}

}  // namespace openclose
