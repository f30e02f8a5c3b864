#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "openclose/geometry/near_pairs.h"
#include "openclose/geometry/plane_graph.h"
#include "openclose/geometry/touch.h"
#include "support/catch.h"

using namespace openclose;

namespace {

/// Whether two edges lie on a common cycle, by removing each node in turn: slow, and plain.
std::vector<int> reachable(int start, int without, int node_count, const std::vector<GraphEdge>& edges) {
  std::vector<int> seen(node_count, 0);
  std::vector<int> open{start};
  seen[start] = 1;
  while (!open.empty()) {
    const int node = open.back();
    open.pop_back();
    for (const auto& [a, b] : edges) {
      if (a == without || b == without || (a != node && b != node)) continue;
      const int other = a == node ? b : a;
      if (seen[other] == 0) {
        seen[other] = 1;
        open.push_back(other);
      }
    }
  }
  return seen;
}

bool is_cut_node(int node, int node_count, const std::vector<GraphEdge>& edges) {
  std::vector<int> neighbours;
  for (const auto& [a, b] : edges) {
    if (a == node) neighbours.push_back(b);
    if (b == node) neighbours.push_back(a);
  }
  if (neighbours.size() < 2) return false;
  const std::vector<int> seen = reachable(neighbours[0], node, node_count, edges);
  return std::any_of(neighbours.begin(), neighbours.end(), [&](int n) { return seen[n] == 0; });
}

}  // namespace

TEST_CASE("biconnected components of small graphs", "[geometry][plane_graph]") {
  SECTION("two triangles that share a node") {
    const std::vector<int> c = biconnected_components(5, {{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 4}, {4, 2}});
    CHECK(c[0] == c[1]);
    CHECK(c[0] == c[2]);
    CHECK(c[3] == c[4]);
    CHECK(c[3] == c[5]);
    CHECK(c[0] != c[3]);
  }
  SECTION("a square with a tail and an isolated node") {
    const std::vector<int> c = biconnected_components(7, {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {2, 4}, {4, 5}});
    CHECK(std::set<int>(c.begin(), c.begin() + 4).size() == 1);
    CHECK(std::set<int>(c.begin(), c.end()).size() == 3);
  }
}

TEST_CASE("biconnected components meet in cut nodes only", "[geometry][plane_graph]") {
  std::mt19937 generator(4);
  for (int round = 0; round < 300; ++round) {
    const int nodes = 10;
    std::uniform_int_distribution<int> any(0, nodes - 1);
    std::set<GraphEdge> chosen;
    for (int i = 0; i < 6 + round % 10; ++i) {
      const int a = any(generator);
      const int b = any(generator);
      if (a != b) chosen.insert(std::minmax(a, b));
    }
    const std::vector<GraphEdge> edges(chosen.begin(), chosen.end());
    const std::vector<int> component = biconnected_components(nodes, edges);
    for (int node = 0; node < nodes; ++node) {
      std::set<int> here;
      for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].first == node || edges[e].second == node) here.insert(component[e]);
      }
      CHECK((here.size() > 1) == is_cut_node(node, nodes, edges));
    }
  }
}

TEST_CASE("faces of a square with a diagonal", "[geometry][plane_graph]") {
  const std::vector<Vec2> nodes{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  const Faces faces = trace_faces(nodes, {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}});
  REQUIRE(faces.cycles.size() == 3);
  CHECK(faces.cycles[0] == std::vector<int>{0, 2, 9});
  CHECK(faces.cycles[1] == std::vector<int>{1, 7, 5, 3});  // outside, clockwise
  CHECK(faces.cycles[2] == std::vector<int>{4, 6, 8});
}

