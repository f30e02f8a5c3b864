#include "openclose/linear/elimination.h"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace openclose {
namespace {

/// [-] A supernode of up to so many rows may be united with its parent as long as no more than this part of what they store together is zeros: small
/// dense matrices cost more in calls than in arithmetic.
struct Relaxation {
  int rows;
  double zeros;
};
constexpr Relaxation relaxations[] = {{4, 0.6}, {12, 0.3}, {32, 0.1}};
constexpr double zeros_of_large = 0.03;

std::vector<int> elimination_tree(const RowGraph& graph, const std::vector<int>& row_at, const std::vector<int>& place_of) {
  const int rows = graph.rows();
  std::vector<int> parent(rows, -1), ancestor(rows, -1);
  for (int i = 0; i < rows; ++i) {
    for (int k = graph.start[row_at[i]]; k < graph.start[row_at[i] + 1]; ++k) {
      for (int j = place_of[graph.neighbour[k]]; j < i && j != -1;) {
        const int next = ancestor[j];
        ancestor[j] = i;
        if (next == -1) parent[j] = i;
        j = next == i ? -1 : next;
      }
    }
  }
  return parent;
}

/// Nodes of a forest, children before parents and every subtree in one piece.
std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> first_child(n, -1), next_sibling(n, -1), roots, order, stack;
  for (int i = n - 1; i >= 0; --i) {
    if (parent[i] < 0) continue;
    next_sibling[i] = first_child[parent[i]];
    first_child[parent[i]] = i;
  }
  for (int root = 0; root < n; ++root) {
    if (parent[root] >= 0) continue;
    stack.assign(1, root);
    while (!stack.empty()) {
      const int node = stack.back();
      if (const int child = first_child[node]; child >= 0) {
        first_child[node] = next_sibling[child];
        stack.push_back(child);
      } else {
        order.push_back(node);
        stack.pop_back();
      }
    }
  }
  return order;
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<int>(i);
  return place;
}

/// Calls f(node, list) with the later places that each node couples, in the order of the nodes; a list is dropped once the parent has it.
/// `own_first` and `own_end` delimit the places of a node.
template <class F>
void for_each_rest(const RowGraph& graph, const std::vector<int>& row_at, const std::vector<int>& place_of, const std::vector<int>& first,
                   const std::vector<int>& parent, F f) {
  const int nodes = static_cast<int>(parent.size());
  std::vector<std::vector<int>> from_children(nodes);
  std::vector<int> seen(graph.rows(), -1);
  for (int node = 0; node < nodes; ++node) {
    std::vector<int> list;
    const auto take = [&](int place) {
      if (place < first[node + 1] || seen[place] == node) return;
      seen[place] = node;
      list.push_back(place);
    };
    for (int place : from_children[node]) take(place);
    std::vector<int>().swap(from_children[node]);
    for (int p = first[node]; p < first[node + 1]; ++p) {
      for (int k = graph.start[row_at[p]]; k < graph.start[row_at[p] + 1]; ++k) take(place_of[graph.neighbour[k]]);
    }
    f(node, list);
    if (parent[node] < 0) continue;
    std::vector<int>& above = from_children[parent[node]];
    above.insert(above.end(), list.begin(), list.end());
  }
}

struct Supernodes {
  std::vector<int> own, rest, parent;  ///< numbers of rows, parent
  std::vector<int> of_place;
};

/// Rows that follow one another and couple the same later rows.
Supernodes fundamental(const std::vector<int>& tree, const std::vector<int>& later) {
  const int rows = static_cast<int>(tree.size());
  std::vector<int> children(rows, 0);
  for (int p : tree) {
    if (p >= 0) ++children[p];
  }
  Supernodes s;
  s.of_place.resize(rows);
  std::vector<int> last;
  for (int i = 0; i < rows; ++i) {
    const bool goes_on = i > 0 && tree[i - 1] == i && children[i] == 1 && later[i] == later[i - 1] - 1;
    if (!goes_on) {
      s.own.push_back(0);
      last.push_back(i);
    }
    s.of_place[i] = static_cast<int>(s.own.size()) - 1;
    ++s.own.back();
    last.back() = i;
  }
  for (int i : last) {
    s.rest.push_back(later[i]);
    s.parent.push_back(tree[i] < 0 ? -1 : s.of_place[tree[i]]);
  }
  return s;
}

