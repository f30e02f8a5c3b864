// Searching only when something has moved beyond the skin must not change what is found.
#include <random>

#include "contacts.h"
#include "openclose/core/tolerance.h"
#include "support/catch.h"

using namespace openclose;
using test::degree;
using test::Detection;
using test::fixed_block;
using test::free_block;
using test::placed;
using test::rectangle;
using test::scene_with;

namespace {

void require_same(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool same = a[i].vertex_block == b[i].vertex_block && a[i].vertex == b[i].vertex && a[i].edge_block == b[i].edge_block &&
                      a[i].edge == b[i].edge && a[i].joint == b[i].joint && a[i].length == b[i].length && a[i].gap == b[i].gap &&
                      a[i].bonded == b[i].bonded && a[i].elastic_slip == b[i].elastic_slip;
    REQUIRE(same);
  }
}

/// A floor of fixed blocks with gaps and steps, and free blocks of several shapes above it.
Scene rough_floor() {
  Scene scene = test::empty_scene();
  for (int i = 0; i < 12; ++i) scene.blocks.push_back(fixed_block("floor", rectangle(1.1 * i, -1.0 + 0.02 * (i % 3), 1.0, 1.0)));
  scene.blocks.push_back(free_block("cube", rectangle(0.3, 0.05, 1.0, 1.0)));
  scene.blocks.push_back(free_block("wedge", placed({{0.0, 0.0}, {1.0, 0.0}, {0.2, 0.9}}, 0.2, {2.0, 0.1})));
  scene.blocks.push_back(free_block("l", placed({{0.0, 0.0}, {2.0, 0.0}, {2.0, 0.5}, {0.5, 0.5}, {0.5, 1.5}, {0.0, 1.5}}, -0.1, {4.0, 0.3})));
  return scene;
}

}  // namespace

TEST_CASE("skipping searches changes nothing while blocks move far", "[contact][search]") {
  const Scene scene = rough_floor();
  const double reach = GENERATE(0.01, 0.2);
  Detection skipping(scene, reach, true), searching(scene, reach, false);
  std::mt19937 generator(14);
  std::uniform_real_distribution<double> drift(0.0, 0.02), bounce(-0.01, 0.01), turn(-0.03, 0.03);
  long contacts = 0, changes = 0;
  for (int step = 0; step < 1500; ++step) {
    for (int b = 12; b < 15; ++b) {
      const double x = drift(generator), y = bounce(generator), angle = turn(generator);
      skipping.move(b, x, y, angle);
      searching.move(b, x, y, angle);
    }
    const std::size_t before = searching.contacts.size();
    require_same(skipping.update(), searching.update());
    contacts += static_cast<long>(searching.contacts.size());
    changes += searching.contacts.size() != before ? 1 : 0;
    for (std::size_t i = 0; i < searching.contacts.size(); ++i) skipping.contacts[i].elastic_slip = searching.contacts[i].elastic_slip = step;
  }
  CHECK(contacts > 1000);
  CHECK(changes > 50);
  CHECK(searching.detector.counters().searches == 1501);
  CHECK(searching.detector.counters().searches_skipped == 0);
  CHECK(skipping.detector.counters().searches_skipped > 750);
  CHECK(skipping.detector.counters().searches > 20);
  CHECK(skipping.detector.counters().searches + skipping.detector.counters().searches_skipped == 1501);
  CHECK(skipping.detector.counters().narrow_phases == 1501);
}

TEST_CASE("two blocks that approach each other by half the skin each are not missed", "[contact][search]") {
  const double reach = 0.05, apart = reach + tolerance::search_skin_m + 1e-3;
  Detection d(scene_with({free_block("left", rectangle(-1.0, 0.0, 1.0, 1.0)), free_block("right", rectangle(apart, 0.0, 1.0, 1.0))}), reach);
  CHECK(d.detector.candidate_pairs().empty());
  const double half = 0.5 * tolerance::search_skin_m;
  d.move(0, 0.999 * half, 0.0);
  d.move(1, -0.999 * half, 0.0);
  CHECK(d.update().empty());
  CHECK(d.detector.counters().searches == 1);
  d.move(0, 0.01 * half, 0.0);
  CHECK(d.update().size() == 2);
  CHECK(d.detector.counters().searches == 2);
}

TEST_CASE("rotation of a long block counts by the way of its ends", "[contact][search]") {
  const Scene scene = scene_with({fixed_block("wall", rectangle(9.5, 0.56, 1.0, 1.0)), free_block("beam", rectangle(-10.0, -0.05, 20.0, 0.1))});
  Detection d(scene, 0.05);
  CHECK(d.contacts.empty());
  // 0.05 rad lift the end by 0.5 m, past the lower edge of the wall, though the centroid has not moved.
  d.move(1, 0.0, 0.0, 0.05);
  CHECK_FALSE(d.update().empty());
  CHECK(d.detector.counters().searches == 2);
}

TEST_CASE("candidates are pairs with a free block, lower number first, in order", "[contact][search]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("right", rectangle(1.0, 0.0, 1.0, 1.0)),
                          free_block("left", rectangle(0.0, 0.0, 1.0, 1.0)), fixed_block("wall", rectangle(2.0, 0.0, 1.0, 1.0)),
                          free_block("distant", rectangle(20.0, 0.0, 1.0, 1.0))}));
  const std::vector<std::pair<int, int>> expected{{0, 1}, {0, 2}, {1, 2}, {1, 3}};
  CHECK(d.detector.candidate_pairs() == expected);
  const long version = d.detector.counters().searches;
  d.update();
  CHECK(d.detector.counters().searches == version);
  d.move(4, 1.0, 0.0);
  d.update();
  CHECK(d.detector.counters().searches != version);
}
