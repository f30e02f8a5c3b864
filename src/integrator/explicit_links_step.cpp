// What a step does to the contacts of the explicit loop.
#include <algorithm>
#include <cmath>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/crossing_energy.h"
#include "openclose/integrator/explicit_links.h"
#include "openclose/integrator/lane_operations.h"

namespace openclose {

namespace {

using namespace lanes;

/// Four numbers of each of four records, by the address of the first of them.
OPENCLOSE_KERNEL void fetch(const double* const (&from)[batch_size], Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  a = load(from[0]);
  b = load(from[1]);
  c = load(from[2]);
  d = load(from[3]);
  transpose(a, b, c, d);
}

/// Of the blocks of four links.
struct FourPoses {
  Lanes x, y, cos_minus_1, sin;
  OPENCLOSE_KERNEL FourPoses(const ExplicitPose* list, const int (&slots)[batch_size]) {
    fetch({&list[slots[0]].x, &list[slots[1]].x, &list[slots[2]].x, &list[slots[3]].x}, x, y, cos_minus_1, sin);
  }
};
struct FourRates {
  Lanes x, y, turn, angle;
  OPENCLOSE_KERNEL FourRates(const ExplicitRate* list, const int (&slots)[batch_size]) {
    fetch({&list[slots[0]].x, &list[slots[1]].x, &list[slots[2]].x, &list[slots[3]].x}, x, y, turn, angle);
  }
};

}  // namespace

/// Four links as they are before a step, with the members of Link.
struct ExplicitLinks::FourLinks {
  Lanes arm_x, arm_y, across_x, across_y, normal_x, normal_y, loaded_gap, normal_stiffness;
  Lanes shear_stiffness, per_shear_stiffness, normal_dashpot, shear_dashpot;
  Lanes friction, cohesion, tension, gap, slip, stretch, normal, shear;
  Lanes viscous_shear, rest_gap;
  Mask was_open{}, breakable{};
  int vertex[batch_size], edge[batch_size];  ///< slots

