// E11: rock bridges that the cutting makes of joints of finite length. A slab on one plane with joints and bridges in turn (Jennings, see E8), and a
// wedge whose plane ends in rock, which only its bridge holds; then the slab in motion.
#include <fmt/format.h>

#include <cmath>

#include "harness.h"
#include "openclose/analytical/planar_wedge.h"
#include "openclose/scene/reader.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double density = 2700.0, gravity = 9.81;
constexpr double friction_deg = 30.0, joint_cohesion = 2e3, bridge_cohesion = 2e4;  // [deg], [Pa]

std::string joint_of(const std::string& naming, double friction, double cohesion) {
  return fmt::format("[[joint]]\n{}\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 4e8\nfriction_angle_deg = {}\ncohesion_pa = {}\n",
                     naming, friction, cohesion);
}

std::string written(const Vec2& at) {
  return fmt::format("[{:.17g}, {:.17g}]", at.x(), at.y());
}

/// The joint of the materials, which no contact here has, would hold everything.
std::string head(double friction, double cohesion, double cohesion_of_bridge) {
  return fmt::format("[[material]]\nname = 'rock'\ndensity_kg_per_m3 = {}\n", density) + joint_of("materials = ['rock', 'rock']", 60.0, 1e7) +
         joint_of("name = 'joint'", friction, cohesion) + joint_of("name = 'bridge'", friction, cohesion_of_bridge);
}

Scene scene_from(const std::string& text, const std::string& name, const std::string& method) {
  Scene scene = scene_of_text(text, name);
  scene.method.contact = method;
  scene.step.dt = 0.01;
  scene.strength_reduction.width = 1e-4;
  use_joint_springs_as_penalty(scene);
  return scene;
}

struct Slab {
  const char* name;
  double trace, gap, begins;  // [m] lengths of joints and bridges, and where the first joint begins
  double bridges;             // [m] in the slab, by counting
};
constexpr double dip_deg = 35.0, length = 10.0, height = 2.0;  // [deg], [m]
constexpr Slab slabs[] = {{"a bridge in the middle", 4.0, 2.0, 0.0, 2.0},
                          {"bridges at both ends", 8.0, 9.0, 1.0, 2.0},
                          {"four bridges", 2.5, 0.5, 0.25, 1.75},
                          {"no bridge", 4.0, 0.0, 1.0, 0.0}};

/// A bed of a meter and the slab above, of one joint set.
Scene slab_scene(const Slab& slab, const std::string& method, double cohesion_of_joint, double cohesion_of_bridge) {
  const auto at = [](double along, double above) { return written(on_slope(dip_deg * analytical::degree, along, above)); };
  std::string text = head(friction_deg, cohesion_of_joint, cohesion_of_bridge);
  text += fmt::format("[domain]\nmaterial = 'rock'\nvertices_m = [{}, {}, {}, {}]\n", at(0, -1), at(length, -1), at(length, height), at(0, height));
  text += fmt::format("[[joint_set]]\ndip_deg = {}\nspacing_m = 100\norigin_m = {}\njoint = 'joint'\nbridge = 'bridge'\ntrace_length_m = {}\n",
                      -dip_deg, at(slab.begins, 0), slab.trace);
  text += fmt::format("gap_m = {}\n[[fixed_line]]\nfrom_m = {}\nto_m = {}\n", slab.gap, at(0, -1), at(length, -1));
  return scene_from(text, slab.name, method);
}

/// [m] On the slab's side of the plane.
double length_of_bridges(const Scene& scene) {
  const BlockInput& block = scene.blocks.back();
  double sum = 0.0;
  for (std::size_t i = 0; i < block.edge_joints.size(); ++i) {
    const int joint = block.edge_joints[i];
    if (joint == BlockInput::by_materials || scene.joints[joint].name != "bridge") continue;
    sum += (block.vertices[(i + 1) % block.vertices.size()] - block.vertices[i]).norm();
  }
  return sum;
}

double jennings(double weight, double plane, double friction, double cohesive_force) {
  return (cohesive_force + weight * std::cos(plane) * std::tan(friction)) / (weight * std::sin(plane));
}

void slabs_on_a_plane(Report& report) {
  for (const Slab& slab : slabs) {
    const double expected = jennings(density * gravity * length * height, dip_deg * analytical::degree, friction_deg * analytical::degree,
                                     joint_cohesion * (length - slab.bridges) + bridge_cohesion * slab.bridges);
    for (const std::string& method : all_methods) {
      const Scene scene = slab_scene(slab, method, joint_cohesion, bridge_cohesion);
      report.near(std::string(slab.name) + ": factor of safety", method, expected, strength_reduction_factor(report, scene),
                  scene.strength_reduction.width, "-", "(sum of c L + W cos psi tan phi)/(W sin psi); width of the bracket");
      // The cut needs no solver, so one that does nothing says nothing about it.
      if (method != all_methods.front() || report.null_solver()) continue;
      report.near(std::string(slab.name) + ": length of bridges", "all", slab.bridges, length_of_bridges(scene), 1e-9, "m", "drawn; rounding");
    }
  }
}

constexpr double joint_part = 0.6;  // of the wedge's plane, from the toe

