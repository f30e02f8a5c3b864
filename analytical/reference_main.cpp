// openclose-reference: the reference solutions as CSV on stdout, for figures. Exit 0, or 2 with one message for bad options or input.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "openclose/analytical/bounce.h"
#include "openclose/analytical/ground_motion.h"
#include "openclose/analytical/incline.h"
#include "openclose/analytical/limit_analysis.h"
#include "openclose/analytical/newmark_block.h"
#include "openclose/analytical/planar_wedge.h"
#include "openclose/analytical/rocking_block.h"
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

struct RecordOptions {
  unsigned seed = 1;
  double peak = 5;
  double duration = 5;
  double dt = 0.01;
};

struct BounceOptions {
  double drop = 1;                // [m]
  double joint_stiffness = 50e6;  // [Pa/m] over the base
  double end = 2;
  double every = 0.01;
  BlockOnPlane block;
};

struct RockingOptions {
  double angle_deg = 0.5;
  double friction_deg = 60;
  double joint_stiffness = 200e6;  // [Pa/m] over the base
  double end = 0.35;
  double every = 0.01;
  RockingBlock block;
};

struct ShakenOptions {
  double slope_deg = 20;
  double friction_deg = 25;
  double joint_stiffness = 50e6;  // [Pa/m] over the base
  double amplitude = 2.943;       // [m/s2]
  double frequency = 2;           // [Hz]
  double end = 1;
  double every = 0.01;
  BlockOnPlane block;
};

