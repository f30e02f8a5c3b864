// The page of results: what it holds is what the tables hold, and nothing in a scene can break out of it.
#include <bit>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/files.h"
#include "openclose/core/error.h"
#include "openclose/core/vector.h"
#include "openclose/io/results.h"
#include "openclose/io/summary.h"
#include "openclose/report/report.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using nlohmann::json;
using openclose::test::fields_of;
using openclose::test::lines_of;
using openclose::test::TemporaryFolder;

namespace {

/// A run with snapshots, its tables and its summary.
void run_into(const TemporaryFolder& place, Scene scene) {
  scene.step.dt = 1e-3;
  scene.end_time = 0.4;
  scene.snapshots_every = 0.1;
  Simulation simulation(scene);
  const OutputFolder folder(place.path());
  StateTables states(folder, scene);
  write_block_properties(folder, scene, simulation.system());
  states.add_drawing(simulation.scene(), simulation.system());
  EnergyFile energy(folder);
  RunObserver observer;
  observer.started = [&](const Simulation& s) { states.add("start", s); };
  observer.snapshot = [&](const std::string& state, const Simulation& s) { states.add(state, s); };
  observer.output = [&](const Simulation& s) { energy.add(s.time(), s.ledger()); };
  const RunResult result = run(simulation, observer);
  states.add("final", simulation);
  states.close();
  energy.close();
  Summary summary;
  summary.command = "run";
  summary.converged = result.converged;
  write_summary(folder, summary, simulation);
}

json data_of(const std::string& html) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">", end = "</script>";
  const std::size_t from = html.find(begin) + begin.size();
  return json::parse(html.substr(from, html.find(end, from) - from));
}

template <typename Number>
std::vector<Number> numbers_in(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = (bits << 6) | static_cast<unsigned>(digits.find(c));
    if ((count += 6) >= 8) bytes += static_cast<char>((bits >> (count -= 8)) & 255u);
  }
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

std::vector<std::vector<std::string>> rows_of(const std::string& path, const std::string& state) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& line : lines_of(path)) {
    if (fields_of(line)[0] == state) rows.push_back(fields_of(line));
  }
  return rows;
}

bool nearly(float shown, const std::string& field) {
  return shown == static_cast<float>(std::stod(field));
}

Scene sliding_block() {
  return test::block_on_incline(40.0 * test::degree);
}

}  // namespace

TEST_CASE("the page holds the motions, velocities and contacts of every state as the tables have them", "[report]") {
  const TemporaryFolder place;
  run_into(place, sliding_block());
  const Report report = report_of_results(place.path());
  const json data = data_of(report.html);
  const json& states = data.at("states");
  REQUIRE(states.size() == report.states);
  REQUIRE(states.size() >= 6);
  CHECK(report.left_out == 0);
  CHECK(states.front().at("name") == "initial");
  const Vec2 origin(data.at("origin").at(0).get<double>(), data.at("origin").at(1).get<double>());
  std::size_t contacts = 0;
  for (const json& state : states) {
    const std::string name = state.at("name");
    INFO(name);
    if (name == "initial") continue;
    const auto rows = rows_of(place / "block_states.csv", name);
    const auto motion = numbers_in<float>(state.at("motion_f4")), velocity = numbers_in<float>(state.at("velocity_f4"));
    REQUIRE(motion.size() == 3 * rows.size());
    for (std::size_t b = 0; b < rows.size(); ++b) {
      CHECK(data.at("blocks").at("names").at(b) == rows[b][2]);
      for (std::size_t k = 0; k < 3; ++k) {
        CHECK(nearly(motion[3 * b + k], rows[b][5 + k]));
        CHECK(nearly(velocity[3 * b + k], rows[b][8 + k]));
      }
    }
    const auto touching = rows_of(place / "contacts.csv", name);
    const auto numbers = numbers_in<float>(state.at("contacts").at("numbers_f4"));
    const auto status = numbers_in<std::uint8_t>(state.at("contacts").at("status_u1"));
    REQUIRE(numbers.size() == 9 * touching.size());
    for (std::size_t i = 0; i < touching.size(); ++i) {
      CHECK(numbers[9 * i] == static_cast<float>(std::stod(touching[i][3]) - origin.x()));
      CHECK(numbers[9 * i + 1] == static_cast<float>(std::stod(touching[i][4]) - origin.y()));
      CHECK(nearly(numbers[9 * i + 5], touching[i][8]));
      CHECK(nearly(numbers[9 * i + 6], touching[i][9]));
      CHECK(nearly(numbers[9 * i + 7], touching[i][10]));
      CHECK(std::vector<std::string>{"open", "sticking", "sliding"}.at(status[i]) == touching[i][11]);
      ++contacts;
    }
  }
  CHECK(contacts >= 10);
}

