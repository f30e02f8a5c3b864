#include "openclose/statics/joint_sections.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "openclose/core/tolerance.h"
#include "openclose/law/edge_stress.h"

namespace openclose {
namespace {

/// The line on which a contact lies in the drawing, counter-clockwise around the block with the lower number.
struct Line {
  Vec2 along;  ///< of length 1
  Vec2 corner;
  double ahead, behind;  ///< [units of length] of what is joined at the corner

  Line(const BlockSystem& system, const GroundOutline& ground, const Contact& contact, const Joined& joined)
      : along((system.position(contact.edge_block, system.next(contact.edge)) - system.position(contact.edge_block, contact.edge)).normalized()),
        corner(system.position(contact.vertex_block, contact.vertex)),
        ahead(joined.ahead),
        behind(joined.behind) {
    if (ground.body(contact.edge_block) < ground.body(contact.vertex_block)) return;
    along = -along;
    std::swap(ahead, behind);
  }

  /// A corner may be off a face by the gap. The longer of the two faces that it makes of it leaves the line that it lies on by at most twice
  /// that, at the other end of the shorter one.
  bool continues(const Line& other, double gap) const {
    return along.dot(other.along) >= std::cos(tolerance::parallel_none_rad) && std::abs(cross(along, other.corner - corner)) <= 2.0 * gap;
  }
};

/// A section that grows, with the line of its first contact.
struct Growing {
  Line line;
  JointSection section;
};

/// Whether the outline of a block stays on a line from a contact to another one, ahead of it.
bool stays_on_line(const BlockSystem& system, const GroundOutline& ground, int block, const Line& line, const Contact& from, double ahead,
                   double gap) {
  const int other = block == from.vertex_block ? from.edge_block : from.vertex_block;
  const bool is_forward = ground.body(block) < ground.body(other);  // the outlines of two blocks run against each other
  const auto end_of = [&](const GroundOutline::BlockEdge& edge, const Vec2& point) {
    return is_forward ? ground.end_ahead(system, edge, point) : ground.end_back(system, edge, point);
  };
  const auto next = [&](int b, int v) {
    return end_of(is_forward ? ground.edge_ahead(b, v) : ground.edge_back(system, b, v), system.position(b, v));
  };
  const Vec2 start = system.position(from.vertex_block, from.vertex);
  auto [at_block, v] = block == from.vertex_block ? next(block, from.vertex) : end_of({block, from.edge}, start);
  // An outline that does not leave the line comes round within as many steps as there are vertices.
  for (std::size_t k = 0; k < system.state().arm.size(); ++k) {
    const Vec2 way = system.position(at_block, v) - start;
    if (line.along.dot(way) >= ahead) return true;
    if (std::abs(cross(line.along, way)) > 2.0 * gap) return false;
    std::tie(at_block, v) = next(at_block, v);
  }
  return false;
}

/// A corner that points away from the other block, if only by rounding, has no contact, and half of the faces on both its sides none either: where
/// the faces touch, the contacts on both sides of such a hole stand for it, too, each for what is nearer to it.
void fill_holes(const BlockSystem& system, const GroundOutline& ground, const std::vector<Contact>& contacts, double gap, Growing& growing) {
  constexpr double rounding = 1e-9;  // [-]
  JointSection& section = growing.section;
  // Two that meet at a corner are both there: what tells them apart is where they go from it.
  std::ranges::sort(section, {}, [](const PlaceInJoint& place) { return place.low + place.high; });
  for (std::size_t i = 0; i + 1 < section.size(); ++i) {
    PlaceInJoint &here = section[i], &next = section[i + 1];
    const Contact &from = contacts[here.contact], &to = contacts[next.contact];
    const double between = next.at - here.at;
    if (next.low - here.high <= rounding * between || from.joint != to.joint) continue;
    const auto touches = [&](int block) { return stays_on_line(system, ground, block, growing.line, from, (1.0 - rounding) * between, gap); };
    if (!touches(from.vertex_block) || !touches(from.edge_block)) continue;
    const double middle = std::clamp(0.5 * (here.at + next.at), here.high, next.low);
    here.filled += middle - here.high;
    next.filled += next.low - middle;
    here.high = next.low = middle;
  }
}

}  // namespace

std::vector<JointSection> joint_sections(const BlockSystem& system, const GroundOutline& ground, const std::vector<Contact>& contacts,
                                         const std::vector<Joined>& joined, double gap) {
  std::map<std::pair<int, int>, std::vector<Growing>> of_blocks;
  std::vector<int> longest_first(contacts.size());
  std::iota(longest_first.begin(), longest_first.end(), 0);
  std::ranges::stable_sort(longest_first, std::greater(), [&](int i) { return joined[i].length; });
  for (const int i : longest_first) {
    if (joined[i].length == 0.0) continue;
    const Contact& contact = contacts[i];
    const Line line(system, ground, contact, joined[i]);
    std::vector<Growing>& known = of_blocks[std::minmax({ground.body(contact.vertex_block), ground.body(contact.edge_block)})];
    auto growing = std::ranges::find_if(known, [&](const Growing& g) { return g.line.continues(line, gap); });
    if (growing == known.end()) growing = known.insert(known.end(), {line, {}});
    const double at = growing->line.along.dot(line.corner - growing->line.corner);
    growing->section.push_back({i, at, at - line.behind, at + line.ahead});
  }
  std::vector<JointSection> sections;
  for (auto& [blocks, list] : of_blocks) {
    for (Growing& growing : list) {
      fill_holes(system, ground, contacts, gap, growing);
      sections.push_back(std::move(growing.section));
    }
  }
  return sections;
}

std::vector<double> pulls_at_edges(const std::vector<JointSection>& sections, std::size_t contacts, const std::function<EndOfJoint(int)>& end_of) {
  std::vector<double> pulls(contacts, 0.0);
  std::vector<PartOfJoint> parts;
  for (const JointSection& section : sections) {
    parts.clear();
    bool is_bonded = false;
    for (const PlaceInJoint& place : section) {
      const EndOfJoint end = end_of(place.contact);
      is_bonded |= end.tension > 0.0;
      // What has cracked holds as long as it presses.
      if (end.tension > 0.0 || end.normal > 0.0) parts.push_back({place.low, place.high, place.at, end.normal});
    }
    if (!is_bonded) continue;
    const LinearStress stress(parts);
    for (const PlaceInJoint& place : section) {
      const EndOfJoint end = end_of(place.contact);
      const double pull = -std::min(stress.at(place.low), stress.at(place.high)) * end.length;
      if (end.tension > 0.0) pulls[place.contact] = std::max(0.0, pull / end.tension);
    }
  }
  return pulls;
}

}  // namespace openclose
