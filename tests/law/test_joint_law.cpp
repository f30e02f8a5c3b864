#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "openclose/core/tolerance.h"
#include "openclose/law/edge_stress.h"
#include "openclose/law/joint_law.h"
#include "support/builders.h"
#include "support/catch.h"

using namespace openclose;

namespace {

constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();

JointProperties joint_with(double friction, double cohesion, double tension, CohesionBehaviour behaviour = CohesionBehaviour::ductile) {
  JointProperties joint = builders::frictional_joint(1e9, 4e8, std::atan(friction));
  joint.cohesion = cohesion;
  joint.tensile_strength = tension;
  joint.cohesion_behaviour = behaviour;
  return joint;
}

Contact contact_of_length(double length, bool bonded = true) {
  Contact contact;
  contact.length = length;
  contact.joint_state.bonded = bonded;
  return contact;
}

/// Friction [-], cohesion [N] and tension [N] of a contact of 1 m.
ContactStrength strength_of(double friction, double cohesion = 0.0, double tension = 0.0) {
  return ContactStrength(TabulatedJoint(joint_with(friction, cohesion, tension)), contact_of_length(1.0));
}

/// 1000 N/m normal, 400 N/m shear, closed by 1 m: 1000 N at rest.
ContactSprings springs_under_load() {
  ContactSprings springs;
  springs.normal = 1000.0;
  springs.shear = 400.0;
  springs.gap = -1.0;
  return springs;
}

}  // namespace

TEST_CASE("strength is the joint's times the tributary length", "[law][strength]") {
  const JointProperties joint = joint_with(0.7, 3e4, 2e4);
  const ContactStrength strength(TabulatedJoint(joint), contact_of_length(0.25));
  CHECK(strength.friction == Approx(0.7).epsilon(rounding));
  CHECK(strength.cohesion == Approx(7.5e3).epsilon(rounding));
  CHECK(strength.tension == Approx(5e3).epsilon(rounding));
}

TEST_CASE("cohesion and tension act on what is joined of the tributary length", "[law][strength]") {
  Contact contact = contact_of_length(0.25);
  contact.joint_state.joined = 0.4;
  const ContactStrength strength(TabulatedJoint(joint_with(0.7, 3e4, 2e4)), contact);
  CHECK(strength.friction == Approx(0.7).epsilon(rounding));
  CHECK(strength.cohesion == Approx(3e3).epsilon(rounding));
  CHECK(strength.tension == Approx(2e3).epsilon(rounding));
}

TEST_CASE("a bond does not grow with its contact, ductile cohesion does", "[law][strength]") {
  const auto behaviour = GENERATE(CohesionBehaviour::ductile, CohesionBehaviour::lost_on_opening, CohesionBehaviour::lost_on_slip);
  const TabulatedJoint joint(joint_with(0.7, 3e4, 2e4, behaviour));
  Contact contact = contact_of_length(0.5);
  contact.joint_state.joined = 0.8;
  contact.joint_state.bonded_length = 0.2;
  const ContactStrength longer(joint, contact);
  CHECK(longer.cohesion == Approx(3e4 * (behaviour == CohesionBehaviour::ductile ? 0.4 : 0.2)).epsilon(rounding));
  CHECK(longer.tension == Approx(2e4 * 0.2).epsilon(rounding));
  contact.length = 0.1;
  const ContactStrength shorter(joint, contact);
  CHECK(shorter.cohesion == Approx(3e4 * 0.08).epsilon(rounding));
  CHECK(shorter.tension == Approx(2e4 * 0.08).epsilon(rounding));
}

