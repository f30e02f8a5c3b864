// How the degrees of freedom of a rigid block move its points: (u, v, r), the translation of its centroid [m] and its rotation [rad],
// counter-clockwise.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "openclose/core/vector.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// Up to 0.02 rad, more than blocks turn in a step, by series: the first terms left out, x^9/9! and x^8/8!, are below rounding.
struct SineCosine {
  double sine, cosine;
  explicit SineCosine(double x) {
    constexpr double largest_by_series = 0.02;  // [rad]
    const double square = x * x;
    if (std::abs(x) > largest_by_series) {
      sine = std::sin(x), cosine = std::cos(x);
      return;
    }
    sine = x * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square * (1.0 / 5040.0))));
    cosine = 1.0 - square * (1.0 / 2.0 - square * (1.0 / 24.0 - square * (1.0 / 720.0)));
  }
};

struct Motion {
  using Unknowns = Eigen::Vector3d;
  using Matrix = Eigen::Matrix3d;

  static Vec2 translation(const Unknowns& d) { return d.head<2>(); }
  static double rotation(const Unknowns& d) { return d[2]; }

  /// R(angle) - I without cancellation for small angles; Shi's linear rotation keeps the first-order term only.
  struct Turn {
    double sine, versine;
    Turn(double angle, RotationKind kind) {
      if (kind == RotationKind::linear) {
        sine = angle, versine = 0.0;
        return;
      }
      const SineCosine half(0.5 * angle);
      sine = 2.0 * half.sine * half.cosine;
      versine = 2.0 * half.sine * half.sine;
    }
    Vec2 of(const Vec2& r) const { return sine * perpendicular(r) - versine * r; }
  };
  static Vec2 turned_by(double angle, const Vec2& r, RotationKind kind) { return Turn(angle, kind).of(r); }

  /// Displacement [m] of the point at r [m] from the centroid when the block moves by d.
  static Vec2 displacement(const Unknowns& d, const Vec2& r, RotationKind kind) { return translation(d) + turned_by(rotation(d), r, kind); }

  /// Derivative by the unknowns of m . (position of the point now at r): the generalised force of a force m at that point.
  static Unknowns gradient(const Vec2& r, const Vec2& m) { return {m.x(), m.y(), cross(r, m)}; }

  /// Second derivative of the same quantity for exact rotation.
  static Matrix hessian(const Vec2& r, const Vec2& m) {
    Matrix h = Matrix::Zero();
    h(2, 2) = -m.dot(r);
    return h;
  }

  /// Diagonal of the mass matrix [kg, kg, kg m2] per metre of thickness.
  static Unknowns mass(double density, double area, double polar_second_moment) { return density * Unknowns(area, area, polar_second_moment); }

  /// Each component as a force [N]: moments over the radius of the block [m].
  static double largest_force(const Unknowns& f, double radius) { return std::max(f.head<2>().norm(), std::abs(f[2]) / radius); }

  /// [m] no point of a block of this radius moves farther than this.
  static double displacement_bound(const Unknowns& d, double radius) { return translation(d).norm() + radius * std::abs(rotation(d)); }

  static constexpr int rotation_index = 2;
};

}  // namespace openclose
