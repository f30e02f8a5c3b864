#include "openclose/io/results.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "openclose/core/check_sum.h"
#include "openclose/core/error.h"
#include "openclose/core/parallel.h"
#include "openclose/core/process.h"
#include "openclose/integrator/integrators.h"
#include "openclose/io/state_hash.h"
#include "openclose/scene/keys.h"
#include "openclose/scene/names.h"
#include "openclose/version.h"

namespace openclose {
namespace {

const char* name_of(ContactStatus status) {
  switch (status) {
    case ContactStatus::open:
      return "open";
    case ContactStatus::sticking:
      return "sticking";
    case ContactStatus::sliding:
      return "sliding";
  }
  return "";
}

/// In the column `stable`.
const char* word_of(TrialOutcome outcome) {
  switch (outcome) {
    case TrialOutcome::stable:
      return "1";
    case TrialOutcome::failed:
      return "0";
    case TrialOutcome::undecided:
      return "undecided";
  }
  return "";
}

nlohmann::ordered_json optional_json(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

/// Rows of a state are put together first: a table has hundreds of thousands of them. Numbers are the shortest that read back exactly, which is also
/// the quickest way to write them.
template <typename... Arguments>
void print(std::string& rows, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(rows), format, std::forward<Arguments>(arguments)...);
}

/// A text field: quoted if it holds what would break the row.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

/// The ledger's entries with their names, in the order of the files.
std::vector<std::pair<const char*, double>> entries(const EnergyLedger& l) {
  return {{"kinetic_j", l.kinetic},
          {"gravity_j", l.gravity},
          {"base_motion_j", l.base_motion},
          {"contact_springs_j", l.contact_springs},
          {"support_springs_j", l.support_springs},
          {"loads_j", l.loads},
          {"friction_j", l.friction},
          {"contact_damping_j", l.contact_damping},
          {"mass_damping_j", l.mass_damping},
          {"impact_j", l.impact},
          {"scheme_j", l.scheme},
          {"redefinition_j", l.redefinition},
          {"turnover_j", l.turnover},
          {"imbalance_j", l.imbalance()}};
}

std::string energy_columns() {
  std::string columns = "time_s";
  for (const auto& entry : entries({})) columns += fmt::format(",{}", entry.first);
  return columns;
}

}  // namespace

RunTable::RunTable(const OutputFolder& folder, const std::string& name, const std::string& columns, const RestartPoint* restart)
    : path_(folder.path_of(name)) {
  mark_ = {name, 0, empty_check_sum};
  if (restart) {
    for (const TableMark& mark : restart->checkpoint.tables) {
      if (mark.name != name) continue;
      file_ = folder.open_growing(name, table_beside(restart->checkpoint_file, name), mark.length);
      mark_ = mark;
    }
    return;
  }
  file_ = folder.open_growing(name);
  file_ << columns << '\n';
}

TableMark RunTable::written() {
  file_.flush();
  require_written();
  const auto length = static_cast<std::uint64_t>(file_.tellp());
  std::ifstream disk(path_, std::ios::binary);
  std::string added(length - mark_.length, ' ');
  if (!disk.seekg(static_cast<std::streamoff>(mark_.length)) || !disk.read(added.data(), static_cast<std::streamsize>(added.size())))
    throw WriteError(path_, "has been removed or cut while the run went on");
  mark_.sum = check_sum(added, mark_.sum);
  mark_.length = length;
  return mark_;
}

void RunTable::require_written() const {
  if (!file_) throw WriteError(path_);
}

HistoryFile::HistoryFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "history.csv",
               "time_s,point,displacement_x_m,displacement_y_m,rotation_rad,velocity_x_m_per_s,velocity_y_m_per_s,"
               "angular_velocity_rad_per_s",
               restart) {}

void HistoryFile::add(double time, const std::vector<PointMotion>& motions) {
  for (const PointMotion& m : motions) {
    fmt::print(file_, "{:.17g},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", time, field(m.name), m.displacement.x(), m.displacement.y(),
               m.rotation, m.velocity.x(), m.velocity.y(), m.angular_velocity);
  }
  require_written();
}

