#include "openclose/scene/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "openclose/geometry/box.h"
#include "openclose/geometry/labelled_outline.h"
#include "openclose/scene/angle.h"
#include "openclose/scene/base_motion.h"
#include "openclose/scene/domain.h"
#include "openclose/scene/former_keys.h"
#include "openclose/scene/increased_load.h"
#include "openclose/scene/key_depth.h"
#include "openclose/scene/names.h"
#include "openclose/scene/outline.h"
#include "openclose/scene/override.h"
#include "openclose/scene/plausibility.h"
#include "openclose/scene/point_of_block.h"
#include "openclose/scene/table.h"
#include "openclose/scene/toml_hint.h"

namespace openclose {
namespace {

std::string read_text(const std::string& path) {
  const std::string accepted = "the path of a scene file";
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw_input_error({path, 0}, "", "there is no such file", accepted);
  if (!std::filesystem::is_regular_file(status)) throw_input_error({path, 0}, "", "this is not a regular file", accepted);
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) throw_input_error({path, 0}, "", "the file cannot be read", accepted);
  return text;
}

/// \param number  from 1
std::string_view line_of_text(std::string_view text, std::size_t number) {
  for (; number > 1 && !text.empty(); --number) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text.substr(0, text.find('\n'));
}

toml::table parse(const std::string& text, const std::string& path) {
  if (const auto line = line_of_deep_key(text))
    throw_input_error({path, *line}, "", fmt::format("a key has more than {} parts", most_key_parts), "keys such as step.dt_s");
  try {
    toml::table document = toml::parse(text, path);
    if (document.empty())
      throw_input_error({path, 0}, "", "the file is empty", "a scene with at least one [[material]] and one [[block]] or a [domain]");
    return document;
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    throw_input_error({path, static_cast<int>(at.line)}, "", fmt::format("{} in column {}", in_quotes(error.description()), at.column),
                      accepted_instead_of(line_of_text(text, at.line)));
  }
}

Material read_material(Table table, const Vec2& gravity, NameList& names) {
  Material material;
  std::optional<double> density;
  std::optional<double> unit_weight;
  table.required("name", material.name);
  table.optional("density_kg_per_m3", density, positive);
  table.optional("unit_weight_n_per_m3", unit_weight, positive);
  table.finish();

  names.add(table.at("name"), material.name);
  if (density.has_value() == unit_weight.has_value()) {
    table.fail(density ? "both density and unit weight are given" : "neither density nor unit weight is given",
               "exactly one of density_kg_per_m3, unit_weight_n_per_m3");
  }
  if (unit_weight && gravity.isZero(0.0)) table.at("unit_weight_n_per_m3").fail("without gravity a unit weight gives no mass", "density_kg_per_m3");
  material.density = density ? *density : *unit_weight / gravity.norm();
  return material;
}

/// What is met one after the other in a run is also written so: it names its rows and states.
void require_increasing(const Value& value, const std::vector<double>& list) {
  for (std::size_t i = 1; i < list.size(); ++i) {
    if (list[i] <= list[i - 1]) value.element(i).fail(fmt::format("{} follows {}", list[i], list[i - 1]), "numbers that increase");
  }
}

/// A name that strength_reduction.increase can tell from a direction of gravity, and with a minus before it.
void require_load_name(const Value& value, const std::string& name) {
  const bool can_be_named = !name.empty() && name.front() != '-' && can_be_written(name) && !names_gravity(name);
  if (can_be_named) return;
  value.fail(
      in_quotes(name) + " cannot name a load",
      "a name that is not empty, does not begin with a minus and has no commas, quotes and control characters; \"gravity_x\" and \"gravity_y\" "
      "are taken");
}

/// Reads the rows of one table of keys: what the file gives; of the rest finish() reports what is required.
class RowReader {
 public:
  /// \param block_names  for rows that name a block
  explicit RowReader(Table* table, const NameList* block_names = nullptr) : table_(table), block_names_(block_names) {}

  template <typename T, typename Accepted>
  void operator()(const Key& key, T& member, const Accepted& accepted, SourceLocation* where = nullptr) {
    const std::string name(key.name);
    const bool given = read_member(name, member, accepted);
    if (given && where != nullptr) *where = table_->at(name).where();
    if (!given && key.required) table_->miss(name);
  }

 protected:
  Table* table_;

 private:
  const NameList* block_names_;

