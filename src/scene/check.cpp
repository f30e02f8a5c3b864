#include "openclose/scene/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "openclose/core/memory.h"
#include "openclose/core/tolerance.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/overlap.h"
#include "openclose/geometry/polygon.h"
#include "openclose/scene/plausibility.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

[[noreturn]] void fail_overlap(const Scene& scene, const BlockInput& a, const BlockInput& b, double depth) {
  throw InputError(scene.place_of(b), "block",
                   fmt::format("\"{}\" overlaps \"{}\" ({}) by at least {:.3g} m at the start", b.name, a.name, place_name(scene.place_of(a)), depth),
                   fmt::format("overlaps of at most {} m", tolerance::deepest_initial_overlap_m));
}

/// Sweep over x: a block is compared only with those that begin before it ends.
void require_no_overlap(const Scene& scene) {
  const std::vector<BlockInput>& blocks = scene.blocks;
  std::vector<Outline> outlines;
  outlines.reserve(blocks.size());
  for (const BlockInput& block : blocks) outlines.push_back(outline_of(block.vertices));
  for (const auto& [first, second] : blocks_that_may_overlap(blocks)) {
    const double depth = overlap_depth_beyond(tolerance::deepest_initial_overlap_m, outlines[first], outlines[second]);
    if (depth > tolerance::deepest_initial_overlap_m) fail_overlap(scene, blocks[first], blocks[second], depth);
  }
}

/// [-] Area of a block over the median one of the free blocks, below which it is a sliver: a hundredth of its size.
constexpr double sliver_of_median = 1e-4;

struct Use {
  int blocks = 0;
  int free_blocks = 0;
};

/// Whether two blocks of these materials, one of them free to move, can be found.
bool can_meet(const std::vector<Use>& uses, std::size_t a, std::size_t b) {
  if (a == b) return uses[a].blocks >= 2 && uses[a].free_blocks >= 1;
  return uses[a].blocks >= 1 && uses[b].blocks >= 1 && uses[a].free_blocks + uses[b].free_blocks >= 1;
}

bool is_part_of_one_that_acts(const Scene&, const auto&) {
  return false;
}

/// A stretch over several blocks is one on each of them.
bool is_part_of_one_that_acts(const Scene& scene, const Surcharge& part) {
  return std::any_of(scene.surcharges.begin(), scene.surcharges.end(), [&](const Surcharge& other) {
    const bool is_alike = other.name == part.name && other.pressure == part.pressure && other.shear == part.shear;
    const Vec2 along = (part.to - part.from).normalized();
    return is_alike && !scene.blocks[other.block].fixed && std::abs(cross(along, other.from - part.from)) <= tolerance::touching_m &&
           std::abs(cross(along, other.to - part.from)) <= tolerance::touching_m;
  });
}

/// A fixed block feels none: in a domain, a point may lie in a large block that a fixed line happens to touch.
void warn_of_fixed_points(const Scene& scene, std::vector<std::string>& warnings) {
  for_each_force(scene, [&](const auto& force) {
    if (!scene.blocks[force.block].fixed || is_part_of_one_that_acts(scene, force)) return;
    std::vector<Vec2> points;
    force.visit_points(force, [&](const Vec2& point) { points.push_back(point); });
    warnings.push_back(fmt::format("{}: the {} at ({:g}, {:g}) has no effect: its block \"{}\" is fixed", scene.where.file, force.table().name,
                                   points.front().x(), points.front().y(), scene.blocks[force.block].name));
  });
}

/// The base moves what is fixed, and nothing else does.
void warn_of_fixed_velocities(const Scene& scene, std::vector<std::string>& warnings) {
  for (const BlockInput& block : scene.blocks) {
    if (!block.fixed || (block.velocity.isZero(0.0) && block.angular_velocity == 0.0)) continue;
    warnings.push_back(fmt::format("{}: the velocity of block \"{}\" has no effect: the block is fixed", scene.where.file, block.name));
  }
}

/// A contact lies in a seam that both blocks name; a joint of materials as well is there where none does. Those of a domain have been cut, and may
/// end at its outline.
void warn_of_lone_seams(const Scene& scene, std::vector<std::string>& warnings) {
  if (scene.cutting) return;
  std::vector<std::set<const BlockInput*>> named_by(scene.joints.size());
  for (const BlockInput& block : scene.blocks) {
    for (const int joint : block.edge_joints) {
      if (joint != BlockInput::by_materials) named_by[joint].insert(&block);
    }
  }
  for (std::size_t joint = 0; joint < named_by.size(); ++joint) {
    if (named_by[joint].size() != 1 || scene.joints[joint].has_materials()) continue;
    warnings.push_back(
        fmt::format("{}: joint \"{}\" is named by edges of block \"{}\" alone, and has no effect: a contact has the joint that the "
                    "edges of both blocks name",
                    scene.where.file, scene.joints[joint].name, (*named_by[joint].begin())->name));
  }
}

bool nothing_holds(const Scene& scene) {
  const bool any_fixed = std::any_of(scene.blocks.begin(), scene.blocks.end(), [](const BlockInput& block) { return block.fixed; });
  bool any_holds = false;
  for_each_force(scene, [&](const auto& force) { any_holds |= force.holds; });
  return !any_fixed && !any_holds && !scene.gravity.isZero(0.0);
}

bool nothing_loads(const Scene& scene) {
  bool any_loads = false;
  for_each_force(scene, [&](const auto& force) { any_loads |= !force.holds; });
  const auto moves = [](const BlockInput& block) { return !block.velocity.isZero(0.0) || block.angular_velocity != 0.0; };
  return !any_loads && scene.gravity.isZero(0.0) && !scene.base_motion && std::ranges::none_of(scene.blocks, moves);
}

}  // namespace

