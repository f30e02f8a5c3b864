#include "openclose/io/drawing_loads.h"

#include <algorithm>
#include <map>

#include "openclose/io/drawing_units.h"

namespace openclose {
namespace {

/// [px] Between the arrows of a load that is spread along an edge, about.
constexpr double arrow_spacing = 22.0;
/// [px] Of the arrows of forces and tractions: of the largest, and at least.
constexpr double longest_force = 70.0, shortest_force = 18.0, longest_traction = 45.0, shortest_traction = 14.0;

bool is_spread(const Picture::Arrow& load) {
  return !load.spread.isZero(0.0);
}

/// [N] Of a load at a point; [Pa] of one that is spread.
double size_of(const Picture::Arrow& load) {
  return is_spread(load) ? load.vector.norm() / load.spread.norm() : load.vector.norm();
}

/// A traction away from its block, which lies on the left of the stretch.
bool pulls(const Picture::Arrow& load) {
  return is_spread(load) && cross(load.spread, load.vector) < 0.0;
}

}  // namespace

LoadArrows::LoadArrows(const std::vector<Picture::Arrow>& loads) : loads_(loads) {
  for (const Picture::Arrow& load : loads) {
    double& largest = is_spread(load) ? largest_traction_ : largest_force_;
    largest = std::max(largest, size_of(load));
  }
}

Vec2 LoadArrows::outwards(const Picture::Arrow& load) const {
  const double size = size_of(load);
  if (size == 0.0) return Vec2::Zero();
  const double length = is_spread(load) ? std::max(shortest_traction, longest_traction * size / largest_traction_)
                                        : std::max(shortest_force, longest_force * size / largest_force_);
  return (pulls(load) ? length : -length) * load.vector.normalized();
}

std::vector<DrawnLoad> LoadArrows::drawn(const std::function<Vec2(const Vec2&)>& at, bool label_forces) const {
  std::vector<DrawnLoad> list;
  std::map<std::string, std::pair<double, std::size_t>> longest;  // [m] of the stretches with the same number, and which of the list has it
  for (const Picture::Arrow& load : loads_) {
    const double size = size_of(load);
    if (size == 0.0) continue;
    const Vec2 way = outwards(load), out(way.x(), -way.y());
    const Vec2 first = at(load.point - 0.5 * load.spread), last = at(load.point + 0.5 * load.spread);
    const int gaps = is_spread(load) ? std::max(1, static_cast<int>((last - first).norm() / arrow_spacing)) : 0;
    DrawnLoad& drawn = list.emplace_back();
    for (int i = 0; i <= gaps; ++i) {
      const Vec2 foot = gaps == 0 ? first : Vec2(first + static_cast<double>(i) / gaps * (last - first)), end = foot + out;
      // The head is where the load acts, but for one that pulls.
      drawn.arrows.push_back(pulls(load) ? std::pair(foot, end) : std::pair(end, foot));
    }
    drawn.outer_end = first + out;
    drawn.other_outer_end = last + out;
    drawn.head = gaps == 0 ? 11.0 : 8.0;
    drawn.width = gaps == 0 ? 2.4 : 1.6;
    if (gaps == 0 && label_forces) drawn.label = force_text(size);
    if (gaps == 0) continue;
    const auto [place, is_new] = longest.try_emplace(pressure_text(size), load.spread.norm(), list.size() - 1);
    if (load.spread.norm() > place->second.first) place->second = {load.spread.norm(), list.size() - 1};
  }
  for (const auto& [text, place] : longest) list[place.second].label = text;
  return list;
}

}  // namespace openclose
