// B9: a block on planes of many angles with many coefficients of friction: what rests, rests; what slides, slides as the closed form says; at the
// border a part in a thousand of the friction decides; and on the level each stops after v0^2/(2 mu g).
#include <cmath>

#include "harness.h"
#include "openclose/analytical/incline.h"
#include "openclose/analytical/stopping_distance.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double frictions[] = {0.1, 0.3, 0.5, 0.7, 1.0};         // [-]
constexpr double inclines_deg[] = {3.0, 10.0, 20.0, 30.0, 40.0};  // all below the 63 degrees at which the block topples
constexpr double border = 1e-3;                                   // [-] of the friction
constexpr double end = 0.5;                                       // [s]

analytical::BlockOnPlane block_of(double incline_deg, double friction) {
  analytical::BlockOnPlane data;
  data.slope_angle = incline_deg * analytical::degree;
  data.friction_angle = std::atan(friction);
  return data;
}

Scene scene_of(const analytical::BlockOnPlane& data, const std::string& method, Start start) {
  Scene scene = block_on_plane(data);
  scene.method.contact = method;
  scene.method.start = start;
  scene.step.dt = 1e-3;
  scene.end_time = end;
  scene.output_every = end;
  use_joint_springs_as_penalty(scene);
  return scene;
}

double slid(const Report& report, const Scene& scene, const analytical::BlockOnPlane& data) {
  Simulation simulation = report.simulate(scene);
  return downhill_history(simulation, data, 2).back();
}

void grid(Report& report, const std::string& method) {
  double worst = 0.0;
  int sliding = 0, resting = 0, rests = 0;
  for (const double incline : inclines_deg) {
    for (const double friction : frictions) {
      const analytical::BlockOnPlane data = block_of(incline, friction);
      if (friction > std::tan(data.slope_angle)) {
        ++resting;
        rests += stands(report, scene_of(data, method, Start::settled)) == 1.0;
      } else {
        ++sliding;
        const double way = slid(report, scene_of(data, method, Start::steady_sliding), data);
        worst = larger(worst, std::abs(way / analytical::sliding_displacement(data, end) - 1.0));
      }
    }
  }
  report.near(text("friction above the slope: blocks of {} that rest", resting), method, resting, rests, 0.0, "-", "phi > alpha holds");
  report.near(text("friction below the slope: largest error of {} ways in 0.5 s", sliding), method, 0.0, worst, 1e-10, "-",
              "g (sin alpha - mu cos alpha) t^2/2, relative; constant forces are integrated exactly");
}

void at_the_border(Report& report, const std::string& method) {
  for (const double incline : inclines_deg) {
    for (const double part : {-border, border}) {
      const analytical::BlockOnPlane data = block_of(incline, std::tan(incline * analytical::degree) * (1.0 + part));
      report.near(text("{:g} deg, ", incline) + text("friction of {:g} times its tangent: holds", 1.0 + part), method, part > 0.0 ? 1.0 : 0.0,
                  stands(report, scene_of(data, method, Start::settled)), 0.0, "-", "phi > alpha holds, phi < alpha slides");
    }
  }
}

/// Springs throw the block back by up to twice mu W/(2 ks) when it stops; rigid contact misses the place by r dt^2.
void stopping_ways(Report& report, const std::string& method) {
  const double speed = 2.0, dt = 1e-3;
  for (const double friction : frictions) {
    const analytical::BlockOnPlane data = block_of(0.0, friction);
    const auto stop = analytical::stopping(data, speed, 1);
    Scene scene = scene_of(data, method, Start::steady_sliding);
    scene.blocks[1].rotation_locked = true;
    scene.blocks[1].velocity = {speed, 0.0};
    scene.end_time = scene.output_every = dt * std::ceil(stop.time / dt + 10.0);
    const double thrown_back = method == "hard" ? 0.0 : friction * data.weight() / data.shear_stiffness;
    report.near(text("friction {}: way from 2 m/s to the stop", friction), method, stop.distance, slid(report, scene, data),
                speed / stop.time * dt * dt + thrown_back, "m", "v0^2/(2 mu g); r dt^2, and with springs twice mu W/(2 ks)");
  }
}

void friction_grid(Report& report) {
  for (const std::string& method : all_methods) {
    grid(report, method);
    at_the_border(report, method);
    stopping_ways(report, method);
  }
}

const Registered<Case> registered{{"B9", "a grid of slopes and coefficients of friction", &friction_grid}};

}  // namespace
}  // namespace openclose::verification
