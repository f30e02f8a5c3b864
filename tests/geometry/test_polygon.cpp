#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "openclose/geometry/polygon.h"
#include "support/catch.h"

using namespace openclose;
using std::numbers::pi;

namespace {

const Polygon unit_square{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};

/// Square of 2 x 2 without its upper right quarter.
const Polygon corner_piece{{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}, {0.0, 2.0}};

Polygon moved(Polygon polygon, const Vec2& shift) {
  for (Vec2& vertex : polygon) vertex += shift;
  return polygon;
}

Polygon regular(int n, double radius) {
  Polygon polygon;
  for (int i = 0; i < n; ++i) polygon.emplace_back(radius * std::cos(2.0 * pi * i / n), radius * std::sin(2.0 * pi * i / n));
  return polygon;
}

/// Star-shaped about the origin, mostly not convex.
Polygon random_star(std::mt19937& generator) {
  std::uniform_real_distribution<double> radius(0.2, 2.0);
  const int n = std::uniform_int_distribution<int>(3, 30)(generator);
  Polygon polygon;
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * pi * i / n;
    polygon.push_back(radius(generator) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

/// By the triangles between the origin and the edges of a star, with the textbook formulas of a triangle and the parallel-axis theorem.
PolygonProperties by_triangles(const Polygon& star) {
  PolygonProperties sum;
  double about_origin = 0.0;
  for (std::size_t i = 0; i < star.size(); ++i) {
    const Vec2 a = star[i];
    const Vec2 b = star[(i + 1) % star.size()];
    const double area = cross(a, b) / 2.0;
    const Vec2 centroid = (a + b) / 3.0;
    const double about_centroid = area / 36.0 * (a.squaredNorm() + b.squaredNorm() + (b - a).squaredNorm());
    sum.area += area;
    sum.centroid += area * centroid;
    about_origin += about_centroid + area * centroid.squaredNorm();
  }
  sum.centroid /= sum.area;
  sum.polar_second_moment = about_origin - sum.area * sum.centroid.squaredNorm();
  return sum;
}

/// Whether any two edges without a common vertex cross, by solving for the place of the crossing on both.
bool crosses_itself(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      Eigen::Matrix2d directions;
      directions << polygon[i + 1] - polygon[i], polygon[j] - polygon[(j + 1) % n];
      const Vec2 places = directions.inverse() * (polygon[j] - polygon[i]);
      if (places.minCoeff() >= 0.0 && places.maxCoeff() <= 1.0) return true;
    }
  }
  return false;
}

void check_same(const PolygonProperties& found, const PolygonProperties& expected, double length) {
  CHECK(found.area == Approx(expected.area).epsilon(1e-12).margin(0.0));
  CHECK((found.centroid - expected.centroid).norm() <= 1e-12 * length);
  CHECK(found.polar_second_moment == Approx(expected.polar_second_moment).epsilon(1e-12).margin(0.0));
}

}  // namespace

TEST_CASE("mass properties of regular polygons", "[geometry][polygon]") {
  // Area n R^2 sin(a) / 2 and J = n R^4 sin(a) (2 + cos(a)) / 12 with a = 2 pi / n.
  const int n = GENERATE(3, 4, 5, 6, 17, 100, 1000);
  const double radius = GENERATE(1e-3, 1.0, 250.0);
  const double angle = 2.0 * pi / n;
  const double square = radius * radius;
  const PolygonProperties expected{
      n * square * std::sin(angle) / 2.0, {0.0, 0.0}, n * square * square * std::sin(angle) * (2.0 + std::cos(angle)) / 12.0};
  check_same(polygon_properties(regular(n, radius)), expected, radius);
}

