#include "openclose/statics/frozen_system.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "openclose/contact/detection.h"
#include "openclose/contact/ground_outline.h"
#include "openclose/contact/kinematics.h"
#include "openclose/geometry/polygon.h"
#include "openclose/model/external_forces.h"
#include "openclose/scene/increased_load.h"
#include "openclose/scene/median_size.h"

namespace openclose {
namespace {

/// The scene with its first vertex at the origin and lengths in this unit [m]; only what detection looks at.
Scene in_units(const Scene& scene, double unit) {
  Scene scaled = scene;
  if (scene.blocks.empty()) return scaled;
  const Vec2 origin = scene.blocks.front().vertices.front();
  const auto scale = [&](Vec2& p) { p = (p - origin) / unit; };
  for (BlockInput& block : scaled.blocks) {
    for (Vec2& v : block.vertices) scale(v);
  }
  for_each_force(scaled, [&](auto& force) {
    force.visit_points(force, scale);
    force.change_unit_of_length(unit);
  });
  return scaled;
}

Polygon polygon_of(const BlockSystem& system, int b) {
  Polygon polygon;
  const auto& block = system.block(b);
  for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) polygon.push_back(system.position(b, v));
  return polygon;
}

/// Whether a third block lies between the corner and the edge of a contact that is drawn open.
bool has_block_between(const BlockSystem& system, const Contact& contact, const std::vector<std::vector<int>>& neighbours) {
  if (contact.gap <= tolerance::edge_end_m) return false;
  const ContactStart at(system, contact);
  const Vec2 middle = system.position(contact.vertex_block, contact.vertex) - 0.5 * contact.gap * at.normal;
  return std::ranges::any_of(neighbours[contact.vertex_block],
                             [&](int other) { return other != contact.edge_block && contains(polygon_of(system, other), middle); });
}

/// Those that a second look finds again, for which all that touches is closed. How corners pass over each other depends on what they rest on, and in
/// the first look nothing rests on anything: a tip of rock that lies flush ahead of a block's foot meets the block's face there.
std::vector<Contact> contacts_of_drawing(Detector& detector, const BlockSystem& system, const JointTable& joints) {
  ContactSet contacts;
  detector.update(system, joints, contacts);
  std::vector<Contact> drawn = contacts.moving;
  for (Contact& c : contacts.moving) {
    if (c.gap <= tolerance::edge_end_m) c.status = ContactStatus::sticking;
  }
  detector.look_again();
  detector.update(system, joints, contacts);
  std::set<std::pair<int, int>> found_again;
  for (const Contact& c : contacts.moving) found_again.emplace(c.vertex, c.edge);
  std::erase_if(drawn, [&](const Contact& c) { return !found_again.contains({c.vertex, c.edge}); });
  return drawn;
}

BlockVector scaled_rotation(const Eigen::Vector3d& gradient, double radius, bool locked) {
  return {gradient[0], gradient[1], locked ? 0.0 : gradient[2] / radius};
}

/// [N] Gravity and loads on a block. Moments have their arms in units of length.
BlockVector load_on(const BlockSystem& system, int b, double mass, const ExternalForces& external) {
  BlockVector load = Motion::gradient(Vec2::Zero(), mass * external.gravity());
  external.for_each_element(b, [&](const ForceElement& element) { load += element.force(element.path(system, BlockVector::Zero())); });
  return scaled_rotation(load, system.block(b).radius, system.block(b).rotation_locked);
}

}  // namespace

double frozen_length_unit(const Scene& scene) {
  std::vector<double> areas;
  for (const BlockInput& block : scene.blocks) {
    if (block.fixed) continue;
    Polygon polygon;
    for (const Vec2& v : block.vertices) polygon.push_back(v - block.vertices.front());
    areas.push_back(polygon_properties(polygon).area);
  }
  return size_of_median(std::move(areas)).value_or(1.0);
}

FrozenSystem::FrozenSystem(const Scene& scene) : has_live_load_(scene.strength_reduction.increase), length_unit_(frozen_length_unit(scene)) {
  const Scene scaled = in_units(scene, length_unit_);
  BlockSystem system(scaled);
  const ExternalForces dead(with_increased_load(scaled, 0.0), system), all(with_increased_load(scaled, 1.0), system);
  const double area_unit = length_unit_ * length_unit_;

  double acceleration_unit = scene.gravity.norm(), heaviest = 0.0;
  for (int b : system.free_blocks()) {
    FrozenBlock block;
    block.block = b;
    block.centroid = scene.blocks.front().vertices.front() + length_unit_ * system.centroid(b);
    block.radius = system.block(b).radius;
    block.rotation_locked = system.block(b).rotation_locked;
    const BlockSystem::Unknowns mass = system.block(b).mass * area_unit;  // [kg, kg, kg in units of length squared]
    block.mass = {mass[0], mass[1], mass[2] / (block.radius * block.radius)};
    block.dead_load = load_on(system, b, mass[0], dead);
    block.live_load = load_on(system, b, mass[0], all) - block.dead_load;
    if (scene.gravity.norm() == 0.0) acceleration_unit = std::max(acceleration_unit, (block.dead_load + block.live_load).norm() / mass[0]);
    heaviest = std::max(heaviest, mass[0]);
    blocks_.push_back(block);
  }
  if (acceleration_unit == 0.0) acceleration_unit = 1.0;  // nothing to carry
  force_unit_ = heaviest > 0.0 ? heaviest * acceleration_unit : 1.0;
  for (FrozenBlock& block : blocks_) {
    block.dead_load /= force_unit_;
    block.live_load /= force_unit_;
    block.mass /= heaviest;
    block.weight = block.mass[0];
  }
  multiply_live_load(0.0);
  for (const auto& element : dead.elements()) {
    const auto& block = system.block(element->block());
    if (block.equation < 0) continue;
    for (const auto& [direction, stiffness] : element->springs(element->path(system, BlockVector::Zero())))
      supports_.push_back({block.equation, scaled_rotation(direction, block.radius, block.rotation_locked), stiffness});
  }
  find_contacts(scaled, system);
  for (FrozenContact& c : contacts_) c.point = scene.blocks.front().vertices.front() + length_unit_ * c.point;
  set_units(scene);
}

