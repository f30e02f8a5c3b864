// What a contact remembers, and how it is passed on.
#include <cmath>

#include "contacts.h"
#include "openclose/core/tolerance.h"
#include "support/catch.h"

using namespace openclose;
using namespace openclose::test;

namespace {

/// 10 m wide; a vertex (3) in the middle of the top, whose edges are those from 2 (right of it) and 3 (left of it).
BlockInput base_with_seam() {
  return fixed_block("base", {{-5.0, -1.0}, {5.0, -1.0}, {5.0, 0.0}, {0.0, 0.0}, {-5.0, 0.0}});
}

void load(Contact& contact) {
  contact.status = ContactStatus::sliding;
  contact.bonded = true;
  contact.elastic_slip = 0.25;
  contact.normal_force = 3.0;
  contact.shear_force = -2.0;
  contact.stored_energy = 7.0;
}

void check_loaded(const Contact* contact) {
  REQUIRE(contact != nullptr);
  CHECK(contact->status == ContactStatus::sliding);
  CHECK(contact->bonded);
  CHECK(contact->elastic_slip == 0.25);
  CHECK(contact->normal_force == 3.0);
  CHECK(contact->shear_force == -2.0);
  CHECK(contact->stored_energy == 7.0);
}

void check_new(const Contact* contact) {
  REQUIRE(contact != nullptr);
  CHECK(contact->status == ContactStatus::open);
  CHECK_FALSE(contact->bonded);
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
    CHECK(c.bonded == (gap <= tolerance::deepest_initial_overlap_m));
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
  d.move(2, 4.0, 2.0 * std::tan(slope));
  d.update();
  REQUIRE(d.contacts.size() == 1);
  if (slope < 15.0 * degree) {
    check_loaded(d.find(8, 4 + 2));
  } else {
    check_new(d.find(8, 4 + 2));
  }
}

TEST_CASE("history follows when the end of an overlap changes hands", "[contact][history]") {
  // Block's lower right corner (5) on the base's top (2) before, base's corner (2) under the block's bottom (4) after; and back.
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 6.0, 1.0)), free_block("block", rectangle(-0.01, 0.0, 1.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  load(*d.find(5, 2));
  d.move(1, 0.02, 0.0);
  d.update();
  REQUIRE(d.contacts.size() == 2);
  check_loaded(d.find(2, 4));
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
