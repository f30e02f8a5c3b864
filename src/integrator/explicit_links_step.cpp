// What a step does to the contacts of the explicit loop.
#include <algorithm>
#include <cmath>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/crossing_energy.h"
#include "openclose/integrator/explicit_links.h"
#include "openclose/integrator/lane_operations.h"

namespace openclose {

using namespace lanes;

template <bool damped>
void ExplicitLinks::follow_link(Link& link, LinkSums& sums) {
  const Place at = place(link);
  if (rests(link) && openclose::is_open(link.strength, -link.normal_stiffness * at.gap)) {
    link.gap = at.gap;
    link.slip = at.slip;
    return;
  }
  const double gap_change = at.gap - link.gap, slip = at.slip - link.slip;
  const double memory = -link.shear_stiffness * (link.stretch + slip);
  CarriedForces f;
  if constexpr (damped) {
    f = carry(link.strength, trials(link, at, memory));
  } else {
    f = carry(link.strength, {-link.normal_stiffness * at.gap, 0.0, memory, 0.0});
  }
  const bool was_open = link.status == ContactStatus::open, opened = f.status == ContactStatus::open;
  const double normal_before = was_open ? 0.0 : link.normal,
               shear_before = was_open ? 0.0 : link.shear;  // what settles an opening is no joint's force
  double settled_shear = f.shear;
  if (was_open != opened || (was_open && (link.normal != 0.0 || link.shear != 0.0))) {
    settle_crossing(link, {normal_before, shear_before, at.gap, slip, opened}, f.normal, settled_shear, sums.scheme);
  }
  // The step's forces were those at its start, but for what settles an opening; see the ledger for the formulas, with theta = 0.
  const double stretch = -f.elastic_shear * link.per_shear_stiffness;
  const double stretched = stretch - link.stretch, opening = opened ? at.gap : 0.0;
  const double closing = -gap_change + (opening - (was_open ? link.gap : 0.0));
  sums.scheme += normal_before * gap_change + shear_before * slip - normal_before * opening -
                 0.5 * (link.normal_stiffness * closing * closing + link.shear_stiffness * stretched * stretched) -
                 (shear_before - link.viscous_shear + link.shear_stiffness * link.stretch) * stretched;
  // What rubs in the step is the mean force: so the work of central difference is summed by parts.
  const double rubbed = std::max(0.0, -0.5 * (shear_before + f.shear) * (slip - stretched));
  sums.friction += rubbed;
  sums.scheme -= rubbed + shear_before * (slip - stretched);
  if constexpr (damped)
    sums.damping += (normal_before - (was_open ? 0.0 : -link.normal_stiffness * link.gap)) * closing - link.viscous_shear * stretched;
  link.gap = at.gap;
  link.slip = at.slip;
  link.stretch = stretch;
  link.status = f.status;
  link.normal = f.normal;
  link.shear = settled_shear;
  if constexpr (damped) link.viscous_shear = f.shear - f.elastic_shear;
  if (f.status != ContactStatus::open) sums.deepest = std::max(sums.deepest, -at.gap - link.rest_gap);
  if (link.breakable) lose_strength(link, joints_->joint(rest_[&link - links_.data()].joint), at);
  push(link, at);
}

template <bool damped>
bool ExplicitLinks::follow_four(Link* links, LinkSums& sums) {
  const Lanes zero{};
  const auto fetch = [](const double*(&from)[batch_size], Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
    a = lanes::load(from[0]);
    b = lanes::load(from[1]);
    c = lanes::load(from[2]);
    d = lanes::load(from[3]);
    transpose(a, b, c, d);
  };
  const auto fetch_links = [&](double Link::*first, Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
    const double* from[] = {&(links[0].*first), &(links[1].*first), &(links[2].*first), &(links[3].*first)};
    fetch(from, a, b, c, d);
  };
  const auto fetch_blocks = [&](const auto& list, auto first, int Link::*slot, Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
    const double* from[] = {&(list[links[0].*slot].*first), &(list[links[1].*slot].*first), &(list[links[2].*slot].*first),
                            &(list[links[3].*slot].*first)};
    fetch(from, a, b, c, d);
  };
  Lanes arm_x, arm_y, across_x, across_y, normal_x, normal_y, loaded_gap, kn, ks, per_ks, normal_dashpot, shear_dashpot;
  fetch_links(&Link::arm_x, arm_x, arm_y, across_x, across_y);
  fetch_links(&Link::normal_x, normal_x, normal_y, loaded_gap, kn);
  fetch_links(&Link::shear_stiffness, ks, per_ks, normal_dashpot, shear_dashpot);
  Lanes vx, vy, v_cos_minus_1, v_sin, ex, ey, e_cos_minus_1, e_sin;
  fetch_blocks(blocks_.poses(), &ExplicitPose::x, &Link::vertex_slot, vx, vy, v_cos_minus_1, v_sin);
  fetch_blocks(blocks_.poses(), &ExplicitPose::x, &Link::edge_slot, ex, ey, e_cos_minus_1, e_sin);

  // As place().
  const Lanes turned_x = v_cos_minus_1 * arm_x - v_sin * arm_y, turned_y = v_cos_minus_1 * arm_y + v_sin * arm_x;
  const Lanes dx = vx - ex + turned_x, dy = vy - ey + turned_y;
  const Lanes change_x = e_cos_minus_1 * normal_x - e_sin * normal_y, change_y = e_cos_minus_1 * normal_y + e_sin * normal_x;
  const Lanes nx = normal_x + change_x, ny = normal_y + change_y;
  const Lanes gap = loaded_gap + (change_x * across_x + change_y * across_y + (nx * dx + ny * dy));
  const Lanes all_slip = change_x * across_y - change_y * across_x + (nx * dy - ny * dx);
  const Lanes now_arm_x = arm_x + turned_x, now_arm_y = arm_y + turned_y, now_across_x = across_x + dx, now_across_y = across_y + dy;

  Lanes friction, cohesion, tension, gap_before, slip_before, stretch_before, normal_before, shear_before;
  const double* strength[] = {&links[0].strength.friction, &links[1].strength.friction, &links[2].strength.friction, &links[3].strength.friction};
  fetch(strength, friction, cohesion, tension, gap_before);
  fetch_links(&Link::slip, slip_before, stretch_before, normal_before, shear_before);
  const Lanes viscous_shear_before{links[0].viscous_shear, links[1].viscous_shear, links[2].viscous_shear, links[3].viscous_shear};
  Mask was_open{}, breakable{};
  for (int k = 0; k < batch_size; ++k) {
    was_open[k] = links[k].status == ContactStatus::open ? -1 : 0;
    breakable[k] = links[k].breakable ? -1 : 0;
  }

  const Mask settles = was_open & ((normal_before != 0.0) | (shear_before != 0.0));
  normal_before = was_open ? zero : normal_before;  // what settles an opening is no joint's force
  shear_before = was_open ? zero : shear_before;

  // As trials(), and carry() for four.
  const Lanes gap_change = gap - gap_before, slip = all_slip - slip_before;
  const Lanes elastic_normal = -kn * gap, memory = -ks * (stretch_before + slip);
  Lanes viscous_normal = zero, viscous_shear = zero;
  if constexpr (damped) {
    Lanes v_rate_x, v_rate_y, v_turn, e_rate_x, e_rate_y, e_turn, angle;
    fetch_blocks(blocks_.rates(), &ExplicitRate::x, &Link::vertex_slot, v_rate_x, v_rate_y, v_turn, angle);
    fetch_blocks(blocks_.rates(), &ExplicitRate::x, &Link::edge_slot, e_rate_x, e_rate_y, e_turn, angle);
    const Lanes x = (v_rate_x - v_turn * now_arm_y) - (e_rate_x - e_turn * now_across_y),
                y = (v_rate_y + v_turn * now_arm_x) - (e_rate_y + e_turn * now_across_x);
    viscous_normal = -normal_dashpot * (nx * x + ny * y);
    viscous_shear = -shear_dashpot * (nx * y - ny * x);
  }
  const Mask closed = ~spring_is_open(tension, elastic_normal);
  const MohrCoulomb carried(friction, cohesion, tension, elastic_normal + viscous_normal, memory + viscous_shear, tolerance::cohesion_ramp);
  const Mask sticking = closed & carried.is_sticking;
  if (any(breakable & ~sticking)) return false;
  Lanes normal = closed ? carried.normal : zero;
  const Lanes shear = closed ? carried.shear : zero;
  const Lanes elastic_shear = closed ? carried.limit.of(memory) : zero;

  // Few do so in a step: one by one.
  const Mask crosses = (was_open ^ ~closed) | settles;
  Lanes settled_shear = shear;
  double settled[batch_size] = {};
  if (any(crosses)) {
    for (int k = 0; k < batch_size; ++k) {
      if (!crosses[k]) continue;
      double n = normal[k], t = settled_shear[k];
      settle_crossing(links[k], {normal_before[k], shear_before[k], gap[k], slip[k], !closed[k]}, n, t, settled[k]);
      normal[k] = n;
      settled_shear[k] = t;
    }
  }

  // The step's forces were those at its start; see follow_link().
  const Lanes stretch = -elastic_shear * per_ks;
  const Lanes stretched = stretch - stretch_before, opening = closed ? zero : gap;
  const Lanes closing = -gap_change + (opening - (was_open ? gap_before : zero));
  const Lanes scheme = normal_before * gap_change + shear_before * slip - normal_before * opening -
                       0.5 * (kn * closing * closing + ks * stretched * stretched) -
                       (shear_before - viscous_shear_before + ks * stretch_before) * stretched;
  const Lanes rubbed = larger(zero, -0.5 * (shear_before + shear) * (slip - stretched)), not_yet = rubbed + shear_before * (slip - stretched);
  const Lanes rest_gap{links[0].rest_gap, links[1].rest_gap, links[2].rest_gap, links[3].rest_gap}, depth = closed ? -gap - rest_gap : zero;
  for (int k = 0; k < batch_size; ++k) {
    sums.friction += rubbed[k];
    sums.scheme += settled[k];
    sums.scheme += scheme[k];
    sums.scheme -= not_yet[k];
    sums.deepest = std::max(sums.deepest, depth[k]);
  }
  if constexpr (damped) {
    const Lanes elastic_before = was_open ? zero : -kn * gap_before;
    const Lanes damping = (normal_before - elastic_before) * closing - viscous_shear_before * stretched;
    const Lanes kept_shear = shear - elastic_shear;
    for (int k = 0; k < batch_size; ++k) {
      sums.damping += damping[k];
      links[k].viscous_shear = kept_shear[k];
    }
  }

  const Lanes x = normal * nx - settled_shear * ny, y = normal * ny + settled_shear * nx;
  const Lanes on_vertex = now_arm_x * y - now_arm_y * x, on_edge = now_across_x * y - now_across_y * x;
  Lanes history[] = {all_slip, stretch, normal, settled_shear}, forward[] = {x, y, on_vertex, zero}, back[] = {x, y, on_edge, zero};
  transpose(history[0], history[1], history[2], history[3]);
  transpose(forward[0], forward[1], forward[2], forward[3]);
  transpose(back[0], back[1], back[2], back[3]);
  for (int k = 0; k < batch_size; ++k) {
    Link& link = links[k];
    link.gap = gap[k];
    lanes::store(&link.slip, history[k]);
    link.status = !closed[k] ? ContactStatus::open : (sticking[k] ? ContactStatus::sticking : ContactStatus::sliding);
    double* const v = &blocks_.forces()[link.vertex_slot].x;
    lanes::store(v, lanes::load(v) + forward[k]);
    double* const e = &blocks_.forces()[link.edge_slot].x;
    lanes::store(e, lanes::load(e) - back[k]);
  }
  return true;
}

template <bool damped>
void ExplicitLinks::follow_all(LinkSums& sums) {
  const std::size_t fours = fours_ ? links_.size() / batch_size * batch_size : 0;
  for (std::size_t i = 0; i < links_.size(); i += batch_size) {
    if (i < fours && follow_four<damped>(&links_[i], sums)) continue;
    for (std::size_t k = i; k < std::min(i + batch_size, links_.size()); ++k) follow_link<damped>(links_[k], sums);
  }
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void ExplicitLinks::follow_damped(LinkSums& sums) {
  follow_all<true>(sums);
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void ExplicitLinks::follow_undamped(LinkSums& sums) {
  follow_all<false>(sums);
}

void ExplicitLinks::follow() {
  lost_strength_ = false;
  LinkSums sums{0.0, 0.0, 0.0, max_penetration_};
  damped_ ? follow_damped(sums) : follow_undamped(sums);
  energies_.friction += sums.friction;
  energies_.contact_damping += sums.damping;
  energies_.scheme += sums.scheme;
  max_penetration_ = sums.deepest;
}

/// Of a contact that closes or opens, or has opened in the last step: the forces that settle its crossing, see crossing_energy.h, instead of none.
/// What a dashpot takes is not given back.
[[gnu::noinline]] void ExplicitLinks::settle_crossing(Link& link, const Crossing& crossing, double& normal, double& shear, double& scheme) {
  const double before = link.crossing_energy;
  const bool was_open = link.status == ContactStatus::open;
  link.crossing_energy = 0.0;
  if (link.strength.tension == 0.0 && was_open && !crossing.is_open) {
    link.crossing_energy = closing_energy(link.normal_stiffness, link.gap, crossing.gap);
  } else if (link.strength.tension == 0.0 && !was_open && crossing.is_open) {
    const double energy = before + 0.5 * std::min(crossing.normal_before, -link.normal_stiffness * link.gap) * crossing.gap;
    const Opening opening = settled(energy, link.normal_stiffness, crossing.gap - link.gap, link.shear_stiffness, crossing.slip, link.stretch,
                                    crossing.shear_before, share_);
    normal = opening.normal;
    shear = opening.shear;
    link.crossing_energy = opening.energy;
  }
  scheme += link.crossing_energy - before;
}

void ExplicitLinks::book_step_change(double before, double now, const Vec2& base) {
  const double factor = 0.125 * (before * before - now * now);
  for (Link& link : links_) {
    if (link.status == ContactStatus::open || link.strength.tension > 0.0) continue;
    const Place at = place(link);
    const ExplicitRate v = blocks_.acceleration(link.vertex_slot, base), e = blocks_.acceleration(link.edge_slot, base);
    const double x = (v.x - v.turn * at.arm_y) - (e.x - e.turn * at.across_y), y = (v.y + v.turn * at.arm_x) - (e.y + e.turn * at.across_x);
    const double gained = factor * (link.normal * (at.normal_x * x + at.normal_y * y) + link.shear * (at.normal_x * y - at.normal_y * x));
    link.crossing_energy += gained;
    energies_.scheme += gained;
  }
}

void ExplicitLinks::lose_strength(Link& link, const TabulatedJoint& joint, const Place& at) {
  if (stays_bonded(joint, true, link.status)) return;
  lost_strength_ = true;
  link.bonded = link.breakable = false;
  link.strength.break_bond(joint);
  carry_now(link, at);
  if (at.gap <= 0.0 || link.status == ContactStatus::open) return;
  // It slipped while it was pulling: nothing pulls any more.
  link.status = ContactStatus::open;
  energies_.redefinition += 0.5 * link.normal_stiffness * (at.gap * at.gap);
}

}  // namespace openclose