EnergyFile::EnergyFile(const OutputFolder& folder, const RestartPoint* restart) : RunTable(folder, "energy.csv", energy_columns(), restart) {}

void EnergyFile::add(double time, const EnergyLedger& ledger) {
  fmt::print(file_, "{:.17g}", time);
  for (const auto& entry : entries(ledger)) fmt::print(file_, ",{:.17g}", entry.second);
  file_ << '\n';
  require_written();
}

BlocksFile::BlocksFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "blocks.csv", "state,block,vertex,x_m,y_m", restart) {}

void BlocksFile::add(const std::string& state, const Scene& scene, const BlockSystem& system) {
  std::string rows;
  for (int b = 0; b < system.block_count(); ++b) {
    const auto& block = system.block(b);
    for (int i = 0; i < block.vertex_count; ++i) {
      const Vec2 p = system.position(b, block.first_vertex + i) + system.origin();
      print(rows, "{},{},{},{},{}\n", state, field(scene.blocks[b].name), i, p.x(), p.y());
    }
  }
  file_ << rows;
  require_written();
}

ContactsFile::ContactsFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "contacts.csv", "state,block_a,block_b,x_m,y_m,normal_x,normal_y,length_m,gap_m,normal_force_n,shear_force_n,status",
               restart) {}

void ContactsFile::add(const std::string& state, const Scene& scene, const BlockSystem& system, const std::vector<Contact>& contacts) {
  const auto still = Motion::Unknowns::Zero().eval();
  std::string rows;
  for (const Contact& c : contacts) {
    const Vec2 p = system.position(c.vertex_block, c.vertex) + system.origin();
    const Vec2 n = ContactKinematics(system, c, still, still).normal;
    print(rows, "{},{},{},{},{},{},{},{},{},{},{},{}\n", state, field(scene.blocks[c.vertex_block].name), field(scene.blocks[c.edge_block].name),
          p.x(), p.y(), n.x(), n.y(), c.length, c.gap, c.normal_force, c.shear_force, name_of(c.status));
  }
  file_ << rows;
  require_written();
}

BlockStatesFile::BlockStatesFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "block_states.csv",
               "state,time_s,block,x_m,y_m,displacement_x_m,displacement_y_m,rotation_rad,velocity_x_m_per_s,velocity_y_m_per_s,"
               "angular_velocity_rad_per_s",
               restart) {}

void BlockStatesFile::add_place(std::string& rows, const std::string& state, const std::string& time, const Scene& scene, const BlockSystem& system,
                                int b) const {
  const Vec2 p = system.centroid(b) + system.origin();
  const auto& d = system.displacement(b);
  print(rows, "{},{},{},{},{},{},{},{}", state, time, field(scene.blocks[b].name), p.x(), p.y(), d[0], d[1], Motion::rotation(d));
}

void BlockStatesFile::add(const std::string& state, const Simulation& simulation) {
  const std::string time = fmt::format("{}", simulation.time());
  std::string rows;
  for (int b = 0; b < simulation.system().block_count(); ++b) {
    add_place(rows, state, time, simulation.scene(), simulation.system(), b);
    const auto v = simulation.velocity(b);
    print(rows, ",{},{},{}\n", v[0], v[1], Motion::rotation(v));
  }
  file_ << rows;
  require_written();
}

void BlockStatesFile::add(const std::string& state, const Scene& scene, const BlockSystem& system) {
  std::string rows;
  for (int b = 0; b < system.block_count(); ++b) {
    add_place(rows, state, "", scene, system, b);
    print(rows, ",,,\n");
  }
  file_ << rows;
  require_written();
}

CracksFile::CracksFile(const OutputFolder& folder, const Scene& scene, const RestartPoint* restart)
    : RunTable(folder, "cracks.csv", "state,block_a,block_b,x1_m,y1_m,x2_m,y2_m,length_m,opening1_m,opening2_m,slip1_m,slip2_m", restart),
      joints_(drawn_joints(scene)) {}

