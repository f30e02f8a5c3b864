// Drawings show the blocks as they lie, and what they say of sizes is measured from their lines.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "io/files.h"
#include "openclose/core/error.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/polygon.h"
#include "openclose/io/drawing.h"
#include "openclose/io/force_chain.h"
#include "openclose/io/result_picture.h"
#include "openclose/io/results.h"
#include "openclose/io/summary.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::TemporaryFolder;

namespace {

/// [px] The box of the polygon with this name, x to the right and y downwards.
Box box_of(const std::string& svg, const std::string& name) {
  const std::size_t title = svg.find("<title>" + name);
  REQUIRE(title != std::string::npos);
  const std::string opening = "points=\"";
  const std::size_t begin = svg.rfind(opening, title) + opening.size();
  std::istringstream points(svg.substr(begin, svg.find('"', begin) - begin));
  Polygon polygon;
  char comma = 0;
  for (Vec2 p; points >> p.x() >> comma >> p.y();) polygon.push_back(p);
  REQUIRE(polygon.size() == 4);
  return Box::around(polygon);
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

/// What the groups of the expression match, wherever it does.
std::vector<std::vector<std::string>> all_matches(const std::string& text, const std::string& expression) {
  const std::regex regex(expression);
  std::vector<std::vector<std::string>> list;
  for (std::sregex_iterator i(text.begin(), text.end(), regex), end; i != end; ++i) list.push_back({i->begin() + 1, i->end()});
  return list;
}

/// The part of the document in the group of this class.
std::string group(const std::string& svg, const std::string& name) {
  const std::size_t begin = svg.find("<g class=\"" + name + "\"");
  return begin == std::string::npos ? "" : svg.substr(begin, svg.find("</g>", begin) - begin);
}

/// What drawings need of the summary of a run.
std::string summary_of_run(int blocks) {
  return "{\"command\": \"run\", \"blocks\": " + std::to_string(blocks) +
         R"(, "time_s": 1, "converged": true, "options": {"method": {"contact": "soft"}}, "materials": ["rock"], "joints": ["cross", "bedding"],
          "table_bytes": {}})";
}

/// blocks.csv of a run that has moved nothing. \param vertices  "name,number,x,y" each
std::string outlines_of_run(const std::vector<std::string>& vertices) {
  std::string text = "state,block,vertex,x_m,y_m\n";
  for (const char* state : {"initial", "final"}) {
    for (const std::string& vertex : vertices) text += std::string(state) + "," + vertex + "\n";
  }
  return text;
}

/// Two squares, one on top of the other, with their joint.
void write_two_squares(const TemporaryFolder& place, const std::string& contacts, const std::string& crack) {
  place.write("summary.json", summary_of_run(2));
  place.write("blocks.csv", outlines_of_run({"a,0,0,0", "a,1,1,0", "a,2,1,1", "a,3,0,1", "b,0,0,1", "b,1,1,1", "b,2,1,2", "b,3,0,2"}));
  place.write("contacts.csv", "state,block_a,block_b,x_m,y_m,normal_x,normal_y,length_m,gap_m,normal_force_n,shear_force_n,status\n" + contacts);
  place.write("cracks.csv", "state,block_a,block_b,x1_m,y1_m,x2_m,y2_m,length_m,opening1_m,opening2_m,slip1_m,slip2_m,joint\n" + crack);
}

Scene tower_on_base() {
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("base", test::rectangle(100.0, 50.0, 4.0, 1.0)),
                  test::free_block("tower", test::rectangle(103.0, 51.0, 1.0, 2.0))};
  return scene;
}

/// The results of a column of blocks that has come to rest on its base, or of its factor of safety.
struct Results {
  TemporaryFolder place;
  Scene scene;

  explicit Results(bool is_factor = false) : scene(is_factor ? test::block_on_incline(0.3) : test::column_of_blocks(3)) {
    scene.title = "A <small> one";
    scene.strength_reduction.limit_analysis = false;  // its mechanism would dilate
    scene.end_time = 0.01;
    scene.method.start = Start::settled;
    scene.measured_points = {{"mark", 1, scene.blocks[1].vertices[3]}};
    scene.loads = {{1, scene.blocks[1].vertices[2], {0.0, -1000.0}}};
    scene.supports = {{1, scene.blocks[1].vertices[1], {0.0, is_factor ? 1e-6 : 1e3}}};  // too weak to stop what fails
    const OutputFolder folder(place.path());
    Simulation simulation(scene);
    StateTables states(folder, scene);
    states.add_drawing(simulation.scene(), simulation.system());
    write_block_properties(folder, scene, simulation.system());
    Summary summary;
    if (is_factor) {
      summary.command = "fos";
      const FactorOfSafety safety = factor_of_safety(simulation);
      for (const NamedState& state : safety.states) states.add(state, scene);
      write_mechanism(folder, scene, safety.mechanism);
      states.close();
      write_summary(folder, summary, simulation, &safety);
    } else {
      summary.command = "run";
      summary.converged = run(simulation, RunObserver()).converged;
      states.add("final", simulation);
      states.close();
      write_summary(folder, summary, simulation);
    }
  }

  std::string draw(const DrawingRequest& request = {}) const { return svg_drawing(picture_of_results(place.path(), request)); }
};

}  // namespace

