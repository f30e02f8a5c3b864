#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "io/files.h"
#include "openclose/core/process.h"
#include "openclose/io/results.h"
#include "openclose/io/summary.h"
#include "openclose/scene/keys.h"
#include "openclose/version.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::fields_of;
using openclose::test::lines_of;
using openclose::test::TemporaryFolder;

namespace {

/// Numbers that fewer digits would change.
const std::vector<double> awkward = {0.1,
                                     1.0 / 3.0,
                                     -2.0 / 3.0 * 1e-300,
                                     1.0 + std::numeric_limits<double>::epsilon(),
                                     std::numeric_limits<double>::denorm_min(),
                                     std::numeric_limits<double>::max(),
                                     -0.0};

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

double number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  REQUIRE(*end == '\0');
  return value;
}

PointMotion motion(const std::string& name) {
  PointMotion m;
  m.name = name;
  return m;
}

nlohmann::json summary_json(const TemporaryFolder& place) {
  return nlohmann::json::parse(test::text_of(place / "summary.json"));
}

}  // namespace

TEST_CASE("history.csv", "[io][results]") {
  const TemporaryFolder place;
  {
    HistoryFile file(OutputFolder(place.path()));
    for (double x : awkward) {
      PointMotion m = motion("p");
      m.displacement = {x, -x};
      m.rotation = x;
      m.velocity = {-x, x};
      m.angular_velocity = -x;
      file.add(x, {m, motion("q")});
    }
    file.close();
  }
  const auto lines = lines_of(place / "history.csv");
  REQUIRE(lines.size() == 1 + 2 * awkward.size());
  CHECK(lines[0] == "time_s,point,displacement_x_m,displacement_y_m,rotation_rad,velocity_x_m_per_s,velocity_y_m_per_s,angular_velocity_rad_per_s");
  for (std::size_t i = 0; i < awkward.size(); ++i) {
    const double x = awkward[i];
    const auto fields = fields_of(lines[1 + 2 * i]);
    REQUIRE(fields.size() == 8);
    CHECK(fields[1] == "p");
    const double expected[] = {x, 0.0, x, -x, x, -x, x, -x};
    for (int k : {0, 2, 3, 4, 5, 6, 7}) CHECK(same_bits(number(fields[k]), expected[k]));
    CHECK(fields_of(lines[2 + 2 * i])[1] == "q");
  }
}

TEST_CASE("names that would break a row are quoted", "[io][results]") {
  const TemporaryFolder place;
  HistoryFile file(OutputFolder(place.path()));
  file.add(0.0, {motion("plain name"), motion("a,b"), motion("say \"x\""), motion("two\nlines")});
  file.close();
  const std::string text = test::text_of(place / "history.csv");
  const std::string zeros = ",0,0,0,0,0,0\n";
  const std::string header = lines_of(place / "history.csv")[0] + "\n";
  CHECK(text == header + "0,plain name" + zeros + "0,\"a,b\"" + zeros + "0,\"say \"\"x\"\"\"" + zeros + "0,\"two\nlines\"" + zeros);
}

TEST_CASE("energy.csv ends with the imbalance", "[io][results]") {
  const TemporaryFolder place;
  EnergyLedger l;
  l.kinetic = 1.0 / 3.0;
  l.gravity = -2.0 / 3.0;
  l.base_motion = -0.15;
  l.contact_springs = 0.1;
  l.support_springs = 0.2;
  l.loads = -0.3;
  l.friction = 0.7;
  l.contact_damping = 0.4;
  l.mass_damping = 0.45;
  l.impact = 1e-17;
  l.scheme = 1e-3;
  l.redefinition = -1e-5;
  l.turnover = 12.0;
  EnergyFile file(OutputFolder(place.path()));
  file.add(0.25, l);
  file.close();
  const auto lines = lines_of(place / "energy.csv");
  REQUIRE(lines.size() == 2);
  CHECK(lines[0] ==
        "time_s,kinetic_j,gravity_j,base_motion_j,contact_springs_j,support_springs_j,loads_j,friction_j,contact_damping_j,mass_damping_j,impact_j,"
        "scheme_j,"
        "redefinition_j,turnover_j,imbalance_j");
  const double expected[] = {0.25,           l.kinetic,  l.gravity,         l.base_motion,  l.contact_springs, l.support_springs,
                             l.loads,        l.friction, l.contact_damping, l.mass_damping, l.impact,          l.scheme,
                             l.redefinition, l.turnover, l.imbalance()};
  const auto fields = fields_of(lines[1]);
  REQUIRE(fields.size() == std::size(expected));
  for (std::size_t i = 0; i < fields.size(); ++i) CHECK(same_bits(number(fields[i]), expected[i]));
}