TEST_CASE("an open or slipped joint keeps only ductile cohesion, and no tension", "[law][strength]") {
  const Contact broken = contact_of_length(0.5, false), bonded = contact_of_length(0.5);
  const auto behaviour = GENERATE(CohesionBehaviour::ductile, CohesionBehaviour::lost_on_opening, CohesionBehaviour::lost_on_slip);
  const JointProperties joint = joint_with(0.7, 3e4, 2e4, behaviour);
  CHECK(ContactStrength(TabulatedJoint(joint), bonded).cohesion == 1.5e4);
  CHECK(ContactStrength(TabulatedJoint(joint), bonded).tension == 1e4);
  CHECK(ContactStrength(TabulatedJoint(joint), broken).cohesion == (behaviour == CohesionBehaviour::ductile ? 1.5e4 : 0.0));
  CHECK(ContactStrength(TabulatedJoint(joint), broken).tension == 0.0);
  CHECK(ContactStrength(TabulatedJoint(joint), broken).friction == Approx(0.7).epsilon(rounding));
}

TEST_CASE("the bond survives what its behaviour allows", "[law][strength]") {
  struct Case {
    CohesionBehaviour behaviour;
    ContactStatus status;
    bool stays;
  };
  const std::array<Case, 9> table{{{CohesionBehaviour::ductile, ContactStatus::open, false},
                                   {CohesionBehaviour::ductile, ContactStatus::sticking, true},
                                   {CohesionBehaviour::ductile, ContactStatus::sliding, true},
                                   {CohesionBehaviour::lost_on_opening, ContactStatus::open, false},
                                   {CohesionBehaviour::lost_on_opening, ContactStatus::sticking, true},
                                   {CohesionBehaviour::lost_on_opening, ContactStatus::sliding, true},
                                   {CohesionBehaviour::lost_on_slip, ContactStatus::open, false},
                                   {CohesionBehaviour::lost_on_slip, ContactStatus::sticking, true},
                                   {CohesionBehaviour::lost_on_slip, ContactStatus::sliding, false}}};
  const JointState broken{.bonded = false};
  for (const Case& c : table) {
    const JointProperties joint = joint_with(0.5, 1e4, 1e4, c.behaviour);
    CHECK(joint.weakens_by_slip() == (c.behaviour == CohesionBehaviour::lost_on_slip));
    CHECK(state_after(joint, {}, c.status, 1e-6).bonded == c.stays);
    // Nothing heals.
    CHECK_FALSE(state_after(joint, broken, c.status, 1e-6).bonded);
  }
}

TEST_CASE("a joint with residual friction has it once it has slipped or opened, and with it goes its bond", "[law][strength]") {
  const auto behaviour = GENERATE(CohesionBehaviour::ductile, CohesionBehaviour::lost_on_slip);
  JointProperties joint = joint_with(0.7, 3e4, 2e4, behaviour);
  joint.residual_friction_angle = std::atan(0.4);
  const TabulatedJoint tabulated(joint);
  CHECK(ContactStrength(tabulated, contact_of_length(0.5)).friction == Approx(0.7).epsilon(rounding));
  const ContactStrength broken(tabulated, contact_of_length(0.5, false));
  CHECK(broken.friction == Approx(0.4).epsilon(rounding));
  CHECK(broken.cohesion == (behaviour == CohesionBehaviour::ductile ? 1.5e4 : 0.0));
  CHECK(broken.tension == 0.0);
  CHECK(joint.weakens_by_slip());
  CHECK(state_after(joint, {}, ContactStatus::sticking, 1e-6).bonded);
  CHECK_FALSE(state_after(joint, {}, ContactStatus::sliding, 1e-6).bonded);
  CHECK_FALSE(state_after(joint, {}, ContactStatus::open, 0.0).bonded);
  joint.cohesion = joint.tensile_strength = 0.0;
  CHECK(can_lose_strength(joint, {}));
  CHECK_FALSE(can_lose_strength(joint, {.bonded = false}));
  // As high as the friction angle it takes nothing away.
  joint.residual_friction_angle = joint.friction_angle;
  CHECK_FALSE(can_lose_strength(joint, {}));
  CHECK(ContactStrength(TabulatedJoint(joint), contact_of_length(0.5, false)).friction == Approx(0.7).epsilon(rounding));
  if (behaviour == CohesionBehaviour::ductile) CHECK(state_after(joint, {}, ContactStatus::sliding, 1e-6).bonded);
}