void FrozenSystem::multiply_live_load(double multiplier) {
  for (FrozenBlock& block : blocks_) block.load = block.dead_load + multiplier * block.live_load;
}

void FrozenSystem::find_contacts(const Scene& scaled, const BlockSystem& system) {
  const JointTable joints(scaled);
  DetectionSkips skips;
  skips.contact_skin = tolerance::rounding_of_ways_m;
  Detector detector(closed_gap, skips);
  const std::vector<Contact> found = contacts_of_drawing(detector, system, joints);
  const GroundOutline& ground = detector.ground();
  std::vector<std::vector<int>> neighbours(system.block_count());
  for (const auto& [a, b] : detector.candidate_pairs()) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  const BlockSystem::Unknowns still = BlockSystem::Unknowns::Zero();
  std::vector<Joined> joined;
  std::vector<Contact> closed;
  std::vector<Joined> joined_of_closed;
  std::set<std::pair<int, int>> pairs_with_joint;
  const auto pair_of = [&](const Contact& c) -> std::pair<int, int> { return std::minmax({ground.body(c.vertex_block), ground.body(c.edge_block)}); };
  for (const Contact& contact : found) {
    joined.push_back(joined_at(system, ground, contact, closed_gap));
    if (joined.back().length > 0.0) pairs_with_joint.insert(pair_of(contact));
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Contact& contact = found[i];
    if (contact.gap > closed_gap || has_block_between(system, contact, neighbours)) continue;
    // Beside a joint of the same two blocks a corner that is drawn open is no careless drawing of a contact.
    if (joined[i].length == 0.0 && contact.gap > tolerance::edge_end_m && pairs_with_joint.contains(pair_of(contact))) continue;
    const auto &corner_block = system.block(contact.vertex_block), &edge_block = system.block(contact.edge_block);
    if (corner_block.equation < 0 && edge_block.equation < 0) continue;
    const ContactKinematics k(system, contact, still, still);
    FrozenContact c;
    c.a = std::max(corner_block.equation, -1);
    c.b = std::max(edge_block.equation, -1);
    c.normal_a = scaled_rotation(k.normal_vertex, corner_block.radius, corner_block.rotation_locked);
    c.shear_a = scaled_rotation(k.shear_vertex, corner_block.radius, corner_block.rotation_locked);
    c.normal_b = scaled_rotation(k.normal_edge, edge_block.radius, edge_block.rotation_locked);
    c.shear_b = scaled_rotation(k.shear_edge, edge_block.radius, edge_block.rotation_locked);
    c.source = contact;
    c.source.length *= length_unit_;
    c.source.joint_state = {};
    c.joined_length = joined[i].length * length_unit_;
    c.normal = k.normal;
    c.point = system.position(contact.vertex_block, contact.vertex);
    contacts_.push_back(c);
    closed.push_back(contact);
    joined_of_closed.push_back(joined[i]);
  }
  sections_ = joint_sections(system, ground, closed, joined_of_closed, closed_gap);
  for (const JointSection& section : sections_) {
    for (const PlaceInJoint& place : section) {
      contacts_[place.contact].joined_length += place.filled * length_unit_;
      contacts_[place.contact].source.length += place.filled * length_unit_;
    }
  }
}

/// Springs over the mean of the normal ones.
void FrozenSystem::set_units(const Scene& scene) {
  const JointTable joints(scene);
  double sum = 0.0;
  for (const FrozenContact& c : contacts_) sum += joints.joint(c.source.joint).normal_stiffness * c.source.length;
  const double stiffness_unit = contacts_.empty() ? 1.0 : sum / static_cast<double>(contacts_.size());  // [N/m]
  closure_unit_ = force_unit_ / stiffness_unit;
  for (FrozenContact& c : contacts_) {
    const TabulatedJoint& joint = joints.joint(c.source.joint);
    c.normal_stiffness = joint.normal_stiffness * c.source.length / stiffness_unit;
    c.shear_stiffness = joint.shear_stiffness * c.source.length / stiffness_unit;
  }
  for (FrozenSupport& s : supports_) s.stiffness /= stiffness_unit;
}

}  // namespace openclose
