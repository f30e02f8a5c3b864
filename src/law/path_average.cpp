#include "openclose/law/path_average.h"

#include <array>

namespace openclose {
namespace {

/// A number with its derivatives by the gap and the slip at the end of the path.
struct Dual {
  double value = 0.0, by_gap = 0.0, by_slip = 0.0;
};
Dual operator+(const Dual& a, const Dual& b) {
  return {a.value + b.value, a.by_gap + b.by_gap, a.by_slip + b.by_slip};
}
Dual operator-(const Dual& a, const Dual& b) {
  return {a.value - b.value, a.by_gap - b.by_gap, a.by_slip - b.by_slip};
}
Dual operator-(const Dual& a) {
  return {-a.value, -a.by_gap, -a.by_slip};
}
Dual operator*(double k, const Dual& a) {
  return {k * a.value, k * a.by_gap, k * a.by_slip};
}
Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.by_gap * b.value + a.value * b.by_gap, a.by_slip * b.value + a.value * b.by_slip};
}
Dual operator/(const Dual& a, const Dual& b) {
  const double q = a.value / b.value;
  return {q, (a.by_gap - q * b.by_gap) / b.value, (a.by_slip - q * b.by_slip) / b.value};
}
Dual constant(double value) {
  return {value, 0.0, 0.0};
}
const Dual& larger(const Dual& a, const Dual& b) {
  return a.value < b.value ? b : a;
}
const Dual& smaller(const Dual& a, const Dual& b) {
  return b.value < a.value ? b : a;
}
Dual clamp(const Dual& x, const Dual& bound) {
  return larger(-bound, smaller(x, bound));
}

/// Mean of the positive part of a line from a to b.
Dual mean_positive_part(const Dual& a, const Dual& b) {
  if (a.value <= 0.0 && b.value <= 0.0) return {};
  if (a.value >= 0.0 && b.value >= 0.0) return 0.5 * (a + b);
  const Dual& above = a.value > 0.0 ? a : b;
  const Dual& below = a.value > 0.0 ? b : a;
  return 0.5 * (above * above / (above - below));
}

struct Line {
  Dual start, end;
  Dual mean() const { return 0.5 * (start + end); }
  Dual at(const Dual& share) const { return (constant(1.0) - share) * start + share * end; }
};
Line operator*(double k, const Line& a) {
  return {k * a.start, k * a.end};
}

/// Mean of a line that is cut off at a bound which is a line too.
Dual mean_within(const Line& x, const Line& bound) {
  return x.mean() - mean_positive_part(x.start - bound.start, x.end - bound.end) + mean_positive_part(-x.start - bound.start, -x.end - bound.end);
}

Dual shear_bound(const ContactStrength& strength, const Dual& normal) {
  const ShearLimit<double> bound = strength.shear_bound(normal.value);
  return {bound.value, bound.slope * normal.by_gap, bound.slope * normal.by_slip};
}

double kink_of_bound(const ContactStrength& strength) {
  return openclose::kink_of_bound(strength.friction, strength.cohesion, strength.tension, tolerance::cohesion_ramp);
}

double stored(double force, double stiffness) {
  return 0.5 * force * force / stiffness;
}

/// The part of the path on which the spring is closed.
class ClosedPart {
 public:
  ClosedPart(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change)
      : springs_(springs), strength_(strength), slip_change_{slip_change, 0.0, 1.0}, gap_change_{gap_change, 1.0, 0.0} {
    const double start = springs.shift - springs.normal * (springs.gap - springs.target);
    const Dual end = constant(start) - springs.normal * gap_change_;
    // Compression beyond the opening.
    const Dual beyond_0 = constant(start + strength.tension), beyond_1 = end + constant(strength.tension);
    starts_closed = beyond_0.value > 0.0;
    ends_closed = beyond_1.value > 0.0;
    if (!starts_closed && !ends_closed) return;
    const Dual opening = constant(-strength.tension);
    elastic_ = {starts_closed ? constant(start) : opening, ends_closed ? end : opening};
    length_ = constant(1.0);
    if (starts_closed != ends_closed) {
      const Dual crossing = beyond_0 / (beyond_0 - beyond_1);
      length_ = starts_closed ? crossing : constant(1.0) - crossing;
    }
    integrate();
  }