void CracksFile::add(const std::string& state, const Scene& scene, const BlockSystem& system) {
  std::string rows;
  for (const DrawnJoint& joint : joints_) {
    const JointMotion m = joint_motion(joint, system);
    print(rows, "{},{},{},{},{},{},{},{},{},{},{},{}\n", state, field(scene.blocks[joint.block_a].name), field(scene.blocks[joint.block_b].name),
          m.from.middle.x(), m.from.middle.y(), m.to.middle.x(), m.to.middle.y(), (joint.to_b - joint.from_b).norm(), m.from.opening, m.to.opening,
          m.from.slip, m.to.slip);
  }
  file_ << rows;
  require_written();
}

ContactHistoryFile::ContactHistoryFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "contact_history.csv", "time_s,contact,normal_force_n,shear_force_n,gap_m,slip_m,status,closed_contacts", restart) {}

void ContactHistoryFile::add(double time, const std::vector<ContactMotion>& motions) {
  for (const ContactMotion& m : motions) {
    fmt::print(file_, "{:.17g},{},{:.17g},{:.17g},{:.17g},{:.17g},{},{}\n", time, field(m.name), m.normal_force, m.shear_force, m.gap, m.slip,
               name_of(m.status), m.closed);
  }
  require_written();
}

StateTables::StateTables(const OutputFolder& folder, const Scene& scene, const RestartPoint* restart)
    : blocks_(folder, restart), contacts_(folder, restart), states_(folder, restart), cracks_(folder, scene, restart) {}

void StateTables::add(const std::string& state, const Simulation& simulation, const std::vector<Contact>& contacts) {
  blocks_.add(state, simulation);
  contacts_.add(state, simulation.scene(), simulation.system(), contacts);
  states_.add(state, simulation);
  cracks_.add(state, simulation.scene(), simulation.system());
}

void StateTables::add(const NamedState& state, const Scene& scene) {
  blocks_.add(state.name, scene, state.system);
  contacts_.add(state.name, scene, state.system, state.contacts);
  states_.add(state.name, scene, state.system);
  cracks_.add(state.name, scene, state.system);
}

std::vector<TableMark> StateTables::written() {
  return {blocks_.written(), contacts_.written(), states_.written(), cracks_.written()};
}

void StateTables::close() {
  blocks_.close();
  contacts_.close();
  states_.close();
  cracks_.close();
}

void write_block_properties(const OutputFolder& folder, const Scene& scene, const BlockSystem& system) {
  std::ofstream file = folder.open("block_properties.csv");
  file << "block,material,fixed,area_m2,mass_kg\n";
  for (int b = 0; b < system.block_count(); ++b) {
    const BlockInput& block = scene.blocks[b];
    fmt::print(file, "{},{},{},{:.17g},{:.17g}\n", field(block.name), field(scene.materials[block.material].name), block.fixed ? 1 : 0,
               system.block(b).area, system.block(b).mass[0]);
  }
  finish(file, folder.path_of("block_properties.csv"));
}

void write_mechanism(const OutputFolder& folder, const Scene& scene, const std::vector<FailingBlock>& blocks) {
  std::ofstream file = folder.open("mechanism.csv");
  file << "block,area_m2,x_m,y_m,velocity_x,velocity_y,rotation_per_m\n";
  for (const FailingBlock& b : blocks) {
    fmt::print(file, "{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", field(scene.blocks[b.block].name), b.area, b.centroid.x(),
               b.centroid.y(), b.velocity.x(), b.velocity.y(), b.rotation);
  }
  finish(file, folder.path_of("mechanism.csv"));
}

void write_trials(const OutputFolder& folder, const std::vector<StrengthTrial>& trials) {
  std::ofstream file = folder.open("trials.csv");
  file << "srf,stage,stable,criterion,steps,displacement_m\n";
  for (const StrengthTrial& t : trials) {
    fmt::print(file, "{:.17g},{},{},{},{},{:.17g}\n", t.srf, t.stage, word_of(t.outcome), field(t.criterion), t.steps, t.displacement);
  }
  finish(file, folder.path_of("trials.csv"));
}