TEST_CASE("slip takes strength over the slip-weakening distance, opening all of it at once", "[law][strength]") {
  JointProperties joint = joint_with(0.7, 3e4, 2e4, CohesionBehaviour::lost_on_slip);
  joint.residual_friction_angle = std::atan(0.4);
  joint.slip_weakening_distance = 0.02;
  const TabulatedJoint tabulated(joint);
  const JointState first = state_after(joint, {}, ContactStatus::sliding, 0.004);
  CHECK(first == JointState{true, 0.004});
  CHECK(state_after(joint, first, ContactStatus::sticking, 0.5) == first);
  const JointState second = state_after(joint, first, ContactStatus::sliding, 0.011);
  CHECK(second.slip == Approx(0.015).epsilon(rounding));
  const ContactStrength weak(tabulated, 0.5, second);  // three quarters are gone
  CHECK(weak.friction == Approx(0.475).epsilon(rounding));
  CHECK(weak.cohesion == Approx(0.25 * 1.5e4).epsilon(rounding));
  CHECK(weak.tension == 1e4);
  CHECK(can_lose_strength(joint, second));
  const JointState all = state_after(joint, second, ContactStatus::sliding, 0.005);
  CHECK_FALSE(all.bonded);
  CHECK_FALSE(can_lose_strength(joint, all));
  for (const JointState& broken : {all, state_after(joint, first, ContactStatus::open, 0.0)}) {
    const ContactStrength left(tabulated, 0.5, broken);
    CHECK(left.friction == Approx(0.4).epsilon(rounding));
    CHECK(left.cohesion == 0.0);
    CHECK(left.tension == 0.0);
    CHECK(state_after(joint, broken, ContactStatus::sliding, 1.0) == broken);
  }
  // A quarter more of the distance.
  CHECK(loss(joint, first, {true, 0.009}) == Approx(0.25).epsilon(rounding));
  CHECK(loss(joint, {true, 0.009}, first) == Approx(-0.25).epsilon(rounding));
  CHECK(loss(joint, second, all) == 1.0);
  CHECK(loss(joint, all, all) == 0.0);
  // Ductile cohesion stays.
  joint.cohesion_behaviour = CohesionBehaviour::ductile;
  CHECK(ContactStrength(TabulatedJoint(joint), 0.5, second).cohesion == 1.5e4);
  // Without a distance the first slip takes all, and is not counted.
  joint.slip_weakening_distance = 0.0;
  CHECK(state_after(joint, {}, ContactStatus::sliding, 1e-9) == JointState{false, 0.0});
  CHECK(loss(joint, {}, {true, 1.0}) == 0.0);
  CHECK(loss(joint, {}, {false, 0.0}) == 1.0);
}

TEST_CASE("without cohesion the shear strength is friction alone", "[law][shear_bound]") {
  const ContactStrength strength = strength_of(0.6);
  for (const double n : {0.0, 1e-9, 1.0, 1e6}) CHECK(strength.shear_bound(n).value == Approx(0.6 * n).epsilon(rounding));
  CHECK(strength.shear_bound(5.0).slope == Approx(0.6).epsilon(rounding));
}

TEST_CASE("cohesion comes in over a ramp, the lower of two lines", "[law][shear_bound]") {
  const double friction = GENERATE(0.0, 0.6), cohesion = GENERATE(0.0, 100.0, 3000.0), tension = GENERATE(0.0, 50.0, 1000.0);
  const ContactStrength strength = strength_of(friction, cohesion, tension);
  const double ramp = GENERATE(as<double>(), tolerance::cohesion_ramp, 1.0), steep = friction + 1.0 / ramp;
  const double scale = friction * 5000.0 + cohesion + steep * (5000.0 + tension);
  const auto limit = [&](double n) { return ShearLimit<double>(friction, cohesion, tension, n, ramp); };
  for (double n = -tension; n <= 5000.0; n += 7.3) {
    const double lower = std::max(0.0, std::min(friction * n + cohesion, steep * (n + tension)));
    CHECK(std::abs(limit(n).value - lower) <= rounding * scale);
    if (ramp == tolerance::cohesion_ramp) CHECK(strength.shear_bound(n).value == limit(n).value);
  }
  CHECK(limit(-tension).value <= rounding * scale);
  CHECK(limit(1e6).value == Approx(friction * 1e6 + cohesion).epsilon(rounding));
}

