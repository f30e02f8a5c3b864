// Searching only when something has moved beyond the skin must not change what is found.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "contacts.h"
#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"
#include "support/catch.h"

using namespace openclose;
using namespace openclose::test;

namespace {

void require_same(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool same = a[i].vertex_block == b[i].vertex_block && a[i].vertex == b[i].vertex && a[i].edge_block == b[i].edge_block &&
                      a[i].edge == b[i].edge && a[i].joint == b[i].joint && a[i].length == b[i].length && a[i].gap == b[i].gap &&
                      a[i].joint_state == b[i].joint_state && a[i].elastic_slip == b[i].elastic_slip;
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

/// Squares of a metre, side by side and one on the other.
Scene squares(int columns, int rows) {
  return scene_with(wall(rows, columns, 1.0, 0.0));
}

}  // namespace

TEST_CASE("what a large system gives back between updates changes nothing", "[contact][search]") {
  constexpr int columns = 50, rows = 42;
  const DetectionSkips skips;
  Detection large(squares(columns, rows), 0.05, skips), small(squares(columns, rows / 2), 0.05, skips);
  const auto bytes_a_block = [](const Detection& d) {
    const Memory of = d.detector.memory();
    return static_cast<double>(of.blocks + of.contacts) / d.system.block_count();
  };
  // 4 edges of 40 bytes and a box of 32, at least.
  CHECK(bytes_a_block(small) - bytes_a_block(large) > 190.0);
  Detection searching(squares(columns, rows), 0.05, {false, true, true, 0.0});
  require_same(large.contacts, searching.contacts);
  for (int step = 0; step < 3; ++step) {
    for (const int b : {17, 800, 801, 2099}) {
      for (Detection* d : {&large, &searching}) d->move(b, 0.3 * tolerance::contact_skin_m * (b % 3 - 1), 1.2 * tolerance::contact_skin_m, 1e-4);
    }
    large.update();
    searching.update();
    REQUIRE(large.contacts.size() == searching.contacts.size());
    for (std::size_t i = 0; i < large.contacts.size(); ++i) {
      const Contact &a = large.contacts[i], &b = searching.contacts[i];
      REQUIRE(std::pair(a.vertex, a.edge) == std::pair(b.vertex, b.edge));
      REQUIRE(std::abs(a.length - b.length) < tolerance::contact_skin_m);
    }
  }
  CHECK(large.detector.counters().narrow_phases_skipped > 0);
  CHECK(bytes_a_block(small) - bytes_a_block(large) > 190.0);
}

TEST_CASE("skipping searches changes nothing while blocks move far", "[contact][search]") {
  const Scene scene = rough_floor();
  const double reach = GENERATE(0.01, 0.2);
  Detection skipping(scene, reach), searching(scene, reach, {false, true, true, 0.0});
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

TEST_CASE("blocks that are kept apart by the joints between them are no candidates, though their boxes overlap", "[contact][search]") {
  std::vector<BlockInput> blocks;
  for (int i = 0; i < 6; ++i) blocks.push_back(free_block("slice", placed({{0.0, 0.0}, {1.0, 0.0}, {5.0, 4.0}, {4.0, 4.0}}, 0.0, {1.0 * i, 0.0})));
  const Detection d(scene_with(blocks));
  const std::vector<std::pair<int, int>> expected{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}};
  CHECK(d.detector.candidate_pairs() == expected);
}

TEST_CASE("blocks that are no candidates are out of reach by the skins", "[contact][search]") {
  const double reach = 0.05, contact_skin = 1e-3;
  const Polygon l{{0.0, 0.0}, {2.0, 0.0}, {2.0, 0.5}, {0.5, 0.5}, {0.5, 1.5}, {0.0, 1.5}}, wedge{{0.0, 0.0}, {1.0, 0.0}, {0.2, 0.9}};
  std::mt19937 generator(16);
  std::uniform_real_distribution<double> place(0.0, 2.5), turn(-3.0, 3.0);
  int candidates = 0, boxes_overlap = 0, others = 0;
  for (int i = 0; i < 2000; ++i) {
    const Polygon first = placed(l, turn(generator), {place(generator), place(generator)});
    const Polygon second = placed(i % 2 == 0 ? l : wedge, turn(generator), {place(generator), place(generator)});
    const Detection d(scene_with({free_block("first", first), free_block("second", second)}), reach, {true, true, true, contact_skin});
    double distance = std::numeric_limits<double>::infinity();
    for (const Vec2& p : first) distance = std::min(distance, contains(second, p) ? 0.0 : distance_to_boundary(second, p));
    for (const Vec2& p : second) distance = std::min(distance, contains(first, p) ? 0.0 : distance_to_boundary(first, p));
    const double room = reach + contact_skin + tolerance::search_skin_m;
    const bool box = Box::around(first).inflated(0.5 * room).overlaps(Box::around(second).inflated(0.5 * room));
    if (!d.detector.candidate_pairs().empty()) {
      ++candidates;
      continue;
    }
    CHECK(distance > room);
    ++(box ? boxes_overlap : others);
  }
  CHECK(candidates > 500);
  CHECK(boxes_overlap > 100);
  CHECK(others > 100);
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

TEST_CASE("with a skin of zero, leaving pairs as they are changes nothing", "[contact][search]") {
  const Scene scene = rough_floor();
  Detection skipping(scene, 0.1, {true, true, true, 0.0}), redoing(scene, 0.1);
  std::mt19937 generator(15);
  std::uniform_real_distribution<double> drift(0.0, 0.02), bounce(-0.01, 0.01), turn(-0.03, 0.03);
  for (int step = 0; step < 900; ++step) {
    const int b = 12 + step % 3;
    const double x = drift(generator), y = bounce(generator), angle = turn(generator);
    skipping.move(b, x, y, angle);
    redoing.move(b, x, y, angle);
    require_same(skipping.update(), redoing.update());
    for (std::size_t i = 0; i < redoing.contacts.size(); ++i) skipping.contacts[i].elastic_slip = redoing.contacts[i].elastic_slip = step;
  }
  const DetectionCounters &some = skipping.detector.counters(), &all = redoing.detector.counters();
  CHECK(some.narrow_phases + some.narrow_phases_skipped == all.narrow_phases);
  CHECK(all.narrow_phases_skipped == 0);
  CHECK(some.narrow_phases_skipped > all.narrow_phases / 2);
}

TEST_CASE("a list that stays as it is is not touched", "[contact][search]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))}), 0.05, {});
  const Contact* place = d.contacts.data();
  d.contacts[0].gap = 0.25;
  d.move(1, 0.6 * tolerance::contact_skin_m, 0.0);
  CHECK_FALSE(d.detector.update(d.system, d.joints, d.set));
  CHECK(d.contacts.data() == place);
  CHECK(d.contacts[0].gap == 0.25);
  CHECK(d.detector.counters().narrow_phases == 1);
  CHECK(d.detector.counters().narrow_phases_skipped == 1);
  d.move(1, 0.6 * tolerance::contact_skin_m, 0.0);
  CHECK(d.detector.update(d.system, d.joints, d.set));
  CHECK(d.contacts[0].gap == 0.0);
  d.detector.forget();
  CHECK(d.detector.update(d.system, d.joints, d.set));
  CHECK(d.detector.counters().narrow_phases == 3);
}

TEST_CASE("blocks that move together are not redone, however far they turn", "[contact][search]") {
  Detection d(scene_with({free_block("below", rectangle(-2.0, -1.0, 4.0, 1.0)), free_block("above", rectangle(-0.5, 0.0, 1.0, 1.0))}), 0.05, {});
  for (int step = 0; step < 100; ++step) {
    // One rigid motion: a turn about a point and a shift of 10 m.
    const double angle = 0.03;
    const Vec2 shift(0.1, -0.2);
    const Vec2 between = d.system.centroid(1) - d.system.centroid(0);
    const Vec2 other = shift + Vec2(std::cos(angle) * between.x() - std::sin(angle) * between.y() - between.x(),
                                    std::sin(angle) * between.x() + std::cos(angle) * between.y() - between.y());
    d.move(0, shift.x(), shift.y(), angle);
    d.move(1, other.x(), other.y(), angle);
    d.update();
  }
  CHECK(d.detector.counters().narrow_phases == 1);
  CHECK(d.detector.counters().searches > 10);
  d.move(1, 0.0, 0.0, 0.01);
  d.update();
  CHECK(d.detector.counters().narrow_phases == 2);
}

TEST_CASE("what skips is off by no more than the skin", "[contact][search]") {
  // Over a seam, past the end of the lower block and away, in steps much shorter than the skin.
  const double step = GENERATE(1e-4, 3.7e-4), skin = tolerance::contact_skin_m;
  const Scene scene = scene_with({fixed_block("left", rectangle(-5.0, -1.0, 5.0, 1.0)), fixed_block("right", rectangle(0.0, -1.0, 1.0, 1.0)),
                                  free_block("block", rectangle(-0.12, 0.0, 0.1, 0.1))});
  Detection skipping(scene, 0.05, {}), redoing(scene);
  for (double x = 0.0; x < 1.2; x += step) {
    skipping.move(2, step, 0.0);
    redoing.move(2, step, 0.0);
    skipping.update();
    redoing.update();
    // Either of the two overlaps may be as it was up to a skin ago.
    CHECK(std::abs(skipping.total_length() - redoing.total_length()) <= 2.0 * skin + 1e-12);
  }
  CHECK(skipping.contacts.size() == redoing.contacts.size());
  const DetectionCounters &some = skipping.detector.counters(), &all = redoing.detector.counters();
  CHECK(some.narrow_phases < all.narrow_phases / 2);
  CHECK(some.transfers == all.transfers);
}

TEST_CASE("nothing comes within reach unseen", "[contact][search]") {
  const double reach = 0.05;
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 0.07, 2.0, 1.0))}), reach, {});
  for (double gap = 0.07; gap > 0.04; gap -= 0.00037) {
    CHECK((gap > reach || d.contacts.size() == 2));
    d.move(1, 0.0, -0.00037);
    d.update();
  }
}

