#include "openclose/analysis/loose_motion.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "openclose/analysis/simulation.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/polygon.h"

namespace openclose {
namespace {

/// [-] of the fastest corner of a block: a point that is slower stands still, and a joint that parts more slowly is slid along. Mechanisms are known
/// to three digits, displacements of a block that has moved a metre bend the path by some percent.
constexpr double slow = 0.1;
/// [-] To which mechanisms of limit analysis open a joint by its friction angle.
constexpr double exact = 1e-3;
constexpr std::size_t most_named = 3;
/// Blocks that are looked at; of more, the fastest.
constexpr std::size_t most_described = 200;

/// A point at which a block touches another one, the direction of the edge there and its joint, if there is one.
struct Touch {
  int other;
  Vec2 along, point;
  const JointProperties* joint;
  bool is_within_edge;  ///< not at its end
};

struct Description {
  std::string words;
  bool by_itself = true;    ///< not carried by another block that moves
  bool is_specific = true;  ///< says more than a direction
};

class Describer {
 public:
  Describer(const Scene& scene, const std::vector<FailingBlock>& mechanism) : scene_(scene), moving_(scene.blocks.size(), nullptr) {
    for (const FailingBlock& block : mechanism) moving_[static_cast<std::size_t>(block.block)] = &block;
  }

  static Vec2 velocity_at(const FailingBlock& block, const Vec2& point) {
    return block.velocity + block.rotation * perpendicular(point - block.centroid);
  }

  double fastest(const FailingBlock& block) const {
    double speed = 0.0;
    for (const Vec2& vertex : polygon(block)) speed = std::max(speed, velocity_at(block, vertex).norm());
    return speed;
  }

  /// What moves with others as one body is told by the first of them, in the given order, that slides, turns or is hinged against something else.
  std::vector<Description> describe(const std::vector<FailingBlock>& blocks) const {
    std::vector<std::vector<Touch>> touches;
    for (const FailingBlock& block : blocks) touches.push_back(touches_of(block));
    const std::vector<std::size_t> body = bodies(blocks, touches);
    std::vector<Description> own;
    for (std::size_t i = 0; i < blocks.size(); ++i) own.push_back(describe(blocks[i], beyond_body(i, blocks, touches[i], body)));
    std::vector<Description> told;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const std::size_t first = teller(body[i], own, body);
      if (first == i) {
        told.push_back(own[i]);
      } else {
        const std::string leader = name_of(blocks[first].block);
        told.push_back({fmt::format("{} moves with {} (what holds {} would hold it)", name_of(blocks[i].block), leader, leader), false});
      }
    }
    return told;
  }

 private:
  Description describe(const FailingBlock& block, const std::vector<Touch>& touches) const {
    const std::string name = name_of(block.block);
    const std::optional<std::string> centre = centre_of(block, touches);
    if (centre) return {fmt::format("{} turns about {} ({})", name, *centre, held_in_turning), true};
    if (touches.empty() && touches_of(block).empty())
      return {fmt::format("{} touches no other block and moves {} ({})", name, heading(block), held_by_anything), true};
    if (const auto sliding = sliding_of(block, touches)) return {name + *sliding, true};
    if (const auto hinge = hinge_of(block, touches)) return {name + *hinge, true};
    const bool carried = std::any_of(touches.begin(), touches.end(), [&](const Touch& t) { return moving_[static_cast<std::size_t>(t.other)]; });
    return {fmt::format("{} moves {} ({})", name, heading(block), held_by_anything), !carried, false};
  }

  /// Of each block, the first block of the body that it is part of.
  std::vector<std::size_t> bodies(const std::vector<FailingBlock>& blocks, const std::vector<std::vector<Touch>>& touches) const {
    std::vector<std::size_t> index(scene_.blocks.size(), blocks.size()), body(blocks.size());
    for (std::size_t i = 0; i < blocks.size(); ++i) index[static_cast<std::size_t>(blocks[i].block)] = body[i] = i;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (const Touch& touch : touches[i]) {
        const std::size_t other = index[static_cast<std::size_t>(touch.other)];
        if (other == blocks.size() || body[other] == body[i] || !moves_with(blocks[i], touch.other)) continue;
        const auto [kept, gone] = std::minmax({body[i], body[other]});
        std::replace(body.begin(), body.end(), gone, kept);
      }
    }
    return body;
  }

  /// Whether no corner of a block moves against another moving one.
  bool moves_with(const FailingBlock& block, int other) const {
    const Polygon& corners = polygon(block);
    return std::all_of(corners.begin(), corners.end(),
                       [&](const Vec2& corner) { return relative_velocity(block, other, corner).norm() < slow * fastest(block); });
  }