TEST_CASE("the shear strength is continuous and its slope is its derivative", "[law][shear_bound]") {
  const ContactStrength strength = strength_of(0.6, 800.0, 30.0);
  const double steep = 0.6 + 1.0 / tolerance::cohesion_ramp;
  const double kink = (800.0 - steep * 30.0) / (steep - 0.6);
  // Along a line the difference quotient is exact but for rounding: values of 1e3 N over 1e-3 N.
  const double h = 1e-3, quotient_rounding = 1e3 * rounding / h;
  double before = strength.shear_bound(-30.0).value;
  for (int i = 1; i <= 2000; ++i) {
    const double n = -30.0 + 0.1 * i;
    const auto bound = strength.shear_bound(n);
    CHECK(std::abs(bound.value - before) <= steep * 0.1 * (1.0 + 1e-9));
    if (std::abs(n - kink) > 2.0 * h) {
      const double quotient = (strength.shear_bound(n + h).value - strength.shear_bound(n - h).value) / (2.0 * h);
      CHECK(std::abs(bound.slope - quotient) <= quotient_rounding);
    }
    before = bound.value;
  }
  CHECK(strength.shear_bound(kink - 1.0).slope == Approx(steep).epsilon(rounding));
  CHECK(strength.shear_bound(kink + 1.0).slope == Approx(0.6).epsilon(rounding));
}

TEST_CASE("the spring-slider sticks, slides and opens", "[law][spring_slider]") {
  const ContactSprings springs = springs_under_load();
  const ContactStrength strength = strength_of(0.5);
  SECTION("sticking") {
    const ContactForces f = spring_slider(springs, strength, -0.2, 0.3);
    CHECK(f.status == ContactStatus::sticking);
    CHECK(f.normal == Approx(1200.0).epsilon(rounding));
    CHECK(f.shear == Approx(-120.0).epsilon(rounding));
    CHECK(f.normal_by_gap == -1000.0);
    CHECK(f.shear_by_gap == 0.0);
    CHECK(f.shear_by_slip == -400.0);
  }
  SECTION("sliding either way, against the motion") {
    const double way = GENERATE(-1.0, 1.0);
    const ContactForces f = spring_slider(springs, strength, 0.2, 3.0 * way);
    CHECK(f.status == ContactStatus::sliding);
    CHECK(f.normal == Approx(800.0).epsilon(rounding));
    CHECK(f.shear == Approx(-400.0 * way).epsilon(rounding));
    CHECK(f.normal_by_gap == -1000.0);
    CHECK(f.shear_by_gap == Approx(500.0 * way).epsilon(rounding));
    CHECK(f.shear_by_slip == 0.0);
  }
  SECTION("open") {
    const double opening = GENERATE(1.0, 1.5);
    const ContactForces f = spring_slider(springs, strength, opening, 0.3);
    CHECK(f.status == ContactStatus::open);
    CHECK(f.normal == 0.0);
    CHECK(f.shear == 0.0);
    CHECK(f.normal_by_gap == 0.0);
    CHECK(f.shear_by_gap == 0.0);
    CHECK(f.shear_by_slip == 0.0);
  }
}

TEST_CASE("target, shift and initial shear displace the springs", "[law][spring_slider]") {
  ContactSprings springs = springs_under_load();
  springs.target = -0.4;
  springs.shift = 70.0;
  springs.initial_shear = 90.0;
  const ContactForces f = spring_slider(springs, strength_of(10.0), 0.1, 0.05);
  CHECK(f.status == ContactStatus::sticking);
  CHECK(f.normal == Approx(70.0 + 1000.0 * 0.5).epsilon(rounding));
  CHECK(f.shear == Approx(90.0 - 400.0 * 0.05).epsilon(rounding));
}

