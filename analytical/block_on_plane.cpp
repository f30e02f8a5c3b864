#include "openclose/analytical/block_on_plane.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace openclose::analytical {
namespace {

void require_positive(double value, const char* name) {
  if (!(value > 0) || !std::isfinite(value)) throw std::invalid_argument(std::string(name) + " must be positive and finite");
}

void require_acute(double angle, const char* name) {
  if (!(angle >= 0 && angle < std::numbers::pi / 2)) throw std::invalid_argument(std::string(name) + " must be in [0, 90) degrees");
}

}  // namespace

double BlockOnPlane::friction() const {
  return std::tan(friction_angle);
}
double BlockOnPlane::mass() const {
  return density * width * height;
}
double BlockOnPlane::weight() const {
  return mass() * gravity;
}
double BlockOnPlane::normal_weight() const {
  return weight() * std::cos(slope_angle);
}
double BlockOnPlane::moment_of_inertia() const {
  return mass() * (width * width + height * height) / 12;
}

void require_valid(const BlockOnPlane& block) {
  require_positive(block.width, "width");
  require_positive(block.height, "height");
  require_positive(block.density, "density");
  require_positive(block.normal_stiffness, "normal stiffness");
  require_positive(block.shear_stiffness, "shear stiffness");
  require_positive(block.gravity, "gravity");
  require_acute(block.slope_angle, "slope angle");
  require_acute(block.friction_angle, "friction angle");
}

}  // namespace openclose::analytical
