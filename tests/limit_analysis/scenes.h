// Small systems of rigid blocks of which the factor is known.
#pragma once

#include <cmath>

#include "openclose/limit_analysis/limit_analysis.h"

namespace openclose::limit_analysis {

inline double cross(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// A block b wide and h high on a plane that falls to the right, in the frame of the plane; both ends of its base touch.
inline Problem block_on_plane(double b, double h, double slope, double weight, double cohesion, double friction, double tension = 0) {
  Problem problem;
  Block block;
  block.centroid = {b / 2, h / 2};
  block.load = weight * Eigen::Vector3d(std::sin(slope), -std::cos(slope), 0);
  block.radius = std::hypot(b, h) / 2;
  problem.blocks = {block};
  for (const double x : {0.0, b}) problem.contacts.push_back({0, -1, {x, 0}, {0, 1}, cohesion / 2, friction, tension / 2});
  return problem;
}

/// Rows of stones in running bond on a table that is tilted: what it stands depends on toppling and sliding of many blocks at once.
inline Problem tilted_wall(int rows, int stones, double width, double height, double tilt, double cohesion, double friction, double size = 1.0,
                           const Point& origin = Point::Zero()) {
  Problem problem;
  const auto number = [&](int row, int k) { return row * stones + k; };
  const double weight = width * height * size * size;
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < stones; ++k) {
      Block block;
      block.centroid = origin + size * Point((k + 0.5 * (row % 2)) * width + width / 2, (row + 0.5) * height);
      block.load = weight * Eigen::Vector3d(std::sin(tilt), -std::cos(tilt), 0);
      block.radius = size * std::hypot(width, height) / 2;
      problem.blocks.push_back(block);
    }
  }
  const auto add = [&](int a, int b, const Point& from, const Point& to, const Point& normal) {
    const double half = cohesion * size * (to - from).norm() / 2;
    for (const Point& p : {from, to}) problem.contacts.push_back({a, b, origin + size * p, normal, half, friction, 0});
  };
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < stones; ++k) {
      const double left = (k + 0.5 * (row % 2)) * width, bottom = row * height;
      if (row == 0) add(number(row, k), -1, {left, 0}, {left + width, 0}, {0, 1});
      if (k > 0) add(number(row, k), number(row, k - 1), {left, bottom}, {left, bottom + height}, {1, 0});
      if (row == 0) continue;
      for (int below = 0; below < stones; ++below) {
        const double other = (below + 0.5 * ((row - 1) % 2)) * width;
        const double from = std::max(left, other), to = std::min(left, other) + width;
        if (to - from > width / 4) add(number(row, k), number(row - 1, below), {from, bottom}, {to, bottom}, {0, 1});
      }
    }
  }
  return problem;
}

}  // namespace openclose::limit_analysis
