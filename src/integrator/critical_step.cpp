#include "openclose/integrator/critical_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace openclose {

void CriticalStepBound::begin(const StepProblem& problem) {
  const BlockSystem& system = problem.system;
  scales_.clear();
  stiffness_.assign(system.free_count(), Matrix());
  damping_.assign(system.free_count(), Matrix());
  damped_ = false;
  changed_ = true;
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    const double turns = block.rotation_locked ? 0.0 : 1.0;
    const Scale scale{1.0 / block.mass[0], turns / block.mass[2], turns / std::sqrt(block.mass[0] * block.mass[2])};
    const Motion::Matrix k = problem.external.symmetric_stiffness(system, b);
    stiffness_[block.equation] = {scale.mass * k(0, 0),  scale.mass * k(0, 1),  scale.mass * k(1, 1),
                                  scale.lever * k(0, 2), scale.lever * k(1, 2), scale.moment * k(2, 2)};
    scales_.push_back(scale);
  }
}

void CriticalStepBound::add(const StiffnessPart& part, double sign) {
  add(stiffness_[part.equation], scales_[part.equation], part, sign * part.normal_stiffness, sign * part.shear_stiffness);
  if (part.normal_dashpot == 0.0) return;
  damped_ = true;
  add(damping_[part.equation], scales_[part.equation], part, sign * part.normal_dashpot, sign * part.shear_dashpot);
}

void CriticalStepBound::add(Matrix& m, const Scale& scale, const StiffnessPart& part, double normal, double shear) {
  const Vec2& n = part.normal;
  const double lever_n = cross(part.arm, n), lever_t = part.arm.dot(n);  // of the normal and of the tangent, the normal turned by +90 degrees
  const double k = part.share * normal, s = part.share * shear;
  m.xx += scale.mass * (k * n.x() * n.x() + s * n.y() * n.y());
  m.xy += scale.mass * ((k - s) * n.x() * n.y());
  m.yy += scale.mass * (k * n.y() * n.y() + s * n.x() * n.x());
  m.xr += scale.lever * (k * n.x() * lever_n - s * n.y() * lever_t);
  m.yr += scale.lever * (k * n.y() * lever_n + s * n.x() * lever_t);
  m.rr += scale.moment * (k * lever_n * lever_n + s * lever_t * lever_t);
  m.largest = -1.0;
  changed_ = true;
}

double CriticalStepBound::Matrix::bound() const {
  return std::max({xx + std::abs(xy) + std::abs(xr), yy + std::abs(xy) + std::abs(yr), rr + std::abs(xr) + std::abs(yr)});
}

/// Newton's method on the characteristic polynomial, from a bound: above its largest root the polynomial of a symmetric matrix is convex and rises,
/// so that every iterate is a bound from above.
double CriticalStepBound::Matrix::largest_eigenvalue() const {
  constexpr double close = 1e-10;  // [-] of the eigenvalue, far below the room that step_fraction leaves
  const double c_2 = xx + yy + rr;
  const double c_1 = (xx * yy - xy * xy) + (xx * rr - xr * xr) + (yy * rr - yr * yr);
  const double c_0 = xx * (yy * rr - yr * yr) - xy * (xy * rr - yr * xr) + xr * (xy * yr - yy * xr);
  double x = bound();
  while (true) {  // even at a double root the distance is halved every time
    const double value = ((x - c_2) * x + c_1) * x - c_0, slope = (3.0 * x - 2.0 * c_2) * x + c_1;
    if (!(value > 0.0) || !(slope > 0.0)) return x;
    const double change = value / slope;
    x -= change;
    if (change <= close * std::abs(x)) return x;
  }
}

double CriticalStepBound::largest(std::vector<Matrix>& matrices) {
  double largest = 0.0;
  for (const Matrix& m : matrices) largest = std::max(largest, m.largest);
  for (Matrix& m : matrices) {
    if (m.largest >= 0.0 || m.bound() <= largest) continue;
    m.largest = m.largest_eigenvalue();
    largest = std::max(largest, m.largest);
  }
  return largest;
}

double CriticalStepBound::step(double local_damping) {
  if (changed_) {
    stiffest_ = largest(stiffness_);
    most_damped_ = damped_ ? largest(damping_) : 0.0;
    changed_ = false;
  }
  const double a = (1.0 + local_damping) * stiffest_, b = (1.0 + local_damping) * most_damped_;
  return a > 0.0 ? 4.0 / (b + std::sqrt(b * b + 4.0 * a)) : std::numeric_limits<double>::infinity();
}

}  // namespace openclose