TEST_CASE("the stuck shear force may be the strength itself, not more", "[law][spring_slider]") {
  ContactSprings springs = springs_under_load();
  const ContactStrength strength = strength_of(0.5);
  springs.initial_shear = strength.shear_bound(1000.0).value;
  CHECK(spring_slider(springs, strength, 0.0, 0.0).status == ContactStatus::sticking);
  CHECK(spring_slider(springs, strength, 0.0, -1e-9).status == ContactStatus::sliding);
  CHECK(spring_slider(springs, strength, 0.0, 1e-9).status == ContactStatus::sticking);
}

TEST_CASE("a contact with tensile strength pulls until the cut-off", "[law][spring_slider]") {
  const ContactSprings springs = springs_under_load();
  const ContactStrength strength = strength_of(0.5, 0.0, 250.0);
  CHECK(spring_slider(springs, strength, 1.2, 0.0).normal == Approx(-200.0).epsilon(rounding * 10.0));
  CHECK(spring_slider(springs, strength, 1.2, 0.0).status == ContactStatus::sticking);
  CHECK(spring_slider(springs, strength, 1.249, 0.0).normal == Approx(-249.0).epsilon(rounding * 10.0));
  CHECK(spring_slider(springs, strength, 1.251, 0.0).normal == 0.0);
  CHECK(spring_slider(springs, strength, 1.251, 0.0).status == ContactStatus::open);
  // Without it the same contact opens at zero.
  CHECK(spring_slider(springs, strength_of(0.5), 1.2, 0.0).status == ContactStatus::open);
}

TEST_CASE("without tensile strength forces are continuous across open, stick and slip", "[law][spring_slider]") {
  ContactSprings springs = springs_under_load();
  springs.initial_shear = 35.0;
  const ContactStrength strength = strength_of(0.6, GENERATE(0.0, 400.0));
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> change(-2.0, 2.0), small(-1e-4, 1e-4);
  const double steep = strength.friction + 1.0 / tolerance::cohesion_ramp;
  std::array<int, 3> seen{};
  int changed = 0;
  for (int i = 0; i < 20000; ++i) {
    const double g = i % 2 == 0 ? 1.0 + small(generator) : change(generator), s = change(generator);
    const double dg = small(generator), ds = small(generator);
    const ContactForces f = spring_slider(springs, strength, g, s), near = spring_slider(springs, strength, g + dg, s + ds);
    const double slack = 1e4 * rounding;
    CHECK(std::abs(near.normal - f.normal) <= springs.normal * std::abs(dg) + slack);
    CHECK(std::abs(near.shear - f.shear) <= springs.shear * std::abs(ds) + steep * springs.normal * std::abs(dg) + slack);
    ++seen[static_cast<std::size_t>(f.status)];
    changed += f.status != near.status ? 1 : 0;
  }
  CHECK(*std::min_element(seen.begin(), seen.end()) > 500);
  CHECK(changed > 500);
}

TEST_CASE("derivatives of the spring-slider are its difference quotients", "[law][spring_slider]") {
  ContactSprings springs = springs_under_load();
  springs.initial_shear = -20.0;
  const ContactStrength strength = strength_of(0.6, 400.0, GENERATE(0.0, 60.0));
  std::mt19937 generator(10);
  std::uniform_real_distribution<double> change(-2.0, 2.0), near_opening(0.9, 1.1);
  // The law is made of straight pieces: the quotient is exact but for rounding (forces up to 1e4 N).
  const double h = 1e-5, quotient_rounding = 1e4 * rounding / h;
  std::array<int, 3> compared{};
  int on_ramp = 0;
  for (int i = 0; i < 4000; ++i) {
    const double g = i % 2 == 0 ? near_opening(generator) : change(generator), s = change(generator);
    const ContactForces f = spring_slider(springs, strength, g, s);
    const ContactForces g1 = spring_slider(springs, strength, g - h, s), g2 = spring_slider(springs, strength, g + h, s);
    const ContactForces s1 = spring_slider(springs, strength, g, s - h), s2 = spring_slider(springs, strength, g, s + h);
    const auto slope = [&](const ContactForces& at) { return strength.shear_bound(at.normal).slope; };
    const bool kink = g1.status != f.status || g2.status != f.status || s1.status != f.status || s2.status != f.status || slope(g1) != slope(g2);
    if (kink) continue;
    CHECK(std::abs(f.normal_by_gap - (g2.normal - g1.normal) / (2.0 * h)) <= quotient_rounding);
    CHECK(std::abs(f.shear_by_gap - (g2.shear - g1.shear) / (2.0 * h)) <= quotient_rounding);
    CHECK(std::abs(f.shear_by_slip - (s2.shear - s1.shear) / (2.0 * h)) <= quotient_rounding);
    ++compared[static_cast<std::size_t>(f.status)];
    on_ramp += f.status == ContactStatus::sliding && slope(f) > 1.0 ? 1 : 0;
  }
  CHECK(*std::min_element(compared.begin(), compared.end()) > 200);
  CHECK(on_ramp > 50);
}