TEST_CASE("mass properties of polygons that are not convex", "[geometry][polygon]") {
  SECTION("corner piece: a square of side 2 less one of side 1") {
    // A = 3, x = (4 * 1 - 1 * 1.5) / 3; J = 16/6 + 4 d1^2 - (1/6 + d2^2) with the distances of the squares' centroids from the piece's.
    const double d1 = std::sqrt(2.0) / 6.0;
    const double d2 = std::sqrt(2.0) * 2.0 / 3.0;
    const double moment = 16.0 / 6.0 + 4.0 * d1 * d1 - 1.0 / 6.0 - d2 * d2;
    check_same(polygon_properties(corner_piece), {3.0, {5.0 / 6.0, 5.0 / 6.0}, moment}, 1.0);
  }
  SECTION("arrow: a triangle less a triangle with the same base") {
    // Triangles of base 2 and heights 3 and 1 with the apex above the middle: J about the base's middle = A (h^2/6 + b^2/24).
    const Polygon arrow{{-1.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}, {0.0, 3.0}};
    const double centroid = (3.0 * 1.0 - 1.0 / 3.0) / 2.0;
    const double about_base = 3.0 * (9.0 / 6.0 + 4.0 / 24.0) - 1.0 * (1.0 / 6.0 + 4.0 / 24.0);
    check_same(polygon_properties(arrow), {2.0, {0.0, centroid}, about_base - 2.0 * centroid * centroid}, 1.0);
  }
}

TEST_CASE("a polygon 1e6 m away has the mass properties of the one at the origin", "[geometry][polygon]") {
  // Coordinates that are exact at both places, so that any difference is the formula's.
  const double grid = std::ldexp(1.0, -20);
  Polygon polygon = regular(23, 3.0);
  for (Vec2& vertex : polygon) vertex = grid * (vertex / grid).array().round();
  const Vec2 shift = GENERATE(Vec2(1e6, 1e6), Vec2(-1e6, 0.0), Vec2(0.0, 1e6));

  const PolygonProperties here = polygon_properties(polygon);
  const PolygonProperties there = polygon_properties(moved(polygon, shift));
  CHECK(there.area == here.area);
  CHECK(there.polar_second_moment == here.polar_second_moment);
  CHECK((there.centroid - shift - here.centroid).norm() <= 2.4e-10);  // one rounding of a coordinate of 1e6 m
  CHECK(signed_area(moved(polygon, shift)) == signed_area(polygon));
}

TEST_CASE("mass properties of random polygons agree with a triangulation", "[geometry][polygon]") {
  std::mt19937 generator(20);
  for (int i = 0; i < 500; ++i) {
    const Polygon star = random_star(generator);
    check_same(polygon_properties(star), by_triangles(star), 2.0);
    CHECK(signed_area(star) == Approx(polygon_properties(star).area).epsilon(1e-12).margin(0.0));
  }
}

TEST_CASE("a slender polygon keeps the accuracy of its second moment", "[geometry][polygon]") {
  const double height = GENERATE(1e-5, 1e-2, 1.0);
  const Polygon strip{{0.0, 0.0}, {100.0, 0.0}, {100.0, height}, {0.0, height}};
  const double area = 100.0 * height;
  check_same(polygon_properties(strip), {area, {50.0, height / 2.0}, area * (1e4 + height * height) / 12.0}, 100.0);
}

TEST_CASE("clockwise polygons have a negative area and can be turned", "[geometry][polygon]") {
  const Polygon clockwise = reversed(corner_piece);
  CHECK(clockwise.front() == corner_piece.front());
  CHECK(clockwise[1] == corner_piece.back());
  CHECK(signed_area(clockwise) == -3.0);
  CHECK(reversed(clockwise) == corner_piece);
}

TEST_CASE("a convex hull has all points on its left and turns left at each of its corners", "[geometry][polygon]") {
  std::mt19937 generator(7);
  for (int i = 0; i < 200; ++i) {
    const Polygon star = moved(random_star(generator), {3.0, -2.0});
    const Polygon hull = convex_hull(star);
    const std::size_t n = hull.size();
    REQUIRE(n >= 3);
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2 way = hull[(k + 1) % n] - hull[k];
      CHECK(std::find(star.begin(), star.end(), hull[k]) != star.end());
      CHECK(cross(way, hull[(k + 2) % n] - hull[(k + 1) % n]) > 0.0);
      for (const Vec2& point : star) CHECK(cross(way, point - hull[k]) >= -1e-14);
    }
  }
}