TEST_CASE("contacts of blocks at rest are set aside and come back as they were", "[contact][search]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("lower", rectangle(0.0, 0.0, 2.0, 1.0)),
                          free_block("upper", rectangle(0.0, 1.0, 2.0, 1.0))}),
              0.05, DetectionSkips{});
  REQUIRE(d.contacts.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) d.contacts[i].normal_force = 1.0 + static_cast<double>(i);
  d.system.put_to_rest({1});
  d.detector.divide(d.system, d.set);
  REQUIRE(d.contacts.size() == 2);
  REQUIRE(d.set.resting.size() == 2);
  for (const Contact& c : d.contacts) CHECK(std::max(c.vertex_block, c.edge_block) == 2);
  for (const Contact& c : d.set.resting) CHECK(std::max(c.vertex_block, c.edge_block) == 1);
  d.move(2, 0.01, 0.0);
  REQUIRE(d.update().size() == 2);
  d.system.wake({1});
  d.detector.divide(d.system, d.set);
  REQUIRE(d.set.resting.empty());
  const long found_anew = d.detector.counters().narrow_phases;
  REQUIRE(d.update().size() == 4);
  CHECK(d.detector.counters().narrow_phases == found_anew);
  for (std::size_t i = 0; i < 4; ++i) CHECK(d.contacts[i].normal_force == 1.0 + static_cast<double>(i));
}

