// Ground cut by joints that never open is to what stands on it as ground in one piece.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

#include "contacts.h"
#include "openclose/contact/ground_outline.h"
#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"
#include "support/catch.h"

using namespace openclose;
using namespace openclose::test;

namespace {

using Kind = GroundOutline::Kind;

GroundOutline outline_of(const std::vector<BlockInput>& blocks) {
  return GroundOutline(BlockSystem(scene_with(blocks)));
}

/// What contacts are, whichever block of the ground they name.
using Places = std::vector<std::array<double, 6>>;

Places places_of(const Detection& d) {
  Places places;
  for (const Contact& c : d.contacts) {
    const Vec2 p = d.system.position(c.vertex_block, c.vertex) + d.system.origin();
    const Vec2 along = (d.system.arm(d.system.next(c.edge)) - d.system.arm(c.edge)).normalized();
    places.push_back({p.x(), p.y(), along.x(), along.y(), c.length, c.gap});
  }
  return places;
}

/// Whether every place of the one is one of the other.
bool are_alike(const Places& a, const Places& b, double tolerance) {
  const auto is_among = [&](const Places& those) {
    return [&those, tolerance](const auto& place) {
      return std::ranges::any_of(those, [&](const auto& other) {
        for (std::size_t i = 0; i < place.size(); ++i) {
          if (std::abs(place[i] - other[i]) > tolerance) return false;
        }
        return true;
      });
    };
  };
  return a.size() == b.size() && std::ranges::all_of(a, is_among(b)) && std::ranges::all_of(b, is_among(a));
}

/// Both parts of a convex polygon on the sides of a line; one of them has no corners where the line passes it by.
std::pair<Polygon, Polygon> parts_of(const Polygon& polygon, const Vec2& through, const Vec2& along) {
  std::pair<Polygon, Polygon> parts;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double here = cross(along, p - through), there = cross(along, q - through);
    if (here >= 0.0) parts.first.push_back(p);
    if (here <= 0.0) parts.second.push_back(p);
    if (here * there >= 0.0) continue;
    Vec2 crossing = p + here / (here - there) * (q - p);
    if ((crossing - through).norm() < 1e-9) crossing = through;
    parts.first.push_back(crossing);
    parts.second.push_back(crossing);
  }
  return parts;
}

std::vector<Polygon> cut(const std::vector<Polygon>& polygons, const Vec2& through, const Vec2& along) {
  std::vector<Polygon> pieces;
  for (const Polygon& polygon : polygons) {
    const auto [left, right] = parts_of(polygon, through, along);
    const auto is_sound = [](const Polygon& p) { return p.size() > 2 && polygon_properties(p).area > 1e-3; };
    if (is_sound(left) && is_sound(right)) {
      pieces.push_back(left);
      pieces.push_back(right);
    } else {
      pieces.push_back(polygon);
    }
  }
  return pieces;
}

}  // namespace

TEST_CASE("a joint that ends in a straight face of the ground is no corner of it", "[contact][ground]") {
  // Vertices 0 to 3 of the left one and 4 to 7 of the right one; edges 2 and 6 are their tops.
  const GroundOutline ground =
      outline_of({fixed_block("left", rectangle(-2.0, -1.0, 2.0, 1.0)), fixed_block("right", rectangle(0.0, -1.0, 3.0, 1.0))});
  REQUIRE(ground.corner(2) != nullptr);
  REQUIRE(ground.corner(7) != nullptr);
  CHECK(ground.corner(2)->kind == Kind::straight);
  CHECK(ground.corner(7)->kind == Kind::straight);
  CHECK(ground.corner(2)->first == 2);
  CHECK(ground.corner(7)->first == 2);
  CHECK(ground.corner(3) == nullptr);
  CHECK(ground.covers(1, 0.5, 0.1));
  CHECK(ground.covers(1, 0.0, 0.1));  // up to its ends
  CHECK_FALSE(ground.covers(2, 0.5, 0.0));
  CHECK(ground.straight_on(2).before == Approx(3.0));
  CHECK(ground.straight_on(2).after == 0.0);
  CHECK(ground.straight_on(6).before == 0.0);
  CHECK(ground.straight_on(6).after == Approx(2.0));
  CHECK(ground.body(1) == 0);
  CHECK(ground.has_seam(1));
  for (const double x : {-1.0, -1e-9, 1e-9, 1.0}) {
    // The first vertex of the scene is the origin.
    const Vec2 point(x + 2.0, 1.0);
    CHECK(ground.is_in_front(2, point) == (x < 0.0));
    CHECK(ground.is_in_front(6, point) == (x > 0.0));
  }
}

