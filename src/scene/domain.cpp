#include "openclose/scene/domain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "openclose/core/memory.h"
#include "openclose/core/process.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/touch.h"
#include "openclose/scene/angle.h"
#include "openclose/scene/median_size.h"
#include "openclose/scene/names.h"
#include "openclose/scene/outline.h"
#include "openclose/scene/section.h"

namespace openclose {
namespace {

/// A limit that still fits into memory.
constexpr double most_blocks = 1e7;

constexpr Range part{.low = 0.0, .high = 1.0, .low_included = true};
constexpr Range azimuth_deg{.low = 0.0, .high = 360.0, .low_included = true, .high_included = true};

/// [-] Of a joint plane's normal, out of the section: planes that strike more than 20 degrees off the line across it do not slide in it (Hoek and
/// Bray, Rock Slope Engineering, conditions of plane failure).
const double most_oblique = std::sin(radians(20.0));

// The cutting marks the edges of blocks with the properties of their joints.
static_assert(Cutting::label_of_boundary == BlockInput::by_materials);

struct DomainInput {
  PolygonWithHoles shape;
  int material = 0;
  EnclosedJoints enclosed = EnclosedJoints::refuse;
  std::optional<double> section;  ///< [rad] azimuth into which the x axis points
  CuttingLimits limits;           ///< with no more blocks than there is memory for
  int written_max_blocks = 0;     ///< domain.max_blocks
};

struct Region {
  Polygon outline;
  int material = 0;
  bool any_block = false;  ///< has its centroid inside
};

/// [m] Where joints of this length meet, rounding (1e6 * 2^-52 = 2e-10 m) is below the shortest edge as long as they cross at a degree or more. Ten
/// times as wide a third of random patterns cannot be put together.
constexpr double widest_domain_m = 1e6;
/// [m] Of a joint through such a domain, and of a line along its blocks: twice its width, which is more than its diagonal.
constexpr double longest_line_m = 2.0 * widest_domain_m;

void require_size(const Value& vertices, const Polygon& outer) {
  const Box box = Box::around(outer);
  const double width = (box.high - box.low).maxCoeff();
  if (width > widest_domain_m) vertices.fail(fmt::format("a domain {} m wide", width), fmt::format("domains at most {} m wide", widest_domain_m));
}

DomainInput read_domain(Table& table, const NameList& material_names) {
  DomainInput domain;
  Polygon outer;
  std::vector<Polygon> holes;
  table.required("vertices_m", outer, coordinate);
  table.optional("holes_m", holes, coordinate);
  table.required("material", domain.material, material_names);
  table.optional("sliver_width_m", domain.limits.sliver_width, Range{.low = tolerance::least_sliver_width_m, .low_included = true});
  table.optional("sliver_area_m2", domain.limits.sliver_area, not_negative);
  table.optional("joint_end_reach_m", domain.limits.end_reach, joint_end_reach);
  table.optional("enclosed_joints", domain.enclosed, enclosed_joints_words);
  std::optional<double> section_deg;
  table.optional("section_direction_deg", section_deg, azimuth_deg);
  table.optional("max_blocks", domain.limits.max_blocks, Range{.low = 1.0, .high = most_blocks, .low_included = true, .high_included = true});
  table.finish();
  domain.written_max_blocks = domain.limits.max_blocks;
  if (section_deg) domain.section = radians(*section_deg);
  const double room = static_cast<double>(available_memory() / bytes_of_cut_block);
  domain.limits.max_blocks = static_cast<int>(std::clamp(room, 1.0, static_cast<double>(domain.written_max_blocks)));

  require_size(table.at("vertices_m"), outer);
  domain.shape.outer = outline(table.at("vertices_m"), outer, "domain");
  for (std::size_t i = 0; i < holes.size(); ++i) domain.shape.holes.push_back(outline(table.at("holes_m").element(i), holes[i], "hole"));
  if (const auto fault = first_ring_fault(domain.shape)) {
    const Value hole = table.at("holes_m").element(fault->ring - 1);
    const std::string other = fault->other == 0 ? "the domain's boundary" : fmt::format("hole [{}]", fault->other - 1);
    const std::string accepted = "holes inside the domain that touch neither its boundary nor each other";
    switch (fault->kind) {
      case RingFault::Kind::meets:
        hole.fail("the hole meets " + other, accepted);
      case RingFault::Kind::outside:
        hole.fail("the hole lies outside the domain", accepted);
      case RingFault::Kind::nested:
        hole.fail("the hole lies inside or around " + other, accepted);
    }
  }
  return domain;
}

void read_traces_of(Table& table, JointSet& set) {
  std::optional<double> gap;
  std::optional<double> persistence;
  table.optional("trace_length_m", set.trace_length, positive);
  table.optional("gap_m", gap, not_negative);
  table.optional("persistence", persistence, Range{.low = 0.0, .high = 1.0, .high_included = true});
  table.optional("stagger", set.stagger, part);
  table.optional("trace_scatter", set.trace_scatter, part);
  table.finish();

  if (set.trace_length && gap.has_value() == persistence.has_value()) {
    table.fail(gap ? "both gap and persistence are given" : "neither gap nor persistence is given", "exactly one of gap_m, persistence");
  }
  for (const char* key : {"gap_m", "persistence", "stagger", "trace_scatter"}) {
    if (!set.trace_length && table.has(key)) table.fail(fmt::format("{} is given for joints that run through", key), "trace_length_m with it");
  }
  if (!set.trace_length) return;
  // Persistence is the part of a joint's length that is open.
  set.gap = gap ? *gap : *set.trace_length * (1.0 / *persistence - 1.0);
}

/// A joint set as the file has it.
struct SetInput {
  JointSet set;
  int properties = BlockInput::by_materials;  ///< the joint that it names, see BlockInput::edge_joints
  std::optional<int> bridge;                  ///< the joint that its rock bridges have; absent: they are not cut
  bool is_in_space = false;                   ///< written by a dip direction
  double oblique = 0.0;                       ///< see PlaneInSection
};

/// Turns the dip of a plane in space into that of its lines in the section, and the spacing with it.
void put_into_section(const Table& table, double direction, const DomainInput& domain, SetInput& input) {
  const Value value = table.at("dip_direction_deg");
  if (!domain.section) value.fail("nothing says where the section points", "domain.section_direction_deg, the azimuth of its x axis, with it");
  if (input.set.dip < 0.0 || input.set.dip > 0.5 * std::numbers::pi)
    table.at("dip_deg").fail("the dip of a plane with a dip direction is not between 0 and 90", "a number in [0, 90]");
  const std::optional<PlaneInSection> line = plane_in_section(input.set.dip, direction, *domain.section);
  if (!line) value.fail("the planes lie in the section and have no line there", "a set that crosses the section");
  input.set.dip = line->dip;
  input.set.spacing *= line->spacing;
  input.oblique = line->oblique;
  input.is_in_space = true;
}

SetInput read_joint_set(Table table, const NameList& joint_names, const DomainInput& domain) {
  SetInput input;
  JointSet& set = input.set;
  double dip_deg = 0.0;
  std::optional<double> direction_deg;
  double dip_scatter_deg = 0.0;
  int seed = 1;
  Polygon region;
  table.required("dip_deg", dip_deg, Range{.low = -180.0, .high = 180.0, .low_included = true, .high_included = true});
  table.required("spacing_m", set.spacing, positive);
  table.required("origin_m", set.origin, coordinate);
  table.optional("dip_direction_deg", direction_deg, azimuth_deg);
  table.optional("dip_scatter_deg", dip_scatter_deg, Range{.low = 0.0, .high = 45.0, .low_included = true});
  table.optional("spacing_scatter", set.spacing_scatter, part);
  table.optional("seed", seed, Range{.low = 0.0, .high = 1e9, .low_included = true, .high_included = true});
  const bool bounded = table.optional("region_m", region, coordinate);
  table.optional("joint", input.properties, joint_names);
  table.optional("bridge", input.bridge, joint_names);
  read_traces_of(table, set);
  set.has_bridges = input.bridge.has_value();
  if (input.bridge && !set.trace_length && !bounded)
    table.at("bridge").fail("joints that run through have no bridges", "trace_length_m or region_m with it");

  set.dip = radians(dip_deg);
  set.dip_scatter = radians(dip_scatter_deg);
  set.seed = static_cast<std::uint64_t>(seed);
  if (bounded) set.region = outline(table.at("region_m"), region, "region");
  if (direction_deg) put_into_section(table, radians(*direction_deg), domain, input);
  return input;
}

Segment read_segment(Table& table) {
  Segment line;
  table.required("from_m", line.from, coordinate);
  table.required("to_m", line.to, coordinate);
  table.finish();
  if (line.length() < tolerance::shortest_edge_m) table.fail("the line has no length", "two points from_m and to_m apart from each other");
  if (line.length() > longest_line_m)
    table.fail(fmt::format("the line is {:g} m long", line.length()), fmt::format("at most {:g} m", longest_line_m));
  return line;
}

Region read_region(Table table, const NameList& material_names) {
  Region region;
  Polygon written;
  table.required("vertices_m", written, coordinate);
  table.required("material", region.material, material_names);
  table.finish();
  region.outline = outline(table.at("vertices_m"), written, "region");
  return region;
}

std::string place(const Vec2& point) {
  return fmt::format("({:.6g}, {:.6g})", point.x(), point.y());
}

/// The joints of a scene: the sets, then the lines.
class Joints {
 public:
  Joints(const CuttingTables& tables, const DomainInput& domain, const NameList& joint_names)
      : tables_(tables), domain_(domain), properties_(static_cast<std::size_t>(2 * count()), BlockInput::by_materials) {
    for (std::size_t i = 0; i < tables.joint_sets.size(); ++i) add_set(static_cast<int>(i), joint_names);
    for (std::size_t i = 0; i < tables.joint_lines.size(); ++i) {
      const Table& table = tables.joint_lines[i];
      Table line = table;
      const int joint = static_cast<int>(tables.joint_sets.size() + i);
      std::optional<int> bridge;
      line.optional("joint", properties_[joint], joint_names);
      line.optional("bridge", bridge, joint_names);
      if (bridge) properties_[bridges_of(joint)] = *bridge;
      traces_.push_back({read_segment(line), joint, bridge ? bridges_of(joint) : JointTrace::no_bridge});
    }
  }