TEST_CASE("blocks that are woken are searched for once they have moved enough since they last were among all others", "[contact][search]") {
  constexpr double reach = 0.05, little = 0.36 * tolerance::search_skin_m;  // less than what asks for a search
  const double apart = reach + tolerance::contact_skin_m + 1.25 * tolerance::search_skin_m;
  Detection d(scene_with({free_block("left", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("right", rectangle(1.0 + apart, 0.0, 1.0, 1.0)),
                          free_block("other", rectangle(0.0, 9.0, 1.0, 1.0))}),
              reach, DetectionSkips{});
  d.move(0, little, 0.0);
  d.move(1, -little, 0.0);
  d.update();
  d.system.put_to_rest({0, 1});
  d.detector.divide(d.system, d.set);
  d.move(2, 1.0, 0.0);
  d.update();
  REQUIRE(d.detector.counters().searches == 2);
  d.system.wake({0, 1});
  d.detector.divide(d.system, d.set);
  d.update();
  CHECK(d.detector.counters().searches == 2);
  d.move(0, little, 0.0);
  d.move(1, -little, 0.0);
  CHECK(d.update().size() == 2);
}

TEST_CASE("whoever rests and wakes, in whatever order, every contact stays with its pair", "[contact][search]") {
  constexpr int columns = 4, rows = 3, count = columns * rows;
  Scene scene = scene_with({fixed_block("base", rectangle(-5.0, -1.0, 20.0, 1.0))});
  for (int i = 0; i < count; ++i) scene.blocks.push_back(free_block("block", rectangle(i % columns, i / columns, 1.0, 1.0)));
  Detection d(scene, 0.05, DetectionSkips{});
  for (std::size_t i = 0; i < d.contacts.size(); ++i) d.contacts[i].normal_force = 1.0 + static_cast<double>(i);
  const std::vector<Contact> all = d.contacts;
  std::mt19937 generator(4);
  for (int change = 0; change < 200; ++change) {
    std::vector<int> rest, wake;
    for (int b = 1; b <= count; ++b) {
      if (generator() % 3 == 0) (d.system.is_at_rest(b) ? wake : rest).push_back(b);
    }
    d.system.put_to_rest(rest);
    d.system.wake(wake);
    d.detector.divide(d.system, d.set);
    d.update();
    std::vector<Contact> moving, resting = d.set.resting;
    for (const Contact& c : all) {
      if (d.system.block(c.vertex_block).equation >= 0 || d.system.block(c.edge_block).equation >= 0) moving.push_back(c);
    }
    require_same(d.contacts, moving);
    for (std::size_t i = 0; i < moving.size(); ++i) CHECK(d.contacts[i].normal_force == moving[i].normal_force);
    REQUIRE(moving.size() + resting.size() == all.size());
    std::sort(resting.begin(), resting.end(), [](const Contact& a, const Contact& b) { return a.normal_force < b.normal_force; });
    for (const Contact& c : resting) {
      CHECK(c.vertex == all[std::lround(c.normal_force) - 1].vertex);
      CHECK_FALSE((d.system.block(c.vertex_block).equation >= 0 || d.system.block(c.edge_block).equation >= 0));
    }
  }
}

TEST_CASE("what blocks at rest have closed among themselves still counts for corners that come by", "[contact][search]") {
  // A block slides over the seam of two that stand side by side on joints of which one has given more: the closures there say how high a step it may
  // ride over.
  const auto corner_catches = [](bool rests) {
    Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("low", rectangle(0.0, -0.004, 2.0, 1.0)),
                            free_block("high", rectangle(2.0, 0.0, 2.0, 1.0)), free_block("slider", rectangle(0.8, 0.996, 1.0, 1.0))}),
                0.05, DetectionSkips{});
    for (Contact& c : d.contacts) {
      c.status = c.gap <= 0.0 ? ContactStatus::sticking : ContactStatus::open;
      if (std::max(c.vertex_block, c.edge_block) == 3) c.status = ContactStatus::sliding;
    }
    if (rests) {
      d.system.put_to_rest({1, 2});
      d.detector.divide(d.system, d.set);
    }
    d.move(3, 0.195, 0.0);
    std::vector<std::pair<int, int>> list;
    for (const Contact& c : d.update()) {
      if (std::max(c.vertex_block, c.edge_block) == 3) list.emplace_back(c.vertex, c.edge);
    }
    std::sort(list.begin(), list.end());
    return list;
  };
  CHECK(corner_catches(true) == corner_catches(false));
}

