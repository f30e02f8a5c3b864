#include <Eigen/Eigenvalues>
#include <cmath>
#include <ranges>

#include "openclose/integrator/two_level.h"
#include "openclose/model/motion.h"
#include "support/catch.h"

using namespace openclose;

namespace {

/// [-] What the factor of a group leaves, whole numbers of 16 bits: of the largest entry of a row, each of nine may lack one of 32,767 parts. The
/// condition of the groups here, of which the estimate may lose so many times as much, is some tens.
constexpr double sixteen_bits = 9.0 / 32767.0;
constexpr double condition = 30.0;

/// Bricks of 2 m x 1 m, `width` of them in each of `height` courses on a fixed base, joined by springs of 1 N/m along and across two points of every
/// joint. Every third brick may be locked against turning.
struct Wall {
  Wall(int width, int height, int largest_group, bool some_locked = false)
      : are_some_locked(some_locked), rows(width * height), stiffness(Eigen::MatrixXd::Zero(3 * rows, 3 * rows)) {
    std::vector<Vec2> centroids;
    std::vector<std::pair<int, int>> couplings;
    const auto row = [&](int x, int y) { return y * width + x; };
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        centroids.emplace_back(2.0 * x, y);
        if (x > 0) couplings.emplace_back(row(x - 1, y), row(x, y));
        if (y > 0) couplings.emplace_back(row(x, y - 1), row(x, y));
      }
    }
    flexibility = std::make_unique<TwoLevelFlexibility>(centroids, couplings, largest_group);
    for (int i = 0; i < rows; ++i) {
      if (turns(i)) continue;
      flexibility->lock_rotation(i);
      flexibility->add_own(i, Eigen::Vector3d(0.0, 0.0, 1.0).asDiagonal());
      stiffness(3 * i + 2, 3 * i + 2) = 1.0;
    }
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (x > 0) join(row(x - 1, y), {1.0, 0.0}, row(x, y), {-1.0, 0.0}, {0.0, 0.5});
        join(y > 0 ? row(x, y - 1) : -1, {0.0, 0.5}, row(x, y), {0.0, -0.5}, {1.0, 0.0});
      }
    }
    REQUIRE(flexibility->factor());
  }

  bool turns(int row) const { return row < 0 || !are_some_locked || row % 3 != 0; }

  /// Springs at both ends of a joint, given by its middle seen from either block and half its length.
  void join(int i, const Vec2& from_i, int j, const Vec2& from_j, const Vec2& half) {
    for (const double end : {-1.0, 1.0}) {
      for (const Vec2& way : {Vec2(1.0, 0.0), Vec2(0.0, 1.0)}) {
        const Eigen::Vector3d first = Motion::gradient(from_i + end * half, way), second = -Motion::gradient(from_j + end * half, way);
        flexibility->add_spring(1.0, i, first, j, second);
        Eigen::VectorXd whole = Eigen::VectorXd::Zero(3 * rows);
        if (i >= 0) whole.segment<3>(3 * i) = first;
        whole.segment<3>(3 * j) = second;
        for (const int row : {i, j}) {
          if (!turns(row)) whole[3 * row + 2] = 0.0;
        }
        stiffness += whole * whole.transpose();
      }
    }
  }

  /// Of the estimate times the stiffness, in rising order.
  Eigen::VectorXd eigenvalues() {
    Eigen::MatrixXd estimate(3 * rows, 3 * rows);
    for (int k = 0; k < 3 * rows; ++k) estimate.col(k) = flexibility->displacement(Eigen::VectorXd::Unit(3 * rows, k));
    CHECK((estimate - estimate.transpose()).norm() < sixteen_bits * condition * estimate.norm());
    const Eigen::MatrixXd root = stiffness.llt().matrixL();
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(root.transpose() * estimate * root).eigenvalues();
  }

  bool are_some_locked;
  int rows;
  Eigen::MatrixXd stiffness;
  std::unique_ptr<TwoLevelFlexibility> flexibility;
};

}  // namespace

TEST_CASE("one group is solved as it is, and once more as a rigid body", "[integrator][two_level]") {
  Wall wall(1, 1, 4);
  const Eigen::Vector3d force(1.0, -2.0, 0.5);
  const Eigen::Vector3d expected = 2.0 * wall.stiffness.inverse() * force;
  CHECK((wall.flexibility->displacement(force) - expected).norm() < sixteen_bits * expected.norm());
}

TEST_CASE("no eigenvalue of the estimate times the stiffness is above 3", "[integrator][two_level]") {
  for (const int group : {1, 4, 16, 1000}) {
    INFO(group);
    const Eigen::VectorXd found = Wall(8, 8, group).eigenvalues();
    CHECK(found.maxCoeff() <= TwoLevelFlexibility::largest_eigenvalue);
    CHECK(found.minCoeff() > 0.0);
  }
}

TEST_CASE("bricks that are locked do not turn with their group", "[integrator][two_level]") {
  const auto [width, height] = GENERATE(std::pair(8, 8), std::pair(1, 16));
  for (const int group : {1, 4, 1000}) {
    INFO(width << " x " << height << ", groups of " << group);
    Wall wall(width, height, group, true);
    Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(3 * wall.rows, -1.0, 2.0);
    for (int row = 0; row < wall.rows; ++row) {
      if (!wall.turns(row)) force[3 * row + 2] = 0.0;
    }
    const Eigen::VectorXd found = wall.flexibility->displacement(force);
    for (int row = 0; row < wall.rows; ++row) {
      if (!wall.turns(row)) CHECK(found[3 * row + 2] == 0.0);
    }
    const Eigen::VectorXd eigenvalues = wall.eigenvalues();
    CHECK(eigenvalues.maxCoeff() <= TwoLevelFlexibility::largest_eigenvalue);
    CHECK(eigenvalues.minCoeff() > 0.0);
  }
}

TEST_CASE("rigid groups carry loads through systems of any size", "[integrator][two_level]") {
  // A tower of n bricks: without them the smallest eigenvalue falls with 1/n^2.
  const double small = Wall(1, 32, 4).eigenvalues().minCoeff(), large = Wall(1, 64, 4).eigenvalues().minCoeff();
  CHECK(large > 0.9 * small);
  // The motions that rigid groups can make are found by them alone: nothing is below what remains of those in between, (1/group)^2 of them.
  CHECK(large > 1.0 / 16.0 / 4.0);
}

TEST_CASE("what is held by inertia alone follows it", "[integrator][two_level]") {
  TwoLevelFlexibility flexibility({{0.0, 0.0}, {5.0, 0.0}, {9.0, 3.0}}, {}, 1);
  for (int i = 0; i < 3; ++i) flexibility.add_own(i, Eigen::Vector3d(2.0, 2.0, 4.0).asDiagonal());
  REQUIRE(flexibility.factor());
  Eigen::VectorXd force(9);
  force << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  for (int k = 0; k < 9; ++k) CHECK(flexibility.displacement(force)[k] == Approx(2.0 * force[k] / (k % 3 == 2 ? 4.0 : 2.0)).epsilon(sixteen_bits));
}

TEST_CASE("a block that nothing holds is found out", "[integrator][two_level]") {
  TwoLevelFlexibility flexibility({{0.0, 0.0}, {5.0, 0.0}}, {});
  flexibility.add_own(0, Eigen::Matrix3d::Identity());
  CHECK_FALSE(flexibility.factor());
}