  const std::vector<JointTrace>& traces() const { return traces_; }
  /// Of sets and lines. Their bridges are joints of their own for the cutting, with numbers above these.
  int count() const { return static_cast<int>(tables_.joint_sets.size() + tables_.joint_lines.size()); }
  int bridges_of(int joint) const { return count() + joint; }
  /// By joint, bridges included: index into Scene::joints, or BlockInput::by_materials.
  const std::vector<int>& properties() const { return properties_; }
  const std::vector<int>& oblique() const { return oblique_; }
  const std::vector<SetInSection>& in_section() const { return in_section_; }

  const Table& table(int joint) const {
    const int sets = static_cast<int>(tables_.joint_sets.size());
    return joint < sets ? tables_.joint_sets[joint] : tables_.joint_lines[joint - sets];
  }
  bool is_set(int joint) const { return joint < static_cast<int>(tables_.joint_sets.size()); }

 private:
  void add_set(int index, const NameList& joint_names) {
    const Table& table = tables_.joint_sets[index];
    const SetInput input = read_joint_set(table, joint_names, domain_);
    properties_[index] = input.properties;
    if (input.bridge) properties_[bridges_of(index)] = *input.bridge;
    if (input.is_in_space) in_section_.push_back({place_name(table.where()), input.set.dip, input.set.spacing});
    if (input.oblique > most_oblique) oblique_.push_back(index);
    const auto of_set = openclose::traces(input.set, domain_.shape.outer, domain_.limits.max_blocks);
    if (!of_set) {
      table.fail(fmt::format("the set has more than {} traces in the domain, or its origin lies as many of them away", domain_.limits.max_blocks),
                 "a wider spacing, longer traces, a nearer origin, or a higher domain.max_blocks");
    }
    const int bridge = input.bridge ? bridges_of(index) : JointTrace::no_bridge;
    for (const SetTrace& trace : *of_set) traces_.push_back({trace, trace.is_bridge ? bridge : index, bridge, trace.goes_on_from, trace.goes_on_to});
  }

