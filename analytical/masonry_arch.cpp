#include "openclose/analytical/masonry_arch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace openclose::analytical {
namespace {

/// The part of the arch, R = 1 and unit weight per area, between crown and a joint.
struct Part {
  double angle;   // of the joint from the vertical [rad]
  double weight;  // w
  double moment;  // S
};

struct Ring {
  double inner, outer;
  double squares() const { return outer * outer - inner * inner; }
  double cubes() const { return std::pow(outer, 3) - std::pow(inner, 3); }
};

double voussoir_area(const Ring& ring, double angle, VoussoirShape shape) {
  return ring.squares() / 2 * (shape == VoussoirShape::straight ? std::sin(angle) : angle);
}

/// Distance of the centroid from the centre of the arch.
double centroid_radius(const Ring& ring, double angle, VoussoirShape shape) {
  const double half = angle / 2;
  return 2 * ring.cubes() / (3 * ring.squares()) * (shape == VoussoirShape::straight ? std::cos(half) : std::sin(half) / half);
}

/// Moment of the right half of a keystone about the axis of symmetry.
double half_keystone_moment(const Ring& ring, double angle, VoussoirShape shape) {
  const double s = std::sin(angle / 2), c = std::cos(angle / 2);
  return shape == VoussoirShape::straight ? s * s * c * ring.cubes() / 6 : (1 - c) * ring.cubes() / 3;
}

std::vector<Part> parts_of(const Ring& ring, int voussoirs, VoussoirShape shape) {
  const double angle = std::numbers::pi / voussoirs;
  const double area = voussoir_area(ring, angle, shape), radius = centroid_radius(ring, angle, shape);
  std::vector<Part> parts;
  if (voussoirs % 2 == 0) {
    parts.push_back({0, 0, 0});
  } else {
    parts.push_back({angle / 2, area / 2, half_keystone_moment(ring, angle, shape)});
  }
  for (int i = 0; i < voussoirs / 2; ++i) {
    const Part& above = parts.back();
    parts.push_back({above.angle + angle, above.weight + area, above.moment + area * radius * std::sin(above.angle + angle / 2)});
  }
  return parts;
}

/// By how much the thrust H leaves no room for K: convex in H.
double lack_of_room(const Ring& ring, const std::vector<Part>& parts, double thrust) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (const Part& p : parts) {
    const double along = p.weight * std::sin(p.angle) + thrust * std::cos(p.angle);
    low = std::max(low, ring.inner * along - p.moment);
    high = std::min(high, ring.outer * along - p.moment);
  }
  return low - high;
}

bool stands(double thickness, int voussoirs, VoussoirShape shape) {
  const Ring ring{1 - thickness / 2, 1 + thickness / 2};
  const auto parts = parts_of(ring, voussoirs, shape);
  double low = 0, high = parts.back().weight;
  constexpr int most_sections = 200;  // (2/3)^200: to rounding
  for (int i = 0; i < most_sections; ++i) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    const double at_left = lack_of_room(ring, parts, left), at_right = lack_of_room(ring, parts, right);
    if (std::min(at_left, at_right) <= 0) return true;
    (at_left < at_right ? high : low) = at_left < at_right ? right : left;
  }
  return false;
}

}  // namespace

double smallest_arch_thickness(int voussoirs, VoussoirShape shape) {
  if (voussoirs < 3) throw std::invalid_argument("an arch has at least three voussoirs");
  double falls = 0, holds = 1;
  while (holds - falls > 1e-12) {
    const double middle = (falls + holds) / 2;
    (stands(middle, voussoirs, shape) ? holds : falls) = middle;
  }
  return holds;
}

std::vector<std::array<std::array<double, 2>, 4>> straight_voussoirs(int voussoirs, double thickness_over_radius) {
  const double inner = 1 - thickness_over_radius / 2, outer = 1 + thickness_over_radius / 2;
  // From the left springer at 180 degrees; the ends exactly level.
  const auto place = [&](double radius, int joint) -> std::array<double, 2> {
    if (joint == 0) return {-radius, 0};
    if (joint == voussoirs) return {radius, 0};
    const double angle = std::numbers::pi * (1 - static_cast<double>(joint) / voussoirs);
    return {radius * std::cos(angle), radius * std::sin(angle)};
  };
  std::vector<std::array<std::array<double, 2>, 4>> list;
  for (int i = 0; i < voussoirs; ++i) list.push_back({place(inner, i), place(inner, i + 1), place(outer, i + 1), place(outer, i)});
  return list;
}

}  // namespace openclose::analytical
