// Housner's rocking block (case D5): a rigid rectangle of width b and height h on a rigid level base that turns about one of its lower corners
// without slipping. theta [rad] from upright, alpha_b = atan(b/h), R half the diagonal, p^2 = 3 g/(4 R):
//   theta'' = -p^2 [sin(alpha_b - theta) - (a/g) cos(alpha_b - theta)],  0 < theta,
// a the acceleration of the base away from the side to which the block leans (its inertia pushes it over). The impact on the other corner is plastic:
// the angular momentum about it is kept, and the angular velocity after it is r = 1 - (3/2) sin^2 alpha_b times the one before.
#pragma once

namespace openclose::analytical {

struct RockingBlock {
  double width = 0.5;     // b [m]
  double height = 2;      // h [m]
  double gravity = 9.81;  // [m/s2]

  double critical_angle() const;     // alpha_b [rad]
  double frequency() const;          // p [rad/s]
  double restitution() const;        // r [-]
  double moment_of_inertia() const;  // about the corner, over the mass: 4 R^2/3 [m2]
};

struct RockingState {
  double angle;     // [rad]
  double velocity;  // [rad/s]
};

/// Free motion about one corner from rest at the given angle, 0 < angle < alpha_b, before it is upright again. \param time [s]
RockingState rocking_fall(const RockingBlock& block, double angle, double time, double relative_tolerance = 1e-13);
/// [s] Time of that fall, by CVODE; a quarter of the period of rocking without loss.
double rocking_quarter_period(const RockingBlock& block, double angle, double relative_tolerance = 1e-13);
/// [s] The same for small alpha_b: acosh(1/(1 - angle/alpha_b))/p.
double small_angle_quarter_period(const RockingBlock& block, double angle);
/// [rad/s] By energy: the speed with which it gets upright from rest at the angle.
double rocking_impact_speed(const RockingBlock& block, double angle);
/// [rad] By energy: how far it goes on the other side after that impact.
double angle_after_impact(const RockingBlock& block, double angle);
/// [rad] The angle at a time [s] after the release from rest at `angle`, impacts included; negative: leaning to the other side.
double rocking_angle(const RockingBlock& block, double angle, double time);

/// Whether a rectangular pulse of the base, a > g tan(alpha_b) for a duration, turns the block over: CVODE for the time of the pulse; after it the
/// block falls if it moves on beyond alpha_b, that is if its kinetic energy reaches the barrier. An impact comes too late to matter: it takes energy.
bool overturns(const RockingBlock& block, double acceleration, double duration);
/// [m/s2] The smallest acceleration of that duration that does, by bisection to rounding.
double overturning_acceleration(const RockingBlock& block, double duration);

/// The same for half a sine, peak sin(pi t/duration) (Zhang and Makris, J. Engng Mech. 127, 2001): the block rises when the base reaches g
/// tan(alpha_b). The pulse pushes to one side only: on the way back it takes energy, and so does the impact, so that the first rise decides.
bool overturned_by_half_sine(const RockingBlock& block, double peak, double duration);
/// [m/s2] The smallest peak of that duration that does.
double overturning_half_sine(const RockingBlock& block, double duration);

}  // namespace openclose::analytical