  const CuttingTables& tables_;
  const DomainInput& domain_;
  std::vector<JointTrace> traces_;
  std::vector<int> properties_;
  std::vector<int> oblique_;  ///< sets that strike obliquely to the section
  std::vector<SetInSection> in_section_;
};

void refuse_faults(const Cutting& cutting, const Joints& joints, const DomainInput& domain, const Table& table) {
  if (cutting.too_many && domain.limits.max_blocks < domain.written_max_blocks) {
    table.fail(fmt::format("the joints cut the domain into more than {} blocks, for which there is no memory", domain.limits.max_blocks),
               "fewer joints, or more memory; domain.max_blocks only limits their number");
  }
  if (cutting.too_many) {
    table.fail(fmt::format("the joints cut the domain into more than {} blocks", domain.limits.max_blocks),
               "fewer joints, or a higher domain.max_blocks");
  }
  for (int j = 0; j < joints.count(); ++j) {
    if (!cutting.uses[j].in_domain) {
      joints.table(j).fail(joints.is_set(j) ? "no trace of the set is in the domain" : "the line is outside the domain",
                           "joints that meet the domain");
    }
  }
  for (const auto& [a, b] : cutting.overlaps) {
    if (!joints.is_set(a) || !joints.is_set(b)) continue;
    joints.table(b).fail(fmt::format("the set is parallel to the one of {} and shares joints with it", place_name(joints.table(a).where())),
                         "sets of different dips, or parallel ones whose joints lie between each other");
  }
  if (!cutting.loose_holes.empty()) {
    table.at("holes_m")
        .element(cutting.loose_holes.front())
        .fail("the joints do not connect the hole to the domain's boundary, so that a block would have a hole",
              "joints that reach every hole in two places or more");
  }
  if (!cutting.enclosed.empty() && domain.enclosed == EnclosedJoints::refuse) {
    table.fail(fmt::format("{} group(s) of joints, one near {}, enclose a block within another one, which would have a hole", cutting.enclosed.size(),
                           place(cutting.enclosed.front())),
               "joints that connect them to others in two places or more, or domain.enclosed_joints = \"drop\" to leave them out");
  }
  const bool none_used = std::none_of(cutting.uses.begin(), cutting.uses.end(), [](const JointUse& use) { return use.bounds_block; });
  if (joints.count() > 0 && (none_used || cutting.blocks.size() < 2)) {
    table.fail("the joints cut no block out of the domain", "joints that cross the domain or each other, or none at all");
  }
  for (int j = 0; j < joints.count(); ++j) {
    if (joints.is_set(j) && !cutting.uses[j].bounds_block) {
      joints.table(j).fail("the set bounds no block: all its traces end loose inside one",
                           "traces that reach the boundary or other joints at both ends");
    }
  }
}

/// [-] Of the area of all blocks: what is seen in a drawing.
constexpr double noticeable_area = 1e-3;
/// [-] Of the size of the median block: likewise. Defaults of a millimetre are meant for blocks of a metre.
constexpr double noticeable_length = 0.01;

/// Lengths that are small beside blocks of a metre and not beside those of the domain.
void warn_of_lengths(const Cutting& cutting, const DomainInput& domain, const std::string& file, std::vector<std::string>& warnings) {
  std::vector<double> areas;
  for (const Polygon& block : cutting.blocks) areas.push_back(signed_area(block));
  const double all = std::accumulate(areas.begin(), areas.end(), 0.0);
  if (cutting.slivers_area > noticeable_area * all)
    warnings.push_back(
        fmt::format("{}: {} blocks with {:.2g} % of the area are thinner than domain.sliver_width_m = {:g} or smaller than "
                    "sliver_area_m2 = {:g} and united with their neighbours",
                    file, cutting.slivers_merged, 100.0 * cutting.slivers_area / all, domain.limits.sliver_width, domain.limits.sliver_area));
  const std::optional<double> size = size_of_median(std::move(areas));
  if (size && domain.limits.end_reach > noticeable_length * *size)
    warnings.push_back(fmt::format("{}: domain.joint_end_reach_m = {:g} closes bridges of rock up to {:.2g} % of the median block's size of {:.2g} m",
                                   file, domain.limits.end_reach, 100.0 * domain.limits.end_reach / *size, *size));
}

std::vector<std::string> warnings_of(const Cutting& cutting, const Joints& joints, const DomainInput& domain, const Table& table) {
  std::vector<std::string> warnings;
  const std::string file = table.where().file;
  for (int j = 0; j < joints.count(); ++j) {
    if (cutting.uses[j].bounds_block) continue;
    warnings.push_back(fmt::format("{}: {}: the line ends loose inside one block and bounds none", file, place_name(joints.table(j).where())));
  }
  if (!cutting.enclosed.empty())
    warnings.push_back(fmt::format("{}: {} group(s) of joints enclosed in one block left out", file, cutting.enclosed.size()));
  for (const int j : joints.oblique())
    warnings.push_back(fmt::format("{}: {}: the normals of the planes leave the section by more than 20 degrees, and so does what slides on them",
                                   file, place_name(joints.table(j).where())));
  warn_of_lengths(cutting, domain, file, warnings);
  if (cutting.slivers_left > 0) warnings.push_back(fmt::format("{}: {} sliver(s) that no neighbour could take are left", file, cutting.slivers_left));
  return warnings;
}

CuttingSummary summary_of(const Cutting& cutting, const Joints& joints, const DomainInput& domain, const Table& table) {
  CuttingSummary summary;
  summary.blocks = static_cast<int>(cutting.blocks.size());
  summary.smallest_block = INFINITY;
  for (const Polygon& block : cutting.blocks) {
    const double area = signed_area(block);
    summary.area += area;
    summary.smallest_block = std::min(summary.smallest_block, area);
  }
  summary.domain_area = domain.shape.area();
  const auto is_joint = [&](const JointTrace& trace) { return trace.joint < joints.count(); };
  summary.traces = static_cast<int>(std::ranges::count_if(joints.traces(), is_joint));
  summary.dangling_ends = cutting.dangling_ends;
  summary.slivers_merged = cutting.slivers_merged;
  summary.slivers_area = cutting.slivers_area;
  summary.enclosed_groups = static_cast<int>(cutting.enclosed.size());
  summary.sets_in_section = joints.in_section();
  summary.warnings = warnings_of(cutting, joints, domain, table);
  return summary;
}

/// Of the last region around the centroid; notes every region that has it inside.
int material_at(const Vec2& centroid, std::vector<Region>& regions, int otherwise) {
  int material = otherwise;
  for (Region& region : regions) {
    if (!contains(region.outline, centroid)) continue;
    region.any_block = true;
    material = region.material;
  }
  return material;
}

void refuse_empty_regions(const std::vector<Region>& regions, const std::vector<Table>& tables) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (!regions[i].any_block) tables[i].fail("no block of the domain has its centroid in the region", "a polygon around the centroids of blocks");
  }
}

}  // namespace