  bool starts_closed = false, ends_closed = false;
  Dual normal, elastic_normal;  ///< mean over the step
  Dual shear, elastic_shear;
  Dual shear_start, shear_end;         ///< of the spring, at both ends of the closed part
  Dual normal_end, carried_shear_end;  ///< with dashpots
  Line elastic() const { return elastic_; }
  bool slides_at_end = false;
  double friction = 0.0;

 private:
  Dual normal_at(const Dual& share) const { return larger(elastic_.at(share) - springs_.normal_damping * gap_change_, constant(-strength_.tension)); }

  /// One piece on which the bound is linear: the spring sticks until its force meets the bound, which it then follows.
  void stick_then_slide(const Dual& duration, const Line& bound) {
    const Line trial{shear_end, shear_end - springs_.shear * (duration * slip_change_)};
    const double direction = std::copysign(1.0, trial.end.value);
    const Dual outside = direction * trial.end - bound.end;
    slides_at_end = outside.value > 0.0;
    if (!slides_at_end) {
      add_shear(duration, trial, bound);
      shear_end = trial.end;
      return;
    }
    const Dual sticking = larger(Dual{}, bound.start - direction * trial.start) / (larger(Dual{}, bound.start - direction * trial.start) + outside);
    const Dual crossing = bound.at(sticking);
    add_shear(sticking * duration, {trial.start, direction * crossing}, {bound.start, crossing});
    add_shear((constant(1.0) - sticking) * duration, direction * Line{crossing, bound.end}, {crossing, bound.end});
    friction += 0.5 * (crossing + bound.end).value * outside.value / springs_.shear;
    shear_end = direction * bound.end;
  }

  void add_shear(const Dual& duration, const Line& elastic, const Line& bound) {
    const Dual viscous = -springs_.shear_damping * slip_change_;
    const Line total{elastic.start + viscous, elastic.end + viscous};
    elastic_shear = elastic_shear + duration * elastic.mean();
    shear = shear + duration * mean_within(total, bound);
    carried_shear_end = clamp(total.end, bound.end);
    slides_at_end = slides_at_end || std::abs(total.end.value) > bound.end.value;
  }

  void integrate() {
    elastic_normal = length_ * elastic_.mean();
    std::array<Dual, 4> shares{constant(0.0)};
    std::size_t pieces = 0;
    // Kinks on the way, in the order in which they are passed.
    const Dual first = elastic_.start - springs_.normal_damping * gap_change_, last = elastic_.end - springs_.normal_damping * gap_change_;
    std::array<double, 2> kinks{-strength_.tension, kink_of_bound(strength_)};
    if (last.value < first.value) std::swap(kinks[0], kinks[1]);
    for (const double kink : kinks) {
      const bool passed = (kink - first.value) * (kink - last.value) < 0.0;
      if (passed) shares[++pieces] = (constant(kink) - first) / (last - first);
      if (kinks[0] == kinks[1]) break;
    }
    shares[++pieces] = constant(1.0);

    Line n{{}, normal_at(shares[0])}, bound{{}, shear_bound(strength_, n.end)};
    shear_start = starts_closed ? clamp(constant(springs_.initial_shear), bound.end) : Dual{};
    shear_end = shear_start;
    for (std::size_t i = 0; i < pieces; ++i) {
      const Dual duration = length_ * (shares[i + 1] - shares[i]);
      n = {n.end, normal_at(shares[i + 1])};
      bound = {bound.end, shear_bound(strength_, n.end)};
      normal = normal + duration * n.mean();
      stick_then_slide(duration, bound);
    }
    normal_end = n.end;
  }

  const ContactSprings& springs_;
  const ContactStrength& strength_;
  Dual slip_change_, gap_change_;
  Dual length_;  ///< share of the step
  Line elastic_;
};