std::vector<std::pair<int, int>> blocks_that_may_overlap(const std::vector<BlockInput>& blocks) {
  std::vector<Box> boxes;
  for (const BlockInput& block : blocks) boxes.push_back(Box::around(block.vertices));
  std::vector<int> by_x(blocks.size());
  std::iota(by_x.begin(), by_x.end(), 0);
  std::sort(by_x.begin(), by_x.end(), [&](int a, int b) { return boxes[a].low.x() < boxes[b].low.x(); });

  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    // Polygons cannot be deeper in each other than their boxes are.
    const Box reach = boxes[by_x[i]].inflated(-tolerance::deepest_initial_overlap_m);
    for (std::size_t j = i + 1; j < by_x.size() && boxes[by_x[j]].low.x() <= reach.high.x(); ++j) {
      if (boxes[by_x[i]].overlaps(boxes[by_x[j]].inflated(-tolerance::deepest_initial_overlap_m))) pairs.emplace_back(std::minmax(by_x[i], by_x[j]));
    }
  }
  return pairs;
}

void require_joints(const Scene& scene) {
  std::vector<Use> uses(scene.materials.size());
  for (const BlockInput& block : scene.blocks) {
    ++uses[block.material].blocks;
    if (!block.fixed) ++uses[block.material].free_blocks;
  }
  std::set<std::pair<std::size_t, std::size_t>> joined;
  for (const JointProperties& joint : scene.joints) {
    if (joint.has_materials())
      joined.insert(std::minmax({static_cast<std::size_t>(joint.materials[0]), static_cast<std::size_t>(joint.materials[1])}));
  }
  // Of pairs that can meet one or two blocks are free: as many as the joints there are, or the first one without is soon found.
  std::vector<std::size_t> used, free;
  for (std::size_t m = 0; m < uses.size(); ++m) {
    if (uses[m].blocks > 0) used.push_back(m);
    if (uses[m].free_blocks > 0) free.push_back(m);
  }
  for (const std::size_t a : used) {
    for (const std::size_t b : uses[a].free_blocks > 0 ? used : free) {
      if (b < a || !can_meet(uses, a, b) || joined.contains({a, b})) continue;
      throw InputError(scene.where, "joint",
                       fmt::format("none for the materials \"{}\" and \"{}\"", scene.materials[a].name, scene.materials[b].name),
                       "a [[joint]] for every pair of materials whose blocks can touch");
    }
  }
}

/// The smallest blocks by area: a factor of safety can be that of one of them.
void warn_of_slivers(const Scene& scene, std::vector<std::string>& warnings) {
  std::vector<std::pair<double, std::size_t>> areas;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    if (!scene.blocks[b].fixed) areas.emplace_back(signed_area(scene.blocks[b].vertices), b);
  }
  if (areas.empty()) return;
  std::ranges::sort(areas);
  const double most = sliver_of_median * areas[areas.size() / 2].first;
  const auto count = std::ranges::count_if(areas, [&](const auto& area) { return area.first < most; });
  if (count == 0) return;
  const std::string others = count > 1 ? fmt::format(" and {} others", count - 1) : "";
  warnings.push_back(fmt::format(
      "{}: \"{}\" with {:.3g} m2{}, of {} free blocks, {} smaller than {:g} of the median block{}", scene.where.file,
      scene.blocks[areas.front().second].name, areas.front().first, others, areas.size(), count > 1 ? "are" : "is", sliver_of_median,
      scene.cutting
          ? fmt::format("; domain.sliver_area_m2 = {:.2g} unites such with their neighbours, of which they may make teeth that lock a joint", most)
          : ""));
}

std::string size_of(const Scene& scene) {
  std::size_t vertices = 0;
  for (const BlockInput& block : scene.blocks) vertices += block.vertices.size();
  return fmt::format("{} blocks with {} vertices", scene.blocks.size(), vertices);
}

void require_memory(const Scene& scene, std::size_t available) {
  std::size_t needed = bytes_of_simulated_block * scene.blocks.size();
  for (const BlockInput& block : scene.blocks) needed += bytes_of_simulated_vertex * block.vertices.size();
  if (needed <= available) return;
  constexpr double megabyte = 1e6;
  throw InputError(scene.where, scene.cutting ? "domain" : "block",
                   fmt::format("{} need {:.3g} MB of memory at least, and there are {:.3g} MB", size_of(scene),
                               static_cast<double>(needed) / megabyte, static_cast<double>(available) / megabyte),
                   scene.cutting ? "fewer blocks (joint_set.spacing_m, domain.vertices_m; domain.max_blocks limits their number), or more memory"
                                 : "fewer [[block]], fewer vertices, or more memory");
}

std::vector<std::string> check_scene(const Scene& scene) {
  require_joints(scene);
  require_no_overlap(scene);
  std::vector<std::string> warnings = scene.warnings;
  if (scene.cutting) warnings.insert(warnings.end(), scene.cutting->warnings.begin(), scene.cutting->warnings.end());
  for (std::string& warning : implausible_numbers(scene)) warnings.push_back(std::move(warning));
  if (nothing_holds(scene)) warnings.push_back(scene.where.file + ": nothing is fixed or supported under gravity: every block will fall");
  if (std::ranges::all_of(scene.blocks, [](const BlockInput& block) { return block.fixed; }))
    warnings.push_back(scene.where.file + ": no block is free: nothing will move");
  if (nothing_loads(scene))
    warnings.push_back(scene.where.file +
                       ": there is no gravity, load, surcharge, base motion or velocity: nothing will move, whatever its strength");
  warn_of_fixed_points(scene, warnings);
  warn_of_fixed_velocities(scene, warnings);
  warn_of_lone_seams(scene, warnings);
  warn_of_slivers(scene, warnings);
  return warnings;
}

}  // namespace openclose
