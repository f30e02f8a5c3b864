// Rigid-block limit analysis: the problem as plain data, and the checks of its answers that need no linear program. SI units, unit thickness,
// rotation counter-clockwise.
//
// Each contact point carries a normal force n (compression positive) and a shear force t. At the factor F the strength is
//   n >= -tension/F,   |t| <= (cohesion + friction n)/F.
// F is feasible if forces within this strength keep every free block in equilibrium. Where tension reaches beyond the tip of the cone, at
// cohesion/friction, forces mixed of a pull there and of others need not be within the strength; what counts then is the smallest cone around it,
// with its tip at n = -tension/F (Cone). An infeasible factor is one of the strength, too; a feasible one need not be.
//
// Instead of the strength, a factor can vary the loads: with Varied::live_loads the strength is that of F = 1, and the load of a block is its dead
// load plus the factor times its live load. Where 0 is feasible, everything below holds for this factor, too: forces in equilibrium at two factors,
// mixed, are forces in equilibrium in between, so that what is beyond an infeasible factor is infeasible.
//
// Two certificates say which, and each can be checked by adding up:
//   forces     equilibrium of every block and strength at every contact: F, and every smaller factor, is feasible.
//   mechanism  velocities v of the blocks with relative velocities (g opening, h sliding) at the contacts. Forces in equilibrium do no work on v:
//                0 = loads.v + sum (n g + t h) >= loads.v - resistance - sum n d,   d = max(0, friction |h|/F - g),
//              where resistance is the most that cohesion and tension can take up. If no d is positive and the loads do more work than the
//              resistance, then F, and every larger factor, is infeasible (Farkas). Rounding leaves small d; then the inequality says that forces in
//              equilibrium would need a normal force of at least (loads.v - resistance)/sum d somewhere, which is compared with all loads together.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace openclose::limit_analysis {

using Point = Eigen::Vector2d;  // [m]

struct Block {
  Point centroid = Point::Zero();
  Eigen::Vector3d load = Eigen::Vector3d::Zero();  // force x, y [N], moment about the centroid [N m]; a free block has a force
  double radius = 0;                               // [m] of the vertex farthest from the centroid
  std::array<bool, 3> free = {true, true, true};   // x, y, rotation
  Eigen::Vector3d live = Eigen::Vector3d::Zero();  // as the load; for Varied::live_loads

  bool fixed() const { return !free[0] && !free[1] && !free[2]; }
};

/// A point at which two blocks, or a block and the outside world, push and rub.
struct Contact {
  int a = 0;                      // block
  int b = -1;                     // block; -1: the outside world, which does not move
  Point point = Point::Zero();    // [m]
  Point normal = Point::UnitX();  // unit vector from b into a: compression pushes a along it
  double cohesion = 0;            // [N]
  double friction = 0;            // tan(phi) [-]
  double tension = 0;             // [N]

  Point tangent() const { return {normal.y(), -normal.x()}; }  // the normal turned clockwise; shear on a is positive along it
};

/// The strength of a contact at a factor, without holes: n >= -tension, |t| <= friction (n + tension) + half_width.
struct Cone {
  double tension;     // [N]
  double friction;    // [-]
  double half_width;  // [N] at the tip; 0 where the tension of the contact reaches beyond the tip of its cone

  Cone(const Contact& c, double factor);
  double largest_shear(double normal) const { return friction * (normal + tension) + half_width; }
};

/// A force or couple of unlimited size and either sign on a block: a support.
struct FreeForce {
  int block = 0;
  Eigen::Vector3d unit = Eigen::Vector3d::Zero();  // force x, y [-], moment about the centroid [m] of one newton; a couple: {0, 0, 1}
};
FreeForce support(const Block& block, int number, const Point& point, const Point& direction);

/// What a factor changes.
enum class Varied {
  strength,    // divided by the factor
  live_loads,  // multiplied by the factor
};

struct Problem {
  std::vector<Block> blocks;
  std::vector<Contact> contacts;
  std::vector<FreeForce> free_forces;
  Varied varied = Varied::strength;

  double strength_factor(double factor) const { return varied == Varied::strength ? factor : 1.0; }
  /// Force x, y [N], moment [N m].
  Eigen::Vector3d load(int block, double factor) const {
    return varied == Varied::strength ? blocks[block].load : Eigen::Vector3d(blocks[block].load + factor * blocks[block].live);
  }
};

/// \throws std::invalid_argument if no block is free, a free one has no load or radius, or a number is out of its range
void check(const Problem& problem);

struct ContactForce {
  double normal = 0;  // [N]
  double shear = 0;   // [N]
};

struct Forces {
  std::vector<ContactForce> contacts;
  std::vector<double> free_forces;  // [N] (couples: [N m])
};

struct BlockVelocity {
  Point velocity = Point::Zero();  // of the centroid [m/s]
  double rotation = 0;             // [rad/s]
};
using Mechanism = std::vector<BlockVelocity>;

/// Velocity of a point that moves with a block.
Point velocity_at(const Block& block, const BlockVelocity& motion, const Point& point);

/// Speed of the fastest point of a block, at most: of the centroid plus of the rim.
double speed(const Block& block, const BlockVelocity& motion);

struct ForceCheck {
  /// [-] Largest force, or moment over the radius, that a free block is short of, over its own load and 1e-8 of the forces that press on it,
  /// which no sum in double precision knows better.
  double unbalanced = 0;
  double excess = 0;   // [-] largest force beyond the strength, over the load of the lighter free block of the contact
  bool holds() const;  // both at most force_tolerance
};
ForceCheck check_forces(const Problem& problem, double factor, const Forces& forces);

struct MechanismCheck {
  double work = 0;         // [W] of the loads
  double resistance = 0;   // [W] what cohesion and tension can take up
  double penetration = 0;  // [m/s] sum of d over the contacts
  double support = 0;      // [m/s] sum of the velocities that free forces, which resist without limit, should have kept at zero
  double least_force = 0;  // [-] force that equilibrium would need, over the sum of all loads; infinite if penetration and support are zero
  bool holds() const;      // work above resistance, least_force at least least_force_of_a_proof
};
MechanismCheck check_mechanism(const Problem& problem, double factor, const Mechanism& mechanism);

/// [-] Errors of equilibrium and strength in loads of the block concerned. A load that differs by a ten-millionth is no other load.
inline constexpr double force_tolerance = 1e-7;
/// [-] No joint carries a force of so many times all loads together.
inline constexpr double least_force_of_a_proof = 1e4;

}  // namespace openclose::limit_analysis
