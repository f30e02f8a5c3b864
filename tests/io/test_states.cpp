// The tables of states: what is in them agrees with statics, from file to file.
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/files.h"
#include "openclose/io/results.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::fields_of;
using openclose::test::lines_of;
using openclose::test::TemporaryFolder;

namespace {

/// Rows by column name.
std::vector<std::map<std::string, std::string>> rows_of(const std::string& path) {
  const auto lines = lines_of(path);
  const auto columns = fields_of(lines.at(0));
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = fields_of(lines[i]);
    std::map<std::string, std::string> row;
    for (std::size_t k = 0; k < columns.size(); ++k) row[columns[k]] = k < fields.size() ? fields[k] : "";
    rows.push_back(row);
  }
  return rows;
}

double number(const std::map<std::string, std::string>& row, const std::string& column) {
  return std::stod(row.at(column));
}

/// Runs it, and writes the states into the folder.
void run_into(const TemporaryFolder& place, const Scene& scene) {
  Simulation simulation(scene);
  const OutputFolder folder(place.path());
  StateTables states(folder, scene);
  states.add_drawing(simulation.scene(), simulation.system());
  RunObserver observer;
  observer.started = [&](const Simulation& s) { states.add("start", s); };
  observer.snapshot = [&](const std::string& state, const Simulation& s) { states.add(state, s); };
  REQUIRE(run(simulation, observer).converged);
  states.add("final", simulation);
  states.close();
}

}  // namespace

TEST_CASE("the contact forces of every state of a column at rest carry what lies above", "[io][states]") {
  for (const std::string& method : test::all_methods) {
    for (const bool skips : {false, true}) {
      INFO(method << (skips ? ", blocks at rest" : ""));
      const TemporaryFolder place;
      Scene scene = test::column_of_blocks(3);
      scene.method.contact = method;
      scene.method.skip_resting = skips;
      scene.method.start = Start::settled;
      scene.end_time = 0.5;
      scene.snapshots_every = 0.2;
      scene.snapshot_times = {0.2, 0.3};
      run_into(place, scene);
      std::map<std::string, std::map<std::string, Vec2>> carried;  // by state and block: force on it
      std::vector<std::string> states;
      for (const auto& row : rows_of(place / "contacts.csv")) {
        const Vec2 n(number(row, "normal_x"), number(row, "normal_y"));
        const Vec2 force = number(row, "normal_force_n") * n + number(row, "shear_force_n") * perpendicular(n);
        const std::string state = row.at("state");
        if (states.empty() || states.back() != state) states.push_back(state);
        const auto add = [&](const std::string& block, const Vec2& f) {
          const auto known = carried[state].try_emplace(block, Vec2::Zero());
          known.first->second += f;
        };
        add(row.at("block_a"), force);
        add(row.at("block_b"), -force);
      }
      CHECK(states == std::vector<std::string>{"start", "t=0.2", "t=0.3", "t=0.4", "final"});
      for (const auto& [state, forces] : carried) {
        INFO(state);
        REQUIRE(forces.size() == 4);
        // Each block has its own weight from below less what it passes on; the base has all three. Blocks that hardly move have hardly any inertia.
        for (const auto& [block, force] : forces) {
          const double expected = block == "base" ? -3.0 * test::block_weight : test::block_weight;
          CHECK(force.y() == Approx(expected).epsilon(1e-5));
          CHECK(std::abs(force.x()) < 1e-5 * test::block_weight);
        }
      }
    }
  }
}