/// The same operations as on a single piece of the path, so that the numbers are the same. False if the contact does anything else than stick.
/// \param start, end  [N] of the normal spring, above -tension
bool sticks_all_the_way(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change, double start,
                        double end, PathAverage& result) {
  const StickingPath<double> path(springs, strength, start, end, gap_change, slip_change);
  if (!path.is_one) return false;
  result.end = {ContactStatus::sticking, path.normal_1, path.shear_1, end, path.elastic_shear_1};
  ContactForces& mean = result.mean;
  mean.status = ContactStatus::sticking;
  mean.normal = 0.5 * (path.normal_0 + path.normal_1);
  mean.shear = 0.5 * (path.shear_0 + path.shear_1);
  mean.elastic_normal = 0.5 * (start + end);
  mean.elastic_shear = 0.5 * (path.elastic_shear_0 + path.elastic_shear_1);
  mean.normal_by_gap = path.normal_by_gap;
  mean.shear_by_slip = path.shear_by_slip;
  result.energies.springs = stored(end, springs.normal) - stored(start, springs.normal) + stored(path.elastic_shear_1, springs.shear) -
                            stored(path.elastic_shear_0, springs.shear);
  result.energies.damping = -(mean.normal - mean.elastic_normal) * gap_change - (mean.shear - mean.elastic_shear) * slip_change;
  return true;
}

}  // namespace

PathAverage path_average(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change, double dissipation) {
  PathAverage result;
  const double start = springs.shift - springs.normal * (springs.gap - springs.target), end = start - springs.normal * gap_change;
  const bool starts_closed = start + strength.tension > 0.0, ends_closed = end + strength.tension > 0.0;
  if (!starts_closed && !ends_closed) return result;
  const bool simple = dissipation == 0.0 && starts_closed && ends_closed;
  if (simple && sticks_all_the_way(springs, strength, gap_change, slip_change, start, end, result)) return result;
  result = path_average_by_pieces(springs, strength, gap_change, slip_change, dissipation);  // one result in one place, not copied
  return result;
}

PathAverage path_average_by_pieces(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change,
                                   double dissipation) {
  PathAverage result;
  const ClosedPart part(springs, strength, gap_change, slip_change);
  if (!part.starts_closed && !part.ends_closed) return result;

  const Dual normal_0 = part.starts_closed ? part.elastic().start : Dual{}, normal_1 = part.ends_closed ? part.elastic().end : Dual{};
  const Dual shear_0 = part.starts_closed ? part.shear_start : Dual{}, shear_1 = part.ends_closed ? part.shear_end : Dual{};
  Dual normal = part.normal, shear = part.shear;
  if (dissipation > 0.0) {
    normal = larger(normal + dissipation * (normal_1 - normal_0), constant(-strength.tension));
    shear = clamp(shear + dissipation * (shear_1 - shear_0), shear_bound(strength, normal));
  }

  if (part.ends_closed) {
    result.end.status = part.slides_at_end ? ContactStatus::sliding : ContactStatus::sticking;
    result.end.normal = part.normal_end.value;
    result.end.shear = part.carried_shear_end.value;
    result.end.elastic_normal = normal_1.value;
    result.end.elastic_shear = shear_1.value;
  }
  ContactForces& mean = result.mean;
  mean.status = result.end.status;
  mean.normal = normal.value;
  mean.shear = shear.value;
  mean.elastic_normal = part.elastic_normal.value;
  mean.elastic_shear = part.elastic_shear.value;
  mean.normal_by_gap = normal.by_gap;
  mean.shear_by_gap = shear.by_gap;
  mean.shear_by_slip = shear.by_slip;

  PathEnergies& e = result.energies;
  e.springs = stored(normal_1.value, springs.normal) - stored(normal_0.value, springs.normal) + stored(shear_1.value, springs.shear) -
              stored(shear_0.value, springs.shear);
  e.friction = part.friction;
  e.damping = -(part.normal.value - part.elastic_normal.value) * gap_change - (part.shear.value - part.elastic_shear.value) * slip_change;
  const int openings = (part.starts_closed ? 1 : 0) - (part.ends_closed ? 1 : 0);
  e.rupture = openings * stored(strength.tension, springs.normal);
  e.scheme = -(normal.value - part.normal.value) * gap_change - (shear.value - part.shear.value) * slip_change;
  return result;
}

}  // namespace openclose