  template <typename T, typename Accepted>
  bool read_member(const std::string& name, T& member, const Accepted& limits) {
    return table_->optional(name, member, limits);
  }
  bool read_member(const std::string& name, int& member, const BlockName&) { return table_->optional(name, member, *block_names_); }
  bool read_member(const std::string& name, std::string& member, const OwnName&) {
    const bool given = table_->optional(name, member);
    if (given) require_load_name(table_->at(name), member);
    return given;
  }
  bool read_member(const std::string& name, std::optional<std::string>& member, const LoadName&) { return table_->optional(name, member); }
  bool read_member(const std::string& name, bool& member, const Flag&) { return table_->optional(name, member); }
  template <typename Angle>
  bool read_member(const std::string& name, Angle& member, const Degrees& angle) {
    double in_degrees = 0.0;
    const bool given = table_->optional(name, in_degrees, angle.range);
    if (given) member = radians(in_degrees);
    return given;
  }
  bool read_member(const std::string& name, std::vector<double>& member, const ListOf& list) { return table_->optional(name, member, list.each); }
  bool read_member(const std::string& name, std::vector<double>& member, const Increasing& list) {
    const bool given = table_->optional(name, member, list.each);
    if (given) require_increasing(table_->at(name), member);
    return given;
  }
  bool read_member(const std::string& name, std::vector<std::string>& member, const NameIn&) { return table_->optional(name, member); }
  template <typename T>
  bool read_member(const std::string& name, T& member, const NameIn& names) {
    std::string text;
    if (!table_->optional(name, text)) return false;
    if (text.empty())
      table_->at(name).fail("the name is empty", names == NameIn::enforcements ? "the name of a contact method, e.g. \"soft\""
                                                                               : "the name of a time integrator, e.g. \"theta\"");
    member = text;
    return true;
  }
};

JointProperties read_joint(Table table, const NameList& material_names, NameList& joint_names) {
  JointProperties joint;
  std::vector<int> materials;
  const bool is_named = table.optional("name", joint.name);
  const bool has_materials = table.optional("materials", materials, material_names);
  if (!has_materials && !is_named) table.required("materials", materials, material_names);
  RowReader reader(&table);
  visit_joint_keys(joint, reader);
  table.finish();

  // Every joint has a place among the names, so that these are numbered as the joints are.
  if (is_named) {
    joint_names.add(table.at("name"), joint.name);
  } else {
    joint_names.add_nameless();
  }
  if (has_materials && materials.size() != 2)
    table.at("materials").fail(fmt::format("there are {} names", materials.size()), "two names of materials");
  if (has_materials) {
    joint.materials = {materials[0], materials[1]};
  } else {
    joint.materials = {JointProperties::no_material, JointProperties::no_material};
  }
  if (const auto found = contradiction_in(joint)) table.at(std::string(found->key)).fail(std::string(found->read), std::string(found->accepted));
  return joint;
}

std::vector<JointProperties> read_joints(const std::vector<Table>& tables, const NameList& material_names, NameList& joint_names) {
  std::vector<JointProperties> joints;
  std::map<std::pair<int, int>, SourceLocation> known;
  for (const Table& table : tables) {
    joints.push_back(read_joint(table, material_names, joint_names));
    if (!joints.back().has_materials()) continue;
    const auto& [a, b] = joints.back().materials;
    const auto [earlier, is_new] = known.try_emplace(std::minmax(a, b), table.where());
    if (!is_new) {
      table.fail(fmt::format("the joint of {} is for the same two materials", place_name(earlier->second)),
                 "one [[joint]] for each pair of materials");
    }
  }
  return joints;
}

void set_edge_joints(const Value& value, const std::vector<std::string>& names, const Polygon& written, const NameList& joint_names,
                     BlockInput& block) {
  if (names.size() != written.size())
    value.fail(fmt::format("there are {} names for {} vertices", names.size(), written.size()),
               "a name for the edge from each vertex to the next, \"\" where the joint is that of the materials");
  std::vector<int> joints;
  for (std::size_t i = 0; i < names.size(); ++i)
    joints.push_back(names[i].empty() ? BlockInput::by_materials : joint_names.index(value.element(i), names[i]));
  if (std::all_of(joints.begin(), joints.end(), [](int joint) { return joint == BlockInput::by_materials; })) return;
  // The outline keeps those vertices of a straight side at which its joint changes.
  LabelledOutline outline = simplified(written, joints);
  if (signed_area(outline.polygon) < 0.0) {
    outline.polygon = reversed(outline.polygon);
    std::ranges::reverse(outline.labels);
  }
  block.vertices = std::move(outline.polygon);
  block.edge_joints = std::move(outline.labels);
}

BlockInput read_block(Table table, const std::string& file, const NameList& material_names, const NameList& joint_names, NameList& block_names) {
  BlockInput block;
  Polygon vertices;
  const SourceLocation where = table.where();
  block.line = where.line;
  if (where.file != file) block.source = std::make_shared<const std::string>(where.file);
  table.required("name", block.name);
  table.required("material", block.material, material_names);
  table.required("vertices_m", vertices, coordinate);
  table.optional("fixed", block.fixed);
  table.optional("rotation_locked", block.rotation_locked);
  table.optional("velocity_m_per_s", block.velocity);
  table.optional("angular_velocity_rad_per_s", block.angular_velocity);
  if (block.rotation_locked && block.angular_velocity != 0.0)
    table.at("angular_velocity_rad_per_s").fail("the block cannot turn: rotation_locked is true", "0, or a block that may turn");
  const bool has_edge_joints = table.has("edge_joints");
  std::vector<std::string> edge_joints;
  table.optional("edge_joints", edge_joints);
  table.finish();

  block_names.add(table.at("name"), block.name);
  block.vertices = outline(table.at("vertices_m"), vertices);
  if (has_edge_joints) set_edge_joints(table.at("edge_joints"), edge_joints, vertices, joint_names, block);
  return block;
}

bool touches(const BlockInput& block, const Vec2& point) {
  if (!Box::around(block.vertices).inflated(tolerance::farthest_point_from_joint_m).contains(point)) return false;
  return distance_to_boundary(block.vertices, point) <= tolerance::farthest_point_from_joint_m;
}

template <typename Force>
std::vector<Force> read_force(Table table, const Scene& scene, const NameList& block_names) {
  Force force;
  force.block = unnamed_block;
  RowReader reader(&table, &block_names);
  force.visit_keys(force, reader);
  table.finish();
  return force.completed(table, scene.blocks);
}

MeasuredPoint read_measured_point(Table table, const Scene& scene, const NameList& block_names, NameList& point_names) {
  MeasuredPoint measured;
  measured.block = unnamed_block;
  table.required("name", measured.name);
  table.optional("block", measured.block, block_names);
  table.required("point_m", measured.point);
  table.finish();

  point_names.add(table.at("name"), measured.name);
  measured.block = block_of_point(table.at("point_m"), measured.block, measured.point, scene.blocks);
  return measured;
}

MeasuredContact read_measured_contact(Table table, const Scene& scene, const NameList& block_names, NameList& contact_names) {
  MeasuredContact measured;
  table.required("name", measured.name);
  const bool has_a = table.optional("block_a", measured.block_a, block_names);
  const bool has_b = table.optional("block_b", measured.block_b, block_names);
  if (has_a && !has_b) table.required("block_b", measured.block_b, block_names);
  if (has_b && !has_a) table.required("block_a", measured.block_a, block_names);
  table.required("point_m", measured.point);
  table.finish();

  contact_names.add(table.at("name"), measured.name);
  const Value value = table.at("point_m");
  const std::string where = fmt::format("({}, {})", measured.point.x(), measured.point.y());
  if (has_a) {
    if (measured.block_a == measured.block_b) table.at("block_b").fail("this is block_a, too", "the name of another block");
    for (const int b : {measured.block_a, measured.block_b}) {
      if (!touches(scene.blocks[b], measured.point))
        value.fail(fmt::format("{} does not lie on the boundary of {}", where, in_quotes(scene.blocks[b].name)),
                   "a point of the joint between the two");
    }
    return measured;
  }
  std::vector<int> found;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    if (touches(scene.blocks[b], measured.point)) found.push_back(static_cast<int>(b));
  }
  if (found.size() != 2) {
    value.fail(fmt::format("{} lies on the boundaries of {} blocks", where, found.size()),
               "a point of the joint between two blocks; where more of them meet, block_a and block_b name the two");
  }
  measured.block_a = found[0];
  measured.block_b = found[1];
  return measured;
}