TEST_CASE("drawings have up above, right on the right and one scale", "[io][drawing]") {
  const std::string svg = svg_drawing(picture_of(tower_on_base()));
  const Box base = box_of(svg, "base"), tower = box_of(svg, "tower");
  // Coordinates are written with two decimals.
  constexpr double rounding = 0.011;
  const double scale = (base.high.x() - base.low.x()) / 4.0;
  CHECK(scale > 50.0);
  CHECK(tower.high.y() == Approx(base.low.y()).margin(rounding));
  CHECK(tower.high.x() == Approx(base.high.x()).margin(rounding));
  CHECK(tower.high.x() - tower.low.x() == Approx(scale).margin(2.0 * rounding));
  CHECK(tower.high.y() - tower.low.y() == Approx(2.0 * scale).margin(2.0 * rounding));
  CHECK(base.high.y() - base.low.y() == Approx(scale).margin(2.0 * rounding));
}

TEST_CASE("up to twelve measured points have their names beside them", "[io][drawing]") {
  Scene scene = tower_on_base();
  // Once as the title that a pointer brings up, once beside the point.
  for (const std::size_t points : {1u, 12u, 13u}) {
    scene.measured_points.assign(points, {"mark", 1, scene.blocks[1].vertices[0]});
    CHECK(count(svg_drawing(picture_of(scene)), ">mark<") == (points > 12 ? points : 2 * points));
  }
}

TEST_CASE("the scale bar is as long as it says", "[io][drawing]") {
  for (const double size : {0.01, 1.0, 37.0, 1000.0}) {
    Scene scene = tower_on_base();
    for (BlockInput& block : scene.blocks) {
      for (Vec2& v : block.vertices) v *= size;
    }
    const std::string svg = svg_drawing(picture_of(scene));
    const Box base = box_of(svg, "base");
    const auto bar = all_matches(svg, "class=\"scale\" d=\"M([0-9.]+),[0-9.]+ v8 H([0-9.]+) v-8\"[^>]*/>\\n<text[^>]*>([0-9.e-]+) m<");
    REQUIRE(bar.size() == 1);
    const double pixels = std::stod(bar[0][1]) - std::stod(bar[0][0]), metres = std::stod(bar[0][2]);
    CHECK(pixels == Approx(metres / (4.0 * size) * (base.high.x() - base.low.x())).margin(0.03));
    CHECK(pixels > 50.0);
  }
}

TEST_CASE("tall and wide scenes keep their titles on the page", "[io][drawing]") {
  for (const double height : {0.05, 500.0}) {
    Scene scene = test::empty_scene();
    scene.title = std::string(30, 'a') + " " + std::string(30, 'b') + " " + std::string(30, 'c') + " " + std::string(30, 'd');
    scene.blocks = {test::free_block("block", test::rectangle(0.0, 0.0, 1.0, height))};
    const std::string svg = svg_drawing(picture_of(scene));
    const double width = std::stod(all_matches(svg, "viewBox=\"0 0 ([0-9]+) ([0-9]+)\"")[0][0]);
    for (const auto& text : all_matches(svg, "<text x=\"([0-9.]+)\"[^>]*font-size=\"20\"[^>]*>([^<]*)<"))
      CHECK(std::stod(text[0]) + 0.56 * 20.0 * static_cast<double>(text[1].size()) <= width);
    CHECK(box_of(svg, "block").high.y() <= std::stod(all_matches(svg, "viewBox=\"0 0 ([0-9]+) ([0-9]+)\"")[0][1]));
  }
}

TEST_CASE("every block is a polygon; of many blocks every colour is one path", "[io][drawing]") {
  Picture picture;
  picture.colour_names = {"rock", "clay"};
  constexpr int columns = 90, rows = 60;
  for (int i = 0; i < columns * rows; ++i) {
    picture.blocks.push_back({"block", test::rectangle(i % columns, i / columns, 0.9, 0.9), i % 2, i < columns});
  }
  const std::string svg = svg_drawing(picture);
  CHECK(count(svg, "<polygon") == 0);
  // Regular expressions of the library run out of stack on paths as long as these.
  std::vector<std::string> paths;
  for (std::size_t at = svg.find("<path transform=\"scale(.01)\" fill=\"#"); at != std::string::npos;
       at = svg.find("<path transform=\"scale(.01)\" fill=\"#", at + 1)) {
    const std::size_t begin = svg.find(" d=\"", at) + 4;
    paths.push_back(svg.substr(begin, svg.find('"', begin) - begin));
  }
  REQUIRE(paths.size() == 3);
  std::size_t outlines = 0;
  for (const std::string& path : paths) outlines += count(path, "z");
  CHECK(outlines == columns * rows);
  // The last square of a path is where it belongs: rounding has not added up along the way.
  Vec2 at = Vec2::Zero(), start = Vec2::Zero();
  Box all = {Vec2::Constant(1e9), Vec2::Constant(-1e9)};
  std::istringstream steps(paths[1]);
  for (char command = 0; steps >> command;) {
    Vec2 step = Vec2::Zero();
    if (command == 'z') continue;
    REQUIRE(steps >> step.x() >> step.y());
    // After z a path is at the start of the outline before.
    if (command == 'm') at = start, start = at + step;
    at += step;
    all = {all.low.cwiseMin(at), all.high.cwiseMax(at)};
  }
  const double scale = 100.0 * std::min(1140.0 / 89.9, 820.0 / 59.9);
  CHECK(all.high.x() == Approx(3000.0 + 89.9 * scale).margin(2.0));
  // The lowest row is fixed, and in another path.
  CHECK(all.high.y() - all.low.y() == Approx(58.9 * scale).margin(2.0));

  picture.blocks.resize(100);
  CHECK(count(svg_drawing(picture), "<title>block") == 100);
}