TEST_CASE("blocks that lie against each other are one body in whatever order they come", "[contact][ground]") {
  const std::vector<double> left = GENERATE(std::vector{0.0, 1.0, 2.0, 3.0}, std::vector{3.0, 1.0, 0.0, 2.0}, std::vector{2.0, 0.0, 3.0, 1.0});
  std::vector<BlockInput> blocks;
  for (const double x : left) blocks.push_back(fixed_block("piece", rectangle(x, -1.0, 1.0, 1.0)));
  blocks.push_back(fixed_block("apart", rectangle(6.0, -1.0, 1.0, 1.0)));
  const GroundOutline ground = outline_of(blocks);
  for (int b = 0; b < 4; ++b) CHECK(ground.body(b) == 0);
  CHECK(ground.body(4) == 4);
}

TEST_CASE("what a joint between fixed blocks leaves of a corner", "[contact][ground]") {
  SECTION("a block that stands on another one makes a notch with it, in the middle of an edge") {
    const GroundOutline ground =
        outline_of({fixed_block("under", rectangle(-2.0, -1.0, 4.0, 1.0)), fixed_block("wall", rectangle(0.0, 0.0, 1.0, 2.0))});
    CHECK(ground.corner(4)->kind == Kind::notch);
    CHECK(ground.corner(4)->ahead.edge == 2);
    CHECK(ground.corner(4)->back.edge == 7);
    CHECK(ground.covers(2, 1.5, 0.1));
    CHECK_FALSE(ground.covers(2, 1.05, 0.1));
    CHECK(ground.covers(2, 1.05, 0.0));
    CHECK_FALSE(ground.covers(2, 0.5, 0.0));
  }
  SECTION("four blocks around a point leave nothing") {
    const GroundOutline ground = outline_of({fixed_block("a", rectangle(-1.0, -1.0, 1.0, 1.0)), fixed_block("b", rectangle(0.0, -1.0, 1.0, 1.0)),
                                             fixed_block("c", rectangle(0.0, 0.0, 1.0, 1.0)), fixed_block("d", rectangle(-1.0, 0.0, 1.0, 1.0))});
    for (const int v : {2, 7, 8, 13}) CHECK(ground.corner(v)->kind == Kind::inside);
  }
  SECTION("two tips side by side are one corner") {
    const GroundOutline ground =
        outline_of({fixed_block("left", {{0.0, 0.0}, {-1.0, -2.0}, {0.0, -2.0}}), fixed_block("right", {{0.0, 0.0}, {0.0, -2.0}, {1.0, -2.0}})});
    CHECK(ground.corner(0)->kind == Kind::corner);
    CHECK(ground.corner(3)->kind == Kind::corner);
    CHECK(ground.corner(3)->first == 0);
    CHECK(ground.corner(3)->ahead.edge == 0);
    CHECK(ground.corner(3)->back.edge == 5);
  }
  SECTION("two that touch in a point stay what they are") {
    const GroundOutline ground = outline_of({fixed_block("a", rectangle(-1.0, -1.0, 1.0, 1.0)), fixed_block("b", rectangle(0.0, 0.0, 1.0, 1.0))});
    CHECK(ground.corner(2) == nullptr);
    CHECK(ground.corner(4) == nullptr);
  }
  SECTION("a slit that a corner could go into is none of the joints") {
    const double slit = GENERATE(1e-6, 1e-5);
    const GroundOutline ground = outline_of({fixed_block("a", rectangle(-1.0, -1.0, 1.0, 1.0)), fixed_block("b", rectangle(slit, -1.0, 1.0, 1.0))});
    CHECK((ground.corner(2) != nullptr) == (slit < 2.0 * tolerance::edge_end_m));
  }
  SECTION("faces that bend, or that have joints of their own, are two") {
    const bool bends = GENERATE(true, false);
    Scene scene = scene_with(
        {fixed_block("a", rectangle(-1.0, -1.0, 1.0, 1.0)), fixed_block("b", {{0.0, -1.0}, {1.0, -1.0}, {1.0, bends ? 1e-3 : 0.0}, {0.0, 0.0}})});
    if (!bends) scene.blocks[1].edge_joints.assign(4, 0);
    const GroundOutline ground{BlockSystem(scene)};
    CHECK(ground.corner(2)->kind == Kind::straight);
    CHECK(ground.straight_on(2).before == 0.0);
  }
  SECTION("a wedge's upper face is not inside the ground, though its lower one is a slit away near the tip") {
    // The lower face of "wedge" lies on "under"; near the tip it is 1 um from the upper one of "under"'s neighbour.
    const GroundOutline ground =
        outline_of({fixed_block("under", {{0.0, 0.0}, {-2.0, -1.0}, {3.0, -1.0}, {3.0, -0.1}}),
                    fixed_block("wedge", {{0.0, 0.0}, {3.0, -0.1}, {3.0, 0.0}}), fixed_block("flank", {{0.0, 0.0}, {-2.0, 0.0}, {-2.0, -1.0}})});
    CHECK(ground.corner(4)->kind == Kind::straight);
    CHECK_FALSE(ground.covers(6, 3.0 - 1e-6, 0.0));
    CHECK(ground.covers(4, 1e-6, 0.0));
  }
}