TEST_CASE("blocks.csv holds the polygons of each state in scene coordinates", "[io][results]") {
  const TemporaryFolder place;
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("base, left", test::rectangle(95.0, 49.0, 10.0, 1.0)),
                  test::free_block("block", test::rectangle(100.0, 50.0, 2.0, 1.0))};
  Simulation simulation(scene);
  BlocksFile file(OutputFolder(place.path()));
  file.add("initial", simulation);
  // A quarter turn about the centroid (101, 50.5), and 3 m up.
  simulation.change_system().advance(1, {0.0, 3.0, 90.0 * test::degree});
  file.add("final", simulation);
  file.close();
  const auto lines = lines_of(place / "blocks.csv");
  REQUIRE(lines.size() == 1 + 2 * 8);
  CHECK(lines[0] == "state,block,vertex,x_m,y_m");
  CHECK(lines[1] == "initial,\"base, left\",0,95,49");
  CHECK(lines[7] == "initial,block,2,102,51");
  const auto fields = fields_of(lines[13]);
  REQUIRE(fields.size() == 5);
  CHECK(fields[0] == "final");
  CHECK(fields[1] == "block");
  CHECK(fields[2] == "0");
  CHECK(number(fields[3]) == Approx(101.5).epsilon(1e-14));
  CHECK(number(fields[4]) == Approx(52.5).epsilon(1e-14));
}

TEST_CASE("contacts.csv tells what every contact carries", "[io][results]") {
  const TemporaryFolder place;
  Simulation simulation(test::block_on_base());
  REQUIRE(settle(simulation).settled);
  ContactsFile file(OutputFolder(place.path()));
  file.add("final", simulation.scene(), simulation.system(), simulation.change_contacts());
  file.close();
  const auto lines = lines_of(place / "contacts.csv");
  REQUIRE(lines.size() == 3);
  CHECK(lines[0] == "state,block_a,block_b,x_m,y_m,normal_x,normal_y,length_m,gap_m,normal_force_n,shear_force_n,status");
  std::set<double> places;
  for (int i : {1, 2}) {
    const auto fields = fields_of(lines[i]);
    REQUIRE(fields.size() == 12);
    CHECK(fields[0] == "final");
    CHECK(fields[1] == "block");
    CHECK(fields[2] == "base");
    places.insert(number(fields[3]));
    CHECK(number(fields[4]) == Approx(-test::block_weight / 2e9).epsilon(1e-7));
    CHECK(number(fields[5]) == 0.0);
    CHECK(number(fields[6]) == 1.0);
    CHECK(number(fields[7]) == Approx(1.0).epsilon(1e-14));
    CHECK(number(fields[8]) == Approx(-test::block_weight / 2e9).epsilon(1e-7));
    CHECK(number(fields[9]) == Approx(0.5 * test::block_weight).epsilon(1e-7));
    CHECK(std::abs(number(fields[10])) < 1e-7 * test::block_weight);
    CHECK(fields[11] == "sticking");
  }
  REQUIRE(places.size() == 2);
  CHECK(*places.begin() == Approx(0.0).margin(1e-12));
  CHECK(*places.rbegin() == Approx(2.0).epsilon(1e-12));
}