TEST_CASE("no near pair is left out", "[geometry][near_pairs]") {
  std::mt19937 generator(8);
  std::uniform_real_distribution<double> place(0.0, 100.0);
  const double longest = GENERATE(1.0, 20.0, 200.0);
  std::uniform_real_distribution<double> length(-longest, longest);
  std::vector<Segment> segments;
  for (int i = 0; i < 400; ++i) {
    // Half of them in one corner.
    const Vec2 from = (i % 2 == 0 ? 1.0 : 0.01) * Vec2(place(generator), place(generator));
    segments.push_back({from, from + (i % 2 == 0 ? 1.0 : 0.01) * Vec2(length(generator), length(generator))});
  }
  const auto pairs = *near_pairs(segments, 0.0, 1000000);
  CHECK(std::is_sorted(pairs.begin(), pairs.end()));
  const std::set<std::pair<int, int>> found(pairs.begin(), pairs.end());
  CHECK(found.size() == pairs.size());
  for (int i = 0; i < 400; ++i) {
    for (int j = i + 1; j < 400; ++j) {
      if (segments_meet(segments[i].from, segments[i].to, segments[j].from, segments[j].to)) CHECK(found.count({i, j}) == 1);
    }
  }
  CHECK_FALSE(near_pairs(segments, 0.0, 0));
}

TEST_CASE("needles side by side are parted at any angle", "[geometry][near_pairs]") {
  constexpr int count = 40000;
  std::vector<Segment> edges;
  const auto corner = [](int i) {
    const double angle = 2.0 * M_PI * i / count;
    return Vec2((i % 2 == 0 ? 100.0 : 105.0) * Vec2(std::cos(angle), std::sin(angle)));
  };
  for (int i = 0; i < count; ++i) edges.push_back({corner(i), corner(i + 1)});
  // Boxes of hundreds of other edges overlap that of an edge that runs across both axes; only neighbours touch.
  const auto pairs = near_pairs(edges, 1e-6, 20 * count);
  REQUIRE(pairs);
  const std::set<std::pair<int, int>> found(pairs->begin(), pairs->end());
  for (int i = 0; i + 1 < count; ++i) CHECK(found.count({i, i + 1}) == 1);
  CHECK(found.count({0, count - 1}) == 1);

  // Another one across two hundred of them: all are found.
  edges.push_back({Vec2(102.0 * Vec2(std::cos(0.7), std::sin(0.7))), Vec2(102.0 * Vec2(std::cos(0.7 + 0.01 * M_PI), std::sin(0.7 + 0.01 * M_PI)))});
  int meet = 0;
  const auto with_it = *near_pairs(edges, 1e-6, 20 * count);
  const std::set<std::pair<int, int>> all(with_it.begin(), with_it.end());
  for (int i = 0; i < count; ++i) {
    if (!segments_meet(edges[i].from, edges[i].to, edges[count].from, edges[count].to)) continue;
    ++meet;
    CHECK(all.count({i, count}) == 1);
  }
  CHECK(meet >= 199);
}

TEST_CASE("the part of a line that touches a polygon", "[geometry][touch]") {
  const Polygon square{{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};
  CHECK(common_length({{-1.0, 0.0}, {5.0, 0.0}}, square) == Approx(2.0));
  CHECK(common_length({{1.0, 0.0}, {1.5, 0.0}}, square) == Approx(0.5));
  // No vertex that is away from the line lies above an end of the edge on it.
  CHECK(common_length({{-5.0, 0.0}, {5.0, 0.0}}, {{0.0, 0.0}, {2.0, 0.0}, {2.3, 1.0}, {-0.7, 1.0}}) == Approx(2.0));
  CHECK(common_length({{-1.0, 1.0}, {1.0, 1.0}}, square) == Approx(1.0));
  CHECK(common_length({{0.5, 0.5}, {1.0, 1.0}}, square) == Approx(std::sqrt(0.5)));
  CHECK(common_length({{-1.0, -1e-7}, {5.0, 1e-7}}, square) == Approx(2.0));
  // It enters and leaves through slanted edges, at x = 1/3 and x = 3, where no corner lies above it.
  CHECK(common_length({{-1.0, 1.0}, {5.0, 1.0}}, {{0.0, 0.0}, {4.0, 0.0}, {1.0, 3.0}}) == Approx(8.0 / 3.0));
  SECTION("a corner is not enough") {
    CHECK(common_length({{2.0, 2.0}, {5.0, 2.0}}, square) < 1e-5);
    CHECK(common_length({{1.0, 3.0}, {3.0, 1.0}}, square) < 1e-5);
    CHECK(common_length({{3.0, 0.0}, {3.0, 2.0}}, square) == 0.0);
  }
}
