// What a contact remembers, and how it is passed on.
#include <cmath>
#include <limits>
#include <utility>

#include "contacts.h"
#include "openclose/contact/history.h"
#include "openclose/contact/kinematics.h"
#include "openclose/core/tolerance.h"
#include "support/catch.h"

using namespace openclose;
using namespace openclose::test;

namespace {

/// 10 m wide; a vertex (3) in the middle of the top, whose edges are those from 2 (right of it) and 3 (left of it).
BlockInput base_with_seam() {
  return fixed_block("base", {{-5.0, -1.0}, {5.0, -1.0}, {5.0, 0.0}, {0.0, 0.0}, {-5.0, 0.0}});
}

constexpr double bonded_length = 1e-12;  // [m] no contact is shorter

void load(Contact& contact) {
  contact.status = ContactStatus::sliding;
  contact.joint_state = {true, 0.125, 0.75, bonded_length};
  contact.elastic_slip = 0.25;
  contact.normal_force = 3.0;
  contact.shear_force = -2.0;
  contact.stored_energy = 7.0;
}

/// \param shorter  [-] by which its tributary length has become so
void check_loaded(const Contact* contact, double shorter = 1.0) {
  REQUIRE(contact != nullptr);
  CHECK(contact->status == ContactStatus::sliding);
  CHECK(contact->joint_state == JointState{true, 0.125, 0.75, bonded_length});
  CHECK(contact->elastic_slip == Approx(0.25 * std::sqrt(shorter)).epsilon(1e-12));
  CHECK(contact->normal_force == 3.0);
  CHECK(contact->shear_force == -2.0);
  CHECK(contact->stored_energy == 7.0);
}

void check_new(const Contact* contact) {
  REQUIRE(contact != nullptr);
  CHECK(contact->status == ContactStatus::open);
  CHECK_FALSE(contact->joint_state.bonded);
  CHECK(contact->elastic_slip == 0.0);
  CHECK(contact->normal_force == 0.0);
  CHECK(contact->shear_force == 0.0);
  CHECK(contact->stored_energy == 0.0);
}

}  // namespace

TEST_CASE("a contact that lives on keeps its history and gets the new geometry", "[contact][history]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))}));
  load(*d.find(4, 2));
  d.move(1, 0.3, -1e-5);
  d.update();
  REQUIRE(d.contacts.size() == 2);
  check_loaded(d.find(4, 2));
  CHECK(d.find(4, 2)->gap == Approx(-1e-5).epsilon(1e-9));
  CHECK(d.find(5, 2)->elastic_slip == 0.0);
  CHECK(d.detector.counters().transfers == 0);
}

TEST_CASE("only what touches at the start is bonded", "[contact][history]") {
  const double gap = GENERATE(0.0, 9e-4, 1.1e-3, 0.04);
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, gap, 2.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  for (const Contact& c : d.contacts) {
    CHECK(c.joint_state.bonded == (gap <= tolerance::deepest_initial_overlap_m));
    CHECK(c.status == ContactStatus::open);
  }
}

TEST_CASE("what comes within reach later is not bonded", "[contact][history]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 8.0, 1.0)), fixed_block("wall", rectangle(3.0, -1.0, 1.0, 3.0)),
                          free_block("block", rectangle(0.5, 0.0, 2.0, 1.0))}));
  for (Contact& c : d.contacts) load(c);
  CHECK(d.contacts.size() == 2);
  d.move(2, 0.499, 0.0);
  d.update();
  REQUIRE(d.contacts.size() == 4);
  check_new(d.find(8 + 1, 4 + 3));
  check_new(d.find(8 + 2, 4 + 3));
  check_loaded(d.find(8 + 0, 2));
  check_loaded(d.find(8 + 1, 2));
}

TEST_CASE("a contact that was away comes back as a new one", "[contact][history]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))}));
  for (Contact& c : d.contacts) load(c);
  d.move(1, 0.0, 1.0);
  CHECK(d.update().empty());
  d.move(1, 0.0, -1.0);
  d.update();
  REQUIRE(d.contacts.size() == 2);
  for (const Contact& c : d.contacts) check_new(&c);
}