  /// Touches with what is not part of the same body.
  static std::vector<Touch> beyond_body(std::size_t i, const std::vector<FailingBlock>& blocks, const std::vector<Touch>& touches,
                                        const std::vector<std::size_t>& body) {
    std::vector<Touch> kept;
    for (const Touch& touch : touches) {
      const auto is_other = [&](const FailingBlock& b) { return b.block == touch.other; };
      const auto other = std::find_if(blocks.begin(), blocks.end(), is_other);
      if (other == blocks.end() || body[static_cast<std::size_t>(other - blocks.begin())] != body[i]) kept.push_back(touch);
    }
    return kept;
  }

  static std::size_t teller(std::size_t body, const std::vector<Description>& own, const std::vector<std::size_t>& bodies) {
    for (std::size_t i = body; i < own.size(); ++i) {
      if (bodies[i] == body && own[i].is_specific) return i;
    }
    return body;
  }

  static constexpr const char* held_by_anything = "a block in its way, a [[support]] or fixed = true would hold it";
  static constexpr const char* held_at_hinge = "thicker blocks, a [[support]] or tensile_strength_pa of the joints that open would hold it";
  static constexpr const char* held_in_turning =
      "a block or a [[support]] on the side that goes down, or tensile_strength_pa of its joints, would hold it";

  const Polygon& polygon(const FailingBlock& block) const { return scene_.blocks[static_cast<std::size_t>(block.block)].vertices; }

  std::string heading(const FailingBlock& block) const { return heading(Vec2(block.velocity.normalized())); }

  std::string heading(const Vec2& direction) const {
    const Vec2 down = -Vec2::UnitY();
    const bool gravity_is_down = !scene_.gravity.isZero(0.0) && scene_.gravity.normalized().dot(down) > 1.0 - slow;
    if (gravity_is_down && direction.dot(scene_.gravity.normalized()) > 1.0 - slow) return "down";
    // Not "-0.00": a zero with a sign adds to zero without one.
    const auto rounded = [](double part) { return std::round(100.0 * part) / 100.0 + 0.0; };
    return fmt::format("towards ({:.2f}, {:.2f})", rounded(direction.x()), rounded(direction.y()));
  }

  std::string name_of(int block) const { return fmt::format("\"{}\"", scene_.blocks[static_cast<std::size_t>(block)].name); }

  static std::string at(const Vec2& point) { return fmt::format("({:.4g}, {:.4g})", point.x(), point.y()); }

  /// The point of the block about which it turns; none if it does not turn, or moves on with that point.
  std::optional<std::string> centre_of(const FailingBlock& block, const std::vector<Touch>& touches) const {
    const double still = slow * fastest(block);
    for (const Support& support : scene_.supports) {
      if (support.block == block.block && velocity_at(block, support.point).norm() < still) return "its support at " + at(support.point);
    }
    const Polygon& vertices = polygon(block);
    const auto slower = [&](const Vec2& a, const Vec2& b) { return velocity_at(block, a).norm() < velocity_at(block, b).norm(); };
    const Vec2 slowest = *std::min_element(vertices.begin(), vertices.end(), slower);
    if (velocity_at(block, slowest).norm() < still) return "its corner at " + at(slowest);
    for (const Touch& touch : touches) {
      if (velocity_at(block, touch.point).norm() < still) return fmt::format("the corner of {} at {}", name_of(touch.other), at(touch.point));
    }
    double reach = 0.0;
    for (const Vec2& vertex : vertices) reach = std::max(reach, (vertex - block.centroid).norm());
    const FailingBlock real = without_dilatancy(block, touches, reach);
    if (std::abs(real.rotation) * reach < 0.5 * fastest(real)) return std::nullopt;
    return at(real.centroid + perpendicular(real.velocity) / real.rotation);
  }

  /// The motion nearest to that of the mechanism which does not part joints along which the block slides, and keeps it where it does not move against
  /// a neighbour.
  FailingBlock without_dilatancy(const FailingBlock& block, const std::vector<Touch>& touches, double reach) const {
    std::vector<Eigen::Vector3d> rows;
    std::vector<double> opening;
    for (const Touch& touch : touches) {
      const Vec2 relative = relative_velocity(block, touch.other, touch.point), arm = touch.point - block.centroid;
      const bool is_still = relative.norm() < slow * fastest(block);
      if (!is_still && !is_opened_by_friction(relative, touch, exact * relative.norm())) continue;
      const auto keep = [&](const Vec2& direction, double change) {
        rows.emplace_back(direction.x(), direction.y(), cross(arm, direction) / reach);
        opening.push_back(change);
      };
      const Vec2 normal = perpendicular(touch.along);
      keep(normal, is_still ? 0.0 : -normal.dot(relative));
      if (is_still) keep(touch.along, 0.0);
    }
    if (rows.empty()) return block;
    Eigen::MatrixX3d kept(static_cast<Eigen::Index>(rows.size()), 3);
    Eigen::VectorXd changes(kept.rows());
    for (Eigen::Index i = 0; i < kept.rows(); ++i) {
      kept.row(i) = rows[static_cast<std::size_t>(i)];
      changes[i] = opening[static_cast<std::size_t>(i)];
    }
    const Eigen::Vector3d change = kept.completeOrthogonalDecomposition().solve(changes);
    FailingBlock real = block;
    real.velocity += change.head<2>();
    real.rotation += change[2] / reach;
    return real;
  }