TEST_CASE("lines are as wide as forces and openings are large", "[io][drawing]") {
  Picture picture = picture_of(tower_on_base());
  for (const double force : {4e5, 1e5, 2e4, 10.0}) picture.forces.push_back({{100.0, 50.0}, {101.0, 51.0}, force});
  picture.crack_name = "opening";
  picture.cracks = {{{100.0, 50.0}, {101.0, 51.0}, 0.02}, {{100.0, 50.0}, {101.0, 51.0}, 0.005}, {{100.0, 50.0}, {101.0, 51.0}, 0.0}};
  const std::string svg = svg_drawing(picture);
  const auto widths = [&](const std::string& name) {
    std::vector<double> list;
    for (const auto& match : all_matches(group(svg, name), "stroke-width=\"([0-9.]+)\"")) list.push_back(std::stod(match[0]));
    return list;
  };
  const std::vector<double> forces = widths("forces"), cracks = widths("cracks");
  // What is below a two hundredth of the largest is not drawn.
  REQUIRE(forces.size() == 3);
  CHECK(forces[0] / forces[1] == Approx(4.0).epsilon(2e-3));
  CHECK(forces[0] / forces[2] == Approx(20.0).epsilon(2e-3));
  REQUIRE(cracks.size() == 2);
  CHECK(cracks[0] / cracks[1] == Approx(4.0).epsilon(2e-3));
  // The scale in the legend: the same widths for the same forces.
  const auto scale = all_matches(svg, "class=\"force-scale\"[^>]*stroke-width=\"([0-9.]+)\"[^>]*/>\\n<text[^>]*>(?:largest force )?([0-9.]+) kN/m<");
  REQUIRE(scale.size() == 2);
  CHECK_THAT(svg, ContainsSubstring(">largest force 400 kN/m<"));
  for (const auto& entry : scale) CHECK(100.0 * std::stod(entry[0]) / forces[0] == Approx(std::stod(entry[1]) / 400.0).epsilon(2e-3));
  CHECK_THAT(svg, ContainsSubstring(">opening 20 mm<"));
}

TEST_CASE("joints that edges name are drawn in a colour each, with their names", "[io][drawing]") {
  Scene scene = tower_on_base();
  CHECK(svg_drawing(picture_of(scene)).find("class=\"seam") == std::string::npos);
  constexpr int none = BlockInput::by_materials;
  for (const char* name : {"unused", "rock <bridge>", "bedding"}) {
    scene.joints.push_back(scene.joints.front());
    scene.joints.back().name = name;
  }
  const int bedding = static_cast<int>(scene.joints.size()) - 1, bridge = bedding - 1;
  scene.blocks[1].edge_joints = {bedding, none, bridge, none};
  const Picture picture = picture_of(scene);
  CHECK(picture.seam_names == std::vector<std::string>{"rock <bridge>", "bedding"});
  REQUIRE(picture.seams.size() == 2);
  CHECK(picture.seams[0].name == 1);
  CHECK(picture.seams[0].from == scene.blocks[1].vertices[0]);
  CHECK(picture.seams[0].to == scene.blocks[1].vertices[1]);
  CHECK(picture.seams[1].name == 0);
  CHECK(picture.seams[1].from == scene.blocks[1].vertices[3]);
  CHECK(picture.seams[1].to == scene.blocks[1].vertices[2]);
  // The block beside it with the same edge is drawn over by nothing.
  scene.blocks[0].vertices = {scene.blocks[1].vertices[1], scene.blocks[1].vertices[0], {103.0, 50.0}, {104.0, 50.0}};
  scene.blocks[0].edge_joints = {bedding, none, none, none};
  CHECK(picture_of(scene).seams.size() == 2);
  const std::string svg = svg_drawing(picture);
  const auto colours = all_matches(svg, "class=\"seam\" fill=\"none\" stroke=\"(#[0-9a-f]+)\"");
  REQUIRE(colours.size() == 2);
  CHECK(colours[0] != colours[1]);
  CHECK(svg.find("rock &lt;bridge&gt;</text>") != std::string::npos);
  CHECK(svg.find("unused") == std::string::npos);
}

TEST_CASE("names beyond the colours of joints are dashed", "[io][drawing]") {
  Picture picture = picture_of(tower_on_base());
  for (int n = 0; n < 11; ++n) {
    picture.seam_names.push_back("joint " + std::to_string(n));
    picture.seams.push_back({{100.0 + n, 50.0}, {100.0 + n, 51.0}, n});
  }
  const auto looks = all_matches(svg_drawing(picture), "class=\"seam-key\" stroke=\"(#[0-9a-f]+)\" [^>]*?( stroke-dasharray=\"[0-9. ]+\")?/?>");
  REQUIRE(looks.size() == 11);
  CHECK(std::set<std::vector<std::string>>(looks.begin(), looks.end()).size() == 11);
}