TEST_CASE("the tangent of a status is the one the spring-slider has there", "[law][tangent_for_status]") {
  const ContactSprings springs = springs_under_load();
  const ContactStrength strength = strength_of(0.6, 400.0, 60.0);
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> change(-2.0, 2.0);
  std::array<int, 3> seen{};
  for (int i = 0; i < 2000; ++i) {
    const ContactForces f = spring_slider(springs, strength, change(generator), change(generator));
    const ContactForces tangent = tangent_for_status(springs, strength, f.status, f.normal, f.shear);
    CHECK(tangent.status == f.status);
    CHECK(tangent.normal_by_gap == f.normal_by_gap);
    CHECK(tangent.shear_by_gap == f.shear_by_gap);
    CHECK(tangent.shear_by_slip == f.shear_by_slip);
    ++seen[static_cast<std::size_t>(f.status)];
  }
  CHECK(*std::min_element(seen.begin(), seen.end()) > 100);
}

TEST_CASE("a prolonged law is straight, and the law itself where its status holds", "[law][prolonged]") {
  const ContactSprings springs = springs_under_load();
  const ContactStrength strength = strength_of(0.6, 400.0, 60.0);
  std::mt19937 generator(12);
  std::uniform_real_distribution<double> change(-2.0, 2.0);
  int pulling = 0, beyond_strength = 0;
  for (int i = 0; i < 2000; ++i) {
    const double gap = change(generator), slip = change(generator);
    const ContactForces f = spring_slider(springs, strength, gap, slip);
    const auto same = [&](double g, double s) { return prolonged(springs, strength, f.status, f.normal, f.shear, g, s); };
    const ContactForces here = same(gap, slip);
    CHECK(here.normal == Approx(f.normal).margin(1e-9));
    CHECK(here.shear == Approx(f.shear).margin(1e-9));
    const double dg = change(generator), ds = change(generator);
    const ContactForces there = same(gap + dg, slip + ds);
    CHECK(there.normal == Approx(f.normal + f.normal_by_gap * dg).margin(1e-9));
    CHECK(there.shear == Approx(f.shear + f.shear_by_gap * dg + f.shear_by_slip * ds).margin(1e-9));
    CHECK(there.normal_by_gap == f.normal_by_gap);
    pulling += f.status == ContactStatus::sliding && there.normal < -60.0 ? 1 : 0;
    beyond_strength += f.status == ContactStatus::sticking && std::abs(there.shear) > strength.largest_shear(there.normal) ? 1 : 0;
  }
  CHECK(pulling > 20);
  CHECK(beyond_strength > 50);
}

namespace {

ContactSprings damped_springs() {
  ContactSprings springs = springs_under_load();
  springs.normal_damping = 700.0;
  springs.shear_damping = 300.0;
  return springs;
}

}  // namespace