double stored(double own, double rest) {
  return own * (own + 2.0 * rest);
}

bool worth_uniting(int own, double zeros, double all) {
  for (const Relaxation& r : relaxations) {
    if (own <= r.rows) return zeros <= r.zeros * all;
  }
  return zeros <= zeros_of_large * all;
}

/// For each supernode the one it ends up in.
std::vector<int> unite(Supernodes& s) {
  const int n = static_cast<int>(s.own.size());
  std::vector<double> useful(n);
  for (int i = 0; i < n; ++i) useful[i] = stored(s.own[i], s.rest[i]);
  std::vector<int> into(n);
  std::iota(into.begin(), into.end(), 0);
  for (int child = 0; child < n; ++child) {
    const int p = s.parent[child];
    if (p < 0) continue;
    const int own = s.own[child] + s.own[p];
    const double all = stored(own, s.rest[p]), used = useful[child] + useful[p];
    if (!worth_uniting(own, all - used, all)) continue;
    into[child] = p;
    s.own[p] = own;
    useful[p] = used;
  }
  for (int i = n - 1; i >= 0; --i) into[i] = into[into[i]];
  return into;
}

}  // namespace

Elimination plan_elimination(const RowGraph& graph, const std::vector<int>& order) {
  const int rows = graph.rows();
  Elimination e;
  std::vector<int> tree = elimination_tree(graph, order, inverse(order));
  const std::vector<int> post = postorder(tree);
  const std::vector<int> renumbered = inverse(post);
  e.row_at.resize(rows);
  std::vector<int> tree_of_places(rows);
  for (int i = 0; i < rows; ++i) {
    e.row_at[i] = order[post[i]];
    tree_of_places[i] = tree[post[i]] < 0 ? -1 : renumbered[tree[post[i]]];
  }
  e.place_of = inverse(e.row_at);

  std::vector<int> single(rows + 1), later(rows);
  std::iota(single.begin(), single.end(), 0);
  for_each_rest(graph, e.row_at, e.place_of, single, tree_of_places,
                [&](int i, const std::vector<int>& list) { later[i] = static_cast<int>(list.size()); });
  Supernodes s = fundamental(tree_of_places, later);
  const std::vector<int> into = unite(s);

  // Number what is left, and the rows in it, anew.
  const int before = static_cast<int>(into.size());
  std::vector<int> number(before, -1), kept, parent;
  for (int i = 0; i < before; ++i) {
    if (into[i] != i) continue;
    number[i] = static_cast<int>(kept.size());
    kept.push_back(i);
  }
  for (int i : kept) parent.push_back(s.parent[i] < 0 ? -1 : number[into[s.parent[i]]]);
  const std::vector<int> sequence = postorder(parent), place = inverse(sequence);
  std::vector<std::vector<int>> members(kept.size());
  for (int i = 0; i < rows; ++i) members[place[number[into[s.of_place[i]]]]].push_back(e.row_at[i]);
  e.row_at.clear();
  e.first.assign(1, 0);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    e.row_at.insert(e.row_at.end(), members[k].begin(), members[k].end());
    e.first.push_back(static_cast<int>(e.row_at.size()));
    const int above = parent[sequence[k]];
    e.parent.push_back(above < 0 ? -1 : place[above]);
  }
  e.place_of = inverse(e.row_at);

  e.rest_start.assign(1, 0);
  for_each_rest(graph, e.row_at, e.place_of, e.first, e.parent, [&](int, std::vector<int>& list) {
    std::sort(list.begin(), list.end());
    e.rest.insert(e.rest.end(), list.begin(), list.end());
    e.rest_start.push_back(static_cast<int>(e.rest.size()));
  });
  return e;
}

}  // namespace openclose