TEST_CASE("trials.csv and curve.csv", "[io][results]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  const auto trial = [](TrialOutcome outcome, const char* criterion, int steps, double displacement, double srf, const char* stage) {
    StrengthTrial t;
    t.outcome = outcome, t.criterion = criterion, t.steps = steps, t.displacement = displacement, t.srf = srf, t.stage = stage;
    return t;
  };
  write_trials(folder, {trial(TrialOutcome::stable, "unbalanced force", 3, 0.0, 1.0, "bracket"),
                        trial(TrialOutcome::failed, "displacement", 17, 0.1, 1.0 / 3.0, "bisect"),
                        trial(TrialOutcome::undecided, "steps", 200, 0.0, 1.5, "bisect")});
  write_curve(folder, {{1.1, "crest, left", 1.0 / 3.0}});
  CHECK(test::text_of(place / "trials.csv") ==
        "srf,stage,stable,criterion,steps,displacement_m\n"
        "1,bracket,1,unbalanced force,3,0\n"
        "0.33333333333333331,bisect,0,displacement,17,0.10000000000000001\n"
        "1.5,bisect,undecided,steps,200,0\n");
  CHECK(test::text_of(place / "curve.csv") ==
        "srf,point,displacement_m\n"
        "1.1000000000000001,\"crest, left\",0.33333333333333331\n");
}

TEST_CASE("milestones: the missing ones have a reason in place of times", "[io][results]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  const std::vector<Milestone> milestones = {{10.0, 1.0 / 3.0, 0.5, 0.75, ""}, {40.0, std::nullopt, 0.0, 0.0, "stopped, early"}};
  write_milestones(folder, milestones);
  CHECK(test::text_of(place / "milestones.csv") ==
        "displacement_m,time_s,cpu_s,cpu_of_program_s,reason\n"
        "10,0.33333333333333331,0.5,0.75,\n"
        "40,,,,\"stopped, early\"\n");

  Simulation simulation(test::block_on_base());
  Summary summary;
  summary.milestones = milestones;
  summary.ended_by = "end.displacement_m";
  summary.cpu_of_start = 0.25;
  summary.cpu_of_motion = 0.6;
  write_summary(folder, summary, simulation);
  const nlohmann::json j = summary_json(place);
  REQUIRE(j.at("milestones").size() == 2);
  const nlohmann::json &reached = j.at("milestones")[0], &missing = j.at("milestones")[1];
  CHECK(reached.at("displacement_m") == 10.0);
  CHECK(same_bits(reached.at("time_s").get<double>(), 1.0 / 3.0));
  CHECK(reached.at("cpu_s") == 0.5);
  CHECK(reached.at("cpu_of_program_s") == 0.75);
  CHECK(missing.at("displacement_m") == 40.0);
  for (const char* key : {"time_s", "cpu_s", "cpu_of_program_s"}) CHECK(missing.at(key).is_null());
  CHECK(missing.at("reason") == "stopped, early");
  CHECK(j.at("ended_by") == "end.displacement_m");
  CHECK(j.at("cpu_s").at("start") == 0.25);
  CHECK(j.at("cpu_s").at("motion") == 0.6);
  CHECK(j.at("options").at("end").at("displacement_m").is_null());
}

