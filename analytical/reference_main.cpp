// openclose-reference: the reference solutions as CSV on stdout, for figures. Exit 0, or 2 with one message for bad options.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include "openclose/analytical/incline.h"
#include "openclose/analytical/planar_wedge.h"
#include "openclose/analytical/sliding_block_reference.h"

namespace {

using namespace openclose::analytical;

constexpr int exit_bad_options = 2;
constexpr double most_rows = 1e7;

struct InclineOptions {
  double friction_deg = 20;
  double slope_deg = 30;
  double joint_stiffness = 50e6;  // [Pa/m] over the base
  std::string start = "unloaded";
  bool rotation_locked = false;
  double end = 3;
  double every = 0.01;
  BlockOnPlane block;
};

struct WedgeOptions {
  double face_deg = 50;
  double plane_deg = 35;
  double friction_deg = 40;
  PlanarWedge wedge;
};

CLI::App* add_incline(CLI::App& app, InclineOptions& o) {
  CLI::App* command = app.add_subcommand("incline", "block on two corner springs sliding down a plane (event-resolved), beside the rigid solution");
  command->add_option("--phi-deg", o.friction_deg, "friction angle")->required();
  command->add_option("--alpha-deg", o.slope_deg, "slope angle")->capture_default_str();
  command->add_option("--start", o.start, "state at t = 0")
      ->check(CLI::IsMember({"unloaded", "normal_balanced", "steady_sliding"}))
      ->capture_default_str();
  command->add_flag("--rotation-locked", o.rotation_locked, "the block only translates");
  command->add_option("--density", o.block.density, "kg/m3")->capture_default_str();
  command->add_option("--stiffness", o.joint_stiffness, "normal and shear stiffness of the joint, Pa/m; each corner takes half of the base")
      ->capture_default_str();
  command->add_option("--width", o.block.width, "along the plane, m")->capture_default_str();
  command->add_option("--height", o.block.height, "m")->capture_default_str();
  command->add_option("--gravity", o.block.gravity, "m/s2")->capture_default_str();
  command->add_option("--end", o.end, "last time, s")->check(CLI::NonNegativeNumber)->capture_default_str();
  command->add_option("--every", o.every, "time between rows, s")->check(CLI::PositiveNumber)->capture_default_str();
  return command;
}

CLI::App* add_wedge(CLI::App& app, WedgeOptions& o) {
  CLI::App* command = app.add_subcommand("wedge", "planar wedge of a slope: factor of safety, weight, geometry");
  command->add_option("--height", o.wedge.height, "of the slope, m")->capture_default_str();
  command->add_option("--face-deg", o.face_deg, "slope face")->capture_default_str();
  command->add_option("--plane-deg", o.plane_deg, "sliding plane")->capture_default_str();
  command->add_option("--cohesion", o.wedge.cohesion, "Pa")->capture_default_str();
  command->add_option("--phi-deg", o.friction_deg, "friction angle")->capture_default_str();
  command->add_option("--unit-weight", o.wedge.unit_weight, "N/m3")->capture_default_str();
  return command;
}

SlidingBlockState start_state(const InclineOptions& o) {
  if (o.start == "unloaded") return unloaded_start();
  if (o.start == "normal_balanced") return normal_balanced_start(o.block);
  return steady_sliding_start(o.block, 0.0, o.rotation_locked);
}

void print_incline(InclineOptions o) {
  o.block.slope_angle = o.slope_deg * degree;
  o.block.friction_angle = o.friction_deg * degree;
  o.block.normal_stiffness = o.block.shear_stiffness = o.joint_stiffness * o.block.width / 2;
  require_valid(o.block);
  if (!(o.end / o.every < most_rows)) throw std::invalid_argument("--end over --every asks for more than 1e7 rows");
  ReferenceOptions options;
  options.rotation_locked = o.rotation_locked;
  SlidingBlockReference reference(o.block, start_state(o), options);
  // The slack keeps the last row where end/every falls just short of a whole number in binary.
  const long rows = std::lround(std::floor(o.end / o.every * (1 + 1e-12)));
  std::puts("time_s,displacement_m,rigid_displacement_m");
  for (long i = 0; i <= rows; ++i) {
    const double time = static_cast<double>(i) * o.every;
    std::printf("%.17g,%.17g,%.17g\n", time, reference.advance(time).x, sliding_displacement(o.block, time));
  }
}

void print_wedge(WedgeOptions o) {
  o.wedge.face_angle = o.face_deg * degree;
  o.wedge.plane_angle = o.plane_deg * degree;
  o.wedge.friction_angle = o.friction_deg * degree;
  require_valid(o.wedge);
  const auto vertices = wedge_vertices(o.wedge);
  std::puts("quantity,value");
  const auto row = [](const char* quantity, double value) { std::printf("%s,%.17g\n", quantity, value); };
  row("factor_of_safety", factor_of_safety(o.wedge));
  row("weight_n", wedge_weight(o.wedge));
  row("length_m", plane_length(o.wedge));
  row("toe_x_m", vertices[0][0]);
  row("toe_y_m", vertices[0][1]);
  row("daylight_x_m", vertices[1][0]);
  row("daylight_y_m", vertices[1][1]);
  row("crest_x_m", vertices[2][0]);
  row("crest_y_m", vertices[2][1]);
}

int complain(const char* message) {
  std::cerr << "openclose-reference: " << message << '\n';
  return exit_bad_options;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Reference solutions as CSV on stdout"};
  app.require_subcommand(1);
  InclineOptions incline_options;
  WedgeOptions wedge_options;
  const CLI::App* incline = add_incline(app, incline_options);
  add_wedge(app, wedge_options);
  try {
    app.parse(argc, argv);
    if (incline->parsed()) {
      print_incline(incline_options);
    } else {
      print_wedge(wedge_options);
    }
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : complain(error.what());
  } catch (const std::exception& error) {
    return complain(error.what());
  }
  return 0;
}