void write_curve(const OutputFolder& folder, const std::vector<CurvePoint>& curve) {
  std::ofstream file = folder.open("curve.csv");
  file << "srf,point,displacement_m\n";
  for (const CurvePoint& p : curve) fmt::print(file, "{:.17g},{},{:.17g}\n", p.srf, field(p.point), p.displacement);
  finish(file, folder.path_of("curve.csv"));
}

void write_milestones(const OutputFolder& folder, const std::vector<Milestone>& milestones) {
  std::ofstream file = folder.open("milestones.csv");
  file << "displacement_m,time_s,cpu_s,cpu_of_program_s,reason\n";
  for (const Milestone& m : milestones) {
    if (m.time) {
      fmt::print(file, "{:.17g},{:.17g},{:.17g},{:.17g},\n", m.displacement, *m.time, m.cpu_of_motion, m.cpu_of_program);
    } else {
      fmt::print(file, "{:.17g},,,,{}\n", m.displacement, field(m.reason));
    }
  }
  finish(file, folder.path_of("milestones.csv"));
}

namespace {

nlohmann::ordered_json milestones_json(const std::vector<Milestone>& milestones) {
  using nlohmann::ordered_json;
  ordered_json list = ordered_json::array();
  const ordered_json none;
  for (const Milestone& m : milestones) {
    list.push_back({{"displacement_m", m.displacement},
                    {"time_s", m.time ? ordered_json(*m.time) : none},
                    {"cpu_s", m.time ? ordered_json(m.cpu_of_motion) : none},
                    {"cpu_of_program_s", m.time ? ordered_json(m.cpu_of_program) : none},
                    {"reason", m.reason}});
  }
  return list;
}

nlohmann::ordered_json settling_json(const SettleResult& settling) {
  nlohmann::ordered_json j = {{"settled", settling.settled}, {"criterion", settling.criterion}, {"steps", settling.steps}};
  if (settling.relative_displacement) {
    j["relative_displacement"] = *settling.relative_displacement;
  } else {
    j["unbalanced_fraction"] = settling.unbalanced_fraction;
  }
  j["displacement_m"] = settling.displacement;
  return j;
}

}  // namespace

