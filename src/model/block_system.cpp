#include "openclose/model/block_system.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"
#include "openclose/scene/median_size.h"

namespace openclose {

bool BlockSystem::State::is_finite() const {
  const auto are_finite = [](const auto& list) { return std::ranges::all_of(list, [](const auto& v) { return v.allFinite(); }); };
  return are_finite(displacement) && are_finite(velocity) && are_finite(arm) && are_finite(point_arm);
}

BlockSystem::BlockSystem(const Scene& scene) : rotation_kind_(scene.method.rotation) {
  const std::size_t blocks = scene.blocks.size();
  std::size_t vertices = 0;
  for (const BlockInput& input : scene.blocks) vertices += input.vertices.size();
  blocks_.reserve(blocks);
  for (auto* list : {&state_.displacement, &state_.velocity}) list->reserve(blocks);
  for (auto* list : {&next_, &previous_}) list->reserve(vertices);
  reflex_.reserve(vertices);
  reference_arm_.reserve(vertices);
  if (!scene.blocks.empty()) origin_ = scene.blocks.front().vertices.front();
  for (const BlockInput& input : scene.blocks) {
    Polygon polygon;  // near zero: differences of neighbouring coordinates are exact, their products are not
    for (const Vec2& v : input.vertices) polygon.push_back(v - origin_);
    const PolygonProperties properties = polygon_properties(polygon);
    Block block;
    block.first_vertex = static_cast<int>(reference_arm_.size());
    block.vertex_count = static_cast<int>(input.vertices.size());
    block.material = input.material;
    block.area = properties.area;
    block.rotation_locked = input.rotation_locked;
    block.mass = Motion::mass(scene.materials[input.material].density, properties.area, properties.polar_second_moment);
    block.reference_centroid = properties.centroid;
    for (int i = 0; i < block.vertex_count; ++i) {
      // Differences of scene coordinates first: they are exact for neighbouring numbers.
      const Vec2 arm = (input.vertices[i] - origin_) - block.reference_centroid;
      const Vec2 back = input.vertices[(i + block.vertex_count - 1) % block.vertex_count] - input.vertices[i];
      const Vec2 ahead = input.vertices[(i + 1) % block.vertex_count] - input.vertices[i];
      reference_arm_.push_back(arm);
      next_.push_back(block.first_vertex + (i + 1) % block.vertex_count);
      previous_.push_back(block.first_vertex + (i + block.vertex_count - 1) % block.vertex_count);
      // A vertex on a straight side, where two joints meet, is no notch for rounding.
      reflex_.push_back(cross(ahead, back) < -tolerance::straight_corner_rad * ahead.norm() * back.norm());
      block.radius = std::max(block.radius, arm.norm());
    }
    const int b = block_count();
    if (!input.fixed) {
      block.equation = free_count();
      free_blocks_.push_back(b);
    }
    blocks_.push_back(block);
    state_.displacement.push_back(Unknowns::Zero());
    state_.velocity.push_back(velocity_at_start(input));
  }
  name_joints(scene);
  state_.arm = reference_arm_;
  first_point_.assign(blocks_.size(), -1);
}

double BlockSystem::median_size() const {
  std::vector<double> areas;
  for (const int b : free_blocks_) areas.push_back(blocks_[b].area);
  for (const int b : resting_blocks_) areas.push_back(blocks_[b].area);
  return size_of_median(std::move(areas)).value_or(0.0);
}

void BlockSystem::name_joints(const Scene& scene) {
  if (std::all_of(scene.blocks.begin(), scene.blocks.end(), [](const BlockInput& input) { return input.edge_joints.empty(); })) return;
  for (const BlockInput& input : scene.blocks) {
    if (input.edge_joints.empty()) {
      edge_joints_.insert(edge_joints_.end(), input.vertices.size(), BlockInput::by_materials);
    } else {
      edge_joints_.insert(edge_joints_.end(), input.edge_joints.begin(), input.edge_joints.end());
    }
  }
}

BlockSystem::Unknowns BlockSystem::velocity_at_start(const BlockInput& input) {
  Unknowns velocity = Unknowns::Zero();
  if (!input.fixed) velocity << input.velocity, input.angular_velocity;
  return velocity;
}

int BlockSystem::follow_point(int b, const Vec2& point) {
  const Vec2 arm = (point - origin_) - blocks_[b].reference_centroid;
  const int number = static_cast<int>(points_.size());
  points_.push_back({b, arm, first_point_[b]});
  first_point_[b] = number;
  state_.point_arm.push_back(arm + Motion::turned_by(Motion::rotation(state_.displacement[b]), arm, rotation_kind_));
  return number;
}

void BlockSystem::stop() {
  for (Unknowns& v : state_.velocity) v.setZero();
}

void BlockSystem::number(const std::vector<char>& is_free) {
  free_blocks_.clear();
  resting_blocks_.clear();
  for (int b = 0; b < block_count(); ++b) {
    if (blocks_[b].equation == fixed) continue;
    blocks_[b].equation = is_free[b] ? free_count() : fixed - 1 - static_cast<int>(resting_blocks_.size());
    (is_free[b] ? free_blocks_ : resting_blocks_).push_back(b);
  }
}

void BlockSystem::put_to_rest(const std::vector<int>& blocks) {
  std::vector<char> is_free(blocks_.size(), 0);
  for (const int b : free_blocks_) is_free[b] = 1;
  for (const int b : blocks) {
    is_free[b] = 0;
    state_.velocity[b].setZero();
  }
  number(is_free);
}

void BlockSystem::wake(const std::vector<int>& blocks) {
  std::vector<char> is_free(blocks_.size(), 0);
  for (const int b : free_blocks_) is_free[b] = 1;
  for (const int b : blocks) is_free[b] = 1;
  number(is_free);
}

void BlockSystem::exchange(Archive& archive) {
  std::vector<char> is_free(blocks_.size(), 0);
  for (const int b : free_blocks_) is_free[b] = 1;
  const auto sizes = [this] { return std::array{state_.displacement.size(), state_.velocity.size(), state_.arm.size(), state_.point_arm.size()}; };
  const auto sizes_of_scene = sizes();
  archive(state_, is_free);
  archive.require(sizes() == sizes_of_scene && is_free.size() == blocks_.size(), "the saved state is of other blocks");
  number(is_free);
}

void BlockSystem::advance(int b, const Unknowns& d) {
  state_.displacement[b] += d;
  const Block& block = blocks_[b];
  // Exact rotation starts from the reference each time, so that rounding does not deform the block; Shi's linear one adds to what it had.
  const bool exact = rotation_kind_ == RotationKind::exact;
  const Motion::Turn turn(Motion::rotation(exact ? state_.displacement[b] : d), rotation_kind_);
  const auto turned = [&](const Vec2& reference, const Vec2& current) -> Vec2 {
    const Vec2& from = exact ? reference : current;
    return from + turn.of(from);
  };
  for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) state_.arm[v] = turned(reference_arm_[v], state_.arm[v]);
  for (int i = first_point_[b]; i >= 0; i = points_[i].next_of_block) state_.point_arm[i] = turned(points_[i].reference_arm, state_.point_arm[i]);
}

void BlockSystem::move_to(int b, const Unknowns& displacement) {
  state_.displacement[b] = displacement;
  const Unknowns no_more = Unknowns::Zero();
  advance(b, no_more);
}

double BlockSystem::kinetic_energy() const {
  double energy = 0.0;
  for (int b : free_blocks_) energy += 0.5 * state_.velocity[b].dot(blocks_[b].mass.cwiseProduct(state_.velocity[b]));
  return energy;
}

double BlockSystem::reduced_mass(int a, int b) const {
  double inverse = 0.0;
  for (const int i : {a, b}) {
    if (blocks_[i].equation != fixed) inverse += 1.0 / blocks_[i].mass[0];
  }
  return 1.0 / inverse;
}

}  // namespace openclose
