// A2: mass, centroid and moment of inertia, as the motion under a point load shows them. From rest and without gravity one step of any scheme gives
// d = F dt^2/(2 m), rotation = M dt^2/(2 I). The load is small and normal to its lever, so that turning the lever changes the moment by
// less than rotation^2 = 1e-18.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/regular_polygon.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

struct Response {
  double mass, moment_of_inertia;
  Vec2 lever;
};

/// Pushes the block once through the centroid's side at `point` with a force normal to the lever from `centroid`.
Response push(const Report& report, const std::string& method, const std::vector<Vec2>& vertices, const Vec2& point, const Vec2& centroid,
              double inertia) {
  const double dt = 1.0, strength = 1e-5;
  Scene scene = empty_scene();
  scene.gravity = Vec2::Zero();
  scene.method.contact = method;
  scene.step = {dt, 1.0, 1e-6};
  scene.blocks = {free_block("polygon", vertices)};
  const Vec2 force = strength * perpendicular((point - centroid).normalized());
  scene.loads = {{0, point, force}};
  Simulation simulation = report.simulate(scene);
  simulation.step(dt, false);
  const auto d = simulation.system().displacement(0);
  const double rotation = Motion::rotation(d);
  const double moment = cross(point - centroid, force);
  const double mass = strength * dt * dt / (2.0 * Motion::translation(d).norm());
  // Lever arm that explains the rotation, along the line from the centroid to the point.
  const double arm = 2.0 * inertia * rotation / (dt * dt * strength);
  return {mass, moment * dt * dt / (2.0 * rotation), arm * (point - centroid).normalized()};
}

void mass_properties(Report& report) {
  const std::string source = "regular n-gon, I = (m R^2/6)(1 + 2 cos^2(pi/n))";
  for (const std::string& method : all_methods) {
    for (const int sides : {3, 4, 5, 6, 17}) {
      const analytical::RegularPolygon polygon{sides, 1.5, 2700.0};
      std::vector<Vec2> vertices;
      for (const auto& v : polygon.vertices({0.0, 0.0}, 0.3)) vertices.emplace_back(v[0], v[1]);
      const Response r = push(report, method, vertices, vertices[0], Vec2::Zero(), polygon.moment_of_inertia());
      report.relative(text("mass, {}-gon", sides), method, polygon.mass(), r.mass, 1e-12, "kg/m", source);
      report.relative(text("moment of inertia, {}-gon", sides), method, polygon.moment_of_inertia(), r.moment_of_inertia, 1e-12, "kgm", source);
      report.relative(text("distance centroid to corner, {}-gon", sides), method, polygon.circumradius, r.lever.norm(), 1e-12, "m", source);
    }
    // An L of three unit squares, by the parallel-axis theorem: I = m (1/6 + mean square distance of the squares from the centroid) with
    // distances^2 1/18 + 5/9 ... summed exactly: centroid (5/6, 5/6), squares at (1/2, 1/2), (3/2, 1/2), (1/2, 3/2).
    for (const double offset : {0.0, 1e6}) {
      const Vec2 at(offset, -offset);
      std::vector<Vec2> l;
      for (const Vec2& v : {Vec2(0, 0), Vec2(2, 0), Vec2(2, 1), Vec2(1, 1), Vec2(1, 2), Vec2(0, 2)}) l.emplace_back(v + at);
      const double mass = 3.0 * 2700.0;
      const double inertia = mass * (1.0 / 6.0 + (2.0 / 9.0 + 5.0 / 9.0 + 5.0 / 9.0) / 3.0);
      const Response r = push(report, method, l, l[0], at + Vec2(5.0 / 6.0, 5.0 / 6.0), inertia);
      // The centroid's own coordinates are only known to half a unit in the last place of 1e6 m, which is 6e-11 m, relative to the lever of 1.2 m.
      const double tolerance = offset > 0.0 ? 1e-10 : 1e-12;
      report.relative(text("mass, L-shape moved by {} m", offset), method, mass, r.mass, 1e-12, "kg/m", "three unit squares");
      report.relative(text("moment of inertia, L-shape moved by {} m", offset), method, inertia, r.moment_of_inertia, tolerance, "kgm",
                      "parallel axes");
    }
  }
}

const Registered<Case> registered{{"A2", "mass properties from the response to a load", &mass_properties}};

}  // namespace
}  // namespace openclose::verification
