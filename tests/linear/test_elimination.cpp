#include <algorithm>
#include <numeric>
#include <set>

#include "grids.h"
#include "openclose/linear/elimination.h"
#include "random_systems.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::RandomSystems;

namespace {

RowGraph graph_of(int rows, const std::vector<std::pair<int, int>>& pairs) {
  std::vector<std::set<int>> lists(rows);
  for (const auto& [i, j] : pairs) {
    lists[i].insert(j);
    lists[j].insert(i);
  }
  RowGraph graph;
  for (const auto& list : lists) {
    graph.neighbour.insert(graph.neighbour.end(), list.begin(), list.end());
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

/// Places that elimination in the given sequence couples to each place after it, found by playing it.
std::vector<std::set<int>> filled(const RowGraph& graph, const Elimination& e) {
  std::vector<std::set<int>> later(graph.rows());
  for (int p = 0; p < graph.rows(); ++p) {
    for (int k = graph.start[e.row_at[p]]; k < graph.start[e.row_at[p] + 1]; ++k) {
      if (const int q = e.place_of[graph.neighbour[k]]; q > p) later[p].insert(q);
    }
  }
  for (int p = 0; p < graph.rows(); ++p) {
    for (auto a = later[p].begin(); a != later[p].end(); ++a) later[*a].insert(std::next(a), later[p].end());
  }
  return later;
}

void check_plan(const RowGraph& graph, const std::vector<int>& order) {
  const Elimination e = plan_elimination(graph, order);
  std::vector<int> rows = e.row_at;
  std::sort(rows.begin(), rows.end());
  for (int i = 0; i < graph.rows(); ++i) {
    REQUIRE(rows[i] == i);
    REQUIRE(e.row_at[e.place_of[i]] == i);
  }
  const auto later = filled(graph, e);
  REQUIRE(e.first.back() == graph.rows());
  for (int s = 0; s < e.supernodes(); ++s) {
    const std::vector<int> rest(e.rest.begin() + e.rest_start[s], e.rest.begin() + e.rest_start[s + 1]);
    REQUIRE(std::is_sorted(rest.begin(), rest.end()));
    // The parent owns the first of the rest, and has room for all of it.
    REQUIRE((e.parent[s] < 0) == rest.empty());
    if (e.parent[s] >= 0) {
      const int p = e.parent[s];
      REQUIRE(p > s);
      REQUIRE(rest.front() >= e.first[p]);
      REQUIRE(rest.front() < e.first[p + 1]);
      for (int q : rest) {
        REQUIRE((q < e.first[p + 1] || std::binary_search(e.rest.begin() + e.rest_start[p], e.rest.begin() + e.rest_start[p + 1], q)));
      }
    }
    for (int p = e.first[s]; p < e.first[s + 1]; ++p) {
      for (int q : later[p]) REQUIRE((q < e.first[s + 1] || std::binary_search(rest.begin(), rest.end(), q)));
    }
  }
}

}  // namespace

TEST_CASE("a plan of elimination has room for all that fills in", "[linear][elimination]") {
  RandomSystems random(11);
  for (int rows = 1; rows <= 60; ++rows) {
    const RowGraph graph = graph_of(rows, random.couplings(rows, random.below(3 * rows)));
    std::vector<int> order(rows);
    std::iota(order.begin(), order.end(), 0);
    for (int i = rows - 1; i > 0; --i) std::swap(order[i], order[random.below(i + 1)]);
    check_plan(graph, order);
  }
}

TEST_CASE("rows that couple the same later ones are eliminated together", "[linear][elimination]") {
  std::vector<std::pair<int, int>> all;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < i; ++j) all.emplace_back(i, j);
  }
  std::vector<int> order(40);
  std::iota(order.begin(), order.end(), 0);
  CHECK(plan_elimination(graph_of(40, all), order).supernodes() == 1);
  // A long chain from one end: two rows together store a zero at most in eight places, four rows 6 in 24, so that chunks come out.
  std::vector<std::pair<int, int>> chain;
  for (int i = 0; i < 39; ++i) chain.emplace_back(i, i + 1);
  const int pieces = plan_elimination(graph_of(40, chain), order).supernodes();
  CHECK(pieces > 1);
  CHECK(pieces <= 20);
}

TEST_CASE("zeros stored for the sake of larger supernodes are few", "[linear][elimination]") {
  const RowGraph graph = graph_of(30 * 30, test::grid_pairs(30, 30));
  std::vector<int> order(900);
  std::iota(order.begin(), order.end(), 0);
  const Elimination e = plan_elimination(graph, order);
  double needed = 0.0, stored = 0.0;
  for (const auto& list : filled(graph, e)) needed += 1.0 + 2.0 * static_cast<double>(list.size());
  for (int s = 0; s < e.supernodes(); ++s) stored += static_cast<double>(e.own(s)) * (e.own(s) + 2.0 * e.rest_size(s));
  CHECK(stored >= needed);
  CHECK(stored <= 1.5 * needed);
}