struct LimitOptions {
  std::string blocks;
  std::optional<double> friction_deg, cohesion;
  bool critical_friction = false;
  std::string mechanism;  // file
  LimitAnalysisOptions analysis;
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

void add_times(CLI::App* command, double& end, double& every) {
  command->add_option("--end", end, "last time, s")->check(CLI::NonNegativeNumber)->capture_default_str();
  command->add_option("--every", every, "time between rows, s")->check(CLI::PositiveNumber)->capture_default_str();
}

void add_block(CLI::App* command, BlockOnPlane& block, double& joint_stiffness) {
  command->add_option("--density", block.density, "kg/m3")->capture_default_str();
  command->add_option("--stiffness", joint_stiffness, "normal and shear stiffness of the joint, Pa/m; each corner takes half of the base")
      ->capture_default_str();
  command->add_option("--width", block.width, "along the plane, m")->capture_default_str();
  command->add_option("--height", block.height, "m")->capture_default_str();
  command->add_option("--gravity", block.gravity, "m/s2")->capture_default_str();
}

CLI::App* add_bounce(CLI::App& app, BounceOptions& o) {
  CLI::App* command = app.add_subcommand("bounce", "block that falls flat on the springs of its two lower corners and bounces");
  command->add_option("--drop", o.drop, "height of the fall, m")->check(CLI::PositiveNumber)->capture_default_str();
  add_block(command, o.block, o.joint_stiffness);
  add_times(command, o.end, o.every);
  return command;
}

CLI::App* add_rocking(CLI::App& app, RockingOptions& o) {
  CLI::App* command =
      app.add_subcommand("rocking", "tall block let go on one corner: on two corner springs (event-resolved), beside Housner's rigid block");
  command->add_option("--angle-deg", o.angle_deg, "at the release")->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--phi-deg", o.friction_deg, "friction angle, springs only")->capture_default_str();
  command->add_option("--stiffness", o.joint_stiffness, "normal and shear stiffness of the joint, Pa/m; each corner takes half of the base")
      ->capture_default_str();
  add_times(command, o.end, o.every);
  return command;
}

CLI::App* add_shaken(CLI::App& app, ShakenOptions& o) {
  CLI::App* command = app.add_subcommand(
      "shaken-incline", "block on a plane that is shaken harmonically: on two corner springs (event-resolved), beside Newmark's rigid block");
  command->add_option("--alpha-deg", o.slope_deg, "slope angle")->capture_default_str();
  command->add_option("--phi-deg", o.friction_deg, "friction angle")->capture_default_str();
  command->add_option("--amplitude", o.amplitude, "of the ground's acceleration, m/s2, at first uphill")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--frequency", o.frequency, "Hz")->check(CLI::PositiveNumber)->capture_default_str();
  add_block(command, o.block, o.joint_stiffness);
  add_times(command, o.end, o.every);
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

CLI::App* add_limit(CLI::App& app, LimitOptions& o) {
  CLI::App* command =
      app.add_subcommand("limit-analysis", "factor of safety of rigid blocks: the largest for which equilibrium within the strength exists");
  command->add_option("blocks", o.blocks, "file of blocks that `openclose cut` wrote")->required();
  command->add_option("--friction-angle-deg", o.friction_deg, "instead of every joint's own")->check(CLI::Range(0.0, 89.999));
  command->add_option("--cohesion-pa", o.cohesion, "instead of every joint's own")->check(CLI::NonNegativeNumber);
  command->add_flag("--zero-dilatancy", o.analysis.zero_dilatancy, "slide at constant volume instead of opening at the friction angle");
  command->add_flag("--critical-friction", o.critical_friction, "the smallest friction angle that stands without cohesion and tensile strength");
  command->add_option("--mechanism", o.mechanism, "file for the velocities at failure, CSV");
  command->add_option("--width", o.analysis.width, "of the bracket of the factor")->check(CLI::Range(1e-8, 1.0))->capture_default_str();
  return command;
}

SlidingBlockState start_state(const InclineOptions& o) {
  if (o.start == "unloaded") return unloaded_start();
  if (o.start == "normal_balanced") return normal_balanced_start(o.block);
  return steady_sliding_start(o.block, 0.0, o.rotation_locked);
}

/// [s] 0, every, 2 every, ... \throws std::invalid_argument for too many
std::vector<double> row_times(double end, double every) {
  if (!(end / every < most_rows)) throw std::invalid_argument("--end over --every asks for more than 1e7 rows");
  // The slack keeps the last row where end/every falls just short of a whole number in binary.
  const long rows = std::lround(std::floor(end / every * (1 + 1e-12)));
  std::vector<double> times;
  for (long i = 0; i <= rows; ++i) times.push_back(static_cast<double>(i) * every);
  return times;
}

void print_rows(const std::vector<double>& times, const std::vector<double>& springs, const std::vector<double>& rigid) {
  for (std::size_t i = 0; i < times.size(); ++i) std::printf("%.17g,%.17g,%.17g\n", times[i], springs[i], rigid[i]);
}

void print_incline(InclineOptions o) {
  o.block.slope_angle = o.slope_deg * degree;
  o.block.friction_angle = o.friction_deg * degree;
  o.block.normal_stiffness = o.block.shear_stiffness = o.joint_stiffness * o.block.width / 2;
  require_valid(o.block);
  ReferenceOptions options;
  options.rotation_locked = o.rotation_locked;
  SlidingBlockReference reference(o.block, start_state(o), options);
  std::puts("time_s,displacement_m,rigid_displacement_m");
  for (const double time : row_times(o.end, o.every)) {
    std::printf("%.17g,%.17g,%.17g\n", time, reference.advance(time).x, sliding_displacement(o.block, time));
  }
}

void print_bounce(BounceOptions o) {
  o.block.slope_angle = 0;
  o.block.normal_stiffness = o.block.shear_stiffness = o.joint_stiffness * o.block.width / 2;
  require_valid(o.block);
  const Bounce bounce{o.drop, std::sqrt(2 * o.block.normal_stiffness / o.block.mass()), o.block.gravity};
  std::puts("time_s,height_m,velocity_m_per_s");
  for (const double time : row_times(o.end, o.every)) {
    const auto [height, velocity] = bounce.at(time);
    std::printf("%.17g,%.17g,%.17g\n", time, height, velocity);
  }
}

void print_rocking(const RockingOptions& o) {
  const double angle = o.angle_deg * degree;
  BlockOnPlane block;
  block.width = o.block.width;
  block.height = o.block.height;
  block.gravity = o.block.gravity;
  block.slope_angle = 0;
  block.friction_angle = o.friction_deg * degree;
  block.normal_stiffness = block.shear_stiffness = o.joint_stiffness * block.width / 2;
  require_valid(block);
  // On its left corner, which carries the weight.
  SlidingBlockState start;
  start.rotation = angle;
  start.y = block.width / 2 * std::sin(angle) - block.height * std::pow(std::sin(angle / 2), 2) - block.weight() / block.normal_stiffness;
  SlidingBlockReference reference(block, start);
  const std::vector<double> times = row_times(o.end, o.every);
  std::vector<double> springs, rigid;
  for (const double time : times) {
    springs.push_back(reference.advance(time).rotation);
    rigid.push_back(rocking_angle(o.block, angle, time));
  }
  std::puts("time_s,rotation_rad,rigid_rotation_rad");
  print_rows(times, springs, rigid);
}

void print_shaken(ShakenOptions o) {
  o.block.slope_angle = o.slope_deg * degree;
  o.block.friction_angle = o.friction_deg * degree;
  o.block.normal_stiffness = o.block.shear_stiffness = o.joint_stiffness * o.block.width / 2;
  require_valid(o.block);
  const std::vector<double> times = row_times(o.end, o.every);
  const GroundMotion ground = harmonic_motion(-o.amplitude, o.frequency, o.end + 1 / o.frequency);
  SlidingBlockReference reference(o.block, normal_balanced_start(o.block));
  std::vector<double> springs, rigid;
  for (const SlidingBlockState& s : reference.follow(ground, times)) springs.push_back(s.x);
  for (const NewmarkState& s : newmark_block(o.block, ground, times).states) rigid.push_back(s.x);
  std::puts("time_s,displacement_m,rigid_displacement_m");
  print_rows(times, springs, rigid);
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

void write_mechanism(const std::string& path, const RigidBlockAssembly& assembly, const LimitState& state) {
  std::ofstream file(path);
  file.precision(17);
  file << "block,vertex,x_m,y_m,velocity_x_m_per_s,velocity_y_m_per_s\n";
  for (std::size_t b = 0; b < state.mechanism.size(); ++b) {
    const RigidBlock& block = assembly.blocks[b];
    for (std::size_t i = 0; i < block.vertices.size(); ++i) {
      const Point& vertex = block.vertices[i];
      const Point velocity = velocity_at(block, state.mechanism[b], vertex);
      file << block.name << ',' << i << ',' << vertex.x() << ',' << vertex.y() << ',' << velocity.x() << ',' << velocity.y() << '\n';
    }
  }
  if (!file) throw std::runtime_error("cannot write " + path);
}

void print_limit(const LimitOptions& o) {
  RigidBlockAssembly assembly = read_rigid_blocks(o.blocks);
  for (Interface& i : assembly.interfaces) {
    if (o.friction_deg) i.strength.friction = std::tan(*o.friction_deg * degree);
    if (o.cohesion) i.strength.cohesion = *o.cohesion;
  }
  CriticalFriction critical;
  if (o.critical_friction) critical = critical_friction(assembly, o.analysis);
  const LimitState state = o.critical_friction ? critical.state : limit_analysis(assembly, o.analysis);
  if (!state.found) throw std::runtime_error(state.reason);
  std::puts("quantity,value");
  const auto row = [](const char* quantity, double value) { std::printf("%s,%.17g\n", quantity, value); };
  if (o.critical_friction) {
    row("critical_friction_angle_deg", critical.angle / degree);
  } else {
    row("factor_of_safety", state.factor);
    row("smallest_failed_factor", state.failed);
  }
  row("blocks", static_cast<double>(assembly.blocks.size()));
  row("interfaces", static_cast<double>(assembly.interfaces.size()));
  row("linear_programs", state.programs);
  row("repetitions", state.repetitions);
  row("excess", state.excess);
  if (!o.mechanism.empty()) write_mechanism(o.mechanism, assembly, state);
}

CLI::App* add_record(CLI::App& app, RecordOptions& o) {
  CLI::App* command =
      app.add_subcommand("synthetic-record", "an acceleration record that a seed makes (analytical/ground_motion.h), as a file for [base_motion]");
  command->add_option("--seed", o.seed, "of its generator")->check(CLI::Range(1U, 2147483646U))->capture_default_str();
  command->add_option("--peak", o.peak, "m/s2")->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--duration", o.duration, "s")->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--every", o.dt, "s")->check(CLI::PositiveNumber)->capture_default_str();
  return command;
}

void print_record(const RecordOptions& o) {
  if (o.duration / o.dt > most_rows) throw std::runtime_error("more than 1e7 rows");
  std::printf("# openclose-reference synthetic-record --seed %u --peak %g --duration %g --every %g\n", o.seed, o.peak, o.duration, o.dt);
  std::puts("time_s,acceleration_m_per_s2");
  const std::vector<double> record = synthetic_record(o.seed, o.peak, o.duration, o.dt);
  for (std::size_t i = 0; i < record.size(); ++i) std::printf("%.10g,%.6f\n", o.dt * static_cast<double>(i), record[i]);
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
  BounceOptions bounce_options;
  RockingOptions rocking_options;
  ShakenOptions shaken_options;
  WedgeOptions wedge_options;
  LimitOptions limit_options;
  RecordOptions record_options;
  const CLI::App* incline = add_incline(app, incline_options);
  const CLI::App* bounce = add_bounce(app, bounce_options);
  const CLI::App* rocking = add_rocking(app, rocking_options);
  const CLI::App* shaken = add_shaken(app, shaken_options);
  const CLI::App* wedge = add_wedge(app, wedge_options);
  add_limit(app, limit_options);
  const CLI::App* record = add_record(app, record_options);
  try {
    app.parse(argc, argv);
    if (incline->parsed()) {
      print_incline(incline_options);
    } else if (bounce->parsed()) {
      print_bounce(bounce_options);
    } else if (rocking->parsed()) {
      print_rocking(rocking_options);
    } else if (shaken->parsed()) {
      print_shaken(shaken_options);
    } else if (wedge->parsed()) {
      print_wedge(wedge_options);
    } else if (record->parsed()) {
      print_record(record_options);
    } else {
      print_limit(limit_options);
    }
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : complain(error.what());
  } catch (const std::exception& error) {
    return complain(error.what());
  }
  return 0;
}
