// The rows of what a scene is made of: blocks, materials, joints, forces, the domain. Joints and forces have theirs below their members; who reads
// the other tables is reader.cpp, base_motion.cpp and domain.cpp; a test compares the names.
#include "openclose/scene/keys.h"
#include "openclose/scene/names.h"
#include "openclose/scene/outline.h"
#include "openclose/scene/plausibility.h"

namespace openclose {
namespace {

class Rows {
 public:
  void table(const KeyTable& table) { table_ = table; }
  void required(const Key& key, ValueType type, const Range& range = any_number) { add(key, type, range).key.required = true; }
  void optional(const Key& key, ValueType type, const Range& range = any_number) { add(key, type, range); }
  template <typename Enum, std::size_t n>
  void word(const Key& key, const std::array<Word<Enum>, n>& words) {
    KeyEntry& entry = add(key, ValueType::word, any_number);
    for (const auto& word : words) entry.words.push_back({word.text, word.says});
  }

  std::vector<KeyEntry> entries;

 private:
  KeyEntry& add(const Key& key, ValueType type, const Range& range) {
    KeyEntry entry;
    entry.table = table_;
    entry.key = key;
    entry.type = type;
    entry.range = range;
    entries.push_back(entry);
    return entries.back();
  }

  KeyTable table_;
};

constexpr Range part_of_one{.low = 0.0, .high = 1.0, .low_included = true};
constexpr Range azimuth{.low = 0.0, .high = 360.0, .low_included = true, .high_included = true};
constexpr Range whole_turn{.low = -180.0, .high = 180.0, .low_included = true, .high_included = true};

void add_blocks(Rows& rows) {
  rows.table({"", Audience::user, "At the top of the file, before the first table"});
  rows.optional({"title", "of the scene", "\"\""}, ValueType::text);
  rows.optional({"gravity_m_per_s2", "[x, y]", "[0, -9.81]"}, ValueType::vector, believable_gravity);
  rows.table({"material", Audience::user, "What blocks consist of; a scene has at least one", true});
  rows.required({"name", "unique; no name of a scene may hold commas or quotes"}, ValueType::text);
  rows.optional({"density_kg_per_m3", "this or the next", "from the unit weight"}, ValueType::number, positive);
  rows.optional({"unit_weight_n_per_m3", "divided by gravity, which must not be zero", "from the density"}, ValueType::number, positive);
  rows.table({"block", Audience::user, "A block; a scene has at least one, or a domain", true});
  rows.required({"name", "unique"}, ValueType::text);
  rows.required({"material", "name of a material"}, ValueType::text);
  rows.required({"vertices_m",
                 "a simple polygon, convex or not; clockwise ones are turned, vertices on a straight line are dropped where no joint changes; blocks "
                 "may overlap by up to 1 mm"},
                ValueType::polygon, coordinate);
  rows.optional({"fixed", "true: never moves", "false"}, ValueType::boolean);
  rows.optional({"rotation_locked", "true: moves without turning", "false"}, ValueType::boolean);
  rows.optional({"velocity_m_per_s", "[x, y], of the centroid at time 0", "[0, 0]"}, ValueType::vector);
  rows.optional({"angular_velocity_rad_per_s", "at time 0, counter-clockwise", "0"}, ValueType::number);
  rows.optional({"edge_joints",
                 "a name of a joint for the edge from each vertex to the next, \"\" where the joint is that of the materials, see [scenes](scene.md)",
                 "that of the materials"},
                ValueType::names);
}

void add_joints(Rows& rows) {
  const std::vector<KeyEntry> values = joint_entries(JointProperties{});
  rows.table(values.front().table);
  rows.optional({"name", "unique: by which joint_set, joint_line and block give it to their edges", "none"}, ValueType::text);
  rows.optional({"materials",
                 "two names, in either order, the same one twice for a joint within a material: all contacts between their blocks but those in seams "
                 "that name a joint",
                 "asked for without a name"},
                ValueType::names);
  rows.entries.insert(rows.entries.end(), values.begin(), values.end());
}

void add_point(Rows& rows) {
  rows.optional({"block", "name of a block", "that at the point"}, ValueType::text);
  rows.required({"point_m", "in the block or on its boundary"}, ValueType::vector);
}

void add_points(Rows& rows) {
  const std::vector<KeyEntry> forces = force_keys();
  rows.entries.insert(rows.entries.end(), forces.begin(), forces.end());
  rows.table({"measured_point", Audience::user,
              "A point of which the motion is written; without any, the centroids of the free blocks, under the names of the blocks", true});
  rows.required({"name", "unique"}, ValueType::text);
  add_point(rows);
  rows.table({"measured_contact", Audience::user, "The joint between two blocks at a point of it, in `contact_history.csv` of a run", true});
  rows.required({"name", "unique"}, ValueType::text);
  rows.required({"point_m", "within 1 mm of the boundaries of both blocks, as drawn"}, ValueType::vector);
  rows.optional({"block_a", "asked for where more than two blocks meet", "the two that meet there"}, ValueType::text);
  rows.optional({"block_b", "asked for with `block_a`", "the two that meet there"}, ValueType::text);
}

void add_base_motion(Rows& rows) {
  rows.table({"base_motion", Audience::user, "The ground with all fixed blocks and supports moves during a run, see [scenes](scene.md)"});
  rows.word({.name = "kind", .says = "which of the next keys describe it", .required = true}, base_motion_words);
  rows.optional({"factor", "on all accelerations", "1"}, ValueType::number);
  rows.optional({"amplitude_m_per_s2", "\"harmonic\": [x, y] of amplitude sin(2 pi f t + phase)", "asked for"}, ValueType::vector);
  rows.optional({"frequency_hz", "\"harmonic\"", "asked for"}, ValueType::number, positive);
  rows.optional({"phase_deg", "\"harmonic\"", "0"}, ValueType::number);
  for (const bool horizontal : {true, false}) {
    rows.optional({horizontal ? "horizontal_file" : "vertical_file", "\"record\": a path from the folder of the scene", "none"}, ValueType::text);
    rows.optional({horizontal ? "horizontal_time_s" : "vertical_time_s", "\"record\", instead of the file: times that do not decrease", "none"},
                  ValueType::list, not_negative);
    rows.optional({horizontal ? "horizontal_m_per_s2" : "vertical_m_per_s2", "\"record\": as many accelerations", "none"}, ValueType::list);
  }
  rows.table({"base_motion.pulse", Audience::user, "A rectangular pulse of \"pulses\"; where they overlap they add up", true});
  rows.optional({"start_s", "time", "0"}, ValueType::number, not_negative);
  rows.required({"duration_s", "of the pulse"}, ValueType::number, positive);
  rows.required({"acceleration_m_per_s2", "[x, y]"}, ValueType::vector);
}

void add_domain(Rows& rows) {
  rows.table({"domain", Audience::user, "An outline that joints cut into blocks, see [scenes](scene.md)"});
  rows.required({"vertices_m", "a simple polygon"}, ValueType::polygon, coordinate);
  rows.required({"material", "name of a material"}, ValueType::text);
  rows.optional({"holes_m", "polygons inside it", "none"}, ValueType::polygons, coordinate);
  rows.optional(
      {"sliver_width_m", "thinner blocks (2 area / longest edge) are merged into the neighbour with the longest common edge, and reported", "1e-3"},
      ValueType::number, Range{.low = tolerance::least_sliver_width_m, .low_included = true});
  rows.optional({"sliver_area_m2", "smaller blocks likewise", "0"}, ValueType::number, not_negative);
  rows.optional({"joint_end_reach_m", "joints that end this close to another reach it", "1e-3"}, ValueType::number, joint_end_reach);
  rows.word({"enclosed_joints", "joints inside one block, connected to no other", "\"refuse\""}, enclosed_joints_words);
  rows.optional({"section_direction_deg", "azimuth into which x points, clockwise from north; for `dip_direction_deg`", "asked for with it"},
                ValueType::number, azimuth);
  rows.optional({"max_blocks", "more blocks, or joints, are refused at once", "1000000"}, ValueType::whole_number,
                {.low = 1.0, .high = 1e7, .low_included = true, .high_included = true});
  rows.table({"joint_set", Audience::user, "Parallel joints through the domain", true});
  rows.required({"dip_deg", "counter-clockwise from the horizontal; with `dip_direction_deg` that of the plane in space, downwards"},
                ValueType::number, whole_turn);
  rows.required({"spacing_m", "between joints, at right angles to them"}, ValueType::number, positive);
  rows.required({"origin_m", "a point on one joint of the set"}, ValueType::vector, coordinate);
  rows.optional({"joint", "name of the joint that gives its seams their properties", "that of the materials"}, ValueType::text);
  rows.optional(
      {"bridge",
       "name of the joint that has the strength of rock: each line with a trace is cut through, also where it is rock, and its ends in rock "
       "go on to the next joint, see [scenes](scene.md)",
       "traces are cut back to the last joint that they cross"},
      ValueType::text);
  rows.optional({"dip_direction_deg", "azimuth into which the plane falls: dip and spacing are those of the plane in space, see [scenes](scene.md)",
                 "dip and spacing are those of the section"},
                ValueType::number, azimuth);
  rows.optional({"trace_length_m", "of joints of finite length along each line; with `gap_m` or `persistence`", "through-going"}, ValueType::number,
                positive);
  rows.optional({"gap_m", "rock between two traces of a line", "none"}, ValueType::number, not_negative);
  rows.optional({"persistence", "part of each line that is joint, instead of `gap_m`", "none"}, ValueType::number,
                {.low = 0.0, .high = 1.0, .high_included = true});
  rows.optional({"stagger", "by which part of trace and gap the traces are shifted from line to line", "0"}, ValueType::number, part_of_one);
  rows.optional({"dip_scatter_deg", "the same on every machine for one seed", "0"}, ValueType::number,
                {.low = 0.0, .high = 45.0, .low_included = true});
  rows.optional({"spacing_scatter", "part of the spacing", "0"}, ValueType::number, part_of_one);
  rows.optional({"trace_scatter", "part of the length", "0"}, ValueType::number, part_of_one);
  rows.optional({"seed", "of the scatter", "0"}, ValueType::whole_number, {.low = 0.0, .high = 1e9, .low_included = true, .high_included = true});
  rows.optional({"region_m", "polygon that bounds the set", "everywhere"}, ValueType::polygon, coordinate);
  for (const bool fixed : {false, true}) {
    rows.table({fixed ? "fixed_line" : "joint_line", Audience::user,
                fixed ? "Every block that shares more than a point with it is fixed" : "A single joint", true});
    rows.required({"from_m", "one end"}, ValueType::vector, coordinate);
    rows.required({"to_m", "the other"}, ValueType::vector, coordinate);
    if (fixed) continue;
    rows.optional({"joint", "name of the joint that gives its seams their properties", "that of the materials"}, ValueType::text);
    rows.optional({"bridge", "name of the joint as which ends that lie in rock go on to the next joint or the outline", "ends in rock are cut back"},
                  ValueType::text);
  }
  rows.table({"region", Audience::user, "Blocks whose centroid lies inside have its material, the last region wins", true});
  rows.required({"vertices_m", "a simple polygon"}, ValueType::polygon, coordinate);
  rows.required({"material", "name of a material"}, ValueType::text);
}

}  // namespace

const std::vector<KeyEntry>& element_keys() {
  static const std::vector<KeyEntry> entries = [] {
    Rows rows;
    add_blocks(rows);
    add_joints(rows);
    add_points(rows);
    add_base_motion(rows);
    add_domain(rows);
    return std::move(rows.entries);
  }();
  return entries;
}

}  // namespace openclose