namespace {

/// Where something is held, pushed or measured: points of the drawing.
void add_points(const Scene& scene, nlohmann::ordered_json& j) {
  using nlohmann::ordered_json;
  const auto pair = [](const Vec2& v) { return ordered_json::array({v.x(), v.y()}); };
  const auto plural = [](std::string_view table) { return std::string(table) + 's'; };
  ForceInputs::visit(scene, [&](const auto& list) { j[plural(std::decay_t<decltype(list)>::value_type::table().name)] = ordered_json::array(); });
  for (const std::vector<KeyEntry>& force : force_entries(scene)) {
    ordered_json& entry = j[plural(force.front().table.name)].emplace_back();
    for (const KeyEntry& row : force) entry[std::string(row.key.name)] = ordered_json::parse(row.value.value());
  }
  j["arrows"] = j["measured_points"] = ordered_json::array();
  for_each_force(scene, [&](const auto& force) {
    for (const DrawnForce& arrow : force.drawn()) {
      j["arrows"].push_back({{"block", scene.blocks[force.block].name},
                             {"point_m", pair(arrow.point)},
                             {"force_n", pair(arrow.force)},
                             {"turns_with_block", arrow.turns_with_block}});
    }
  });
  for (const MeasuredPoint& p : scene.measured_points)
    j["measured_points"].push_back({{"name", p.name}, {"block", scene.blocks[p.block].name}, {"point_m", pair(p.point)}});
}

/// Every key with the value that was used, by tables; null where there is none.
nlohmann::ordered_json options_json(const Simulation& simulation) {
  using nlohmann::ordered_json;
  const Scene& scene = simulation.scene();
  ordered_json options;
  for (const KeyEntry& entry : key_entries(scene))
    options[std::string(entry.table.name)][std::string(entry.key.name)] = entry.value ? ordered_json::parse(*entry.value) : ordered_json(nullptr);
  // What a key leaves to the method and to the blocks.
  if (scene.method.contact == "soft") options["method"]["integrator"] = integrator_name(scene.method);
  options["solver"]["contact_skin_m"] = simulation.state().contact_skin;
  options["base_motion"] = scene.base_motion ? ordered_json(word_for(base_motion_words, scene.base_motion->kind)) : ordered_json(nullptr);
  return options;
}

void add_factor(const FactorOfSafety& safety, const Scene& scene, nlohmann::ordered_json& j) {
  using nlohmann::ordered_json;
  j["factor_of_safety"] = optional_json(safety.bracket.stable);
  j["verdict"] = factor_verdict_word(safety.verdict);
  j["definition"] = word_for(factor_definition_words, scene.strength_reduction.definition);
  const bool failed = safety.bracket.failed.has_value();
  j["bracket"] = {{"stable", optional_json(safety.bracket.stable)},
                  {"failed", optional_json(safety.bracket.failed)},
                  {"failed_by", failed ? ordered_json(safety.bracket.failed_by) : ordered_json(nullptr)},
                  {"undecided_trials", safety.bracket.undecided}};
  if (safety.limit_analysis) {
    j["limit_analysis"] = {{"factor", optional_json(safety.limit_analysis->factor)},
                           {"verdict", safety.limit_analysis->verdict},
                           {"programs", safety.limit_analysis->programs}};
  } else {
    j["limit_analysis"] = nullptr;
  }
  ordered_json effects = ordered_json::array();
  for (const StiffnessEffect& effect : safety.stiffness_effects) {
    effects.push_back({{"ratio", effect.ratio}, {"stable", optional_json(effect.stable)}, {"failed", optional_json(effect.failed)}});
  }
  j["shear_to_normal_stiffness"] = effects;
  double area = 0.0;
  ordered_json names = ordered_json::array();
  for (const FailingBlock& block : safety.mechanism) {
    area += block.area;
    names.push_back(scene.blocks[block.block].name);
  }
  j["failing_blocks"] = {{"number", safety.mechanism.size()}, {"area_m2", area}, {"names", names}};
  j["largest_travel_m"] = optional_json(safety.largest_travel);
  ordered_json curve = ordered_json::array();
  for (const StrengthTrial& t : safety.trials) {
    if (t.outcome == TrialOutcome::stable) curve.push_back({{"srf", t.srf}, {"displacement_m", t.displacement}});
  }
  j["displacement_curve"] = curve;
  j["small_displacement_factorisations"] = safety.linear_solves;
}

}  // namespace