TEST_CASE("dashpots have the critical damping of one mass on the joint's spring times the ratio", "[law][damping]") {
  JointProperties joint = joint_with(0.5, 0.0, 0.0);
  joint.damping_ratio = 0.3;
  const ContactDashpots c(joint, 0.25, 900.0);
  CHECK(c.normal == Approx(0.6 * std::sqrt(1e9 * 0.25 * 900.0)).epsilon(rounding));
  CHECK(c.shear == Approx(0.6 * std::sqrt(4e8 * 0.25 * 900.0)).epsilon(rounding));
}

TEST_CASE("dashpots resist while the contact is closed", "[law][damping]") {
  const ContactSprings springs = damped_springs();
  const ContactStrength strength = strength_of(0.5);
  SECTION("closing further and sticking") {
    const ContactForces f = spring_slider(springs, strength, -0.2, 0.3);
    CHECK(f.elastic_normal == Approx(1200.0).epsilon(rounding));
    CHECK(f.normal == Approx(1200.0 + 140.0).epsilon(rounding));
    CHECK(f.elastic_shear == Approx(-120.0).epsilon(rounding));
    CHECK(f.shear == Approx(-120.0 - 90.0).epsilon(rounding));
  }
  SECTION("friction is bounded by the whole normal force, the memory keeps the spring's part") {
    const ContactForces f = spring_slider(springs, strength, -0.2, 1.2);
    CHECK(f.status == ContactStatus::sliding);
    CHECK(f.shear == Approx(-0.5 * 1340.0).epsilon(rounding));
    CHECK(f.elastic_shear == Approx(-480.0).epsilon(rounding));
    CHECK(spring_slider(springs, strength, -0.2, 3.0).elastic_shear == Approx(-0.5 * 1340.0).epsilon(rounding));
  }
  SECTION("only from where the faces touch") {
    ContactSprings open = damped_springs();
    open.gap = 0.4;
    const ContactForces f = spring_slider(open, strength, -0.6, 0.0);
    CHECK(f.normal == Approx(200.0 + 0.2 * 700.0).epsilon(10.0 * rounding));
    CHECK(spring_slider(open, strength, -0.3, 0.0).normal == 0.0);
  }
  SECTION("without pulling: unloaded too fast a contact carries nothing, yet is not open") {
    const ContactForces f = spring_slider(springs, strength, 0.9, 0.1);
    CHECK(f.normal == 0.0);
    CHECK(f.shear == 0.0);
    CHECK(f.elastic_normal == Approx(100.0).epsilon(10.0 * rounding));
    CHECK(f.elastic_shear == 0.0);
    CHECK(f.status != ContactStatus::open);
    CHECK(f.normal_by_gap == 0.0);
  }
  SECTION("as long as the spring pulls") {
    ContactSprings pulling = damped_springs();
    pulling.gap = 0.1;
    const ContactForces f = spring_slider(pulling, strength_of(0.5, 0.0, 250.0), 0.05, 0.0);
    CHECK(f.elastic_normal == Approx(-150.0).epsilon(10.0 * rounding));
    CHECK(f.normal == Approx(-150.0 - 0.05 * 700.0).epsilon(10.0 * rounding));
  }
  SECTION("down to the tensile strength") {
    const ContactStrength tough = strength_of(0.5, 0.0, 250.0);
    CHECK(spring_slider(springs, tough, 1.2, 0.0).normal == -250.0);
    CHECK(spring_slider(springs, tough, 1.2, 0.0).elastic_normal == Approx(-200.0).epsilon(10.0 * rounding));
  }
}