TEST_CASE("the convex hull of a polygon that is not convex leaves out what lies in it and on its edges", "[geometry][polygon]") {
  CHECK(convex_hull(corner_piece) == Polygon{{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {1.0, 2.0}, {0.0, 2.0}});
  CHECK(convex_hull({{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}, {0.0, 2.0}, {1.0, 0.0}, {2.0, 0.0}, {1.0, 1.5}}) ==
        Polygon{{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}});
}

TEST_CASE("longest edge", "[geometry][polygon]") {
  CHECK(longest_edge({{0.0, 0.0}, {1.0, 0.0}, {0.0, 2.0}}) == std::sqrt(5.0));
}

TEST_CASE("repeated vertices and straight corners are no corners", "[geometry][polygon]") {
  using Indices = std::vector<int>;
  CHECK(corners(unit_square) == Indices{0, 1, 2, 3});
  CHECK(corners(corner_piece) == Indices{0, 1, 2, 3, 4, 5});
  SECTION("closing vertex") {
    CHECK(corners({{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 0.0}}) == Indices{0, 1, 2});
  }
  SECTION("doubled vertices") {
    CHECK(corners({{0.0, 0.0}, {1.0, 0.0}, {1.0, 1e-9}, {1.0, 1.0}, {1.0, 1.0}, {0.0, 1.0}}) == Indices{0, 1, 3, 5});
  }
  SECTION("straight corners, the first vertex among them") {
    CHECK(corners({{0.5, 0.0}, {0.7, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.5, 1.0}, {0.0, 1.0}, {0.0, 0.0}}) == Indices{2, 3, 5, 6});
  }
  SECTION("a bend above the tolerance stays") {
    CHECK(corners({{0.0, 0.0}, {1.0, -1e-6}, {2.0, 0.0}, {1.0, 1.0}}).size() == 4);
  }
  SECTION("a bend below the tolerance goes") {
    CHECK(corners({{0.0, 0.0}, {1.0, -1e-10}, {2.0, 0.0}, {1.0, 1.0}}) == Indices{0, 2, 3});
  }
  SECTION("a spike is a corner") {
    CHECK(corners({{0.0, 0.0}, {3.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}).size() == 4);
  }
  SECTION("points on a line leave no polygon") {
    CHECK(corners({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}).size() < 3);
  }
  SECTION("a single place") {
    CHECK(corners({{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}) == Indices{0});
  }
}

TEST_CASE("dropping corners is done once and for all", "[geometry][polygon]") {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> bend(-3e-9, 3e-9);
  for (int i = 0; i < 100; ++i) {
    Polygon polygon = regular(5, 1.0);
    Polygon fine;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec2 edge = polygon[(k + 1) % polygon.size()] - polygon[k];
      for (int part = 0; part < 6; ++part) fine.push_back(polygon[k] + edge * part / 6.0 + (part > 0 ? bend(generator) : 0.0) * perpendicular(edge));
    }
    Polygon cleaned;
    for (const int index : corners(fine)) cleaned.push_back(fine[index]);
    CHECK(corners(cleaned).size() == cleaned.size());
  }
}

TEST_CASE("self-intersections name the two edges", "[geometry][polygon]") {
  using Edges = std::pair<int, int>;
  CHECK_FALSE(first_self_intersection(unit_square));
  CHECK_FALSE(first_self_intersection(corner_piece));
  CHECK_FALSE(first_self_intersection(reversed(corner_piece)));
  CHECK_FALSE(first_self_intersection({{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}));
  SECTION("bow tie") {
    CHECK(first_self_intersection({{0.0, 0.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}}) == Edges{0, 2});
  }
  SECTION("vertex on an edge") {
    CHECK(first_self_intersection({{0.0, 0.0}, {4.0, 0.0}, {4.0, 2.0}, {2.0, 0.0}, {0.0, 2.0}}) == Edges{0, 2});
  }
  SECTION("vertex on a vertex") {
    const Polygon two_squares{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {2.0, 1.0}, {2.0, 2.0}, {1.0, 2.0}, {1.0, 1.0}, {0.0, 1.0}};
    CHECK(first_self_intersection(two_squares) == Edges{1, 5});
  }
  SECTION("overlapping edges") {
    const Polygon slit{{0.0, 0.0}, {4.0, 0.0}, {4.0, 2.0}, {3.0, 2.0}, {3.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}, {3.0, 2.0}, {3.0, 3.0}, {0.0, 3.0}};
    CHECK(first_self_intersection(slit).has_value());
  }
  SECTION("a spike folds an edge onto its neighbour") {
    CHECK(first_self_intersection({{0.0, 0.0}, {3.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}) == Edges{0, 1});
    CHECK(first_self_intersection({{1.0, 0.0}, {1.0, 1.0}, {0.0, 0.0}, {3.0, 0.0}}).has_value());
  }
  SECTION("a narrow but open slit is allowed") {
    const double half = 1e-6;
    const Polygon notched{{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {1.0 + half, 2.0}, {1.0 + half, 1.0}, {1.0 - half, 1.0}, {1.0 - half, 2.0}, {0.0, 2.0}};
    CHECK_FALSE(first_self_intersection(notched));
    CHECK_FALSE(first_self_intersection(moved(notched, {1e6, -1e6})));
  }
  SECTION("random stars are simple; with two vertices swapped, most are not") {
    std::mt19937 generator(3);
    for (int i = 0; i < 200; ++i) {
      Polygon star = random_star(generator);
      CHECK_FALSE(first_self_intersection(star));
      std::swap(star[0], star[2]);
      CHECK(first_self_intersection(star).has_value() == crosses_itself(star));
    }
  }
}

TEST_CASE("points inside and outside", "[geometry][polygon]") {
  CHECK(contains(corner_piece, {0.5, 1.5}));
  CHECK(contains(corner_piece, {1.5, 0.5}));
  CHECK_FALSE(contains(corner_piece, {1.5, 1.5}));
  CHECK_FALSE(contains(corner_piece, {-0.5, 1.0}));  // level with vertices
  CHECK(contains(corner_piece, {0.5, 1.0}));
  CHECK_FALSE(contains(corner_piece, {3.0, 1.0}));
  CHECK(contains(reversed(corner_piece), {0.5, 1.5}));
  CHECK(contains(moved(corner_piece, {1e6, 1e6}), {1e6 + 0.5, 1e6 + 1.5}));
}

TEST_CASE("distance to the boundary from inside and outside", "[geometry][polygon]") {
  CHECK(distance_to_boundary(unit_square, {0.5, 0.5}) == 0.5);
  CHECK(distance_to_boundary(unit_square, {0.5, -2.0}) == 2.0);
  CHECK(distance_to_boundary(unit_square, {4.0, 5.0}) == 5.0);
  CHECK(distance_to_boundary(unit_square, {0.25, 1.0}) == 0.0);
  CHECK(distance_to_boundary(corner_piece, {1.5, 1.75}) == 0.5);
  CHECK(distance_to_segment({3.0, 4.0}, {0.0, 0.0}, {0.0, 0.0}) == 5.0);
}

namespace {

using EdgePair = std::pair<int, int>;

/// Every vertex is joined with the one that follows after `stride` others on a circle of 100 m.
Polygon star(int vertices, int stride) {
  Polygon polygon;
  for (int i = 0; i < vertices; ++i) {
    const double angle = 2.0 * 3.14159265358979323846 * static_cast<double>(static_cast<long>(i) * stride % vertices) / vertices;
    polygon.emplace_back(100.0 * std::cos(angle), 100.0 * std::sin(angle));
  }
  return polygon;
}

std::optional<EdgePair> first_of_all_pairs(const Polygon& polygon) {
  const int n = static_cast<int>(polygon.size());
  for (int i = 0; i < n; ++i) {
    for (int j = i + 2; j < n - (i == 0 ? 1 : 0); ++j) {
      if (segments_meet(polygon[i], polygon[i + 1], polygon[j], polygon[(j + 1) % n])) return EdgePair{i, j};
    }
  }
  return std::nullopt;
}

}  // namespace

TEST_CASE("outlines of very many vertices intersect themselves or not", "[geometry][polygon]") {
  Polygon outline = star(200'000, 1);
  CHECK_FALSE(first_self_intersection(outline));
  std::swap(outline[150'000], outline[150'001]);
  CHECK(first_self_intersection(outline) == EdgePair{149'999, 150'001});
}

TEST_CASE("the first of many intersections is found, however many edges lie near each other", "[geometry][polygon]") {
  for (const auto& [vertices, stride] : {std::pair{7, 2}, std::pair{101, 7}, std::pair{1001, 500}}) {
    INFO(vertices << " / " << stride);
    Polygon outline = star(vertices, stride);
    CHECK(first_self_intersection(outline) == first_of_all_pairs(outline));
    std::reverse(outline.begin() + 1, outline.end());
    CHECK(first_self_intersection(outline) == first_of_all_pairs(outline));
  }
}
