// Forces on a block that depend on where points of it are: loads, supports and whatever else the scene's ForceInputs have. An element acts on one
// block; all forces per metre of thickness, as (force x, force y, moment about the centroid) [N, N, N m].
//
// A new kind of force is an input in scene/force_inputs.* and a class in force_elements.cpp. Solvers ask for forces and derivatives, the ledger for
// energy, statics for the force and the springs at small displacements; only drawings, check.cpp of scene/ and the words on loose blocks know what
// holds and what loads.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "openclose/model/block_system.h"

namespace openclose {

/// The way of a material point while its block moves.
struct PointPath {
  Vec2 position = Vec2::Zero();  ///< [m] before, relative to the system's origin
  Vec2 arm = Vec2::Zero();       ///< [m] from the centroid, before
  Vec2 moved = Vec2::Zero();     ///< [m]
  Vec2 end_arm = Vec2::Zero();   ///< [m] from the centroid, after
};

inline constexpr int most_element_points = 2;

/// The way of a block with the points of an element on it.
struct ElementPath {
  Motion::Unknowns d = Motion::Unknowns::Zero();  ///< [m, m, rad]
  std::array<PointPath, most_element_points> points{};
};

/// The account of the energy ledger to which an element's energy belongs.
enum class ForceAccount : unsigned char {
  loads,            ///< minus the work
  support_springs,  ///< stored
};

class ForceElement {
 public:
  using Unknowns = Motion::Unknowns;
  using Matrix = Motion::Matrix;
  /// [N/m] Along a direction of the block's unknowns.
  struct Spring {
    Unknowns direction;
    double stiffness;
  };

  /// \param points  followed points of the system, all of this block, at most most_element_points
  ForceElement(int block, std::vector<int> points, ForceAccount account) : block_(block), points_(std::move(points)), account_(account) {}
  virtual ~ForceElement() = default;
  ForceElement(const ForceElement&) = delete;
  ForceElement& operator=(const ForceElement&) = delete;

  int block() const { return block_; }
  const std::vector<int>& points() const { return points_; }
  ForceAccount account() const { return account_; }
  /// The block's way by d from the system's present state.
  ElementPath path(const BlockSystem& system, const Unknowns& d) const;

  virtual Unknowns force(const ElementPath& path) const = 0;    ///< at its end
  virtual Matrix stiffness(const ElementPath& path) const = 0;  ///< minus the derivative of force() by d
  /// The mean force over a straight way, of which the product with d is the work: exactly for translations, to the third order in the rotation.
  virtual Unknowns mean_force(const ElementPath& path) const = 0;
  virtual Matrix mean_stiffness(const ElementPath& path) const = 0;  ///< minus the derivative of mean_force() by d
  /// [N] at the end of the way, the scale of what rounding leaves of the force.
  virtual double magnitude(const ElementPath& path) const = 0;
  /// [N] what the force changes by when coordinates change by their own size.
  virtual double spring_scale(const ElementPath&) const { return 0.0; }
  /// [J] of the account, over the way: what is stored, or minus the work.
  virtual double energy_change(const ElementPath& path) const = 0;
  virtual double stored_energy(const ElementPath&) const { return 0.0; }  ///< [J] at its start
  /// At its start: what resists small displacements, to which the rest of the force is constant.
  virtual std::vector<Spring> springs(const ElementPath&) const { return {}; }

 private:
  int block_;
  std::vector<int> points_;
  ForceAccount account_;
};

/// The elements of all forces, in the order of ForceInputs. Makes `system` follow their points.
std::vector<std::unique_ptr<const ForceElement>> force_elements(const ForceInputs& inputs, BlockSystem& system);

}  // namespace openclose