/// A slope with a single line that comes out of the face and ends in rock. The face goes on below it, so that nothing is in the wedge's way.
Scene wedge_scene(const analytical::PlanarWedge& wedge, double cohesion_of_bridge, const std::string& method) {
  const auto corners = analytical::wedge_vertices(wedge);
  const Vec2 toe(corners[0][0], corners[0][1]), daylight(corners[1][0], corners[1][1]), crest(corners[2][0], corners[2][1]);
  const double side = 2.0 * daylight.x(), base = -0.5 * wedge.height;
  const Vec2 foot = base / wedge.height * crest;
  std::string text = head(wedge.friction_angle / analytical::degree, wedge.cohesion, cohesion_of_bridge);
  text += fmt::format("[domain]\nmaterial = 'rock'\nvertices_m = [{}, [{}, {}], [{}, {}], {}]\n", written(foot), side, base, side, wedge.height,
                      written(crest));
  text += fmt::format("[[joint_line]]\nfrom_m = {}\nto_m = {}\njoint = 'joint'\nbridge = 'bridge'\n", written(toe), written(joint_part * daylight));
  text += fmt::format("[[fixed_line]]\nfrom_m = {}\nto_m = [{}, {}]\n", written(foot), side, base);
  return scene_from(text, "wedge", method);
}

void wedge_held_by_its_bridge(Report& report) {
  analytical::PlanarWedge wedge;
  wedge.friction_angle = 25.0 * analytical::degree;
  wedge.cohesion = 0.0;
  wedge.unit_weight = density * gravity;
  const double weight = analytical::wedge_weight(wedge), bridge = (1.0 - joint_part) * analytical::plane_length(wedge);
  const auto factor = [&](double cohesion) { return jennings(weight, wedge.plane_angle, wedge.friction_angle, cohesion * bridge); };
  // What the bridge must carry so that the factor is 1, and 5 % less and more of the whole strength.
  const double by_friction = factor(0.0);
  const auto cohesion_for = [&](double f) { return (f - by_friction) * weight * std::sin(wedge.plane_angle) / bridge; };
  for (const std::string& method : all_methods) {
    for (const double f : {0.95, 1.05, 1.5}) {
      const Scene scene = wedge_scene(wedge, cohesion_for(f), method);
      report.near(text("wedge with a bridge for {}: factor of safety", f), method, f, strength_reduction_factor(report, scene),
                  scene.strength_reduction.width + 1e-5, "-", "Jennings; width of the bracket, and the tilt of the wedge as in E1");
      if (f < 1.2)
        report.near(text("wedge with a bridge for {}: stands", f), method, f > 1.0 ? 1.0 : 0.0, stands(report, scene), 0.0, "-", "Jennings");
    }
  }
}

/// The slab in motion, thrown down the plane: a bridge that loses its cohesion on slip is friction alone from then on, a ductile one goes on to hold.
/// Its length stays that of the drawing while the slab slides over the places where the joint changes, by less than any part is long.
void slab_in_motion(Report& report) {
  constexpr double speed = 1.0, dt = 1e-4, end = 0.5;  // [m/s], [s]
  constexpr double cohesion = 3e4;                     // [Pa]
  const Slab& slab = slabs[0];
  const double dip = dip_deg * analytical::degree, hold = cohesion * slab.bridges / (density * length * height);
  const double driving = gravity * std::sin(dip), friction = gravity * std::cos(dip) * std::tan(friction_deg * analytical::degree);
  for (const CohesionBehaviour behaviour : {CohesionBehaviour::ductile, CohesionBehaviour::lost_on_slip}) {
    const bool is_ductile = behaviour == CohesionBehaviour::ductile;
    const double acceleration = driving - friction - (is_ductile ? hold : 0.0);
    for (const std::string& method : all_methods) {
      if (is_ductile && method == "dem") {
        report.leave_out("ductile bridge, thrown down the plane: way in 0.5 s", method,
                         "corners on corners: rounding may take what the start gave them to carry, and nothing damps the vibration then");
        continue;
      }
      Scene scene = slab_scene(slab, method, 0.0, cohesion);
      for (JointProperties& joint : scene.joints) joint.cohesion_behaviour = behaviour;
      scene.method.start = Start::normal_balanced;
      scene.blocks[1].rotation_locked = true;
      scene.blocks[1].velocity = speed * downhill(dip);
      scene.step.dt = dt;
      scene.end_time = scene.output_every = end;
      Simulation simulation = report.simulate(scene);
      const auto samples = history(simulation);
      const double way = samples.empty() ? not_measured() : samples.back().motion.displacement.dot(downhill(dip));
      report.near(std::string(is_ductile ? "ductile" : "brittle") + " bridge, thrown down the plane: way in 0.5 s", method,
                  speed * end + 0.5 * acceleration * end * end, way, 2.0 * (driving + friction + hold) * dt * end, "m",
                  "s = v t + a t2/2; the bond breaks, and the springs are strained, two steps late at most");
    }
  }
}

void bridges_cut(Report& report) {
  slabs_on_a_plane(report);
  wedge_held_by_its_bridge(report);
  slab_in_motion(report);
}

const Registered<Case> registered{{"E11", "rock bridges that the cutting makes", &bridges_cut}};

}  // namespace
}  // namespace openclose::verification