TEST_CASE("the drawing of a run: state, contact forces, what holds and pushes", "[io][drawing]") {
  const Results results;
  DrawingRequest request;
  request.forces = true;
  const Picture picture = picture_of_results(results.place.path(), request);
  REQUIRE(picture.blocks.size() == 4);
  CHECK(picture.blocks[0].fixed);
  // Each joint carries what lies above it, less what the weak support takes.
  std::vector<double> sizes;
  for (const Picture::Force& force : picture.forces) {
    sizes.push_back(force.size);
    CHECK(std::abs(force.from.x() - force.to.x()) < 1e-3);
  }
  std::ranges::sort(sizes);
  REQUIRE(sizes.size() == 3);
  CHECK(sizes[0] == Approx(test::block_weight).epsilon(1e-3));
  CHECK(sizes[1] == Approx(2.0 * test::block_weight).epsilon(1e-3));
  CHECK(sizes[2] == Approx(3.0 * test::block_weight + 1000.0).epsilon(1e-3));
  for (const Picture::Joint& joint : picture.joints) CHECK(joint.state == JointDrawing::sticking);
  const std::string svg = svg_drawing(picture);
  CHECK_THAT(svg, ContainsSubstring(">A &lt;small&gt; one<") && ContainsSubstring("soft: run to t = 0.01 s") && ContainsSubstring("state \"final\""));
  CHECK_THAT(svg, ContainsSubstring("class=\"supports\"") && ContainsSubstring("class=\"loads\"") && ContainsSubstring(">mark<"));
  CHECK_THAT(svg, ContainsSubstring(">1 kN/m<"));
}

TEST_CASE("a bar of force that grazes an edge goes on, one that leaves a block ends", "[io][drawing]") {
  // The crown of an arch, pressed between two stones just below its upper edge.
  const auto stone = [](double left) { return Picture::Block{"", {{left, 0.0}, {left + 1.0, 0.0}, {left + 1.0, 1.0}, {left, 1.0}}, 0, false, 0.0}; };
  const std::vector<Picture::Block> blocks = {stone(0.0), stone(1.0)};
  const Vec2 hinge(1.0, 0.98);
  for (const double rise : {0.0, 0.1, 0.2}) {
    INFO(rise);
    const Picture::Force bar = force_through({1, 0, Vec2(10.0, 10.0 * rise), hinge}, blocks, 1.0);
    CHECK(bar.size == Approx(10.0 * std::hypot(1.0, rise)));
    CHECK((bar.from - hinge).norm() == Approx(0.5));
    CHECK((bar.to - hinge).norm() == Approx(0.5));
    CHECK(bar.from.y() <= 1.0 + 0.1);
  }
  const Picture::Force steep = force_through({1, 0, Vec2(10.0, 10.0), hinge}, blocks, 1.0);
  CHECK(steep.from.y() > 1.0);
  CHECK(steep.from.y() <= 1.0 + 0.1 + 1e-9);
}

TEST_CASE("a surcharge is drawn by arrows along its edge, which turn with the block, and the traction", "[io][drawing]") {
  Scene scene = tower_on_base();
  const auto& corners = scene.blocks[1].vertices;
  scene.surcharges = {{1, corners[2], corners[3], 5e3, 0.0}};
  const Picture picture = picture_of(scene);
  REQUIRE(picture.loads.size() == 1);
  CHECK((picture.loads[0].point - Vec2(103.5, 53.0)).norm() < 1e-12);
  CHECK((picture.loads[0].vector - Vec2(0.0, -5e3)).norm() < 1e-9);
  CHECK((picture.loads[0].spread - Vec2(-1.0, 0.0)).norm() < 1e-12);
  const std::string svg = svg_drawing(picture), drawn = group(svg, "loads");
  const Box tower = box_of(svg, "tower");
  const auto lines = all_matches(drawn, "<line x1=\"([0-9.]+)\" y1=\"[0-9.]+\" x2=\"([0-9.]+)\"");
  REQUIRE(lines.size() > 3);
  double least = 1e9, most = 0.0;
  for (const auto& line : lines) least = std::min(least, std::stod(line[0])), most = std::max(most, std::stod(line[0]));
  CHECK(std::abs(least - tower.low.x()) < 0.02);
  CHECK(std::abs(most - tower.high.x()) < 0.02);
  CHECK(count(drawn, "class=\"spread\"") == 1);
  CHECK(count(drawn, ">5 kPa<") == 1);
  const TemporaryFolder place;
  scene.gravity.setZero();
  scene.end_time = 0.01;
  scene.blocks[1].angular_velocity = 50.0;
  const OutputFolder folder(place.path());
  Simulation simulation(scene);
  StateTables states(folder, scene);
  states.add_drawing(simulation.scene(), simulation.system());
  write_block_properties(folder, scene, simulation.system());
  simulation.change_system().advance(1, {0.0, 0.0, 0.5});
  simulation.change_contacts();  // finds them where the blocks are now
  states.add("final", simulation);
  Summary summary;
  summary.command = "run";
  states.close();
  write_summary(folder, summary, simulation);
  const Picture turned = picture_of_results(place.path(), {});
  REQUIRE(turned.loads.size() == 1);
  CHECK((turned.loads[0].vector - 5e3 * Vec2(std::sin(0.5), -std::cos(0.5))).norm() < 1.0);
  CHECK((turned.loads[0].spread + Vec2(std::cos(0.5), std::sin(0.5))).norm() < 1e-3);
}