TEST_CASE("a lone corner takes its history from block to block", "[contact][history]") {
  Detection d(scene_with({fixed_block("left", rectangle(-5.0, -1.0, 5.0, 1.0)), fixed_block("right", rectangle(0.0, -1.0, 5.0, 1.0)),
                          free_block("block", placed(rectangle(0.0, 0.0, 1.0, 1.0), 45.0 * degree, {-0.01, 0.0}))}));
  // Beside it only the corners of the two blocks are within reach of its sides.
  REQUIRE(d.find(8, 2) != nullptr);
  load(*d.find(8, 2));
  d.move(2, 0.02, 0.0);
  d.update();
  CHECK(d.find(8, 2) == nullptr);
  check_loaded(d.find(8, 4 + 2));
}

TEST_CASE("a corner does not take its history to an edge of another direction", "[contact][history]") {
  // From the floor to a ramp of 16 or 14 degrees that rises from 2 m on.
  const double slope = GENERATE(16.0, 14.0) * degree;
  Detection d(scene_with({fixed_block("floor", rectangle(-5.0, -1.0, 6.0, 1.0)),
                          fixed_block("ramp", placed(rectangle(0.0, -1.0, 5.0, 1.0), slope, {2.0, 0.0})),
                          free_block("block", placed(rectangle(0.0, 0.0, 1.0, 1.0), 45.0 * degree))}));
  REQUIRE(d.contacts.size() == 1);
  load(*d.find(8, 2));
  const double length = d.length(8, 2);
  d.move(2, 4.0, 2.0 * std::tan(slope));
  d.update();
  REQUIRE(d.contacts.size() == 1);
  if (slope < 15.0 * degree) {
    check_loaded(d.find(8, 4 + 2), length / d.length(8, 4 + 2));
  } else {
    check_new(d.find(8, 4 + 2));
  }
}