TEST_CASE("damped forces are continuous, and their derivatives are their difference quotients", "[law][damping]") {
  ContactSprings springs = damped_springs();
  springs.initial_shear = -20.0;
  springs.gap = GENERATE(-1.0, 0.3);
  const double tension = GENERATE(0.0, 60.0);
  const ContactStrength strength = strength_of(0.6, 400.0, tension);
  std::mt19937 generator(12);
  std::uniform_real_distribution<double> change(-2.0, 2.0), small(-1e-4, 1e-4);
  const double h = 1e-5, quotient_rounding = 2e4 * rounding / h;
  const double steep = strength.friction + 1.0 / tolerance::cohesion_ramp, stiffness = springs.normal + springs.normal_damping;
  int compared = 0, carrying_nothing = 0;
  for (int i = 0; i < 8000; ++i) {
    const double g = change(generator), s = change(generator), dg = small(generator), ds = small(generator);
    const ContactForces f = spring_slider(springs, strength, g, s), near = spring_slider(springs, strength, g + dg, s + ds);
    if (tension == 0.0) {
      const double slack = 1e4 * rounding, shear_slope = springs.shear + springs.shear_damping;
      CHECK(std::abs(near.normal - f.normal) <= stiffness * std::abs(dg) + slack);
      CHECK(std::abs(near.shear - f.shear) <= shear_slope * std::abs(ds) + steep * stiffness * std::abs(dg) + slack);
      CHECK(std::abs(near.elastic_shear - f.elastic_shear) <= springs.shear * std::abs(ds) + steep * stiffness * std::abs(dg) + slack);
    }
    const ContactForces g1 = spring_slider(springs, strength, g - h, s), g2 = spring_slider(springs, strength, g + h, s);
    const ContactForces s1 = spring_slider(springs, strength, g, s - h), s2 = spring_slider(springs, strength, g, s + h);
    const auto piece = [&](const ContactForces& at) { return std::tuple(at.status, at.normal_by_gap, strength.shear_bound(at.normal).slope); };
    const bool kink = piece(g1) != piece(f) || piece(g2) != piece(f) || piece(s1) != piece(f) || piece(s2) != piece(f);
    if (kink) continue;
    CHECK(std::abs(f.normal_by_gap - (g2.normal - g1.normal) / (2.0 * h)) <= quotient_rounding);
    CHECK(std::abs(f.shear_by_gap - (g2.shear - g1.shear) / (2.0 * h)) <= quotient_rounding);
    CHECK(std::abs(f.shear_by_slip - (s2.shear - s1.shear) / (2.0 * h)) <= quotient_rounding);
    ++compared;
    carrying_nothing += f.status != ContactStatus::open && f.normal == -tension ? 1 : 0;
  }
  CHECK(compared > 4000);
  if (springs.gap < 0.0) CHECK(carrying_nothing > 100);
}

TEST_CASE("forces at points of a joint tell the stress along it as in a beam: N/A + M (x - x0)/I", "[law]") {
  SECTION("held at its two ends") {
    constexpr double length = 3.0, normal = 5e3, moment = -7e3;
    const std::array parts = {PartOfJoint{1.0, 2.5, 1.0, 0.5 * normal - moment / length}, PartOfJoint{2.5, 4.0, 4.0, 0.5 * normal + moment / length}};
    const LinearStress stress(parts);
    CHECK(stress.at(4.0) == Approx(normal / length + 6.0 * moment / (length * length)));
    CHECK(stress.at(1.0) == Approx(normal / length - 6.0 * moment / (length * length)));
  }
  SECTION("of unequal parts with a hole between them") {
    // 0 to 1 and 3 to 5: A = 3, x0 = 17/6, I = 1/12 + (7/3)^2 + 8/12 + 2 (7/6)^2.
    const std::array parts = {PartOfJoint{0.0, 1.0, 0.0, 30.0}, PartOfJoint{3.0, 5.0, 4.0, -60.0}};
    const double middle = 17.0 / 6.0, inertia = 1.0 / 12.0 + 49.0 / 9.0 + 8.0 / 12.0 + 2.0 * 49.0 / 36.0;
    const double moment = 30.0 * (0.0 - middle) - 60.0 * (4.0 - middle);
    const LinearStress stress(parts);
    CHECK(stress.at(middle) == Approx(-10.0));
    CHECK(stress.at(5.0) == Approx(-10.0 + moment * (5.0 - middle) / inertia));
  }
  SECTION("what is left holds at its edge alone") {
    const std::array parts = {PartOfJoint{0.0, 2.0, 0.0, -1.0}};
    const LinearStress stress(parts);
    CHECK(stress.at(0.0) == Approx(-0.5 - 1.5));
    CHECK(stress.at(2.0) == Approx(-0.5 + 1.5));
  }
}