TEST_CASE("summary.json of a start by the paper's criterion", "[io][results]") {
  const TemporaryFolder place;
  Scene scene = test::block_on_base();
  scene.settle.criterion = SettleCriterion::paper;
  scene.end_displacement = 2.0;
  scene.run_strength_reduction_factor = 1.5;
  scene.checkpoint_every = 0.25;
  scene.milestones = {1.0, 2.5};
  scene.snapshot_times = {0.5};
  scene.strength_reduction.curve = {1.1};
  scene.strength_reduction.curve_time = 3.0;
  Simulation simulation(scene);
  Summary summary;
  summary.settling.steps = 7;
  summary.settling.criterion = "steps";
  summary.settling.relative_displacement = 1e-3;
  write_summary(OutputFolder(place.path()), summary, simulation);
  const nlohmann::json j = summary_json(place);
  CHECK(j.at("settling").at("relative_displacement") == 1e-3);
  CHECK_FALSE(j.at("settling").contains("unbalanced_fraction"));
  CHECK(j.at("options").at("settle").at("criterion") == "paper");
  CHECK(j.at("options").at("settle").at("relative_displacement") == 1e-5);
  CHECK(j.at("options").at("settle").at("unbalanced_force_n") == 1e3);
  CHECK(j.at("options").at("settle").at("keep_bonds") == true);
  CHECK(j.at("options").at("end").at("displacement_m") == 2.0);
  CHECK(j.at("options").at("run").at("strength_reduction_factor") == 1.5);
  CHECK(j.at("options").at("output").at("checkpoint_every_s") == 0.25);
  CHECK(j.at("options").at("output").at("milestones_m") == scene.milestones);
  CHECK(j.at("options").at("output").at("snapshots_s") == scene.snapshot_times);
  CHECK(j.at("options").at("strength_reduction").at("curve") == scene.strength_reduction.curve);
  CHECK(j.at("options").at("strength_reduction").at("curve_time_s") == 3.0);
}

TEST_CASE("summary.json has every key as it was used", "[io][results][keys]") {
  const TemporaryFolder place;
  Scene scene = test::block_on_base();
  scene.method.contact = "shi";
  scene.method.penalty = 3e9;
  scene.method.closing_tolerance = 1e-7;
  scene.step.smallest_fraction = 0.25;
  const Simulation simulation(scene);
  write_summary(OutputFolder(place.path()), Summary{}, simulation);
  const nlohmann::json options = summary_json(place).at("options");
  for (const KeyEntry& entry : key_entries(scene)) {
    INFO(entry.dotted());
    const nlohmann::json& value = options.at(std::string(entry.table.name)).at(std::string(entry.key.name));
    if (entry.value) CHECK(value == nlohmann::json::parse(*entry.value));
    if (!entry.value && entry.key.name != "contact_skin_m" && entry.key.name != "max_displacement_m") CHECK(value.is_null());
  }
  CHECK(options.at("method").at("penalty_pa_per_m") == 3e9);
  CHECK(options.at("method").at("integrator").is_null());
  CHECK(options.at("solver").at("closing_tolerance_m") == 1e-7);
  CHECK(options.at("solver").at("smallest_fraction") == 0.25);
  CHECK(options.at("solver").at("gap_tolerance_m") == scene.method.gap_tolerance);
  CHECK(options.at("solver").at("contact_skin_m") == simulation.state().lengths.contact_skin);
  CHECK(options.at("step").at("max_displacement_m") == simulation.state().lengths.longest_displacement);
}

