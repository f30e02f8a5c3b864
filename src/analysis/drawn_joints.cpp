#include "openclose/analysis/drawn_joints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/near_pairs.h"
#include "openclose/geometry/polygon.h"

namespace openclose {
namespace {

/// [-] Of the median block's size: what fos takes as closed.
constexpr double closed_part_of_size = 1e-3;

/// [m] How far the sides of a joint may be apart in the drawing.
double widest_joint(const Scene& scene) {
  std::vector<double> areas;
  for (const BlockInput& block : scene.blocks) {
    if (!block.fixed) areas.push_back(polygon_properties(block.vertices).area);
  }
  if (areas.empty()) return tolerance::farthest_point_from_joint_m;
  const auto middle = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
  std::ranges::nth_element(areas, middle);
  return std::max(tolerance::farthest_point_from_joint_m, closed_part_of_size * std::sqrt(*middle));
}

struct OutlineEdge {
  int block = 0, number = 0;
  Segment segment;
};

std::vector<OutlineEdge> all_edges(const Scene& scene) {
  std::vector<OutlineEdge> edges;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const std::vector<Vec2>& v = scene.blocks[b].vertices;
    for (std::size_t i = 0; i < v.size(); ++i) edges.push_back({static_cast<int>(b), static_cast<int>(i), {v[i], v[(i + 1) % v.size()]}});
  }
  return edges;
}

/// The point of the line through the edge that lies across from this one, along the normal of the other edge.
Vec2 across(const Segment& edge, const Vec2& point, const Vec2& normal) {
  const Vec2 along = edge.to - edge.from;
  return point + normal * (cross(edge.from - point, along) / cross(normal, along));
}

/// The stretch along which two edges face each other; nothing if they do not.
std::optional<DrawnJoint> common_stretch(const OutlineEdge& a, const OutlineEdge& b, double widest) {
  const double length = b.segment.length();
  const Vec2 tangent = (b.segment.to - b.segment.from) / length, normal = -perpendicular(tangent);
  const Vec2 other = (a.segment.to - a.segment.from).normalized();
  const bool faces = tangent.dot(other) < 0.0 && std::abs(cross(tangent, other)) < std::sin(tolerance::parallel_full_rad);
  if (!faces) return std::nullopt;
  // The other edge runs the other way.
  const double begin = std::max(0.0, tangent.dot(a.segment.to - b.segment.from));
  const double end = std::min(length, tangent.dot(a.segment.from - b.segment.from));
  if (end - begin < tolerance::shortest_overlap_m) return std::nullopt;
  DrawnJoint joint{a.block, b.block, a.number, b.number, {}, {}, b.segment.from + begin * tangent, b.segment.from + end * tangent};
  joint.from_a = across(a.segment, joint.from_b, normal);
  joint.to_a = across(a.segment, joint.to_b, normal);
  const bool apart = std::max(std::abs(normal.dot(joint.from_a - joint.from_b)), std::abs(normal.dot(joint.to_a - joint.to_b))) > widest;
  return apart ? std::nullopt : std::optional(joint);
}

Vec2 tangent_of(const DrawnJoint& joint, const BlockSystem& system, JointDirection direction) {
  if (direction == JointDirection::drawn) return (joint.to_b - joint.from_b).normalized();
  const int first = system.block(joint.block_b).first_vertex + joint.edge_b;
  return (system.arm(system.next(first)) - system.arm(first)).normalized();
}

JointGap gap_between(const DrawnJoint& joint, const Vec2& on_a, const Vec2& on_b, const BlockSystem& system, JointDirection direction) {
  const auto moved = [&](int b, const Vec2& point) {
    const Vec2 arm = (point - system.origin()) - system.block(b).reference_centroid;
    return Motion::displacement(system.displacement(b), arm, system.rotation_kind());
  };
  const Vec2 way_a = moved(joint.block_a, on_a), way_b = moved(joint.block_b, on_b);
  const Vec2 tangent = tangent_of(joint, system, direction);
  // Differences of the drawing first: they are small, while coordinates may be large.
  const Vec2 apart = (on_a - on_b) + (way_a - way_b);
  return {0.5 * ((on_a + way_a) + (on_b + way_b)), -perpendicular(tangent).dot(apart), tangent.dot(apart)};
}

}  // namespace