TEST_CASE("the two contacts of a face reach towards each other and cover it", "[report]") {
  const TemporaryFolder place;
  run_into(place, sliding_block());
  const json data = data_of(report_of_results(place.path()).html);
  const json& state = data.at("states").at(1);
  const auto numbers = numbers_in<float>(state.at("contacts").at("numbers_f4"));
  REQUIRE(numbers.size() == 18);
  const auto end = [&](std::size_t i) {
    const float* c = numbers.data() + 9 * i;
    return Vec2(Vec2(c[0], c[1]) + c[8] * perpendicular(Vec2(c[2], c[3])));
  };
  // They meet: the end of the one is the end of the other.
  CHECK((end(0) - end(1)).norm() < 1e-3);
  CHECK(std::abs(numbers[8]) == numbers[4]);
}

TEST_CASE("no title of a scene ends the data of the page", "[report]") {
  const TemporaryFolder place;
  Scene scene = sliding_block();
  scene.title = "</script><script>alert(1)</script><!-- \"quoted\" \\";
  run_into(place, scene);
  const std::string html = report_of_results(place.path()).html;
  CHECK(data_of(html).at("summary").at("title") == scene.title);
  CHECK_THAT(html, !ContainsSubstring("alert(1)</script>"));
  // Complete in itself: nothing is fetched.
  for (const std::string fetched : {"src=", "href=\"http", "@import", "url(", "fetch("}) CHECK_THAT(html, !ContainsSubstring(fetched));
  CHECK_THAT(html, !ContainsSubstring("{{"));
}

TEST_CASE("a page that would become too large leaves out contacts first, then states, and says so", "[report]") {
  const TemporaryFolder place;
  run_into(place, sliding_block());
  const Report whole = report_of_results(place.path());
  const std::size_t states = whole.states;
  const Report some = report_of_results(place.path(), {1000});
  CHECK(some.left_out == 0);
  CHECK(some.without_contacts > whole.without_contacts);
  const Report few = report_of_results(place.path(), {400});
  CHECK(few.left_out > 0);
  CHECK(few.states + few.left_out == states);
  const json data = data_of(few.html);
  CHECK(data.at("states_left_out") == few.left_out);
  // The drawing and the end stay, and the end has its contacts.
  CHECK(data.at("states").front().at("name") == "initial");
  CHECK(data.at("states").back().at("name") == data_of(whole.html).at("states").back().at("name"));
  CHECK(data.at("states").back().contains("contacts"));
  CHECK(few.html.size() < some.html.size());
}

TEST_CASE("what is no folder of results is refused with what would be one", "[report]") {
  const TemporaryFolder place;
  CHECK_THROWS_WITH(report_of_results(place / "nowhere"), ContainsSubstring("there is no such folder"));
  CHECK_THROWS_WITH(report_of_results(place.write("file", "")), ContainsSubstring("this is no folder"));
  CHECK_THROWS_WITH(report_of_results(place.path()), ContainsSubstring("summary.json: there is no such file"));
  place.write("summary.json", "[]");
  CHECK_THROWS_AS(report_of_results(place.path()), InputError);
  place.write("summary.json", "{\"command\": \"fos\"}");
  CHECK_THROWS_AS(report_of_results(place.path()), InputError);
  place.write("summary.json", "{\"command\": \"fos\", \"blocks\": 1}");
  CHECK_THROWS_WITH(report_of_results(place.path()), ContainsSubstring("blocks.csv: there is no such file"));
  place.write("blocks.csv", "state,block,vertex,x_m,y_m\nfinal,a,0,0,0\n");
  CHECK_THROWS_WITH(report_of_results(place.path()), ContainsSubstring("the drawing is not written there"));
  // A summary without its answer.
  place.write("blocks.csv", "state,block,vertex,x_m,y_m\ninitial,a,0,0,0\ninitial,a,1,1,0\ninitial,a,2,0,1\n");
  CHECK_THROWS_WITH(report_of_results(place.path()), ContainsSubstring("this is not what openclose writes"));
}