TEST_CASE("the drawing of a factor of safety has it in the title and shows the mechanism", "[io][drawing]") {
  const Results results(true);
  const Picture mechanism = picture_of_results(results.place.path(), {});
  const double exact = std::tan(30.0 * test::degree) / std::tan(0.3);
  const auto answer = all_matches(mechanism.notes.at(0), "factor of safety ([0-9.]+) \\(failed at ([0-9.]+), certified; soft\\)");
  REQUIRE(answer.size() == 1);
  CHECK(std::stod(answer[0][0]) < std::stod(answer[0][1]));
  // The load adds to the weight, so that friction alone still decides.
  CHECK(std::stod(answer[0][0]) == Approx(exact).margin(1e-2));
  CHECK_THAT(mechanism.notes.at(1), ContainsSubstring("state \"failed\""));
  REQUIRE(mechanism.velocities.size() == 2);
  CHECK(mechanism.velocities[0].vector.norm() == 0.0);
  CHECK(mechanism.velocities[1].vector.normalized().dot(test::downhill(0.3)) == Approx(1.0).epsilon(1e-3));
  CHECK(mechanism.blocks[1].value == 1.0);
  CHECK_THAT(results.draw(), ContainsSubstring("class=\"velocities\""));

  DrawingRequest request;
  request.state = "stable";
  request.colour = BlockColour::displacement;
  const Picture stable = picture_of_results(results.place.path(), request);
  REQUIRE(stable.scale);
  CHECK(stable.scale->quantity == "displacement [mm]");
  // Closures: of the order of weight over stiffness times area, and of the slip of the shear springs.
  CHECK(stable.scale->largest > 1e3 * test::block_weight * std::cos(0.3) / 2e9);
  CHECK(stable.scale->largest < 1.0);
}

TEST_CASE("joints are drawn as their contacts are", "[io][drawing]") {
  const TemporaryFolder place;
  const auto write = [&](const std::string& status) {
    write_two_squares(place, "final,b,a,0,1,0,1,0.5,0,1,0," + status + "\nfinal,b,a,1,1,0,1,0.5,0,1,0,sticking\n",
                      status == "open" ? "final,a,b,0,1,1,1,1,0.01,0,0,0,\n" : "final,a,b,0,1,1,1,1,0,0,0,0,\n");
  };
  const std::map<std::string, JointDrawing> states = {{"open", JointDrawing::open}, {"sliding", JointDrawing::sliding}};
  for (const auto& [word, state] : states) {
    write(word);
    const Picture picture = picture_of_results(place.path(), {});
    REQUIRE(picture.joints.size() == 2);
    CHECK(picture.joints[0].state == state);
    CHECK(picture.joints[0].to == Vec2(0.5, 1.0));
    CHECK(picture.joints[1].state == JointDrawing::sticking);
    const std::string svg = svg_drawing(picture);
    CHECK(count(svg, "class=\"open\"") == (word == "open" ? 2 : 0));  // the joint, and the legend
    CHECK(count(svg, "class=\"sliding\"") == (word == "sliding" ? 2 : 0));
  }
}

TEST_CASE("what counts as open in a mechanism goes by the corner that moves farthest, whichever of a block's it is", "[io][drawing]") {
  // One corner of the upper square goes 0.5 m, the others 0.1 m: openings count from a hundredth of the longer way on.
  const std::vector<std::string> corners = {"0,1", "1,1", "1,2", "0,2"};
  for (std::size_t far = 0; far < corners.size(); ++far) {
    INFO("corner " << far);
    std::string outlines = "state,block,vertex,x_m,y_m\n";
    for (const char* state : {"initial", "failed"}) {
      const bool has_moved = std::string(state) == "failed";
      for (const char* vertex : {"a,0,0,0", "a,1,1,0", "a,2,1,1", "a,3,0,1"}) outlines += std::string(state) + "," + vertex + "\n";
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const double x = corners[i][0] - '0', y = corners[i][2] - '0', way = !has_moved ? 0.0 : i == far ? 0.5 : 0.1;
        outlines += fmt::format("{},b,{},{},{}\n", state, i, x + way, y);
      }
    }
    for (const bool opens : {false, true}) {
      const TemporaryFolder place;
      write_two_squares(place, "", fmt::format("failed,a,b,0,1,1,1,1,{},0,0,0,\n", opens ? 0.0051 : 0.0049));
      place.write("summary.json", std::regex_replace(summary_of_run(2), std::regex("\"run\","),
                                                     R"("fos", "verdict": "certified", "bracket": {"stable": 1, "failed": 2},)"));
      place.write("blocks.csv", outlines);
      place.write("mechanism.csv", "block,velocity_x,velocity_y,angular_velocity\nb,1,0,0\n");
      const Picture picture = picture_of_results(place.path(), {});
      REQUIRE(picture.joints.size() == (opens ? 2 : 1));  // the other half is closed
      CHECK(picture.joints[0].state == (opens ? JointDrawing::open : JointDrawing::sticking));
    }
  }
}

TEST_CASE("the force of a hinge is seen, though it leaves both blocks at once", "[io][drawing]") {
  const TemporaryFolder folder;
  folder.write("summary.json", summary_of_run(2));
  folder.write("blocks.csv", outlines_of_run({"left,1,0,0", "left,2,1,0", "left,3,1,1", "left,4,0,0.5", "right,1,1,0", "right,2,2,0", "right,3,2,0.5",
                                              "right,4,1,1"}));
  folder.write("contacts.csv",
               "state,block_a,block_b,x_m,y_m,normal_x,normal_y,length_m,gap_m,normal_force_n,shear_force_n,status\n"
               "final,left,right,1,1,-1,0,0.5,0,1000,0,sticking\n");
  folder.write("cracks.csv", "state,block_a,block_b,x1_m,y1_m,x2_m,y2_m,length_m,opening1_m,opening2_m,slip1_m,slip2_m,joint\n");
  DrawingRequest request;
  request.forces = true;
  const Picture picture = picture_of_results(folder.path(), request);
  REQUIRE(picture.forces.size() == 1);
  const Vec2 line = picture.forces[0].to - picture.forces[0].from;
  CHECK(std::abs(line.y()) < 1e-12);
  CHECK(line.x() > 0.1);
  CHECK(line.x() < 1.0);
}