TEST_CASE("summary.json of a run", "[io][results]") {
  const TemporaryFolder place;
  Scene scene = test::block_on_base();
  scene.title = "A \"quoted\" title";
  scene.method.start = Start::settled;
  scene.end_time = 0.01;
  Simulation simulation(scene);
  const RunResult result = run(simulation, {});
  Summary summary;
  summary.command = "run";
  summary.scene_file = "scenes/a.toml";
  summary.overrides = {"method.theta=1"};
  summary.warnings = {"one"};
  summary.converged = result.converged;
  summary.settling = result.settling;
  summary.ledger.friction = 1.0 / 3.0;
  summary.max_penetration = 0.1;
  write_summary(OutputFolder(place.path()), summary, simulation);

  const nlohmann::json j = summary_json(place);
  CHECK(j.at("version") == version);
  CHECK(j.at("command") == "run");
  CHECK(j.at("scene") == "scenes/a.toml");
  CHECK(j.at("title") == "A \"quoted\" title");
  CHECK(j.at("overrides") == std::vector<std::string>{"method.theta=1"});
  CHECK(j.at("warnings") == std::vector<std::string>{"one"});
  CHECK(j.at("options").at("method").at("contact") == "soft");
  CHECK(j.at("options").at("method").at("start") == "settled");
  CHECK(j.at("options").at("method").at("integrator") == "shi");
  CHECK(j.at("options").at("method").at("theta").is_null());
  CHECK(j.at("options").at("step").at("dt_s") == 1e-3);
  CHECK(j.at("blocks") == 2);
  CHECK(j.at("free_blocks") == 1);
  CHECK(j.at("converged") == true);
  CHECK(j.at("reason") == "");
  CHECK(same_bits(j.at("time_s").get<double>(), 10 * 1e-3));
  CHECK(same_bits(j.at("max_penetration_m").get<double>(), 0.1));
  CHECK(j.at("counters").at("steps") == simulation.state().counters.steps);
  CHECK(j.at("counters").at("steps").get<long>() >= 11);
  CHECK(j.at("counters").at("iterations") == simulation.state().counters.iterations);
  CHECK(j.at("counters").at("searches") == simulation.state().detector.counters().searches);
  const nlohmann::json& memory = j.at("memory_bytes");
  CHECK(memory.at("program") == memory_of_program());
  CHECK(memory.at("program").get<long>() < j.at("peak_memory_bytes").get<long>());
  CHECK(memory.at("contacts") == simulation.state().memory.contacts);
  CHECK(memory.at("factor") == simulation.state().memory.factor);
  CHECK(memory.at("krylov") == 0);
  long sum = 0;
  for (const char* part : {"program", "blocks", "contacts", "matrix"}) {
    CHECK(memory.at(part).get<long>() > 0);
    sum += memory.at(part).get<long>();
  }
  CHECK(memory.at("without_factor") == sum);
  for (const char* stage : {"detection", "solution", "bookkeeping"}) CHECK(j.at("stage_s").at(stage).get<double>() > 0.0);
  CHECK(same_bits(j.at("energy_ledger").at("friction_j").get<double>(), 1.0 / 3.0));
  CHECK(j.at("energy_ledger").at("imbalance_j") == 1.0 / 3.0);
  CHECK(j.at("energy_ledger").size() == 14);
  CHECK(j.at("integrator_loss") == summary.ledger.integrator_loss());
  CHECK(j.at("settling").at("settled") == true);
  CHECK(j.at("settling").at("criterion") == "unbalanced force");
  CHECK_FALSE(j.contains("factor_of_safety"));
}

TEST_CASE("summary.json has counters under their own names", "[io][results]") {
  const TemporaryFolder place;
  Scene scene = test::tumbling_blocks();
  scene.method.contact = "soft";
  scene.step.dt = 1e-2;
  scene.step.max_displacement = 0.02;  // some steps are cut
  Simulation simulation(scene);
  for (int i = 0; i < 100; ++i) REQUIRE(simulation.advance(scene.step.dt));
  write_summary(OutputFolder(place.path()), Summary(), simulation);
  const StepCounters& steps = simulation.state().counters;
  const DetectionCounters& detection = simulation.state().detector.counters();
  const LinearCounters& linear = simulation.enforcement().linear_counters();
  const std::map<std::string, long> expected = {{"steps", steps.steps},
                                                {"steps_cut", steps.cuts},
                                                {"error_cuts", steps.error_cuts},
                                                {"eased_steps", steps.eased},
                                                {"dissipative_steps", steps.dissipative},
                                                {"still_steps", steps.still},
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
                                                {"factorisations", linear.factorisations},
                                                {"rows", linear.rows},
                                                {"rows_kept", linear.rows_kept},
                                                {"refinements", linear.refinements},
                                                {"couplings_taken_in", linear.couplings_taken_in},
                                                {"pivots_lost", linear.pivots_lost},
                                                {"symbolic", linear.symbolic},
                                                {"symbolic_skipped", linear.symbolic_skipped}};
  const nlohmann::json counters = summary_json(place).at("counters");
  for (const auto& [name, value] : expected) {
    INFO(name);
    CHECK(counters.at(name) == value);
  }
  // Counters that are 0 could be any of those.
  for (const char* name :
       {"steps", "steps_cut", "iterations", "searches", "searches_skipped", "narrow_phases", "narrow_phases_skipped", "rows", "rows_kept"}) {
    INFO(name);
    CHECK(expected.at(name) > 0);
  }
}

