#include "openclose/analytical/two_spring_block.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace openclose::analytical {

double bounce_frequency(const BlockOnPlane& block) {
  return std::sqrt(2 * block.normal_stiffness / block.mass());
}

std::array<double, 2> sway_rock_frequencies(const BlockOnPlane& block) {
  const double b = block.width;
  const double h = block.height;
  const double sway = 2 * block.shear_stiffness / block.mass();
  const double rock = (block.normal_stiffness * b * b + block.shear_stiffness * h * h - block.weight() * h) / (2 * block.moment_of_inertia());
  const double coupling_squared = std::pow(block.shear_stiffness * h, 2) / (block.mass() * block.moment_of_inertia());
  const double determinant = sway * rock - coupling_squared;
  if (!(determinant > 0 && rock > 0)) throw std::domain_error("the springs do not hold the block upright");
  const double larger = (sway + rock) / 2 + std::hypot((sway - rock) / 2, std::sqrt(coupling_squared));
  // The smaller eigenvalue from the product: no cancellation.
  return {std::sqrt(determinant / larger), std::sqrt(larger)};
}

double highest_frequency(const BlockOnPlane& block) {
  return std::max(bounce_frequency(block), sway_rock_frequencies(block)[1]);
}

double critical_explicit_step(const BlockOnPlane& block) {
  return 2 / highest_frequency(block);
}

}  // namespace openclose::analytical
