#include "openclose/statics/increment_packs.h"

#include <algorithm>

#include "openclose/law/mohr_coulomb.h"

namespace openclose {
namespace {

/// The contact law of balance.h. Joints that just touch, as drawn, resist.
template <ShearLaw law>
OPENCLOSE_KERNEL ResponsePack respond(const IncrementSprings& springs, Lanes gap_change, Lanes slip_change) {
  const Lanes zero{};
  ResponsePack r;
  const Lanes trial = -springs.normal_stiffness * (springs.gap + gap_change);
  const auto is_closed = trial >= -springs.tension;
  r.normal = is_closed ? trial : -springs.tension;
  r.normal_by_gap = is_closed ? -springs.normal_stiffness : zero;
  const Lanes shear = springs.shear - springs.shear_stiffness * slip_change;
  if constexpr (law == ShearLaw::elastic) {
    r.shear = shear;
    r.shear_by_slip = -springs.shear_stiffness;
  } else {
    const ShearLimit limit(springs.friction, springs.cohesion, springs.tension, r.normal, tolerance::cohesion_ramp);
    const Lanes bound = law == ShearLaw::coulomb ? limit.value : springs.bound;
    const Lanes slope = law == ShearLaw::coulomb ? limit.slope : zero;
    const auto sticks = (shear <= bound) & (-bound <= shear);
    const auto is_backward = shear < zero;
    const Lanes at_bound = is_backward ? -bound : bound, slope_at_bound = is_backward ? -slope : slope;
    r.shear = sticks ? shear : at_bound;
    r.shear_by_gap = sticks ? zero : slope_at_bound * r.normal_by_gap;
    r.shear_by_slip = sticks ? -springs.shear_stiffness : zero;
  }
  return r;
}

OPENCLOSE_KERNEL Lanes of_four(const double* numbers, const int* rows, int k) {
  return Lanes{numbers[3 * rows[0] + k], numbers[3 * rows[1] + k], numbers[3 * rows[2] + k], numbers[3 * rows[3] + k]};
}

OPENCLOSE_KERNEL Lanes along(const Lanes* gradient, const double* motion, const int* rows) {
  return gradient[0] * of_four(motion, rows, 0) + gradient[1] * of_four(motion, rows, 1) + gradient[2] * of_four(motion, rows, 2);
}

OPENCLOSE_KERNEL Lanes gap_of(const IncrementPack& p, const double* motion) {
  return along(p.normal_a, motion, p.a) + along(p.normal_b, motion, p.b);
}

OPENCLOSE_KERNEL Lanes slip_of(const IncrementPack& p, const double* motion) {
  return along(p.shear_a, motion, p.a) + along(p.shear_b, motion, p.b);
}

OPENCLOSE_KERNEL void add_forces(const IncrementPack& p, const ResponsePack& r, double* force) {
  Lanes on_a[3], on_b[3];
  for (int k = 0; k < 3; ++k) {
    on_a[k] = r.normal * p.normal_a[k] + r.shear * p.shear_a[k];
    on_b[k] = r.normal * p.normal_b[k] + r.shear * p.shear_b[k];
  }
  for (int lane = 0; lane < batch_size; ++lane) {
    double *a = force + 3 * p.a[lane], *b = force + 3 * p.b[lane];
    for (int k = 0; k < 3; ++k) {
      a[k] += on_a[k][lane];
      b[k] += on_b[k][lane];
    }
  }
}

template <ShearLaw law>
OPENCLOSE_KERNEL void evaluate_all(const IncrementPack* packs, std::size_t count, const double* motion, ResponsePack* responses, double* force) {
  for (std::size_t i = 0; i < count; ++i) {
    responses[i] = respond<law>(packs[i].springs, gap_of(packs[i], motion), slip_of(packs[i], motion));
    add_forces(packs[i], responses[i], force);
  }
}

template <ShearLaw law>
OPENCLOSE_KERNEL void follow_all(IncrementPack* packs, std::size_t count, const double* motion, ResponsePack* responses, double* force) {
  for (std::size_t i = 0; i < count; ++i) {
    const Lanes opening = gap_of(packs[i], motion);
    responses[i] = respond<law>(packs[i].springs, opening, slip_of(packs[i], motion));
    packs[i].springs.gap += opening;
    packs[i].springs.shear = responses[i].shear;
    add_forces(packs[i], responses[i], force);
  }
}

template <ShearLaw law>
OPENCLOSE_KERNEL double subtract_power_of_all(double from, const IncrementPack* packs, const SearchPack* ways, std::size_t count, double part) {
  for (std::size_t i = 0; i < count; ++i) {
    const SearchPack& w = ways[i];
    const ResponsePack r = respond<law>(packs[i].springs, w.gap + part * w.opening, w.slip + part * w.slipping);
    const Lanes power = r.normal * w.opening + r.shear * w.slipping;
    for (int lane = 0; lane < batch_size; ++lane) from -= power[lane];
  }
  return from;
}

}  // namespace

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void evaluate_increment(ShearLaw law, const IncrementPack* packs, std::size_t count, const double* motion,
                                                         ResponsePack* responses, double* force) {
  if (law == ShearLaw::coulomb) return evaluate_all<ShearLaw::coulomb>(packs, count, motion, responses, force);
  if (law == ShearLaw::fixed) return evaluate_all<ShearLaw::fixed>(packs, count, motion, responses, force);
  evaluate_all<ShearLaw::elastic>(packs, count, motion, responses, force);
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void follow_increment(ShearLaw law, IncrementPack* packs, std::size_t count, const double* motion,
                                                       ResponsePack* responses, double* force) {
  if (law == ShearLaw::coulomb) return follow_all<ShearLaw::coulomb>(packs, count, motion, responses, force);
  if (law == ShearLaw::fixed) return follow_all<ShearLaw::fixed>(packs, count, motion, responses, force);
  follow_all<ShearLaw::elastic>(packs, count, motion, responses, force);
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO double subtract_increment_power(ShearLaw law, double from, const IncrementPack* packs, const SearchPack* ways,
                                                                 std::size_t count, double part) {
  if (law == ShearLaw::coulomb) return subtract_power_of_all<ShearLaw::coulomb>(from, packs, ways, count, part);
  if (law == ShearLaw::fixed) return subtract_power_of_all<ShearLaw::fixed>(from, packs, ways, count, part);
  return subtract_power_of_all<ShearLaw::elastic>(from, packs, ways, count, part);
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void begin_increment_search(const IncrementPack* packs, std::size_t count, const double* motion, const double* way,
                                                             SearchPack* ways) {
  for (std::size_t i = 0; i < count; ++i) {
    ways[i] = {gap_of(packs[i], motion), slip_of(packs[i], motion), gap_of(packs[i], way), slip_of(packs[i], way)};
  }
}

IncrementPacks::IncrementPacks(const FrozenSystem& system)
    : packs_((system.contacts().size() + batch_size - 1) / batch_size), responses_(packs_.size()), ways_(packs_.size()) {
  for (IncrementPack& p : packs_) {
    std::ranges::fill(p.a, system.rows());
    std::ranges::fill(p.b, system.rows());
  }
  for (std::size_t i = 0; i < system.contacts().size(); ++i) {
    const FrozenContact& c = system.contacts()[i];
    IncrementPack& p = packs_[i / batch_size];
    const std::size_t lane = i % batch_size;
    for (int k = 0; k < 3; ++k) {
      if (c.a >= 0) p.normal_a[k][lane] = c.normal_a[k], p.shear_a[k][lane] = c.shear_a[k];
      if (c.b >= 0) p.normal_b[k][lane] = c.normal_b[k], p.shear_b[k][lane] = c.shear_b[k];
    }
    if (c.a >= 0) p.a[lane] = c.a;
    if (c.b >= 0) p.b[lane] = c.b;
    p.springs.normal_stiffness[lane] = c.normal_stiffness;
    p.springs.shear_stiffness[lane] = c.shear_stiffness;
  }
}

void IncrementPacks::start(std::size_t i, const FrozenContactState& state) {
  IncrementSprings& s = packs_[i / batch_size].springs;
  s.gap[i % batch_size] = state.gap;
  s.shear[i % batch_size] = state.shear;
}

void IncrementPacks::set_strength(std::size_t i, const ContactStrength& strength) {
  IncrementSprings& s = packs_[i / batch_size].springs;
  s.friction[i % batch_size] = strength.friction;
  s.cohesion[i % batch_size] = strength.cohesion;
  s.tension[i % batch_size] = strength.tension;
}

void IncrementPacks::set_bound_of(std::size_t i, double normal) {
  IncrementSprings& s = packs_[i / batch_size].springs;
  const std::size_t lane = i % batch_size;
  s.bound[lane] = ShearLimit(s.friction[lane], s.cohesion[lane], s.tension[lane], normal, tolerance::cohesion_ramp).value;
}

void IncrementPacks::evaluate(const double* motion, ShearLaw law, double* force) {
  evaluate_increment(law, packs_.data(), packs_.size(), motion, responses_.data(), force);
}

void IncrementPacks::follow(const double* motion, ShearLaw law, double* force) {
  follow_increment(law, packs_.data(), packs_.size(), motion, responses_.data(), force);
}

ContactResponse IncrementPacks::response(std::size_t i) const {
  const ResponsePack& r = responses_[i / batch_size];
  const std::size_t lane = i % batch_size;
  return {r.normal[lane], r.shear[lane], r.normal_by_gap[lane], r.shear_by_gap[lane], r.shear_by_slip[lane]};
}

void IncrementPacks::begin_search(const double* motion, const double* way) {
  begin_increment_search(packs_.data(), packs_.size(), motion, way, ways_.data());
}

double IncrementPacks::subtract_power(double from, double part, ShearLaw law) const {
  return subtract_increment_power(law, from, packs_.data(), ways_.data(), packs_.size(), part);
}

}  // namespace openclose