TEST_CASE("summary.json of a factor of safety", "[io][results]") {
  const TemporaryFolder place;
  Simulation simulation(test::block_on_base());
  FactorOfSafety safety;
  Scene scene = test::block_on_base();
  Summary summary;
  summary.command = "fos";
  summary.reason = "why";
  SECTION("found") {
    safety.bracket.stable = 1.25;
    safety.bracket.failed = 1.5;
    safety.bracket.failed_by = "mechanism";
    safety.verdict = FactorVerdict::certified;
    safety.mechanism = {{1, 2.5, Vec2(0.5, 0.5), Vec2(1.0, 0.0), 0.0}};
    safety.trials.resize(1);
    safety.trials[0].outcome = TrialOutcome::stable;
    safety.trials[0].srf = 1.25;
    summary.converged = true;
    write_summary(OutputFolder(place.path()), summary, simulation, &safety);
    const nlohmann::json j = summary_json(place);
    CHECK(j.at("factor_of_safety") == 1.25);
    CHECK(j.at("load_multiplier").is_null());
    CHECK(j.at("verdict") == "certified");
    CHECK(j.at("definition") == "small_displacements");
    CHECK(j.at("bracket").at("stable") == 1.25);
    CHECK(j.at("bracket").at("failed") == 1.5);
    CHECK(j.at("bracket").at("failed_by") == "mechanism");
    CHECK(j.at("limit_analysis").is_null());
    CHECK(j.at("failing_blocks").at("number") == 1);
    CHECK(j.at("failing_blocks").at("area_m2") == 2.5);
    CHECK(j.at("failing_blocks").at("names").at(0) == scene.blocks[1].name);
    CHECK(j.at("displacement_curve").at(0).at("srf") == 1.25);
    CHECK(j.at("converged") == true);
  }
  SECTION("multiplier of a load: the arrows are those of the stable end") {
    scene.loads = {{1, {1.0, 0.5}, {2.0, 0.0}, "push"}, {1, {1.0, 0.5}, {0.0, -3.0}}};
    scene.strength_reduction.increase = "-push";
    Simulation pushed(scene);
    safety.bracket.stable = 0.5;
    safety.trials.resize(1);
    safety.trials[0].outcome = TrialOutcome::stable;
    safety.trials[0].srf = 0.5;
    write_summary(OutputFolder(place.path()), summary, pushed, &safety);
    const nlohmann::json j = summary_json(place);
    CHECK(j.at("factor_of_safety").is_null());
    CHECK(j.at("load_multiplier") == 0.5);
    CHECK(j.at("displacement_curve").at(0).at("multiplier") == 0.5);
    CHECK(j.at("options").at("strength_reduction").at("increase") == "-push");
    CHECK(j.at("loads").at(0).at("name") == "push");
    CHECK(j.at("loads").at(0).at("force_n").at(0) == 2.0);
    CHECK_FALSE(j.at("loads").at(1).contains("name"));
    CHECK(j.at("arrows").at(0).at("force_n").at(0) == -1.0);
    CHECK(j.at("arrows").at(1).at("force_n").at(1) == -3.0);
  }
  SECTION("not found") {
    write_summary(OutputFolder(place.path()), summary, simulation, &safety);
    const nlohmann::json j = summary_json(place);
    CHECK(j.at("factor_of_safety").is_null());
    CHECK(j.at("verdict") == "undecided");
    CHECK(j.at("bracket").at("stable").is_null());
    CHECK(j.at("bracket").at("failed_by").is_null());
    CHECK(j.at("converged") == false);
    CHECK(j.at("reason") == "why");
  }
}