TEST_CASE("contacts are those of ground in one piece, however it is cut", "[contact][ground]") {
  std::mt19937 random(20261128);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  for (int scene = 0; scene < 300; ++scene) {
    // A block of three or four corners that stands on a slope, one that lies behind it, and the ground.
    const double turn = uniform(-0.6, 0.6), width = uniform(0.5, 2.0), height = uniform(0.3, 2.0), lean = uniform(-0.8, 0.8);
    std::vector<Polygon> free{{{0.0, 0.0}, {width, 0.0}, {width + lean, height}, {lean, height}},
                              {{-1.5, 0.0}, {0.0, 0.0}, {lean, height}, {-1.5, 0.4}}};
    if (scene % 3 == 0) free[0].erase(free[0].begin() + 2);
    std::vector<Polygon> whole{{{-4.0, -2.0}, {5.0, -2.0}, {5.0, 0.0}, {-4.0, 0.0}}}, pieces = whole;
    const std::array<double, 5> feet{0.0, width, -1.5, uniform(-2.0, 3.0), uniform(-2.0, 3.0)};
    for (int k = 1 + scene % 4; k > 0; --k) {
      const double angle = scene % 2 == 0 ? uniform(0.0, 3.1) : uniform(0.01, 0.25) * (k % 2 == 0 ? 1.0 : -1.0);
      pieces =
          cut(pieces, {feet[static_cast<std::size_t>(uniform(0.0, 4.99))] + (scene % 5 == 0 ? 1e-6 : 0.0), 0.0}, {std::cos(angle), std::sin(angle)});
    }
    const auto with = [&](const std::vector<Polygon>& ground) {
      std::vector<BlockInput> blocks;
      for (std::size_t i = 0; i < free.size(); ++i) blocks.push_back(free_block("free" + std::to_string(i), placed(free[i], turn, Vec2::Zero())));
      for (std::size_t i = 0; i < ground.size(); ++i)
        blocks.push_back(fixed_block("ground" + std::to_string(i), placed(ground[i], turn, Vec2::Zero())));
      return scene_with(blocks);
    };
    Detection one(with(whole)), cut_up(with(pieces));
    CAPTURE(scene, pieces.size());
    const double rounding = 1e-5;  // lengths of the short pieces' directions are no better
    CHECK(are_alike(places_of(one), places_of(cut_up), rounding));
    for (int step = 0; step < 8; ++step) {
      // Along the slope, in by what contacts close, and turning a little.
      const Vec2 way = uniform(0.0, 0.2) * Vec2(std::cos(turn), std::sin(turn)) + (step == 0 ? -2e-5 : 0.0) * Vec2(-std::sin(turn), std::cos(turn));
      for (Detection* d : {&one, &cut_up}) {
        for (Contact& c : d->contacts) c.status = c.gap <= 0.0 ? ContactStatus::sliding : ContactStatus::open;
        d->move(0, way.x(), way.y());
        d->update();
      }
      CHECK(are_alike(places_of(one), places_of(cut_up), rounding));
    }
  }
}

TEST_CASE("a foot is held at every place of its way over a seam of the ground", "[contact][ground]") {
  // With the lists of contacts kept while little moves, as in a run.
  Detection d(
      scene_with({fixed_block("left", {{-5.0, -1.0}, {-1.0, -1.0}, {0.0, 0.0}, {-5.0, 0.0}}),
                  fixed_block("right", {{-1.0, -1.0}, {5.0, -1.0}, {5.0, 0.0}, {0.0, 0.0}}), free_block("block", rectangle(-0.5, 0.0, 1.0, 1.0))}),
      0.05, DetectionSkips());
  REQUIRE(d.contacts.size() == 2);
  for (int step = 0; step < 4000; ++step) {
    d.move(2, 3e-4 * std::sin(0.01 * step * step) + 1.5e-4, 0.0);
    d.update();
    REQUIRE(d.contacts.size() == 2);
    for (const Contact& c : d.contacts) {
      const double x = d.system.position(c.vertex_block, c.vertex).x() + d.system.origin().x();
      const bool is_right = c.edge_block == 1;
      // The lists may be late by as much as counts as the end of an edge.
      CHECK(std::abs(x) * (is_right == (x > 0.0) ? 0.0 : 1.0) <= 2.0 * tolerance::edge_end_m);
    }
  }
}