TEST_CASE("looking only at pairs whose blocks have gone far enough finds the same ones due", "[contact][search]") {
  // Blocks that rest, that creep, that run and that turn about each other; every now and then one jumps.
  const double creep = GENERATE(1e-5, 3e-4), skin = GENERATE(1e-3, 1e-2);
  const Scene scene = rough_floor();
  Detection looking(scene, 0.1, {true, true, true, skin}), plain(scene, 0.1, {true, true, false, skin});
  std::mt19937 generator(16);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int step = 0; step < 4000; ++step) {
    const auto move = [&](int b, double x, double y, double turn) {
      looking.move(b, x, y, turn);
      plain.move(b, x, y, turn);
    };
    const double way = creep * number(generator), turn = 0.3 * creep * number(generator);
    move(12, way, 0.1 * way, 0.0);
    if (step % 3 == 0) move(13, creep, creep * number(generator), turn);
    if (step % 500 > 450) {
      // Block 14 goes round with block 13 as if they were one.
      const Vec2 apart = looking.system.centroid(14) - looking.system.centroid(13);
      const Vec2 with = Motion::turned_by(creep, apart, RotationKind::exact);
      move(13, 0.0, 0.0, creep);
      move(14, with.x(), with.y(), creep);
    }
    if (step % 700 == 699) move(14, 0.1 * number(generator), 0.0, 0.1);
    require_same(looking.update(), plain.update());
    REQUIRE(looking.detector.counters().narrow_phases == plain.detector.counters().narrow_phases);
    for (std::size_t i = 0; i < plain.contacts.size(); ++i) looking.contacts[i].elastic_slip = plain.contacts[i].elastic_slip = step;
  }
  const DetectionCounters &few = looking.detector.counters(), &all = plain.detector.counters();
  CHECK(all.looks_skipped == 0);
  CHECK(few.looks + few.looks_skipped == all.looks);
  CHECK((few.looks < all.looks / 3 || creep > 1e-4));
  CHECK(all.narrow_phases > 20);
}

