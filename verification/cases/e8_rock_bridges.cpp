// E8: a plane part of which is a joint and part of which is rock bridges (Jennings, A mathematical theory for the calculation of the stability of
// slopes in open cast mines, 1970): the cohesions of the parts add up by their lengths.
#include <cmath>

#include "harness.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

struct Part {
  double from, to;  // [m] along the plane
  bool is_bridge;
};
struct Plane {
  const char* name;
  std::vector<Part> parts;
};
const Plane planes[] = {{"a joint alone", {{0.0, 10.0, false}}},
                        {"a bridge in the middle", {{0.0, 4.0, false}, {4.0, 6.0, true}, {6.0, 10.0, false}}},
                        {"two bridges", {{0.0, 3.0, false}, {3.0, 4.0, true}, {4.0, 7.0, false}, {7.0, 8.0, true}, {8.0, 10.0, false}}},
                        {"rock alone", {{0.0, 10.0, true}}}};
constexpr double slope = 35.0 * analytical::degree, friction = 30.0 * analytical::degree;
constexpr double joint_cohesion = 2e3, bridge_cohesion = 2e4;  // [Pa]
constexpr double length = 10.0, height = 2.0;                  // [m] of the block

/// The block on fixed ones, a material for joints and one for bridges. It is long and low: no part of it lifts off.
Scene scene_of(const Plane& plane, const std::string& method) {
  analytical::BlockOnPlane data;
  data.friction_angle = friction;
  Scene scene = empty_scene(data);
  scene.materials.push_back({"bridge", scene.materials[0].density});
  JointProperties& joint = scene.joints[0];
  joint.cohesion = joint_cohesion;
  scene.joints.push_back(joint);
  scene.joints.back().materials = {0, 1};
  scene.joints.back().cohesion = bridge_cohesion;
  const auto place = [&](double along, double above) { return on_slope(slope, along, above); };
  for (const Part& part : plane.parts) {
    scene.blocks.push_back(fixed_block("base " + std::to_string(scene.blocks.size()),
                                       {place(part.from, -1.0), place(part.to, -1.0), place(part.to, 0.0), place(part.from, 0.0)}));
    scene.blocks.back().material = part.is_bridge ? 1 : 0;
  }
  scene.blocks.push_back(free_block("block", {place(0.0, 0.0), place(length, 0.0), place(length, height), place(0.0, height)}));
  scene.method.contact = method;
  scene.step.dt = 0.01;
  use_joint_springs_as_penalty(scene);
  return scene;
}

double jennings(const Plane& plane) {
  const double weight = 2700.0 * 9.81 * length * height;
  double strength = weight * std::cos(slope) * std::tan(friction);
  for (const Part& part : plane.parts) strength += (part.is_bridge ? bridge_cohesion : joint_cohesion) * (part.to - part.from);
  return strength / (weight * std::sin(slope));
}

void rock_bridges(Report& report) {
  for (const Plane& plane : planes) {
    for (const std::string& method : all_methods) {
      const Scene scene = scene_of(plane, method);
      report.near(std::string(plane.name) + ": factor of safety", method, jennings(plane), strength_reduction_factor(report, scene),
                  scene.strength_reduction.width, "-", "(sum of c L + W cos psi tan phi)/(W sin psi); width of the bracket");
    }
  }
}

const Registered<Case> registered{{"E8", "rock bridges on one plane", &rock_bridges}};

}  // namespace
}  // namespace openclose::verification
