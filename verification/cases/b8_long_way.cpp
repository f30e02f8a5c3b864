// B8: a block slides 250 m down a plane. From the steady state it is exact at any time; what an unloaded start has lost in its first bounces is a
// velocity, so that the relative error of the way falls as 1/t.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/incline.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double way = 250.0;  // [m]

Scene scene_of(const analytical::BlockOnPlane& data, const std::string& method, Start start, double end) {
  Scene scene = block_on_plane(data, way + 20.0);
  scene.method.contact = method;
  scene.method.start = start;
  scene.step.dt = end / 8000.0;  // 2 ms; outputs fall on steps
  scene.end_time = end;
  scene.output_every = 0.25 * end;
  return scene;
}

void steady(Report& report, const analytical::BlockOnPlane& data, const std::string& method, double end) {
  Simulation simulation = report.simulate(scene_of(data, method, Start::steady_sliding, end));
  const double slid = downhill_history(simulation, data, 5).back();
  report.relative("from the steady state: way in 16.6076541 s", method, way, slid, 1e-10, "m",
                  "g (sin alpha - mu cos alpha) t^2/2; constant forces are integrated exactly, rounding of coordinates of 250 m");
}

/// Errors of the way over the time. The bounces of Newmark (1/2, 1) are gone after two seconds: exp(-w^2 dt t/4) with w^2 dt = 37/s. Rigid contacts
/// have none. What happens at the start takes a tenth of a second at most; the order is off by its part of the first time.
void cold(Report& report, const analytical::BlockOnPlane& data, Start start, double end, double order, const char* name, const char* source) {
  Simulation simulation = report.simulate(scene_of(data, "soft", start, end));
  const std::vector<double> slid = downhill_history(simulation, data, 5);
  std::vector<double> times, errors;
  for (const int quarter : {1, 2, 3, 4}) {
    times.push_back(0.25 * quarter * end);
    errors.push_back(std::abs(slid[quarter] / analytical::sliding_displacement(data, times.back()) - 1.0));
  }
  const double slack = 0.1 / times.front() * std::log(4.0);
  report.order(std::string(name) + ": relative error of the way over the time", "soft", times, errors, order - slack, order + slack, source,
               "time_s");
}

void long_way(Report& report) {
  const analytical::BlockOnPlane data;
  const double end = std::sqrt(2.0 * way / (data.gravity * (std::sin(data.slope_angle) - data.friction() * std::cos(data.slope_angle))));
  for (const std::string& method : all_methods) steady(report, data, method, end);
  cold(report, data, Start::normal_balanced, end, -1.0, "relaxed shear springs", "they give the block a velocity before it slips: order -1");
  cold(report, data, Start::unloaded, end, -2.0, "unloaded start",
       "x + mu y moves as the rigid block while both corners slip: what is left is mu times the closure, order -2");
}

const Registered<Case> registered{{"B8", "a long way down a plane", &long_way}};

}  // namespace
}  // namespace openclose::verification
