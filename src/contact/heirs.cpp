#include "openclose/contact/heirs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

const double cosine_collinear = std::cos(tolerance::parallel_none_rad);

/// Whether `now` continues `before` under another name: the same corner has gone on to a nearly collinear edge, or, at the end of an overlap, the
/// corner that lay on the edge has passed its end and the edge's own corner lies on the other block's edge instead.
bool continues(const BlockSystem& system, const Contact& before, const Contact& now) {
  const auto direction = [&](int e) { return (system.arm(system.next(e)) - system.arm(e)).normalized(); };
  const double cosine = direction(now.edge).dot(direction(before.edge));
  if (now.vertex == before.vertex) return cosine > cosine_collinear;
  const bool edge_end_took_over = now.vertex == before.edge || now.vertex == system.next(before.edge);
  const bool edge_belongs_to_corner = now.edge == before.vertex || system.next(now.edge) == before.vertex;
  return edge_end_took_over && edge_belongs_to_corner && cosine < -cosine_collinear;
}

}  // namespace

int pass_on_history(const BlockSystem& system, std::vector<Contact>& before, const std::vector<int>& gone, std::vector<Contact>& found,
                    std::vector<std::size_t>& born, InheritedForces forces) {
  if (born.empty() || gone.empty()) return 0;
  std::vector<std::pair<int, int>> gone_by_vertex, gone_by_edge;
  for (const int k : gone) {
    gone_by_vertex.emplace_back(before[k].vertex, k);
    gone_by_edge.emplace_back(before[k].edge, k);
  }
  std::sort(gone_by_vertex.begin(), gone_by_vertex.end());
  std::sort(gone_by_edge.begin(), gone_by_edge.end());
  // Longest first: where a corner lies on the seam of two edges the one that carries it inherits.
  std::sort(born.begin(), born.end(),
            [&](std::size_t i, std::size_t j) { return found[i].length != found[j].length ? found[i].length > found[j].length : i < j; });
  int transfers = 0;
  constexpr double taken = -1.0;  // in place of a length
  for (const std::size_t i : born) {
    int ancestor = -1;
    const auto consider = [&](const std::vector<std::pair<int, int>>& those_gone, int key) {
      for (auto it = std::lower_bound(those_gone.begin(), those_gone.end(), std::pair(key, 0)); it != those_gone.end() && it->first == key; ++it) {
        const int k = it->second;
        if (before[k].length == taken || !continues(system, before[k], found[i])) continue;
        const auto rank = [&](int m) { return std::pair(-before[m].length, m); };
        if (ancestor < 0 || rank(k) < rank(ancestor)) ancestor = k;
      }
    };
    consider(gone_by_vertex, found[i].vertex);
    consider(gone_by_edge, found[i].vertex);
    consider(gone_by_edge, system.previous(found[i].vertex));
    if (ancestor < 0) continue;
    inherit(before[ancestor], before[ancestor].stretch(), forces, found[i]);
    before[ancestor].length = taken;
    ++transfers;
  }
  return transfers;
}

}  // namespace openclose