/// The names of the tables in which keys stand.
class TableNames {
 public:
  void table(const KeyTable& table) { names.emplace_back(table.name); }
  template <typename... Row>
  void operator()(const Key&, const Row&...) {}

  std::vector<std::string> names;
};

/// Reads every key of the options that the file gives.
class KeyReader : public RowReader {
 public:
  explicit KeyReader(std::map<std::string, Table>& tables) : RowReader(nullptr), tables_(tables) {}

  void table(const KeyTable& table) {
    finish();
    table_ = &tables_.at(std::string(table.name));
  }
  /// To be called after the last row.
  void finish() const {
    if (table_ != nullptr) table_->finish();
  }

 private:
  std::map<std::string, Table>& tables_;
};

void require_both(const Table& table, const std::string& a, const std::string& b) {
  if (table.has(a) == table.has(b)) return;
  throw_input_error(table.where(), fmt::format("method.{}", table.has(a) ? b : a), "this key is missing", fmt::format("{} and {} together", a, b));
}

void read_keys(std::map<std::string, Table>& tables, Scene& scene) {
  scene.method.contact_where = scene.where;
  KeyReader reader(tables);
  visit_keys(scene, reader);
  reader.finish();
  require_both(tables.at("method"), "first_integrator", "first_integrator_s");
  require_increased_load(scene);
}

