// Systems of the kind that blocks in contact make, as large as a test likes.
#pragma once

#include "openclose/linear/block_matrix.h"

namespace openclose::test {

inline std::vector<std::pair<int, int>> grid_pairs(int columns, int rows) {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < columns * rows; ++i) {
    if (i % columns + 1 < columns) pairs.emplace_back(i, i + 1);
    if (i + columns < columns * rows) pairs.emplace_back(i, i + columns);
  }
  return pairs;
}

/// Unit springs in both directions between neighbours of a grid whose lowest row is held. Every `sliding_every`-th one slides: its shear force is 0.8
/// times the normal one instead of that of a spring, so that the matrix is not symmetric.
inline BlockMatrix grid(int columns, int rows, int sliding_every = 0) {
  BlockMatrix matrix;
  const auto pairs = grid_pairs(columns, rows);
  matrix.set_pattern(columns * rows, pairs);
  int count = 0;
  for (const auto& [i, j] : pairs) {
    const bool beside = j == i + 1;
    const Eigen::Vector3d normal = beside ? Eigen::Vector3d(1.0, 0.0, 0.0) : Eigen::Vector3d(0.0, 1.0, 0.0);
    const Eigen::Vector3d shear_i = beside ? Eigen::Vector3d(0.0, 1.0, 0.5) : Eigen::Vector3d(1.0, 0.0, -0.5);
    const Eigen::Vector3d shear_j = beside ? Eigen::Vector3d(0.0, 1.0, -0.5) : Eigen::Vector3d(1.0, 0.0, 0.5);
    const bool slides = sliding_every > 0 && ++count % sliding_every == 0;
    const Eigen::Vector3d by_i = slides ? (0.8 * normal).eval() : shear_i, by_j = slides ? (0.8 * normal).eval() : shear_j;
    // Two contacts, half the joint apart from its middle, hold the rotation.
    const Eigen::Matrix3d turn = Eigen::Vector3d(0.0, 0.0, 0.25).asDiagonal();
    matrix.add(i, i, normal * normal.transpose() + shear_i * by_i.transpose() + turn);
    matrix.add(j, j, normal * normal.transpose() + shear_j * by_j.transpose() + turn);
    matrix.add(i, j, -normal * normal.transpose() - shear_i * by_j.transpose() - turn);
    matrix.add(j, i, -normal * normal.transpose() - shear_j * by_i.transpose() - turn);
  }
  for (int i = 0; i < columns; ++i) matrix.add(i, i, Eigen::Matrix3d::Identity());
  return matrix;
}

}  // namespace openclose::test