TEST_CASE("the label of a load stands at the tail of its arrow", "[io][drawing]") {
  Picture picture = picture_of(tower_on_base());
  picture.loads = {{{103.5, 53.0}, {0.0, -5e3}}};
  const std::string svg = svg_drawing(picture);
  const auto tail = all_matches(group(svg, "loads"), "<line[^>]*y1=\"([-0-9.]+)\"");
  const auto label = all_matches(group(svg, "loads"), "<text x=\"[-0-9.]+\" y=\"([-0-9.]+)\"[^>]*>5 kN/m<");
  REQUIRE(tail.size() == 1);
  REQUIRE(label.size() == 1);
  CHECK(std::abs(std::stod(label[0][0]) - std::stod(tail[0][0])) < 10.0);
}

TEST_CASE("what cannot be drawn is refused with what can", "[io][drawing]") {
  const Results results;
  const auto refusal = [&](const std::string& folder, const DrawingRequest& request) {
    try {
      picture_of_results(folder, request);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("nothing is refused");
  };
  DrawingRequest request;
  const TemporaryFolder old;
  old.write("blocks.csv", test::text_of(results.place / "blocks.csv"));
  old.write("summary.json", "{\"command\": \"fos\", \"title\": \"old\"}");
  CHECK_THAT(refusal(old.path(), request), ContainsSubstring("summary.json: this is not what openclose writes"));
  old.write("summary.json", "{");
  CHECK_THAT(refusal(old.path(), request), ContainsSubstring("summary.json: this is not JSON"));
  CHECK_THAT(refusal(results.place / "nowhere", request),
             ContainsSubstring("nowhere: there is no such folder; accepted: the folder of a run or fos"));
  CHECK_THAT(refusal(results.place / "blocks.csv", request), ContainsSubstring("this is no folder"));
  const TemporaryFolder empty;
  CHECK_THAT(refusal(empty.path(), request), ContainsSubstring("summary.json: there is no such file"));
  empty.write("summary.json", summary_of_run(2));
  CHECK_THAT(refusal(empty.path(), request), ContainsSubstring("blocks.csv: there is no such file"));
  empty.write("blocks.csv", "state,block,vertex,x_m,y_m\n");
  CHECK_THAT(refusal(empty.path(), request), ContainsSubstring("no state is written there"));
  request.state = "finl";
  CHECK_THAT(refusal(results.place.path(), request),
             ContainsSubstring("--state: there is no state \"finl\", did you mean \"final\"?; accepted: \"final\", \"initial\""));
  request.state = "initial";
  request.forces = true;
  CHECK_THAT(refusal(results.place.path(), request),
             ContainsSubstring("--forces: there are no contacts in the state \"initial\"; accepted: --state with one of \"final\""));
  request.forces = false;
  request.cracks = true;
  CHECK_THAT(refusal(results.place.path(), request), ContainsSubstring("--cracks"));
  request.cracks = false;
  request.colour = BlockColour::state;
  CHECK_THAT(refusal(results.place.path(), request),
             ContainsSubstring("--colour: there are no contacts in the state \"initial\"; accepted: --state with one of \"final\""));
  request.colour = BlockColour::velocity;
  CHECK_THAT(refusal(results.place.path(), request), ContainsSubstring("--colour: there are no velocities in the state \"initial\""));
}

TEST_CASE("tables that are damaged, cut off or of another analysis are refused with file, line and column", "[io][drawing]") {
  const Results results, factor(true);
  DrawingRequest everything;
  everything.forces = everything.cracks = true;
  /// What is said when a text in a table is another one.
  const auto refusal = [&](const Results& from, const std::string& file, const std::string& text, const std::string& instead,
                           DrawingRequest request) {
    const TemporaryFolder place;
    for (const auto& entry : std::filesystem::directory_iterator(from.place.path())) std::filesystem::copy(entry.path(), place.path());
    std::string table = test::text_of(place / file);
    REQUIRE(table.find(text) != std::string::npos);
    table.replace(table.find(text), text.size(), instead);
    place.write(file, table);
    try {
      picture_of_results(place.path(), request);
    } catch (const InputError& e) {
      return std::string(e.what()).substr(place.path().size());
    }
    return std::string("nothing is refused");
  };
  const std::string vertex = "final,base,0,-10,", accepted = "; accepted: a number, as openclose has written it";
  for (const std::string wrong : {"nan", "inf", "abc", "", "1e999", "5 "}) {
    CHECK(refusal(results, "blocks.csv", vertex, "final,base,0," + wrong + ",", {}) ==
          "/blocks.csv:18: x_m: \"" + wrong + "\" is no finite number" + accepted);
  }
  CHECK_THAT(refusal(results, "blocks.csv", vertex, "final,base,0,", {}), ContainsSubstring("/blocks.csv:18: a row of 4 fields; accepted: 5 fields"));
  CHECK_THAT(refusal(results, "blocks.csv", "x_m", "x", {}), ContainsSubstring("/blocks.csv:1: there is no column x_m"));
  CHECK_THAT(refusal(results, "summary.json", "\"blocks\": 4", "\"blocks\": 5", {}),
             ContainsSubstring("blocks.csv: it has 4 blocks; accepted: the 5"));
  CHECK_THAT(refusal(results, "summary.json", "\"command\": \"run\"", "\"command\": \"fos\"", {}), ContainsSubstring("not the states of fos"));
  CHECK_THAT(refusal(factor, "summary.json", "\"command\": \"fos\"", "\"command\": \"run\"", {}), ContainsSubstring("not the states of a run"));
  const std::string outlines = test::text_of(results.place / "blocks.csv"), last = outlines.substr(outlines.rfind("final,"));
  CHECK_THAT(refusal(results, "blocks.csv", last, "", {}), ContainsSubstring("is not the same in the states \"initial\" and \"final\""));
  CHECK_THAT(refusal(results, "contacts.csv", "final,", "final,nobody", everything), ContainsSubstring("contacts.csv:") &&
                                                                                         ContainsSubstring("block_a: there is no block \"nobody") &&
                                                                                         ContainsSubstring("accepted: the name of a block in "));
  CHECK_THAT(refusal(results, "cracks.csv", "final,", "final,nobody", everything), ContainsSubstring("block_a: there is no block \"nobody"));
  CHECK_THAT(refusal(results, "block_properties.csv", "\nbase", "\nnobody", {}), ContainsSubstring("block: there is no block \"nobody"));
  DrawingRequest speeds;
  speeds.colour = BlockColour::velocity;
  CHECK_THAT(refusal(results, "block_states.csv", ",base,", ",nobody,", speeds), ContainsSubstring("block_states.csv:2: block: there is no block"));
  CHECK_THAT(refusal(factor, "mechanism.csv", "\nblock,", "\nnobody,", {}), ContainsSubstring("mechanism.csv:2: block: there is no block"));
}

TEST_CASE("bars of openings and lines of joints stand only where the two blocks still face each other", "[io][drawing]") {
  const TemporaryFolder place;
  DrawingRequest request;
  request.cracks = true;
  const auto picture = [&](const std::string& contacts, const std::string& crack) {
    write_two_squares(place, contacts, crack);
    return picture_of_results(place.path(), request);
  };
  const std::string open = "final,b,a,0,1,0,1,0.5,0.05,0,0,open\nfinal,b,a,1,1,0,1,0.5,0.05,0,0,open\n";
  CHECK(picture(open, "final,a,b,0,1,1,1,1,0.05,0.05,0,0,\n").cracks.size() == 2);
  // A gap of half a block is seen itself.
  const Picture far = picture(open, "final,a,b,0,1,1,1,1,0.5,0.5,0,0,\n");
  CHECK(far.cracks.empty());
  CHECK(far.joints.empty());
  CHECK_THAT(far.crack_name, ContainsSubstring("still face each other"));
  // The line in the middle of the two sides, of which either has moved along it by half of the slip.
  const Picture slipped = picture(open, "final,a,b,0,1,1,1,1,0.05,0.05,0.04,-0.06,\n");
  REQUIRE(slipped.joints.size() == 1);
  CHECK(slipped.joints[0].from.x() == Approx(0.02));
  CHECK(slipped.joints[0].to.x() == Approx(0.97));
  CHECK(slipped.cracks.front().from.x() == Approx(0.02));
  CHECK(picture(open, "final,a,b,0,1,0.05,1,0.05,0.02,0.02,0.06,0.06,\n").joints.empty());
  // Where they touch now.
  const Picture slid =
      picture("final,b,a,0.1,1,0,1,0.45,0,1,0,sliding\nfinal,b,a,1,1,0,1,0.45,0,1,0,sliding\n", "final,a,b,0.05,1,1.05,1,1,0,0,0.1,0.1,\n");
  REQUIRE(slid.joints.size() == 2);
  CHECK(slid.joints[0].from.x() == Approx(0.1));
  CHECK(slid.joints[1].to.x() == Approx(1.0));
}

TEST_CASE("openings that are rounding beside slips are none", "[io][drawing]") {
  const TemporaryFolder place;
  DrawingRequest request;
  request.cracks = true;
  write_two_squares(place, "", "final,a,b,0,1,1,1,1,1e-12,-1e-12,0.01,0.01,\n");
  const Picture closed = picture_of_results(place.path(), request);
  CHECK(closed.cracks.empty());
  CHECK_THAT(svg_drawing(closed), ContainsSubstring(">no joint is open<"));
  write_two_squares(place, "", "final,a,b,0,1,1,1,1,1e-5,0,0.01,0.01,\n");
  CHECK(picture_of_results(place.path(), request).cracks.size() == 1);
  // Two corners that touch without a force.
  const std::string open = "final,a,b,0,1,0,1,0.5,1e-21,0,0,open\nfinal,a,b,1,1,0,1,0.5,1e-21,0,0,open\n";
  write_two_squares(place, open, "final,a,b,0,1,1,1,1,1e-21,1e-21,0,0,\n");
  CHECK(
      std::ranges::none_of(picture_of_results(place.path(), request).joints, [](const Picture::Joint& j) { return j.state == JointDrawing::open; }));
}

TEST_CASE("sizes that round up to a thousand are written in the next unit", "[io][drawing]") {
  Picture picture = picture_of(tower_on_base());
  picture.loads = {{{103.2, 53.0}, {0.0, -0.6 * 999.99999}, {-0.6, 0.0}}, {{103.8, 53.0}, {0.0, -0.4 * 1000.00001}, {-0.4, 0.0}}};
  const std::string svg = svg_drawing(picture);
  CHECK(count(group(svg, "loads"), "<text") == 1);
  CHECK(count(svg, ">1 kPa<") == 1);
}

TEST_CASE("tables with the line ends of another system are read", "[io][drawing]") {
  const Results results;
  const std::string before = results.draw();
  for (const char* name : {"blocks.csv", "contacts.csv", "cracks.csv", "block_states.csv", "block_properties.csv"}) {
    std::string table = test::text_of(results.place / name), other;
    for (const char c : table) other += c == '\n' ? std::string("\r\n") : std::string(1, c);
    results.place.write(name, other);
  }
  CHECK(results.draw() == before);
}

TEST_CASE("corners of open contacts are not joined by a line", "[io][drawing]") {
  const TemporaryFolder place;
  const std::map<std::string, std::size_t> lines = {{"open", 0}, {"sliding", 2}};
  for (const auto& [status, number] : lines) {
    // A joint elsewhere, so that the two contacts are new ones.
    write_two_squares(place, "final,b,a,0,1,0,1,0.5,0,0,0," + status + "\nfinal,b,a,1,1,0,1,0.5,0,0,0," + status + "\n", "");
    CHECK(picture_of_results(place.path(), {}).joints.size() == number);
  }
}

TEST_CASE("what is open by less than a hundredth of the widest joint has a thin line", "[io][drawing]") {
  const TemporaryFolder place;
  write_two_squares(place, "final,b,a,0,1,0,1,0.5,0,0,0,open\nfinal,b,a,1,1,0,1,0.5,0,0,0,open\n",
                    "final,a,b,0,1,0.5,1,0.5,0.05,0.05,0,0,\nfinal,a,b,0.5,1,1,1,0.5,4e-4,1e-6,0,0,\n");
  const Picture picture = picture_of_results(place.path(), {});
  REQUIRE(picture.joints.size() == 2);
  CHECK_FALSE(picture.joints[0].is_slight);
  CHECK(picture.joints[1].is_slight);
  const std::string svg = svg_drawing(picture);
  CHECK_THAT(svg, ContainsSubstring("less than a hundredth of the widest"));
  const auto widths = all_matches(svg, "class=\"open\"[^>]*stroke-width=\"([0-9.]+)\"");
  REQUIRE(widths.size() >= 2);
  CHECK(std::stod(widths[0][0]) > 2.0 * std::stod(widths[1][0]));
}

TEST_CASE("titles tell a reduced strength, a mechanism of limit analysis and the push that grows", "[io][drawing]") {
  const auto picture = [](const Results& from, const std::string& text, const std::string& instead) {
    const std::string file = from.place / "summary.json";
    std::string summary = test::text_of(file);
    REQUIRE(summary.find(text) != std::string::npos);
    from.place.write("summary.json", summary.replace(summary.find(text), text.size(), instead));
    return picture_of_results(from.place.path(), {});
  };
  const Results run;
  CHECK_THAT(run.draw(), !ContainsSubstring("strength divided"));
  CHECK_THAT(picture(run, "\"strength_reduction_factor\": 1,", "\"strength_reduction_factor\": 1.8,").notes.at(0),
             ContainsSubstring("with the strength divided by 1.8"));
  const Results factor(true);
  CHECK_THAT(factor.draw(), !ContainsSubstring("limit analysis") && !ContainsSubstring("which grows"));
  CHECK_THAT(picture(factor, "\"failed_by\": \"mechanism\"", "\"failed_by\": \"limit analysis\"").notes.at(1),
             ContainsSubstring("the mechanism of the limit analysis of 1 of them"));
  const Picture pushed = picture(factor, "\"increase\": null", "\"increase\": \"-gravity_x\"");
  REQUIRE(pushed.push);
  CHECK(pushed.push->direction == Vec2(-1.0, 0.0));
  CHECK_THAT(group(svg_drawing(pushed), "push"), ContainsSubstring("<path"));
}

TEST_CASE("a spring is drawn outside of the block that it holds", "[io][drawing]") {
  Scene scene = tower_on_base();
  const auto& corners = scene.blocks[1].vertices;
  scene.supports = {{1, 0.5 * (corners[1] + corners[2]), {1e3, 0.0}}, {1, 0.5 * (corners[0] + corners[3]), {1e3, 0.0}}};
  const auto sides = all_matches(group(svg_drawing(picture_of(scene)), "supports"), "scale\\((-?1) (-?1)\\)");
  REQUIRE(sides.size() == 2);
  CHECK(sides[0][0] == "-1");
  CHECK(sides[1][0] == "1");
}

TEST_CASE("named joints are told from each other in a drawing of blocks by material", "[io][drawing]") {
  const TemporaryFolder place;
  const auto drawn = [&](const std::string& first, const std::string& second, BlockColour colour) {
    write_two_squares(place, "", "final,a,b,0,1,0.5,1,0.5,0,0,0,0," + first + "\nfinal,a,b,0.5,1,1,1,0.5,0,0,0,0," + second + "\n");
    return picture_of_results(place.path(), {{}, colour});
  };
  const Picture two = drawn("cross", "bedding", BlockColour::material);
  CHECK(two.seam_names == std::vector<std::string>{"cross", "bedding"});  // their colours are those that the scene has given them
  REQUIRE(two.seams.size() == 2);
  CHECK(two.seams[0].name == 0);
  CHECK(two.seams[0].to == Vec2(0.5, 1.0));
  CHECK(svg_drawing(two).find(">bedding</text>") != std::string::npos);
  const Picture one = drawn("bedding", "", BlockColour::material);
  REQUIRE(one.seams.size() == 1);
  CHECK(one.seams[0].name == 1);
  CHECK(svg_drawing(one).find(">cross</text>") == std::string::npos);
  CHECK(drawn("cross", "cross", BlockColour::material).seams.empty());  // nothing to tell it from
  CHECK(drawn("cross", "bedding", BlockColour::displacement).seams.empty());
}