TEST_CASE("history follows when the end of an overlap changes hands", "[contact][history]") {
  // Block's lower right corner (5) on the base's top (2) before, base's corner (2) under the block's bottom (4) after; and back.
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 6.0, 1.0)), free_block("block", rectangle(-0.01, 0.0, 1.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  load(*d.find(5, 2));
  const double length = d.length(5, 2);
  d.move(1, 0.02, 0.0);
  d.update();
  REQUIRE(d.contacts.size() == 2);
  check_loaded(d.find(2, 4), length / d.length(2, 4));
  CHECK(d.find(4, 2)->elastic_slip == 0.0);
  CHECK(d.detector.counters().transfers == 1);
  d.move(1, -0.02, 0.0);
  d.update();
  check_loaded(d.find(5, 2));
  CHECK(d.detector.counters().transfers == 2);
}

TEST_CASE("when an overlap is divided by a seam the longer contact inherits", "[contact][history]") {
  // The block's right corner (6) passes the seam (3): most of its length is now the seam's, under the block's bottom (5).
  Detection d(scene_with({base_with_seam(), free_block("block", rectangle(-1.01, 0.0, 1.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  load(*d.find(6, 3));
  d.move(1, 0.02, 0.0);
  d.update();
  REQUIRE(d.contacts.size() == 3);
  check_loaded(d.find(3, 5));
  check_new(d.find(6, 2));
  CHECK(d.find(3, 5)->length == Approx(0.5).epsilon(1e-12));
  CHECK(d.find(6, 2)->length == Approx(0.005).epsilon(1e-9));
}

TEST_CASE("forces of rigid contacts keep their pressure, but for those that have just begun", "[contact][history]") {
  // Of the length and of the force, where contacts are rigid.
  const auto [length, force] =
      GENERATE(std::pair(1.5, 1.5), std::pair(0.6, 0.6), std::pair(3.0, most_change_of_length), std::pair(0.2, 1.0 / most_change_of_length));
  Contact from, rigid, elastic;
  load(from);
  from.length = 0.01;
  rigid.length = elastic.length = length * from.length;
  inherit(from, -1e-6, InheritedForces::at_same_pressure, rigid);
  CHECK(rigid.normal_force == Approx(3.0 * force).epsilon(1e-12));
  CHECK(rigid.shear_force == Approx(-2.0 * force).epsilon(1e-12));
  inherit(from, -1e-6, InheritedForces::as_they_were, elastic);
  CHECK(elastic.normal_force == 3.0);
  CHECK(elastic.shear_force == -2.0);
}

TEST_CASE("one history is not inherited twice, nor from a contact that lives on", "[contact][history]") {
  Detection d(scene_with({base_with_seam(), free_block("block", rectangle(-1.01, 0.0, 1.0, 1.0))}));
  load(*d.find(6, 3));
  d.move(1, 0.02, 0.0);
  d.update();
  int loaded = 0;
  for (const Contact& c : d.contacts) loaded += c.elastic_slip == 0.25 ? 1 : 0;
  CHECK(loaded == 1);
  d.move(1, 0.02, 0.0);
  d.update();
  check_new(d.find(6, 2));
  CHECK(d.detector.counters().transfers == 1);
}

TEST_CASE("a deep contact that carries load is kept", "[contact][history]") {
  // Deeper than the slab is thick, which only its history makes believable.
  Detection d(scene_with({fixed_block("slab", rectangle(-5.0, -0.002, 10.0, 0.002)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))}));
  for (Contact& c : d.contacts) load(c);
  d.move(1, 0.0, -0.003);
  d.update();
  REQUIRE(d.contacts.size() == 2);
  check_loaded(d.find(4, 2));
  for (Contact& c : d.contacts) c.status = ContactStatus::open;
  CHECK(d.update().empty());
}

TEST_CASE("pairs that are redone at different times still pass history on", "[contact][history]") {
  // The block's corner (8) crosses the seam between the tops of the left (2) and the right block (6).
  Detection d(scene_with({fixed_block("left", rectangle(-5.0, -1.0, 5.0, 1.0)), free_block("right", rectangle(0.0, -1.0, 5.0, 1.0)),
                          free_block("block", placed(rectangle(0.0, 0.0, 1.0, 1.0), 45.0 * degree, {-1.0e-3, 0.0}))}),
              0.05, {});
  REQUIRE(d.find(8, 2) != nullptr);
  load(*d.find(8, 2));
  const double part = 0.6 * tolerance::contact_skin_m;
  d.move(2, part, 0.0);
  d.update();
  // The right block goes and comes back, so that what the left one has to do with the block is half done and what the right one has is not.
  for (const double way : {3.0, -3.0}) {
    d.move(1, way * part, 0.0);
    d.update();
  }
  for (int step = 0; step < 3; ++step) {
    d.move(2, part, 0.0);
    d.update();
  }
  CHECK(d.find(8, 2) == nullptr);
  check_loaded(d.find(8, 4 + 2));
}

namespace {

/// [J] over a stiffness of 1 Pa/m.
double normal_energy(const Contact& c, double stretch) {
  return 0.5 * c.length * stretch * stretch;
}
double shear_energy(const Contact& c) {
  return 0.5 * c.length * c.elastic_slip * c.elastic_slip;
}

}  // namespace

TEST_CASE("a spring that changes its length keeps its energy, or loses some, and never closes more than there is", "[contact][history]") {
  const double length_before = GENERATE(1e-9, 0.3, 1.0, 4.0), length = GENERATE(1e-9, 0.3, 1.0, 4.0);
  const double stretch = GENERATE(-2.0, -1e-3, -1e-9), gap = GENERATE(-3.0, -1e-3, 0.0, 0.2);
  Contact before, now;
  load(before);
  before.length = length_before;
  now.length = length;
  now.gap = gap;
  inherit(before, stretch, InheritedForces::as_they_were, now);
  CHECK(now.rest_gap <= std::max(0.0, gap));
  // The stretch is the difference of two gaps.
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(gap), of_same_energy = stretch * std::sqrt(length_before / length);
  CHECK(now.stretch() == Approx(std::max(of_same_energy, std::min(0.0, gap))).epsilon(1e-12).margin(rounding));
  CHECK(normal_energy(before, stretch) == Approx(normal_energy(now, of_same_energy)).epsilon(1e-12));
  CHECK(shear_energy(now) == Approx(shear_energy(before)).epsilon(1e-12));
}

TEST_CASE("lengths that change to and fro leave a spring as it was", "[contact][history]") {
  Contact c;
  load(c);
  c.length = 1.0;
  c.gap = -1.0;
  for (const double length : {0.5, 3.0, 1e-3, 1.0}) {
    Contact next;
    next.length = length;
    next.gap = -100.0;  // deep enough for all of them
    inherit(c, c.stretch(), InheritedForces::as_they_were, next);
    c = next;
  }
  CHECK(c.stretch() == Approx(-1.0).epsilon(1e-12));
  CHECK(c.elastic_slip == Approx(0.25).epsilon(1e-12));
}

TEST_CASE("contacts of a drawing are bonded along what touches there, however they grow", "[contact][history]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 5.8, 1.0)), free_block("block", rectangle(0.0, 0.0, 1.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  for (const Contact& c : d.contacts) CHECK(c.joint_state.bonded_length == Approx(0.4).epsilon(1e-9));
  d.move(1, -0.5, 0.0);
  d.update();
  for (const Contact& c : d.contacts) {
    CHECK(c.length == Approx(0.5).epsilon(1e-9));
    if (c.joint_state.bonded) CHECK(c.joint_state.bonded_length == Approx(0.4).epsilon(1e-9));
  }
}

TEST_CASE("what has slid off a face is not bonded when it comes back", "[contact][history]") {
  Contact c;
  load(c);
  c.length = 1.0;
  c.joint_state.joined = 0.8;
  c.joint_state.bonded_length = 0.8;
  for (const double length : {0.5, 1.5, 1.0}) {
    Contact next;
    next.length = length;
    inherit(c, c.stretch(), InheritedForces::as_they_were, next);
    c = next;
  }
  CHECK(c.joint_state.joined == 0.8);
  CHECK(c.joint_state.bonded_length == Approx(0.4).epsilon(1e-12));
}

TEST_CASE("a spring that pulls never gains energy by its length", "[contact][history]") {
  const double length = GENERATE(0.1, 1.0, 7.0), gap = GENERATE(1e-4, 2e-4);
  Contact before, now;
  load(before);
  before.length = 1.0;
  now.length = length;
  now.gap = gap;
  inherit(before, 2e-4, InheritedForces::as_they_were, now);
  CHECK(now.stretch() > 0.0);
  CHECK(normal_energy(now, now.stretch()) <= normal_energy(before, 2e-4) * (1.0 + 1e-12));
}

TEST_CASE("an open contact begins to carry where it is, at most at gap zero", "[contact][history]") {
  const double gap = GENERATE(-0.3, 0.0, 0.1);
  Contact before, now;
  before.length = now.length = 1.0;
  now.gap = gap;
  inherit(before, 1e-5, InheritedForces::as_they_were, now);
  CHECK(now.rest_gap == std::min(0.0, gap));
}

TEST_CASE("what is found deep in a block is born without force, in the drawing with it", "[contact][history]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, -5e-4, 2.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  for (const Contact& c : d.contacts) CHECK(c.stretch() == c.gap);
  d.move(1, 0.0, 1.0);
  CHECK(d.update().empty());
  d.move(1, 0.0, -1.01);
  d.update();
  REQUIRE(d.contacts.size() == 2);
  for (const Contact& c : d.contacts) {
    CHECK(c.gap < -0.01);
    CHECK(c.stretch() == 0.0);
  }
}

TEST_CASE("springs follow the positions, but open ones only where somebody has moved the blocks", "[contact][history]") {
  const bool loaded = GENERATE(false, true), others = GENERATE(false, true);
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 5e-4, 2.0, 1.0))}));
  for (Contact& c : d.contacts) {
    if (loaded) load(c);
  }
  d.move(1, 0.0, -6e-4);
  if (others) d.detector.forget();
  d.update();
  REQUIRE(d.contacts.size() == 2);
  for (const Contact& c : d.contacts) {
    CHECK(c.gap == Approx(-1e-4));
    CHECK(c.stretch() == Approx(loaded || others ? -1e-4 : 0.0));
  }
}

TEST_CASE("however a block moves, finding its contacts anew adds no energy", "[contact][history]") {
  Detection d(
      scene_with({fixed_block("base", rectangle(-5.0, -1.0, 5.0, 1.0)), free_block("block", placed(rectangle(-1.5, -5e-4, 2.0, 1.0), 0.11))}));
  for (Contact& c : d.contacts) load(c);
  const auto energy = [&] {
    double sum = 0.0;
    for (const Contact& c : d.contacts) sum += normal_energy(c, std::min(0.0, c.stretch())) + shear_energy(c);
    return sum;
  };
  double largest_loss = 0.0;
  for (int step = 0; step < 100; ++step) {
    const double turn = step % 2 == 0 ? 0.02 : -0.015;
    d.move(1, 0.013, 0.0, turn);
    for (Contact& c : d.contacts) {
      const ContactStart at(d.system, c);
      c.gap = at.normal.dot(at.lever);
    }
    const double before = energy();
    d.update();
    const double now = energy();
    CHECK(now <= before * (1.0 + 1e-12));
    largest_loss = std::max(largest_loss, 1.0 - now / before);
  }
  CHECK(largest_loss > 1e-3);  // lengths did change
}
