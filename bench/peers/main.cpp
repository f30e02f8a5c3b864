// openclose-peers: blocks that `openclose cut` has written in another engine; what came out as JSON on stdout. Exit 0, or 2 with one message.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine.h"
#include "openclose/core/process.h"
#include "openclose/geometry/polygon.h"
#include "openclose/scene/reader.h"

namespace openclose::peers {
namespace {

constexpr std::size_t most_vertices = 8;  // of a polygon in Box2D
constexpr int exit_bad_input = 2;

struct Options {
  std::string engine = "box2d";
  std::string blocks_file;
  double friction_angle_deg = 0.0;
  double dt = 0.01;
  double end = 5.0;
};

std::vector<PeerBlock> peer_blocks(const Scene& scene) {
  std::vector<PeerBlock> blocks;
  for (const BlockInput& input : scene.blocks) {
    const auto properties = polygon_properties(input.vertices);
    PeerBlock block;
    block.fixed = input.fixed;
    block.density = scene.materials[input.material].density;
    block.centroid = properties.centroid;
    block.mass = block.density * properties.area;
    block.inertia = block.density * properties.polar_second_moment;
    for (Polygon piece : convex_pieces(input.vertices, most_vertices)) {
      for (Vec2& v : piece) v -= block.centroid;
      block.pieces.push_back(std::move(piece));
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

nlohmann::ordered_json follow(const Options& options) {
  const Scene scene = read_scene(options.blocks_file);
  const std::vector<PeerBlock> blocks = peer_blocks(scene);
  const double friction = std::tan(options.friction_angle_deg * std::numbers::pi / 180.0);
  const auto make = options.engine == "box2d" ? make_box2d : make_chipmunk;
  const auto engine = make(blocks, friction, scene.gravity);
  std::vector<Vec2> start;
  for (std::size_t b = 0; b < blocks.size(); ++b) start.push_back(engine->position(b));
  const long steps = std::lround(options.end / options.dt);
  double cpu = 0.0, deepest = 0.0, farthest = 0.0;
  for (long i = 0; i < steps; ++i) {
    const double begin = process_cpu_time();
    engine->step(options.dt);
    cpu += process_cpu_time() - begin;
    deepest = std::max(deepest, engine->deepest_penetration());
  }
  for (std::size_t b = 0; b < blocks.size(); ++b) farthest = std::max(farthest, (engine->position(b) - start[b]).norm());
  const auto split = std::count_if(blocks.begin(), blocks.end(), [](const PeerBlock& block) { return block.pieces.size() > 1; });
  return {{"engine", engine->name()},
          {"settings", engine->settings()},
          {"blocks", blocks.size()},
          {"split_blocks", split},
          {"steps", steps},
          {"cpu_s", cpu},
          {"farthest_m", farthest},
          {"max_penetration_m", deepest},
          {"peak_memory_bytes", peak_memory()}};
}

int main_of(int argc, char** argv) {
  CLI::App app{"Blocks in another engine"};
  Options o;
  app.add_option("blocks", o.blocks_file, "file of blocks that `openclose cut` wrote")->required();
  app.add_option("--engine", o.engine)->check(CLI::IsMember({"box2d", "chipmunk"}))->capture_default_str();
  app.add_option("--friction-angle-deg", o.friction_angle_deg, "of every contact")->required()->check(CLI::Range(0.0, 89.999));
  app.add_option("--dt", o.dt, "step, s")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--end", o.end, "last time, s")->check(CLI::PositiveNumber)->capture_default_str();
  try {
    app.parse(argc, argv);
    std::cout << follow(o).dump(2) << '\n';
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "openclose-peers: " << error.what() << '\n';
    return exit_bad_input;
  } catch (const std::exception& error) {
    std::cerr << "openclose-peers: " << error.what() << '\n';
    return exit_bad_input;
  }
  return 0;
}

}  // namespace
}  // namespace openclose::peers

int main(int argc, char** argv) {
  return openclose::peers::main_of(argc, argv);
}
