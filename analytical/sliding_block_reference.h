// Reference solution of the block on two corner springs (cases B1 and B4): exact rotation, exact lever arms, every change of contact located.
//
// Frame and block: block_on_plane.h. A corner r = (+-b/2, -h/2) (lower, upper) of the block with centroid (x, h/2 + y) and rotation theta has
//   gap  g = y + [R(theta) r]_y + h/2,      position along the plane  s = x + [R(theta) r]_x - r_x,
//   normal force N = -kn g while closed (compression only), tangential force T = -ks u on the block, both acting at the corner itself.
// u is the elastic part of the slip:
//   open: u = 0, N = T = 0;  stick: u' = s', |ks u| <= mu N;  slip in direction d (+1 downhill, -1 uphill): T = -d mu N, u = d mu N/ks, and the
//   plastic slip rate d (s' - u') >= 0.
// Equations: m x'' = W sin alpha + sum T, m y'' = -W cos alpha + sum N, I theta'' = sum(arm x force).
//
// Integrated by SUNDIALS CVODE (variable-order Adams), which also finds the events: gap through zero, |ks u| = mu N from below, plastic slip rate
// through zero from above. Forces are continuous at every event; the integrator is restarted there. A corner that closes sticks if ks |s'| < mu kn
// |g'| (both grow from zero), else slips; a corner at its bound with zero rates is decided by the next derivatives. Range: any friction angle below
// 90 degrees and any motion in which only the two lower corners can touch the plane. On a plane that is shaken (follow()) coordinates move with it
// and the block feels minus its mass times the acceleration of the ground.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "openclose/analytical/block_on_plane.h"
#include "openclose/analytical/ground_motion.h"

namespace openclose::analytical {

enum class ContactMode { open, stick, slip_downhill, slip_uphill };

/// Corners in the order lower (downhill), upper.
struct SlidingBlockState {
  double time = 0;                   // [s]
  double x = 0;                      // centroid along the plane, downhill positive, from where it is at t = 0 [m]
  double y = 0;                      // centroid normal to the plane, 0 where the untilted block just touches [m]
  double rotation = 0;               // [rad]
  double velocity_x = 0;             // [m/s]
  double velocity_y = 0;             // [m/s]
  double angular_velocity = 0;       // [rad/s]
  std::array<double, 2> shear = {};  // elastic slip u [m]
  double dissipated = 0;             // work of friction since t = 0, >= 0 [J/m]
  std::array<ContactMode, 2> modes = {};
};

/// Corners just touching, springs unstressed, at rest.
SlidingBlockState unloaded_start();
/// Normal springs carry the normal component of the weight, shear springs relaxed, at rest (the moment balances without tilt).
SlidingBlockState normal_balanced_start(const BlockOnPlane& block);
/// Steady sliding pose (steady_pose in incline.h; untilted if rotation is locked) with T = -direction mu N at both corners, and the given velocity
/// [m/s] along the plane. The direction is that of the velocity; downhill if that is zero.
SlidingBlockState steady_sliding_start(const BlockOnPlane& block, double velocity = 0, bool rotation_locked = false);

struct ReferenceOptions {
  bool rotation_locked = false;
  double relative_tolerance = 3e-15;  // of CVODE, per step and unknown; ten times its limit in double precision
  double steps_per_period = 100;      // at least, of the highest vibration; keeps two events of one corner out of one step
};

struct ContactEvent {
  double time;  // [s]
  int corner;   // 0 lower, 1 upper
  ContactMode before;
  ContactMode after;
};

class SlidingBlockReference {
 public:
  /// \param start  the modes in it are not read: they follow from positions and velocities
  /// \throws std::invalid_argument for data out of range or for a start with a tangential force beyond friction
  SlidingBlockReference(const BlockOnPlane& block, const SlidingBlockState& start, const ReferenceOptions& options = {});
  ~SlidingBlockReference();
  SlidingBlockReference(SlidingBlockReference&&) noexcept;
  SlidingBlockReference& operator=(SlidingBlockReference&&) noexcept;

  /// Moves on to the given time [s], not before the present one. \throws std::runtime_error if CVODE gives up
  const SlidingBlockState& advance(double time);
  /// The states at the given times [s], ascending, none before the present one.
  std::vector<SlidingBlockState> states_at(const std::vector<double>& times);
  /// The same on a plane that is shaken: at rest before the motion, between its pieces and after it. For a reference that starts at time 0.
  std::vector<SlidingBlockState> follow(const GroundMotion& ground, const std::vector<double>& times);

  const SlidingBlockState& state() const;
  const std::vector<ContactEvent>& events() const;

  /// Kinetic energy + springs + potential of the weight + work of friction [J/m]: constant while the ground is at rest.
  double energy() const;
  /// Normal and tangential force on the block at a corner [N]; the tangential one positive downhill.
  double normal_force(int corner) const;
  double tangential_force(int corner) const;

 private:
  class Integration;
  std::unique_ptr<Integration> integration_;
};

}  // namespace openclose::analytical