  OPENCLOSE_KERNEL explicit FourLinks(const Link* links)
      : viscous_shear{links[0].viscous_shear, links[1].viscous_shear, links[2].viscous_shear, links[3].viscous_shear},
        rest_gap{links[0].rest_gap, links[1].rest_gap, links[2].rest_gap, links[3].rest_gap},
        vertex{links[0].vertex_slot, links[1].vertex_slot, links[2].vertex_slot, links[3].vertex_slot},
        edge{links[0].edge_slot, links[1].edge_slot, links[2].edge_slot, links[3].edge_slot} {
    const auto fetch_from = [&](double Link::*first, Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
      fetch({&(links[0].*first), &(links[1].*first), &(links[2].*first), &(links[3].*first)}, a, b, c, d);
    };
    fetch_from(&Link::arm_x, arm_x, arm_y, across_x, across_y);
    fetch_from(&Link::normal_x, normal_x, normal_y, loaded_gap, normal_stiffness);
    fetch_from(&Link::shear_stiffness, shear_stiffness, per_shear_stiffness, normal_dashpot, shear_dashpot);
    fetch({&links[0].strength.friction, &links[1].strength.friction, &links[2].strength.friction, &links[3].strength.friction}, friction, cohesion,
          tension, gap);
    fetch_from(&Link::slip, slip, stretch, normal, shear);
    for (int k = 0; k < batch_size; ++k) {
      was_open[k] = links[k].status == ContactStatus::open ? -1 : 0;
      breakable[k] = links[k].breakable ? -1 : 0;
    }
  }
};

/// Four links after a step.
struct ExplicitLinks::FourForces {
  LinkPlace<Lanes> now;
  Lanes slip, stretch;                ///< [m] slip in the step
  Lanes normal_before, shear_before;  ///< [N] of joints
  Lanes normal, shear;                ///< [N] with what settles openings
  Mask closed, sticking;
};

template <bool damped>
void ExplicitLinks::follow_four(Link* links, LinkSums& sums) {
  const Lanes zero{};
  const FourLinks four(links);
  FourForces f;
  f.now = link_place<Lanes>(FourPoses(blocks_.poses(), four.vertex), FourPoses(blocks_.poses(), four.edge), four);
  const Lanes gap = f.now.gap, kn = four.normal_stiffness, ks = four.shear_stiffness;
  f.normal_before = four.was_open ? zero : four.normal;  // what settles an opening is no joint's force
  f.shear_before = four.was_open ? zero : four.shear;

  // As trials(), and carry() for four.
  f.slip = f.now.slip - four.slip;
  const Lanes elastic_normal = -kn * gap, memory = -ks * (four.stretch + f.slip);
  Lanes viscous_normal = zero, viscous_shear = zero;
  if constexpr (damped) {
    const LinkRate<Lanes> rate = link_rate<Lanes>(FourRates(blocks_.rates(), four.vertex), FourRates(blocks_.rates(), four.edge), f.now.at);
    viscous_normal = -four.normal_dashpot * rate.normal;
    viscous_shear = -four.shear_dashpot * rate.shear;
  }
  f.closed = ~spring_is_open(four.tension, elastic_normal);
  const MohrCoulomb carried(four.friction, four.cohesion, four.tension, elastic_normal + viscous_normal, memory + viscous_shear,
                            tolerance::cohesion_ramp);
  f.sticking = f.closed & carried.is_sticking;
  f.normal = f.closed ? carried.normal : zero;
  const Lanes shear = f.closed ? carried.shear : zero, elastic_shear = f.closed ? carried.limit.of(memory) : zero;
  f.shear = shear;
  f.stretch = -elastic_shear * four.per_shear_stiffness;
  const LinkEnergies<Lanes> energies({kn, ks, four.was_open ? zero : four.gap, four.was_open ? four.gap : zero, four.stretch, f.normal_before,
                                      f.shear_before, four.viscous_shear, gap - four.gap, f.slip, f.closed ? zero : gap, f.stretch, shear});
  double settled[batch_size] = {};
  settle_crossings(links, four, f, settled);
  const Lanes depth = f.closed ? -gap - four.rest_gap : zero, kept_shear = shear - elastic_shear;
  for (int k = 0; k < batch_size; ++k) {
    sums.friction += energies.rubbed[k];
    sums.scheme += settled[k];
    sums.scheme += energies.scheme[k];
    sums.scheme -= energies.not_yet[k];
    sums.deepest = std::max(sums.deepest, depth[k]);
    if constexpr (damped) {
      sums.damping += energies.damping[k];
      links[k].viscous_shear = kept_shear[k];
    }
  }
  store_four(links, f);
  if (any(four.breakable & ~f.sticking)) lose_strengths(links, four, f);
  push_four(four, f);
}

/// Few contacts close or open in a step: one by one.
/// \param scheme  [J] of each
void ExplicitLinks::settle_crossings(Link* links, const FourLinks& four, FourForces& f, double (&scheme)[batch_size]) {
  const Mask settles = four.was_open & ((four.normal != 0.0) | (four.shear != 0.0)), crosses = (four.was_open ^ ~f.closed) | settles;
  if (!any(crosses)) return;
  for (int k = 0; k < batch_size; ++k) {
    if (!crosses[k]) continue;
    double normal = f.normal[k], shear = f.shear[k];
    settle_crossing(links[k], {f.normal_before[k], f.shear_before[k], f.now.gap[k], f.slip[k], !f.closed[k]}, normal, shear, scheme[k]);
    f.normal[k] = normal;
    f.shear[k] = shear;
  }
}

/// Writes the history.
void ExplicitLinks::store_four(Link* links, const FourForces& f) {
  Lanes history[] = {f.now.slip, f.stretch, f.normal, f.shear};
  transpose(history[0], history[1], history[2], history[3]);
  for (int k = 0; k < batch_size; ++k) {
    Link& link = links[k];
    link.gap = f.now.gap[k];
    lanes::store(&link.slip, history[k]);
    link.status = !f.closed[k] ? ContactStatus::open : (f.sticking[k] ? ContactStatus::sticking : ContactStatus::sliding);
  }
}

/// Few contacts lose their strength: one by one, too.
void ExplicitLinks::lose_strengths(Link* links, const FourLinks& four, FourForces& f) {
  const ForcePlace<Lanes>& at = f.now.at;
  for (int k = 0; k < batch_size; ++k) {
    if (!four.breakable[k]) continue;
    lose_strength(
        links[k], rest_[&links[k] - links_.data()], f.slip[k] + four.stretch[k] - f.stretch[k],
        {f.now.gap[k], f.now.slip[k], {at.normal_x[k], at.normal_y[k], at.vertex_arm_x[k], at.vertex_arm_y[k], at.edge_arm_x[k], at.edge_arm_y[k]}});
    f.normal[k] = links[k].normal;
    f.shear[k] = links[k].shear;
  }
}

/// Adds the forces to the blocks.
void ExplicitLinks::push_four(const FourLinks& four, const FourForces& f) {
  const ContactPush<Lanes> push(f.normal, f.shear, f.now.at);
  const Lanes zero{};
  Lanes forward[] = {push.x, push.y, push.on_vertex, zero}, back[] = {push.x, push.y, push.on_edge, zero};
  transpose(forward[0], forward[1], forward[2], forward[3]);
  transpose(back[0], back[1], back[2], back[3]);
  for (int k = 0; k < batch_size; ++k) {
    double* const v = &blocks_.forces()[four.vertex[k]].x;
    lanes::store(v, lanes::load(v) + forward[k]);
    double* const e = &blocks_.forces()[four.edge[k]].x;
    lanes::store(e, lanes::load(e) - back[k]);
  }
}

template <bool damped>
void ExplicitLinks::follow_all(LinkSums& sums) {
  for (std::size_t i = 0; i < links_.size(); i += batch_size) follow_four<damped>(&links_[i], sums);
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
    const Place place_now = place(link);
    const ExplicitRate v = blocks_.acceleration(link.vertex_slot, base), e = blocks_.acceleration(link.edge_slot, base);
    const LinkRate<double> opening = link_rate<double>(v, e, place_now.at);
    const double gained = factor * (link.normal * opening.normal + link.shear * opening.shear);
    link.crossing_energy += gained;
    energies_.scheme += gained;
  }
}

void ExplicitLinks::lose_strength(Link& link, LinkRest& rest, double slip, const Place& at) {
  const TabulatedJoint& joint = joints_->joint(rest.joint);
  const JointState state = state_after(joint, rest.joint_state, link.status, std::abs(slip));
  if (state == rest.joint_state) return;
  lost_strength_ |= !state.bonded;  // what it loses little by little shows in the forces of the next steps
  rest.joint_state = state;
  link.breakable = can_lose_strength(joint, state);
  link.strength = ContactStrength(joint, rest.length, state);
  if (link.status == ContactStatus::open) return;  // what settles its opening is not the joint's
  carry_now(link, at);
  if (link.breakable || at.gap <= 0.0) return;
  // It slipped while it was pulling: nothing pulls any more.
  link.status = ContactStatus::open;
  energies_.redefinition += 0.5 * link.normal_stiffness * (at.gap * at.gap);
}

}  // namespace openclose