  void add_touches(const BlockInput& corners, const BlockInput& edges, int other, std::vector<Touch>& touches) const {
    const std::size_t count = edges.vertices.size();
    for (std::size_t e = 0; e < count; ++e) {
      const Vec2 &from = edges.vertices[e], &to = edges.vertices[(e + 1) % count];
      for (std::size_t v = 0; v < corners.vertices.size(); ++v) {
        const Vec2& corner = corners.vertices[v];
        if (distance_to_segment(corner, from, to) <= tolerance::farthest_point_from_joint_m)
          touches.push_back(
              {other, (to - from).normalized(), corner, joint_of(corners, v, edges, e), is_apart(corner, from) && is_apart(corner, to)});
      }
    }
  }

  static bool is_apart(const Vec2& a, const Vec2& b) { return (a - b).norm() > tolerance::farthest_point_from_joint_m; }

  /// As JointTable has it of contacts: of the name of the edge where an edge at the corner has the same, else of the materials.
  const JointProperties* joint_of(const BlockInput& corners, std::size_t v, const BlockInput& edges, std::size_t e) const {
    const int seam = edges.joint_of_edge(e);
    const std::size_t before = (v + corners.vertices.size() - 1) % corners.vertices.size();
    const bool is_in_seam = seam != BlockInput::by_materials && (corners.joint_of_edge(v) == seam || corners.joint_of_edge(before) == seam);
    return is_in_seam ? &scene_.joints[static_cast<std::size_t>(seam)] : scene_.joint(corners.material, edges.material);
  }

  std::vector<Touch> touches_of(const FailingBlock& block) const {
    std::vector<Touch> touches;
    const Box reach = Box::around(polygon(block)).inflated(tolerance::farthest_point_from_joint_m);
    for (std::size_t other = 0; other < scene_.blocks.size(); ++other) {
      const BlockInput &one = scene_.blocks[static_cast<std::size_t>(block.block)], &another = scene_.blocks[other];
      if (static_cast<int>(other) == block.block || !reach.overlaps(Box::around(another.vertices))) continue;
      add_touches(one, another, static_cast<int>(other), touches);
      add_touches(another, one, static_cast<int>(other), touches);
    }
    return touches;
  }

  /// Along a joint with a block that does not move in the same way.
  std::optional<std::string> sliding_of(const FailingBlock& block, const std::vector<Touch>& touches) const {
    for (const Touch& touch : touches) {
      const Vec2 relative = relative_velocity(block, touch.other, touch.point);
      if (relative.norm() < slow * fastest(block) || !is_along(relative, touch)) continue;
      if (!is_joint(touch, touches) || turns_against(block, touch.other, relative)) continue;
      // What moves faster along it overtakes the block: that joint tells the motion of the other one.
      if (relative.dot(velocity_at(block, touch.point)) <= 0.0) continue;
      const Vec2 along = touch.along.dot(relative) < 0.0 ? Vec2(-touch.along) : touch.along;
      return fmt::format(" slides along its joint with {} {} ({}cohesion_pa or a [[support]] would hold it)", name_of(touch.other), heading(along),
                         friction_on(touch));
    }
    return std::nullopt;
  }

  Vec2 relative_velocity(const FailingBlock& block, int other, const Vec2& point) const {
    const FailingBlock* moving = moving_[static_cast<std::size_t>(other)];
    return velocity_at(block, point) - (moving == nullptr ? Vec2(Vec2::Zero()) : velocity_at(*moving, point));
  }

  /// What turns against its neighbour opens their joint and does not slide along it.
  bool turns_against(const FailingBlock& block, int other, const Vec2& relative) const {
    const FailingBlock* moving = moving_[static_cast<std::size_t>(other)];
    const double turn = std::abs(block.rotation - (moving == nullptr ? 0.0 : moving->rotation));
    double reach = 0.0;
    for (const Vec2& vertex : polygon(block)) reach = std::max(reach, (vertex - block.centroid).norm());
    return turn * reach > 2.0 * slow * relative.norm();
  }

