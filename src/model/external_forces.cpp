#include "openclose/model/external_forces.h"

namespace openclose {

ExternalForces::ExternalForces(const Scene& scene, BlockSystem& system)
    : gravity_(scene.gravity), base_motion_(scene.base_motion), elements_(force_elements(scene, system)) {
  if (!elements_.empty()) of_blocks_.resize(scene.blocks.size());
  for (const auto& element : elements_) of_blocks_[element->block()].push_back(element.get());
}

ExternalForces::Unknowns ExternalForces::weight(const BlockSystem& system, int b) const {
  return Motion::gradient(Vec2::Zero(), system.block(b).mass[0] * gravity_);
}

ExternalForces::Unknowns ExternalForces::base_force(const BlockSystem& system, int b) const {
  return Motion::gradient(Vec2::Zero(), -system.block(b).mass[0] * base_acceleration_);
}

ExternalForces::Unknowns ExternalForces::force(const BlockSystem& system, int b, const Unknowns& d) const {
  Unknowns total = weight(system, b) + base_force(system, b);
  for_each_element(b, [&](const ForceElement& element) { total += element.force(element.path(system, d)); });
  return total;
}

ExternalForces::Matrix ExternalForces::stiffness(const BlockSystem& system, int b, const Unknowns& d) const {
  Matrix total = Matrix::Zero();
  for_each_element(b, [&](const ForceElement& element) { total += element.stiffness(element.path(system, d)); });
  return total;
}

ExternalForces::Matrix ExternalForces::symmetric_stiffness(const BlockSystem& system, int b) const {
  const Matrix all = stiffness(system, b, Unknowns::Zero());
  return 0.5 * (all + all.transpose());
}

ExternalForces::Unknowns ExternalForces::mean_force(const BlockSystem& system, int b, const Unknowns& d) const {
  Unknowns total = weight(system, b) + base_force(system, b);
  for_each_element(b, [&](const ForceElement& element) { total += element.mean_force(element.path(system, d)); });
  return total;
}

ExternalForces::Matrix ExternalForces::mean_stiffness(const BlockSystem& system, int b, const Unknowns& d) const {
  Matrix total = Matrix::Zero();
  for_each_element(b, [&](const ForceElement& element) { total += element.mean_stiffness(element.path(system, d)); });
  return total;
}

double ExternalForces::magnitude(const BlockSystem& system, int b, const Unknowns& d) const {
  double total = weight(system, b).norm() + base_force(system, b).norm();
  for_each_element(b, [&](const ForceElement& element) { total += element.magnitude(element.path(system, d)); });
  return total;
}

double ExternalForces::spring_scale(const BlockSystem& system, int b) const {
  double total = 0.0;
  for_each_element(b, [&](const ForceElement& element) { total += element.spring_scale(element.path(system, Unknowns::Zero())); });
  return total;
}

}  // namespace openclose
