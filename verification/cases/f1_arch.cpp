// F1: the smallest thickness of a semicircular arch of n straight-edged voussoirs, against the line of thrust.
#include <array>
#include <cmath>

#include "harness.h"
#include "openclose/analytical/masonry_arch.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double joint_stiffness = 1e9;  // [Pa/m] the softest
/// [m] Ten times what the closures of standing arches come to: only a mechanism moves so far.
constexpr double failing = 1e-2;
constexpr double bracket = 1e-4;  // [-] of the thickness, rigid arches

/// R = 1 m, on two fixed springers. Friction of 60 degrees: the thrust on the line of the smallest thickness stays within 30 degrees of the joints'
/// normals.
Scene arch(int voussoirs, double thickness, const std::string& method, double stiffness) {
  analytical::BlockOnPlane data;
  data.friction_angle = 60.0 * analytical::degree;
  Scene scene = empty_scene(data);
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = stiffness;
  scene.method.contact = method;
  scene.method.penalty = stiffness;
  scene.method.penalty_shear_ratio = 1.0;
  scene.step.dt = 1e-3;
  scene.settle.failure_displacement = failing;
  for (const double x : {-1.0, 1.0}) scene.blocks.push_back(fixed_block(x < 0.0 ? "left" : "right", rectangle(x - 0.3, -0.5, 0.6, 0.5)));
  for (const auto& corners : analytical::straight_voussoirs(voussoirs, thickness)) {
    std::vector<Vec2> vertices;
    for (const auto& [x, y] : corners) vertices.emplace_back(x, y);
    scene.blocks.push_back(free_block("voussoir " + std::to_string(scene.blocks.size() - 1), vertices));
  }
  return scene;
}

double smallest_thickness(const Report& report, int voussoirs, const std::string& method, double stiffness, double reach, double width) {
  const double limit = analytical::smallest_arch_thickness(voussoirs, analytical::VoussoirShape::straight);
  return threshold(limit * (1.0 - reach), limit * (1.0 + reach), width * limit,
                   [&](double thickness) { return stands(report, arch(voussoirs, thickness, method, stiffness)); });
}

void arch(Report& report) {
  for (const int n : {6, 7, 10, 27}) {
    const double limit = analytical::smallest_arch_thickness(n, analytical::VoussoirShape::straight);
    report.relative("smallest t/R of " + std::to_string(n) + " voussoirs", "hard", limit,
                    smallest_thickness(report, n, "hard", joint_stiffness, 0.02, bracket), bracket, "-",
                    "line of thrust in the same voussoirs; width of the bracket");
  }
  // Nearly a ring. A trial takes seconds, so that only the two ends of a bracket of the goal's width, 0.2 %, are tried.
  constexpr int fine = 320;
  constexpr double reach = 1e-3;
  report.relative("smallest t/R of 320 voussoirs", "hard", analytical::smallest_arch_thickness(fine, analytical::VoussoirShape::straight),
                  smallest_thickness(report, fine, "hard", joint_stiffness, reach, 3.0 * reach), reach, "-",
                  "line of thrust in the same voussoirs; falls 0.1 % below, stands 0.1 % above");
  for (const std::string method : {"soft", "shi", "dem"}) {
    std::vector<double> compliance, errors;
    for (const double factor : {1.0, 4.0, 16.0}) {
      const double limit = analytical::smallest_arch_thickness(10, analytical::VoussoirShape::straight);
      compliance.push_back(1.0 / (factor * joint_stiffness));
      errors.push_back(smallest_thickness(report, 10, method, factor * joint_stiffness, 0.05, 1e-6) / limit - 1.0);
    }
    report.order("smallest t/R of 10 voussoirs, excess over the rigid arch", method, compliance, errors, 0.9, 1.1,
                 "closures under the thrust lower the crown and turn the joints: order 1 in 1/kn", "compliance_m_per_pa");
  }
  report.leave_out("smallest t/R of ring sectors", "all", "blocks are polygons; the formula for both shapes is in analytical/masonry_arch.h");
}

const Registered<Case> registered{{"F1", "smallest thickness of an arch", &arch}};

}  // namespace
}  // namespace openclose::verification
