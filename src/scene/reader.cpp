#include "openclose/scene/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "openclose/core/parallel.h"
#include "openclose/geometry/box.h"
#include "openclose/scene/angle.h"
#include "openclose/scene/base_motion.h"
#include "openclose/scene/domain.h"
#include "openclose/scene/names.h"
#include "openclose/scene/outline.h"
#include "openclose/scene/override.h"
#include "openclose/scene/table.h"

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

toml::table parse(const std::string& path) {
  const std::string text = read_text(path);
  try {
    toml::table document = toml::parse(text, path);
    if (document.empty())
      throw_input_error({path, 0}, "", "the file is empty", "a scene with at least one [[material]] and one [[block]] or a [domain]");
    return document;
  } catch (const toml::parse_error& error) {
    throw_input_error({path, static_cast<int>(error.source().begin.line)}, "", in_quotes(error.description()), "TOML 1.0");
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

JointProperties read_joint(Table table, const NameList& material_names) {
  JointProperties joint;
  std::vector<int> materials;
  double friction_angle_deg = 0.0;
  table.required("materials", materials, material_names);
  table.required("normal_stiffness_pa_per_m", joint.normal_stiffness, positive);
  table.required("shear_stiffness_pa_per_m", joint.shear_stiffness, positive);
  table.required("friction_angle_deg", friction_angle_deg, Range{.low = 0.0, .high = 90.0, .low_included = true});
  table.optional("cohesion_pa", joint.cohesion, not_negative);
  table.optional("tensile_strength_pa", joint.tensile_strength, not_negative);
  table.optional("cohesion_behaviour", joint.cohesion_behaviour, cohesion_behaviour_words);
  table.optional("damping_ratio", joint.damping_ratio, not_negative);
  table.finish();

  if (materials.size() != 2) table.at("materials").fail(fmt::format("there are {} names", materials.size()), "two names of materials");
  joint.materials = {materials[0], materials[1]};
  joint.friction_angle = radians(friction_angle_deg);
  return joint;
}

std::vector<JointProperties> read_joints(const std::vector<Table>& tables, const NameList& material_names) {
  std::vector<JointProperties> joints;
  std::map<std::pair<int, int>, SourceLocation> known;
  for (const Table& table : tables) {
    joints.push_back(read_joint(table, material_names));
    const auto& [a, b] = joints.back().materials;
    const auto [earlier, is_new] = known.try_emplace(std::minmax(a, b), table.where());
    if (!is_new) {
      table.fail(fmt::format("the joint of {} is for the same two materials", place_name(earlier->second)),
                 "one [[joint]] for each pair of materials");
    }
  }
  return joints;
}

BlockInput read_block(Table table, const std::string& file, const NameList& material_names, NameList& block_names) {
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
  table.finish();

  block_names.add(table.at("name"), block.name);
  block.vertices = outline(table.at("vertices_m"), vertices);
  return block;
}

/// The only block that contains the point.
int block_at(const Value& value, const Vec2& point, const std::vector<BlockInput>& blocks) {
  std::vector<int> found;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (!Box::around(blocks[b].vertices).inflated(tolerance::farthest_point_outside_block_m).contains(point)) continue;
    if (contains(blocks[b].vertices, point) || distance_to_boundary(blocks[b].vertices, point) <= tolerance::farthest_point_outside_block_m) {
      found.push_back(static_cast<int>(b));
    }
  }
  const std::string accepted = "a point inside a block, or on the boundary of one that the key block names";
  const std::string where = fmt::format("({}, {})", point.x(), point.y());
  if (found.empty()) {
    const auto nearest = std::ranges::min_element(blocks, {}, [&](const BlockInput& block) { return distance_to_boundary(block.vertices, point); });
    value.fail(fmt::format("{} lies in no block; the nearest one is {}, {:.3g} m away", where, in_quotes(nearest->name),
                           distance_to_boundary(nearest->vertices, point)),
               accepted);
  }
  if (found.size() > 1) {
    value.fail(fmt::format("{} lies where {} and {} meet", where, in_quotes(blocks[found[0]].name), in_quotes(blocks[found[1]].name)), accepted);
  }
  return found.front();
}

bool touches(const BlockInput& block, const Vec2& point) {
  if (!Box::around(block.vertices).inflated(tolerance::farthest_point_from_joint_m).contains(point)) return false;
  return distance_to_boundary(block.vertices, point) <= tolerance::farthest_point_from_joint_m;
}

/// Reads the keys block and point_m. Without the first, which blocks cut out of a domain have no use for, the point tells the block.
class PointOfBlock {
 public:
  PointOfBlock(Table& table, int& block, Vec2& point, const NameList& block_names) : table_(table), block_(block), point_(point) {
    named_ = table.optional("block", block, block_names);
    table.required("point_m", point);
  }

  /// To be called after Table::finish().
  void check(const Scene& scene) {
    const Value value = table_.at("point_m");
    if (named_) {
      require_inside(value, point_, scene.blocks[block_].vertices, scene.blocks[block_].name);
    } else {
      block_ = block_at(value, point_, scene.blocks);
    }
  }

 private:
  Table& table_;
  int& block_;
  Vec2& point_;
  bool named_ = false;
};

Support read_support(Table table, const Scene& scene, const NameList& block_names) {
  Support support;
  PointOfBlock place(table, support.block, support.point, block_names);
  table.required("stiffness_n_per_m", support.stiffness, not_negative);
  table.finish();

  if (support.stiffness.isZero(0.0)) table.at("stiffness_n_per_m").fail("both stiffnesses are 0", "[kx, ky] of which one may be 0");
  place.check(scene);
  return support;
}

Load read_load(Table table, const Scene& scene, const NameList& block_names) {
  Load load;
  PointOfBlock place(table, load.block, load.point, block_names);
  table.required("force_n", load.force);
  table.finish();

  place.check(scene);
  return load;
}

MeasuredPoint read_measured_point(Table table, const Scene& scene, const NameList& block_names, NameList& point_names) {
  MeasuredPoint measured;
  table.required("name", measured.name);
  PointOfBlock place(table, measured.block, measured.point, block_names);
  table.finish();

  point_names.add(table.at("name"), measured.name);
  place.check(scene);
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
        value.fail(fmt::format("{} does not lie on the boundary of {}", where, in_quotes(scene.blocks[b].name)), "a point of the joint between the two");
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

MethodInput read_method(Table table, const SourceLocation& scene_where) {
  MethodInput method;
  method.contact_where = scene_where;
  const bool contact_given = table.optional("contact", method.contact);
  table.optional("theta", method.theta, Range{.low = 0.5, .high = 1.0, .low_included = true, .high_included = true});
  table.optional("integrator", method.integrator);
  table.optional("rho_inf", method.rho_inf, Range{.low = 0.0, .high = 1.0, .low_included = true, .high_included = true});
  table.optional("dissipation", method.dissipation, Range{.low = 0.0, .high = 1.0, .low_included = true, .high_included = true});
  const bool has_first = table.optional("first_integrator", method.first_integrator);
  const bool has_its_time = table.optional("first_integrator_s", method.first_integrator_time, positive);
  if (has_first && !has_its_time) table.required("first_integrator_s", method.first_integrator_time, positive);
  if (has_its_time && !has_first) table.required("first_integrator", method.first_integrator);
  table.optional("rotation", method.rotation, rotation_words);
  table.optional("start", method.start, start_words);
  table.optional("statics", method.statics);
  table.optional("residual_tolerance", method.residual_tolerance, between_0_and_1);
  table.optional("max_iterations", method.max_iterations, count);
  table.optional("linear_solver", method.linear_solver, linear_solver_words);
  table.optional("static_solver", method.static_solver, static_solver_words);
  table.optional("skip_search", method.skip_search);
  table.optional("skip_narrow_phase", method.skip_narrow_phase);
  table.optional("skip_looks", method.skip_looks);
  table.optional("contact_skin_m", method.contact_skin, positive);
  table.optional("skip_reload", method.skip_reload);
  table.optional("skip_factorisation", method.skip_factorisation);
  table.optional("skip_symbolic", method.skip_symbolic);
  table.optional("skip_balanced", method.skip_balanced);
  table.optional("skip_unmoved", method.skip_unmoved);
  table.optional("skip_resting", method.skip_resting);
  table.optional("threads", method.threads, Range{.low = 1.0, .high = most_threads, .low_included = true, .high_included = true});
  table.optional("gap_tolerance_m", method.gap_tolerance, positive);
  table.optional("penalty_pa_per_m", method.penalty, positive);
  table.optional("penalty_shear_ratio", method.penalty_shear_ratio, positive);
  table.optional("penetration_tolerance_m", method.penetration_tolerance, positive);
  table.optional("closing_tolerance_m", method.closing_tolerance, not_negative);
  table.optional("max_open_close_iterations", method.max_open_close_iterations, count);
  table.optional("step_cut", method.step_cut, between_0_and_1);
  table.optional("step_fraction", method.step_fraction, between_0_and_1);
  table.optional("damping", method.damping, mass_damping_words);
  table.optional("local_damping", method.local_damping, between_0_and_1);
  table.finish();

  if (contact_given) method.contact_where = table.at("contact").where();
  if (method.contact.empty()) table.at("contact").fail("the name is empty", "the name of a contact method, e.g. \"soft\"");
  return method;
}

StepInput read_step(Table table) {
  StepInput step;
  table.optional("dt_s", step.dt, positive);
  table.optional("max_displacement_m", step.max_displacement, positive);
  table.optional("smallest_fraction", step.smallest_fraction, Range{.low = 0.0, .high = 1.0, .high_included = true});
  if (table.optional("adaptive", step.adaptive)) step.adaptive_where = table.at("adaptive").where();
  table.optional("error_tolerance_m", step.error_tolerance, positive);
  if (table.optional("look_ahead", step.look_ahead, Range{.low = 0.0, .high = 1.0, .low_included = true, .high_included = true}))
    step.look_ahead_where = table.at("look_ahead").where();
  table.finish();
  return step;
}

RestInput read_rest(Table table) {
  RestInput rest;
  table.optional("time_s", rest.time, positive);
  table.optional("displacement_m", rest.displacement, positive);
  table.optional("acceleration_m_per_s2", rest.acceleration, positive);
  table.finish();
  return rest;
}

void read_run(Table table, Scene& scene) {
  table.optional("strength_reduction_factor", scene.run_strength_reduction_factor, positive);
  if (table.optional("settled_by", scene.settled_by)) scene.settled_by_where = table.at("settled_by").where();
  table.finish();
}

void read_end(Table table, Scene& scene) {
  table.optional("time_s", scene.end_time, not_negative);
  table.optional("displacement_m", scene.end_displacement, positive);
  table.finish();
}

/// What is met one after the other in a run is also written so: it names its rows and states.
void require_increasing(const Value& value, const std::vector<double>& list) {
  for (std::size_t i = 1; i < list.size(); ++i) {
    if (list[i] <= list[i - 1]) value.element(i).fail(fmt::format("{} follows {}", list[i], list[i - 1]), "numbers that increase");
  }
}

void read_output(Table table, Scene& scene) {
  table.optional("every_s", scene.output_every, not_negative);
  table.optional("checkpoint_every_s", scene.checkpoint_every, not_negative);
  const bool has_milestones = table.optional("milestones_m", scene.milestones, positive);
  const bool has_snapshots = table.optional("snapshots_s", scene.snapshot_times, not_negative);
  table.optional("snapshots_every_s", scene.snapshots_every, not_negative);
  table.optional("vtk", scene.vtk);
  table.finish();

  if (has_milestones) require_increasing(table.at("milestones_m"), scene.milestones);
  if (has_snapshots) require_increasing(table.at("snapshots_s"), scene.snapshot_times);
}

SettleInput read_settle(Table table) {
  SettleInput settle;
  table.optional("criterion", settle.criterion, settle_criterion_words);
  table.optional("unbalanced_fraction", settle.unbalanced_fraction, between_0_and_1);
  table.optional("first_dt_s", settle.first_dt, positive);
  table.optional("max_steps", settle.max_steps, count);
  table.optional("max_explicit_steps", settle.max_explicit_steps, count);
  table.optional("keep_bonds", settle.keep_bonds);
  table.optional("failure_displacement_m", settle.failure_displacement, positive);
  table.optional("relative_displacement", settle.relative_displacement, between_0_and_1);
  table.optional("steady_steps", settle.steady_steps, count);
  table.optional("max_time_steps", settle.max_time_steps, count);
  table.optional("unbalanced_force_n", settle.unbalanced_force, positive);
  table.finish();
  return settle;
}

StrengthReductionInput read_strength_reduction(Table table) {
  StrengthReductionInput reduction;
  table.optional("definition", reduction.definition, factor_definition_words);
  table.optional("limit_analysis", reduction.limit_analysis);
  table.optional("width", reduction.width, positive);
  table.optional("upper_limit", reduction.upper_limit, Range{.low = 1.0});
  table.optional("curve", reduction.curve, positive);
  if (table.optional("curve_time_s", reduction.curve_time, positive)) reduction.curve_time_where = table.at("curve_time_s").where();
  table.finish();
  return reduction;
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
  root.optional("gravity_m_per_s2", scene.gravity);
  const std::vector<Table> materials = root.tables("material");
  const std::vector<Table> joints = root.tables("joint");
  const std::vector<Table> blocks = root.tables("block");
  const CuttingTables cutting{root.table("domain"), root.tables("joint_set"), root.tables("joint_line"), root.tables("region")};
  const std::vector<Table> fixed_lines = root.tables("fixed_line");
  const std::vector<Table> supports = root.tables("support");
  const std::vector<Table> loads = root.tables("load");
  const std::vector<Table> measured_points = root.tables("measured_point");
  const std::vector<Table> measured_contacts = root.tables("measured_contact");
  const Table base_motion = root.table("base_motion");
  const Table method = root.table("method");
  const Table step = root.table("step");
  const Table rest = root.table("rest");
  const Table run = root.table("run");
  const Table end = root.table("end");
  const Table output = root.table("output");
  const Table settle = root.table("settle");
  const Table strength_reduction = root.table("strength_reduction");
  root.finish();
  require_some(materials, scene.where, "material");
  if (!cutting.domain.is_there()) require_some(blocks, scene.where, "block");

  NameList material_names("material");
  NameList block_names("block");
  NameList point_names("measured point");
  NameList contact_names("measured contact");
  for (const Table& table : materials) scene.materials.push_back(read_material(table, scene.gravity, material_names));
  scene.joints = read_joints(joints, material_names);
  for (const Table& table : blocks) scene.blocks.push_back(read_block(table, scene.where.file, material_names, block_names));
  cut_domain(cutting, material_names, block_names, scene);
  fix_blocks(fixed_lines, scene);
  for (const Table& table : supports) scene.supports.push_back(read_support(table, scene, block_names));
  for (const Table& table : loads) scene.loads.push_back(read_load(table, scene, block_names));
  for (const Table& table : measured_points) scene.measured_points.push_back(read_measured_point(table, scene, block_names, point_names));
  for (const Table& table : measured_contacts) {
    scene.measured_contacts.push_back(read_measured_contact(table, scene, block_names, contact_names));
  }
  scene.method = read_method(method, scene.where);
  if (base_motion.is_there()) {
    scene.base_motion = read_base_motion(base_motion, file);
    if (scene.method.statics)
      base_motion.fail("steps that start from rest know no motion of the base", "no [base_motion], or method.statics = false");
  }
  scene.step = read_step(step);
  scene.rest = read_rest(rest);
  read_run(run, scene);
  read_end(end, scene);
  read_output(output, scene);
  scene.settle = read_settle(settle);
  scene.strength_reduction = read_strength_reduction(strength_reduction);
  return scene;
}

}  // namespace

Scene read_scene(const std::string& path, const std::vector<std::string>& overrides) {
  toml::table document = parse(path);
  for (const std::string& key_and_value : overrides) apply_override(document, path, key_and_value);
  return interpret(document, path);
}

}  // namespace openclose