TEST_CASE("a foot that goes to and fro over a seam of the ground by less than lists are late is held all the time", "[contact][ground]") {
  // The piece that it leaves is looked at because its end is near; the one to which it goes has nothing near, and is looked at with it.
  const double start = GENERATE(-9e-5, -4e-5, -1e-5, 1e-5, 4e-5, 9e-5);
  Detection d(
      scene_with({fixed_block("left", {{-5.0, -1.0}, {-1.0, -1.0}, {0.0, 0.0}, {-5.0, 0.0}}),
                  fixed_block("right", {{-1.0, -1.0}, {5.0, -1.0}, {5.0, 0.0}, {0.0, 0.0}}), free_block("block", rectangle(start, 0.0, 1.0, 1.0))}),
      0.05, DetectionSkips());
  double x = start;
  for (int step = 0; step < 300; ++step) {
    const double next = start + 1e-4 * std::sin(0.1 * step);
    d.move(2, next - x, 0.0);
    x = next;
    d.update();
    REQUIRE(d.contacts.size() == 2);
  }
}

TEST_CASE("a tip does not touch a face away from its ends over the tip of a third block", "[contact][detection]") {
  // The lower side of "above" is 10 degrees from the floor, with a wedge between them that ends where the two meet.
  const double far = 2.0, rise = far * std::tan(10.0 * degree);
  std::vector<BlockInput> blocks{fixed_block("floor", rectangle(-5.0, -1.0, 10.0, 1.0)),
                                 free_block("above", {{-far, rise}, {0.0, 0.0}, {-far, 2.0}})};
  const auto touch = [&] {
    const Detection d(scene_with(blocks));
    return std::ranges::any_of(d.contacts, [](const Contact& c) { return std::minmax({c.vertex_block, c.edge_block}) == std::pair(0, 1); });
  };
  CHECK(touch());
  blocks.push_back(free_block("between", {{-far, 0.0}, {0.0, 0.0}, {-far, rise}}));
  CHECK_FALSE(touch());
}

TEST_CASE("pieces of the ground that overlap by the rounding of a drawing have one face", "[contact][ground]") {
  const double overlap = GENERATE(1e-5, 2e-4, 9e-4), lean = GENERATE(-2.0, 2.0);
  CAPTURE(overlap, lean);
  Detection d(
      scene_with({fixed_block("left", {{-5.0, -6.0}, {lean + overlap, -6.0}, {overlap, 0.0}, {-5.0, 0.0}}),
                  fixed_block("right", {{lean, -6.0}, {5.0, -6.0}, {5.0, 0.0}, {0.0, 0.0}}), free_block("block", rectangle(-1.0, 0.0, 2.0, 0.5))}));
  REQUIRE(d.contacts.size() == 2);
  CHECK(d.length(8, 2) == Approx(1.0));
  CHECK(d.length(9, 6) == Approx(1.0));
}

TEST_CASE("a tip at a seam stands on one of its pieces, and the end of the last one is a corner", "[contact][ground]") {
  // Lengths that do not add up without rounding.
  std::vector<BlockInput> blocks;
  double x = 0.0;
  const double first = GENERATE(0.1, 0.11, 0.13, 0.17, 0.19, 0.23, 0.29, 0.31), turn = GENERATE(0.0, 0.3, 1.1);
  for (const double length : {first, 0.7, 0.3}) {
    blocks.push_back(fixed_block("piece", rectangle(x, -1.0, length, 1.0)));
    x += length;
  }
  const auto turned_scene = [&] {
    for (BlockInput& block : blocks) {
      for (Vec2& v : block.vertices) v = Motion::turned_by(turn, v, RotationKind::exact) + v;
    }
    return scene_with(blocks);
  };
  SECTION("a tip") {
    const Vec2 seam = blocks[1].vertices[3];
    blocks.push_back(free_block("tip", {seam, seam + Vec2(0.5, 0.5), seam + Vec2(-0.5, 0.5)}));
    const Detection d(turned_scene());
    CHECK(d.contacts.size() == 1);
  }
  SECTION("a block that overhangs both ends") {
    blocks.push_back(free_block("block", rectangle(-0.2, 0.0, 2.0, 0.5)));
    Detection d(turned_scene());
    CHECK(d.contacts.size() == 2);
    CHECK(d.length(3, 12) == Approx(0.5 * x));   // the upper left corner of the first piece
    CHECK(d.length(10, 12) == Approx(0.5 * x));  // the upper right one of the last
  }
}
