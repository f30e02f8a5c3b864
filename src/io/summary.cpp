#include "openclose/io/summary.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "openclose/core/parallel.h"
#include "openclose/core/process.h"
#include "openclose/integrator/integrators.h"
#include "openclose/io/drawing.h"
#include "openclose/io/results.h"
#include "openclose/io/state_hash.h"
#include "openclose/scene/increased_load.h"
#include "openclose/scene/keys.h"
#include "openclose/scene/names.h"
#include "openclose/version.h"

namespace openclose {
namespace {

nlohmann::ordered_json optional_json(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

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

/// Where something is held, pushed or measured: points of the drawing. \param pushed  the forces as they are in the results
void add_points(const Scene& scene, const ForceInputs& pushed, nlohmann::ordered_json& j) {
  using nlohmann::ordered_json;
  const auto pair = [](const Vec2& v) { return ordered_json::array({v.x(), v.y()}); };
  const auto plural = [](std::string_view table) { return std::string(table) + 's'; };
  ForceInputs::visit(scene, [&](const auto& list) { j[plural(std::decay_t<decltype(list)>::value_type::table().name)] = ordered_json::array(); });
  for (const std::vector<KeyEntry>& force : force_entries(scene)) {
    ordered_json& entry = j[plural(force.front().table.name)].emplace_back();
    for (const KeyEntry& row : force) {
      if (row.value) entry[std::string(row.key.name)] = ordered_json::parse(*row.value);
    }
  }
  j["arrows"] = j["measured_points"] = ordered_json::array();
  for_each_force(pushed, [&](const auto& force) {
    for (const DrawnForce& arrow : force.drawn()) {
      j["arrows"].push_back({{"block", scene.blocks[force.block].name},
                             {"point_m", pair(arrow.point)},
                             {"force_n", pair(arrow.force)},
                             {"turns_with_block", arrow.turns_with_block},
                             {"spread_m", pair(arrow.spread)}});
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
  options["solver"]["contact_skin_m"] = simulation.state().lengths.contact_skin;
  options["step"]["max_displacement_m"] = simulation.state().lengths.longest_displacement;
  options["base_motion"] = scene.base_motion ? ordered_json(word_for(base_motion_words, scene.base_motion->kind)) : ordered_json(nullptr);
  return options;
}

void add_factor(const FactorOfSafety& safety, const Scene& scene, nlohmann::ordered_json& j) {
  using nlohmann::ordered_json;
  const bool increases_load = scene.strength_reduction.increase.has_value();
  j["factor_of_safety"] = increases_load ? ordered_json(nullptr) : optional_json(safety.bracket.stable);
  j["load_multiplier"] = increases_load ? optional_json(safety.bracket.stable) : ordered_json(nullptr);
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
    if (t.outcome == TrialOutcome::stable)
      curve.push_back({{column_of_answer(scene.strength_reduction.increase), t.srf}, {"displacement_m", t.displacement}});
  }
  j["displacement_curve"] = curve;
  j["small_displacement_factorisations"] = safety.linear_solves;
}

void add_question(const Summary& summary, const Simulation& simulation, const FactorOfSafety* safety, nlohmann::ordered_json& j) {
  using nlohmann::ordered_json;
  const Scene& scene = simulation.scene();
  j["version"] = version;
  j["command"] = summary.command;
  j["scene"] = summary.scene_file;
  j["title"] = scene.title;
  j["overrides"] = summary.overrides;
  j["options"] = options_json(simulation);
  add_points(scene, safety ? with_increased_load(scene, safety->stable()) : scene, j);
  if (const std::string words = gravity_in_words(scene.gravity); !words.empty()) j["gravity_in_words"] = words;
  j["materials"] = j["joints"] = ordered_json::array();
  for (const Material& material : scene.materials) j["materials"].push_back(material.name);
  for (const int joint : joints_of_edges(scene)) j["joints"].push_back(scene.joints[joint].name);
  j["warnings"] = summary.warnings;
  j["blocks"] = simulation.system().block_count();
  j["free_blocks"] = simulation.system().free_count() + static_cast<int>(simulation.system().resting_blocks().size());
  j["converged"] = summary.converged;
  j["reason"] = summary.reason;
}

void add_motion(const Summary& summary, nlohmann::ordered_json& j) {
  nlohmann::ordered_json ledger;
  for (const auto& [name, value] : ledger_entries(summary.ledger)) ledger[name] = value;
  j["energy_ledger"] = ledger;
  j["integrator_loss"] = summary.ledger.integrator_loss();
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

nlohmann::ordered_json memory_json(const Memory& memory) {
  const std::size_t program = static_cast<std::size_t>(memory_of_program());
  return {{"program", program},
          {"blocks", memory.blocks},
          {"contacts", memory.contacts},
          {"matrix", memory.matrix},
          {"factor", memory.factor},
          {"krylov", memory.krylov},
          {"without_factor", program + memory.without_factor()}};
}

nlohmann::ordered_json counters_json(const Simulation& simulation) {
  const StepCounters& steps = simulation.state().counters;
  const DetectionCounters& detection = simulation.state().detector.counters();
  const LinearCounters& linear = simulation.enforcement().linear_counters();
  return {{"steps", steps.steps},
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
}

}  // namespace

void write_summary(const OutputFolder& folder, const Summary& summary, const Simulation& simulation, const FactorOfSafety* safety) {
  const Scene& scene = simulation.scene();
  nlohmann::ordered_json j;
  add_question(summary, simulation, safety, j);
  j["state_hash"] = safety ? state_hash(*safety, scene) : state_hash(simulation);
  if (!safety) j["time_s"] = simulation.time();
  if (summary.settling.steps > 0) j["settling"] = settling_json(summary.settling);
  if (safety) {
    add_factor(*safety, scene, j);
    j["cpu_s"] = {{"search", summary.cpu_of_search}};
  } else {
    add_motion(summary, j);
  }
  j["wall_s"] = wall_time();
  j["max_penetration_m"] = summary.max_penetration;
  j["peak_memory_bytes"] = peak_memory();
  j["memory_bytes"] = memory_json(simulation.state().memory);
  j["counters"] = counters_json(simulation);
  j["work_shared"] = {{"factorisations", times_shared(SharedWork::factorisation)},
                      {"substitutions", times_shared(SharedWork::substitution)},
                      {"products", times_shared(SharedWork::product)}};
  const StepCounters& steps = simulation.state().counters;
  if (simulation.is_explicit()) {
    j["explicit"] = {{"critical_step_s", steps.smallest_critical_step},
                     {"longest_step_s", steps.longest_step},
                     {"state_loads", steps.loads},
                     {"state_loads_skipped", steps.loads_skipped}};
  }
  j["table_bytes"] = folder.table_sizes();
  const StageTimes& stages = simulation.state().stage_times;
  j["stage_s"] = {{"detection", stages.detection}, {"solution", stages.solution}, {"bookkeeping", stages.bookkeeping}};
  std::ofstream file = folder.open("summary.json");
  // The name of a file may be no text: what is none of it is replaced.
  file << j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  finish(file, folder.path_of("summary.json"));
}

}  // namespace openclose