TEST_CASE("block_states.csv has where a thrown block is, and how fast", "[io][states]") {
  const TemporaryFolder place;
  Scene scene = test::falling_block();
  scene.blocks[0].velocity = {3.0, 4.0};
  scene.blocks[0].angular_velocity = -0.5;
  scene.end_time = 1.0;
  scene.snapshots_every = 0.5;
  scene.method.integrator = "theta";
  scene.method.theta = 0.5;
  run_into(place, scene);
  const auto rows = rows_of(place / "block_states.csv");
  REQUIRE(rows.size() == 4);
  for (const auto& row : rows) {
    const double t = number(row, "time_s");
    CHECK(number(row, "displacement_x_m") == Approx(3.0 * t).margin(1e-9));
    CHECK(number(row, "displacement_y_m") == Approx(4.0 * t - 0.5 * 9.81 * t * t).margin(1e-9));
    CHECK(number(row, "x_m") == Approx(1.0 + 3.0 * t).margin(1e-9));
    CHECK(number(row, "rotation_rad") == Approx(-0.5 * t).margin(1e-9));
    CHECK(number(row, "velocity_x_m_per_s") == Approx(3.0).epsilon(1e-9));
    CHECK(number(row, "velocity_y_m_per_s") == Approx(4.0 - 9.81 * t).epsilon(1e-9));
    CHECK(number(row, "angular_velocity_rad_per_s") == Approx(-0.5).epsilon(1e-9));
  }
  CHECK(number(rows[1], "time_s") == Approx(0.5).epsilon(1e-12));
  CHECK(rows[1].at("state") == "t=0.5");
}

TEST_CASE("cracks.csv has the opening of a block that was thrown off its base, beyond the reach of contacts", "[io][states]") {
  const TemporaryFolder place;
  Scene scene = test::block_on_base();
  scene.gravity = Vec2::Zero();
  scene.blocks[1].velocity = {2.0, 5.0};
  scene.end_time = 1.0;
  run_into(place, scene);
  for (const auto& row : rows_of(place / "contacts.csv")) CHECK(row.at("state") != "final");
  const auto rows = rows_of(place / "cracks.csv");
  REQUIRE(rows.size() == 2);
  const auto& last = rows.back();
  CHECK(last.at("state") == "final");
  CHECK(last.at("block_a") == "base");
  CHECK(last.at("block_b") == "block");
  CHECK(number(last, "length_m") == Approx(2.0).epsilon(1e-12));
  for (const std::string end : {"1", "2"}) {
    CHECK(number(last, "opening" + end + "_m") == Approx(5.0).epsilon(1e-9));
    // The base moves to the left, as the block sees it, whose edge runs to the right.
    CHECK(number(last, "slip" + end + "_m") == Approx(-2.0).epsilon(1e-9));
    CHECK(number(last, "y" + end + "_m") == Approx(2.5).epsilon(1e-9));
  }
}

TEST_CASE("the stable state of a factor of safety has forces that balance the weight", "[io][states]") {
  const TemporaryFolder place;
  Scene scene = test::block_on_incline(0.3);
  Simulation simulation(scene);
  const FactorOfSafety safety = factor_of_safety(simulation);
  StateTables states(OutputFolder(place.path()), scene);
  for (const NamedState& state : safety.states) states.add(state, scene);
  states.close();
  Vec2 total = Vec2::Zero();
  for (const auto& row : rows_of(place / "contacts.csv")) {
    CHECK(row.at("state") == "stable");
    const Vec2 n(number(row, "normal_x"), number(row, "normal_y"));
    const double sign = row.at("block_a") == "block" ? 1.0 : -1.0;
    total += sign * (number(row, "normal_force_n") * n + number(row, "shear_force_n") * perpendicular(n));
  }
  CHECK(total.y() == Approx(test::block_weight).epsilon(1e-7));
  CHECK(std::abs(total.x()) < 1e-7 * test::block_weight);
  std::set<std::string> names;
  for (const auto& row : rows_of(place / "block_states.csv")) {
    names.insert(row.at("state"));
    CHECK(row.at("time_s").empty());
  }
  CHECK(names == std::set<std::string>{"stable", "failed"});
}

TEST_CASE("block_properties.csv", "[io][states]") {
  const TemporaryFolder place;
  const Scene scene = test::block_on_base();
  const BlockSystem system(scene);
  write_block_properties(OutputFolder(place.path()), scene, system);
  const auto lines = lines_of(place / "block_properties.csv");
  CHECK(lines == std::vector<std::string>{"block,material,fixed,area_m2,mass_kg", "base,rock,1,20,50000", "block,rock,0,2,5000"});
}