  /// Whether a corner lies within the edge, or the edge is touched at two places: two edges that end in the same corner are no joint, nor are the
  /// upper and lower sides of blocks that stand beside each other.
  static bool is_joint(const Touch& touch, const std::vector<Touch>& touches) {
    if (touch.is_within_edge) return true;
    return std::any_of(touches.begin(), touches.end(), [&](const Touch& t) {
      if (t.other != touch.other || !is_apart(t.point, touch.point)) return false;
      return std::abs(cross(t.along, touch.along)) < slow && std::abs(cross((t.point - touch.point).normalized(), touch.along)) < slow;
    });
  }

  /// The place at which the block turns against a neighbour.
  std::optional<std::string> hinge_of(const FailingBlock& block, const std::vector<Touch>& touches) const {
    const double still = slow * fastest(block);
    for (const Touch& touch : touches) {
      const bool is_hinge =
          relative_velocity(block, touch.other, touch.point).norm() < still && relative_velocity(block, touch.other, block.centroid).norm() >= still;
      if (is_hinge) return fmt::format(" turns against {} about {} ({})", name_of(touch.other), at(touch.point), held_at_hinge);
    }
    return std::nullopt;
  }

  /// Mechanisms of limit analysis open what slides at the friction angle.
  static bool is_along(const Vec2& relative, const Touch& touch) {
    const double opening = std::abs(cross(touch.along, relative)), tolerated = slow * relative.norm();
    return opening <= tolerated || is_opened_by_friction(relative, touch, tolerated);
  }

  static bool is_opened_by_friction(const Vec2& relative, const Touch& touch, double tolerated) {
    if (touch.joint == nullptr) return false;
    const double opening = std::abs(cross(touch.along, relative));
    return std::abs(opening - std::tan(touch.joint->friction_angle) * std::abs(touch.along.dot(relative))) <= tolerated;
  }

  /// Under its weight alone a block stands on an edge with friction above the edge's slope.
  std::string friction_on(const Touch& touch) const {
    if (scene_.gravity.isZero(0.0)) return "";
    const Vec2& along = touch.along;
    const double slope = std::atan2(std::abs(along.dot(scene_.gravity)), std::abs(cross(along, scene_.gravity))) * 180.0 / std::numbers::pi;
    constexpr double steepest = 80.0;  // no joint has so much
    const double there_is = touch.joint == nullptr ? 0.0 : touch.joint->friction_angle * 180.0 / std::numbers::pi;
    return slope < steepest && slope > there_is ? fmt::format("friction above {:.3g} degrees under its weight alone, ", slope) : "";
  }

  const Scene& scene_;
  std::vector<const FailingBlock*> moving_;
};

}  // namespace

std::string motion_in_words(const Scene& scene, const std::vector<FailingBlock>& mechanism) {
  const Describer describer(scene, mechanism);
  std::vector<FailingBlock> fastest = mechanism;
  std::stable_sort(fastest.begin(), fastest.end(),
                   [&](const FailingBlock& a, const FailingBlock& b) { return describer.fastest(a) > describer.fastest(b); });
  if (fastest.size() > most_described) fastest.resize(most_described);
  std::vector<Description> descriptions = describer.describe(fastest);
  std::stable_partition(descriptions.begin(), descriptions.end(), [](const Description& d) { return d.by_itself; });
  std::string words;
  for (std::size_t i = 0; i < std::min(most_named, descriptions.size()); ++i) words += (i > 0 ? "; " : "") + descriptions[i].words;
  if (mechanism.size() > most_named) words += fmt::format("; {} more blocks move", mechanism.size() - most_named);
  return words;
}

namespace {

/// The velocity of a steady turn about one point that has brought the centroid this far [m]: half the angle over its tangent, and across.
Vec2 velocity_of_turn(const Vec2& way, double angle) {
  const double half = 0.5 * angle;
  return std::abs(half) < slow * slow ? way : Vec2(half / std::tan(half) * way - half * perpendicular(way));
}

}  // namespace

std::vector<FailingBlock> moved_blocks(const Simulation& simulation) {
  const BlockSystem& system = simulation.system();
  std::vector<FailingBlock> moved;
  double farthest = 0.0;
  const auto way = [](const FailingBlock& block, double radius) { return block.velocity.norm() + std::abs(block.rotation) * radius; };
  for (const int b : system.free_blocks()) {
    const auto& d = system.displacement(b);
    moved.push_back({b, system.block(b).area, system.block(b).reference_centroid + system.origin(), velocity_of_turn(d.head<2>(), d[2]), d[2]});
    farthest = std::max(farthest, way(moved.back(), system.block(b).radius));
  }
  std::erase_if(moved, [&](const FailingBlock& block) { return way(block, system.block(block.block).radius) <= slow * farthest; });
  return moved;
}

}  // namespace openclose