void cut_domain(const CuttingTables& tables, const NameList& material_names, const NameList& joint_names, NameList& block_names, Scene& scene) {
  if (!tables.domain.is_there()) {
    for (const auto* list : {&tables.joint_sets, &tables.joint_lines, &tables.regions}) {
      if (!list->empty()) list->front().fail("there is no domain to cut", "a scene with a [domain]");
    }
    return;
  }
  Table table = tables.domain;
  const DomainInput domain = read_domain(table, material_names);
  std::vector<Region> regions;
  for (const Table& region : tables.regions) regions.push_back(read_region(region, material_names));
  const Joints joints(tables, domain, joint_names);
  const Cutting cutting = cut_blocks(domain.shape, joints.traces(), joints.properties(), domain.limits);
  refuse_faults(cutting, joints, domain, table);

  const int digits = std::max(4, static_cast<int>(std::to_string(cutting.blocks.size()).size()));
  int number = 0;
  scene.blocks.reserve(scene.blocks.size() + cutting.blocks.size());
  for (std::size_t b = 0; b < cutting.blocks.size(); ++b) {
    const Polygon& polygon = cutting.blocks[b];
    BlockInput block;
    block.name = fmt::format("b{:0{}}", ++number, digits);
    block.material = material_at(polygon_properties(polygon).centroid, regions, domain.material);
    block.vertices = polygon;
    const std::vector<int>& properties = cutting.edge_labels[b];
    if (std::ranges::any_of(properties, [](int property) { return property != BlockInput::by_materials; })) block.edge_joints = properties;
    block.line = table.where().line;
    block_names.add(table.at("vertices_m"), block.name);
    scene.blocks.push_back(std::move(block));
  }
  refuse_empty_regions(regions, tables.regions);
  scene.cutting = summary_of(cutting, joints, domain, table);
}

void fix_blocks(const std::vector<Table>& fixed_lines, Scene& scene) {
  for (const Table& written : fixed_lines) {
    Table table = written;
    const Segment line = read_segment(table);
    bool any = false;
    for (BlockInput& block : scene.blocks) {
      if (common_length(line, block.vertices) < tolerance::shortest_overlap_m) continue;
      block.fixed = any = true;
    }
    if (!any) table.fail("no block touches the line", "a line along edges of blocks, or through blocks");
  }
}

}  // namespace openclose