std::vector<DrawnJoint> drawn_joints(const Scene& scene) {
  const std::vector<OutlineEdge> edges = all_edges(scene);
  std::vector<Segment> segments;
  segments.reserve(edges.size());
  for (const OutlineEdge& edge : edges) segments.push_back(edge.segment);
  const double widest = widest_joint(scene);
  const auto pairs = near_pairs(segments, widest, std::numeric_limits<std::size_t>::max());
  std::vector<DrawnJoint> joints;
  for (const auto& [i, j] : pairs.value()) {
    const OutlineEdge &a = edges[i], &b = edges[j];
    if (a.block == b.block || (scene.blocks[a.block].fixed && scene.blocks[b.block].fixed)) continue;
    if (const std::optional<DrawnJoint> joint = common_stretch(a, b, widest)) joints.push_back(*joint);
  }
  std::ranges::sort(joints, {}, [](const DrawnJoint& j) { return std::tuple(j.block_a, j.block_b, j.edge_a, j.edge_b); });
  return joints;
}

DrawnJoint joint_at(const Scene& scene, int block_a, int block_b, const Vec2& point) {
  const auto edges_near = [&](int b) {
    std::vector<int> near;
    const std::vector<Vec2>& v = scene.blocks[b].vertices;
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (distance_to_segment(point, v[i], v[(i + 1) % v.size()]) <= tolerance::farthest_point_from_joint_m) near.push_back(static_cast<int>(i));
    }
    return near;
  };
  const auto edge_of = [&](int b, int i) {
    const std::vector<Vec2>& v = scene.blocks[b].vertices;
    return Segment{v[i], v[(i + 1) % v.size()]};
  };
  DrawnJoint best{block_a, block_b, 0, 0, point, point, point, point};
  double most_opposed = 2.0;
  for (const int i : edges_near(block_a)) {
    for (const int j : edges_near(block_b)) {
      const Segment a = edge_of(block_a, i), b = edge_of(block_b, j);
      const double cosine = (a.to - a.from).normalized().dot((b.to - b.from).normalized());
      if (cosine >= most_opposed) continue;
      most_opposed = cosine;
      const Vec2 normal = -perpendicular((b.to - b.from).normalized());
      best.edge_a = i;
      best.edge_b = j;
      best.from_b = best.to_b = point - normal * normal.dot(point - b.from);
      // A corner against an edge has no edge across from it.
      best.from_a = best.to_a = cosine < 0.0 ? across(a, best.from_b, normal) : point;
    }
  }
  return best;
}

const std::string& name_of_joint(const Scene& scene, const DrawnJoint& joint) {
  static const std::string none;
  const BlockInput &a = scene.blocks[static_cast<std::size_t>(joint.block_a)], &b = scene.blocks[static_cast<std::size_t>(joint.block_b)];
  const int named = a.joint_of_edge(static_cast<std::size_t>(joint.edge_a));
  if (named != BlockInput::by_materials && named == b.joint_of_edge(static_cast<std::size_t>(joint.edge_b)))
    return scene.joints[static_cast<std::size_t>(named)].name;
  const JointProperties* of_materials = scene.joint(a.material, b.material);
  return of_materials ? of_materials->name : none;
}

JointMotion joint_motion(const DrawnJoint& joint, const BlockSystem& system, JointDirection direction) {
  return {gap_between(joint, joint.from_a, joint.from_b, system, direction), gap_between(joint, joint.to_a, joint.to_b, system, direction)};
}

}  // namespace openclose