TEST_CASE("named joints are lines of the drawing that move with a block", "[report]") {
  Scene scene = test::column_of_blocks(2);
  const int cross = static_cast<int>(scene.joints.size()), bedding = cross + 1;
  for (const char* name : {"cross", "bedding"}) {
    scene.joints.push_back(scene.joints.front());
    scene.joints.back().name = name;
  }
  const auto page = [&](int below, int above) {
    // From the bottom on, counter-clockwise.
    scene.blocks[0].edge_joints.assign(4, below);
    scene.blocks[1].edge_joints = {below, BlockInput::by_materials, above, BlockInput::by_materials};
    scene.blocks[2].edge_joints.assign(4, above);
    const TemporaryFolder place;
    run_into(place, scene);
    return data_of(report_of_results(place.path()).html);
  };
  CHECK_FALSE(page(bedding, bedding).contains("seams"));  // nothing to tell it from
  const json data = page(bedding, cross);
  REQUIRE(data.contains("seams"));
  const json& seams = data.at("seams");
  const auto joints = numbers_in<std::int32_t>(seams.at("joints_i4"));
  const auto ends = numbers_in<float>(seams.at("ends_f4"));
  REQUIRE(joints.size() == 2);
  REQUIRE(ends.size() == 8);
  for (std::size_t k = 0; k < 2; ++k) {
    const bool is_below = seams.at("names").at(joints[k]) == "bedding";
    const double y = scene.blocks[is_below ? 1 : 2].vertices[0].y() - data.at("origin").at(1).get<double>();
    for (const std::size_t n : {4 * k + 1, 4 * k + 3}) CHECK(static_cast<double>(ends[n]) == Approx(y).margin(1e-4));
    CHECK(std::abs(ends[4 * k] - ends[4 * k + 2]) > 0.5F);
  }
  CHECK(joints[0] != joints[1]);
}

TEST_CASE("tables that are damaged or cut off are refused, not shown", "[report]") {
  const TemporaryFolder place;
  run_into(place, sliding_block());
  json summary = json::parse(test::text_of(place / "summary.json"));
  REQUIRE(summary.at("table_bytes").at("energy.csv") == test::text_of(place / "energy.csv").size());
  // Of what is still as long as it was.
  summary["table_bytes"] = json::object();
  place.write("summary.json", summary.dump());
  const auto refusal = [&](const std::string& file, const std::string& text, const std::string& instead) {
    const std::string whole = test::text_of(place / file);
    std::string table = whole;
    const std::size_t at = table.rfind(text);
    REQUIRE(at != std::string::npos);
    place.write(file, table.replace(at, text.size(), instead));
    std::string message = "nothing is refused";
    try {
      report_of_results(place.path());
    } catch (const InputError& e) {
      message = e.what();
    }
    place.write(file, whole);
    return message;
  };
  CHECK_THAT(refusal("contacts.csv", "start,", "start,nobody"), ContainsSubstring("block_a: there is no block \"nobody"));
  CHECK_THAT(refusal("cracks.csv", "start,", "start,nobody"), ContainsSubstring("block_a: there is no block \"nobody"));
  CHECK_THAT(refusal("block_properties.csv", "\nb", "\nnobody"),
             ContainsSubstring("block_properties.csv:") && ContainsSubstring("there is no block"));
  const std::string ledger = test::text_of(place / "energy.csv"), end = ledger.substr(ledger.rfind(','));
  CHECK_THAT(refusal("energy.csv", end, ",1.2.3\n"), ContainsSubstring("energy.csv:") && ContainsSubstring("imbalance_j: \"1.2.3\" is no number"));
  CHECK(refusal("energy.csv", end, ",nan\n") == "nothing is refused");  // of a run that has gone wrong
  CHECK(refusal("energy.csv", end, ",1e-") == "nothing is refused");    // cut off within its last number
  CHECK_THAT(refusal("energy.csv", end, "\n"), ContainsSubstring("energy.csv:") && ContainsSubstring("a row of"));
  CHECK(refusal("energy.csv", "\n", "\r\n") == "nothing is refused");
  place.write("trials.csv", "srf,stage,stable,criterion,steps,displacement_m\n1,bracket,1,,3,0.1\n");
  CHECK_THAT(refusal("trials.csv", "0.1", "much"), ContainsSubstring("trials.csv:2: displacement_m: \"much\" is no number"));
  const std::string states = test::text_of(place / "block_states.csv"),
                    last = states.substr(states.rfind("start,"), states.find('\n', states.rfind("start,")) + 1 - states.rfind("start,"));
  CHECK_THAT(refusal("block_states.csv", last, ""), ContainsSubstring("the state \"start\" has 1 blocks; accepted: the 2 blocks"));
  CHECK_THAT(refusal("block_states.csv", last, "start,0,bar,nan" + last.substr(last.find(",0"))),
             ContainsSubstring("block_states.csv:") && ContainsSubstring("a row of"));
}