void write_summary(const OutputFolder& folder, const Summary& summary, const Simulation& simulation, const FactorOfSafety* safety) {
  using nlohmann::ordered_json;
  const Scene& scene = simulation.scene();
  const StepCounters& steps = simulation.state().counters;
  const DetectionCounters& detection = simulation.state().detector.counters();
  const LinearCounters& linear = simulation.enforcement().linear_counters();
  const StageTimes& cpu = simulation.state().stage_times;

  ordered_json j;
  j["version"] = version;
  j["command"] = summary.command;
  j["scene"] = summary.scene_file;
  j["title"] = scene.title;
  j["overrides"] = summary.overrides;
  j["options"] = options_json(simulation);
  add_points(scene, j);
  j["warnings"] = summary.warnings;
  j["blocks"] = simulation.system().block_count();
  j["free_blocks"] = simulation.system().free_count() + static_cast<int>(simulation.system().resting_blocks().size());
  j["converged"] = summary.converged;
  j["reason"] = summary.reason;
  j["state_hash"] = safety ? state_hash(*safety, scene) : state_hash(simulation);
  if (!safety) j["time_s"] = simulation.time();
  if (summary.settling.steps > 0) j["settling"] = settling_json(summary.settling);
  if (safety) {
    add_factor(*safety, scene, j);
    j["cpu_s"] = {{"search", summary.cpu_of_search}};
  } else {
    ordered_json ledger;
    for (const auto& [name, value] : entries(summary.ledger)) ledger[name] = value;
    j["energy_ledger"] = ledger;
    j["ended_by"] = summary.ended_by;
    j["watch"] = {{"checks", summary.watch.checks},
                  {"created_energy", summary.watch.created_energy},
                  {"available_energy_j", summary.watch.available_energy},
                  {"penetration", summary.watch.penetration},
                  {"overlap", summary.watch.overlap},
                  {"depth_m", summary.watch.depth},
                  {"reach", summary.watch.reach}};
    j["milestones"] = milestones_json(summary.milestones);
    j["cpu_s"] = {{"start", summary.cpu_of_start}, {"motion", summary.cpu_of_motion}};
  }
  j["wall_s"] = wall_time();
  j["max_penetration_m"] = summary.max_penetration;
  j["peak_memory_bytes"] = peak_memory();
  const Memory& memory = simulation.state().memory;
  const std::size_t program = static_cast<std::size_t>(memory_of_program());
  j["memory_bytes"] = {{"program", program},
                       {"blocks", memory.blocks},
                       {"contacts", memory.contacts},
                       {"matrix", memory.matrix},
                       {"factor", memory.factor},
                       {"krylov", memory.krylov},
                       {"without_factor", program + memory.without_factor()}};
  j["counters"] = {{"steps", steps.steps},
                   {"steps_cut", steps.cuts},
                   {"error_cuts", steps.error_cuts},
                   {"entry_cuts", steps.entry_cuts},
                   {"eased_steps", steps.eased},
                   {"still_steps", steps.still},
                   {"dissipative_steps", steps.dissipative},
                   {"iterations", steps.iterations},
                   {"parts", steps.parts},
                   {"part_iterations", steps.part_iterations},
                   {"part_rows", steps.part_rows},
                   {"part_batches", steps.part_batches},
                   {"part_batches_skipped", steps.part_batches_skipped},
                   {"relaxation_steps", steps.relaxation_steps},
                   {"relaxation_estimates", steps.relaxation_estimates},
                   {"searches", detection.searches},
                   {"searches_skipped", detection.searches_skipped},
                   {"narrow_phases", detection.narrow_phases},
                   {"narrow_phases_skipped", detection.narrow_phases_skipped},
                   {"looks", detection.looks},
                   {"looks_skipped", detection.looks_skipped},
                   {"history_transfers", detection.transfers},
                   {"block_steps", steps.block_steps},
                   {"block_steps_skipped", steps.block_steps_skipped},
                   {"put_to_rest", steps.put_to_rest},
                   {"woken", steps.woken},
                   {"steps_repeated_to_wake", steps.repeated_to_wake},
                   {"factorisations", linear.factorisations},
                   {"rows", linear.rows},
                   {"rows_kept", linear.rows_kept},
                   {"refinements", linear.refinements},
                   {"couplings_taken_in", linear.couplings_taken_in},
                   {"pivots_lost", linear.pivots_lost},
                   {"symbolic", linear.symbolic},
                   {"symbolic_skipped", linear.symbolic_skipped},
                   {"krylov_iterations", linear.krylov_iterations},
                   {"krylov_given_up", linear.krylov_given_up},
                   {"incomplete_factorisations", linear.incomplete}};
  j["work_shared"] = {{"factorisations", times_shared(SharedWork::factorisation)},
                      {"substitutions", times_shared(SharedWork::substitution)},
                      {"products", times_shared(SharedWork::product)}};
  if (simulation.is_explicit()) {
    j["explicit"] = {{"critical_step_s", steps.smallest_critical_step},
                     {"longest_step_s", steps.longest_step},
                     {"state_loads", steps.loads},
                     {"state_loads_skipped", steps.loads_skipped}};
  }
  j["stage_s"] = {{"detection", cpu.detection}, {"solution", cpu.solution}, {"bookkeeping", cpu.bookkeeping}};
  std::ofstream file = folder.open("summary.json");
  file << j.dump(2) << '\n';
  finish(file, folder.path_of("summary.json"));
}

}  // namespace openclose