TEST_CASE("a pair that a line parts is left alone until it may have come within reach, and found then", "[contact][search]") {
  const double reach = 0.05, step = 0.004, height = 0.2;
  const bool beside = GENERATE(false, true);  // past the base's end, which another line parts it from
  const Scene scene =
      scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)),
                  free_block("block", placed(rectangle(0.0, 0.0, 0.3, 0.3), 0.2, {beside ? 5.0 + height : 0.0, beside ? -0.5 : height}))});
  Detection d(scene, reach, {});
  REQUIRE(d.contacts.empty());
  const Vec2 low = Box::around(scene.blocks[1].vertices).low;
  const double nearest = beside ? low.x() - 5.0 : low.y();
  for (double gap = nearest - step; gap > -2.0 * step; gap -= step) {
    d.move(1, beside ? -step : 0.0, beside ? 0.0 : -step);
    d.update();
    INFO("gap " << gap);
    if (gap > reach + step) {
      CHECK(d.contacts.empty());
      CHECK(d.detector.counters().narrow_phases == 1);
    }
    if (gap < reach) CHECK_FALSE(d.contacts.empty());
  }
}

TEST_CASE("a list of contacts that the pairs do not share among them is not the detector's", "[contact][search]") {
  Detection d(scene_with({free_block("left", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("middle", rectangle(1.0, 0.0, 1.0, 1.0)),
                          free_block("right", rectangle(2.0, 0.0, 1.0, 1.0))}));
  const auto fits = [&] { return d.detector.fits(d.system, d.joints, d.set); };
  REQUIRE(d.contacts.size() >= 4);
  CHECK(fits());
  SECTION("one is missing") {
    d.contacts.pop_back();
    CHECK_FALSE(fits());
  }
  SECTION("one is no pair's") {
    d.contacts.push_back(d.contacts.back());
    CHECK_FALSE(fits());
    d.detector.forget();
    CHECK(fits());  // it is found anew
  }
  SECTION("two pairs have each other's") {
    std::swap(d.contacts.front(), d.contacts.back());
    CHECK_FALSE(fits());
  }
  SECTION("one at rest is no pair's") {
    d.set.resting.push_back(d.contacts.back());
    CHECK_FALSE(fits());
  }
}

TEST_CASE("a saved detector with a list that is not of all blocks is refused", "[contact][search]") {
  Detection d(scene_with({free_block("left", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("right", rectangle(1.0, 0.0, 1.0, 1.0))}));
  Archive saved;
  saved(d.detector);
  REQUIRE(d.detector.fits(d.system, d.joints, d.set));
  // Wherever a length of two stands, the list behind it loses its last entry.
  const auto length_of = [](std::uint64_t length) { return std::string(reinterpret_cast<const char*>(&length), sizeof length); };
  int refused = 0, read = 0;
  for (std::size_t at = saved.bytes().find(length_of(2)); at != std::string::npos; at = saved.bytes().find(length_of(2), at + 1)) {
    for (const std::size_t size : {sizeof(Vec2), 2 * sizeof(Vec2), sizeof(double), 3 * sizeof(double)}) {
      std::string bytes = saved.bytes();
      if (at + sizeof(std::uint64_t) + 2 * size > bytes.size()) continue;
      bytes.replace(at, sizeof(std::uint64_t), length_of(1));
      bytes.erase(at + sizeof(std::uint64_t) + size, size);
      Detector forged(0.05);
      Archive archive(bytes);
      try {
        archive(forged);
      } catch (const DamagedState&) {
        continue;
      }
      ++read;
      refused += !forged.fits(d.system, d.joints, d.set);
    }
  }
  CHECK(read > 0);
  CHECK(refused == read);
}

TEST_CASE("a saved detector whose pairs do not share the contacts among them is refused", "[contact][search]") {
  Detection d(scene_with({free_block("left", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("middle", rectangle(1.0, 0.0, 1.0, 1.0)),
                          free_block("right", rectangle(2.0, 0.0, 1.0, 1.0))}));
  const auto in_bytes = [](const std::vector<int>& numbers) {
    return std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(int));  // as the archive has them
  };
  const auto is_first_pair = [](const Contact& c) { return std::max(c.vertex_block, c.edge_block) == 1; };
  const int first = static_cast<int>(std::ranges::count_if(d.contacts, is_first_pair)), all = static_cast<int>(d.contacts.size());
  REQUIRE(first >= 2);
  REQUIRE(all > first);
  /// With other begins and ends of the two pairs' contacts.
  const auto fits_with = [&](const std::vector<int>& ranges) {
    Archive saved;
    saved(d.detector);
    std::string bytes = saved.bytes();
    const std::string own = in_bytes({0, first, first, all});
    REQUIRE(bytes.find(own) != std::string::npos);
    bytes.replace(bytes.find(own), own.size(), in_bytes(ranges));
    Detector read(0.05);
    Archive archive(bytes);
    archive(read);
    return read.fits(d.system, d.joints, d.set);
  };
  CHECK(fits_with({0, first, first, all}));
  CHECK_FALSE(fits_with({0, first - 1, first, all}));  // one is no pair's
  CHECK_FALSE(fits_with({0, first, first - 1, all}));  // one is of two
  CHECK_FALSE(fits_with({0, first, all, first}));
  d.detector.forget();
  CHECK(fits_with({0, first - 1, first, all}));  // they are found anew
  CHECK_FALSE(fits_with({-1, first, first, all}));
  CHECK_FALSE(fits_with({0, first, first, all + 1}));
}