void require_some(const std::vector<Table>& tables, const SourceLocation& where, const std::string& key) {
  if (tables.empty())
    throw_input_error(where, key, "the scene has none", fmt::format("at least one [[{}]]{}", key, key == "block" ? " or a [domain]" : ""));
}

Scene interpret(const toml::table& document, const std::string& file) {
  Scene scene;
  scene.where = {file, 0};
  Table root(&document, "", file);
  root.optional("title", scene.title);
  root.optional("gravity_m_per_s2", scene.gravity, believable_gravity);
  const std::vector<Table> materials = root.tables("material");
  const std::vector<Table> joints = root.tables("joint");
  const std::vector<Table> blocks = root.tables("block");
  const CuttingTables cutting{root.table("domain"), root.tables("joint_set"), root.tables("joint_line"), root.tables("region")};
  const std::vector<Table> fixed_lines = root.tables("fixed_line");
  std::map<std::string_view, std::vector<Table>> forces;
  ForceInputs::visit(scene, [&](auto& list) {
    using Force = typename std::decay_t<decltype(list)>::value_type;
    forces.emplace(Force::table().name, root.tables(std::string(Force::table().name)));
  });
  const std::vector<Table> measured_points = root.tables("measured_point");
  const std::vector<Table> measured_contacts = root.tables("measured_contact");
  const Table base_motion = root.table("base_motion");
  TableNames of_keys;
  visit_keys(scene, of_keys);
  std::map<std::string, Table> key_tables;
  for (const std::string& name : of_keys.names) key_tables.emplace(name, root.table(name));
  root.finish();
  require_some(materials, scene.where, "material");
  if (!cutting.domain.is_there()) require_some(blocks, scene.where, "block");

  NameList material_names("material");
  NameList joint_names("joint");
  NameList block_names("block");
  NameList point_names("measured point");
  NameList contact_names("measured contact");
  for (const Table& table : materials) scene.materials.push_back(read_material(table, scene.gravity, material_names));
  scene.joints = read_joints(joints, material_names, joint_names);
  for (const Table& table : blocks) scene.blocks.push_back(read_block(table, scene.where.file, material_names, joint_names, block_names));
  cut_domain(cutting, material_names, joint_names, block_names, scene);
  fix_blocks(fixed_lines, scene);
  ForceInputs::visit(scene, [&](auto& list) {
    using Force = typename std::decay_t<decltype(list)>::value_type;
    for (const Table& table : forces.at(Force::table().name)) {
      for (Force& force : read_force<Force>(table, scene, block_names)) list.push_back(std::move(force));
    }
  });
  for (const Table& table : measured_points) scene.measured_points.push_back(read_measured_point(table, scene, block_names, point_names));
  for (const Table& table : measured_contacts) {
    scene.measured_contacts.push_back(read_measured_contact(table, scene, block_names, contact_names));
  }
  read_keys(key_tables, scene);
  if (base_motion.is_there()) {
    scene.base_motion = read_base_motion(base_motion, file);
    if (scene.method.statics)
      base_motion.fail("steps that start from rest know no motion of the base", "no [base_motion], or method.statics = false");
  }
  return scene;
}

}  // namespace

Scene read_scene(const std::string& path, const std::vector<std::string>& overrides) {
  return scene_of_text(read_text(path), path, overrides);
}

Scene scene_of_text(const std::string& text, const std::string& path, const std::vector<std::string>& overrides) {
  toml::table document = parse(text, path);
  std::vector<std::string> warnings;
  move_former_keys(document, path, warnings);
  for (const std::string& key_and_value : overrides) {
    if (const auto current = with_current_key(key_and_value, path, warnings)) apply_override(document, path, *current);
  }
  Scene scene = interpret(document, path);
  scene.warnings = std::move(warnings);
  return scene;
}

}  // namespace openclose
