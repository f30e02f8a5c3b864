// A bar of Young's modulus E, height H, under its own weight, as a column of n blocks with joints of kn = E n/H: its top sinks by rho g H^2/(2 E).
// The blocks are rigid and each joint stands for the bar between two centroids, so that the lowest one, below half a block, should be twice as stiff:
//   the same joint everywhere: sum of the joints' closures = (1 + 1/n) rho g H^2/(2 E), order 1;
//   the lowest twice as stiff: centroid of the top block where the bar's is to 1/(4 n^2): order 2.
#include <cmath>

#include "studies.h"

namespace openclose::verification {
namespace {

constexpr double modulus = 1e9, bar_height = 8.0;  // [Pa], [m]

Scene column(const Scheme& scheme, int n, double base_factor) {
  Scene scene = empty_scene();
  scene.materials.push_back({"base", 2700.0});
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = modulus * n / bar_height;
  scene.joints.push_back(scene.joints[0]);
  scene.joints[1].materials = {0, 1};
  scene.joints[1].normal_stiffness *= base_factor;
  use(scheme, scene);
  if (scheme.contact == "shi") {
    // One penalty would do for all joints; without one each has ten times its own stiffness.
    scene.method.penalty.reset();
    for (JointProperties& joint : scene.joints) joint.normal_stiffness /= 10.0;
  }
  const double h = bar_height / n;
  scene.blocks = {fixed_block("base", rectangle(-5.0, -1.0, 11.0, 1.0))};
  scene.blocks[0].material = 1;
  for (int i = 0; i < n; ++i) scene.blocks.push_back(free_block("block " + std::to_string(i), rectangle(0.0, i * h, 1.0, h)));
  return scene;
}

void block_number(Studies& studies) {
  const double weight_over_stiffness = 2700.0 * 9.81 / modulus;  // [1/m]
  for (const Scheme& scheme : spring_schemes()) {
    if (!scheme.variant.empty()) continue;  // the same static steps
    for (const bool half_joint : {false, true}) {
      const double order = half_joint ? 2.0 : 1.0;
      // 1e-8 of a block's weight may stay unbalanced.
      const Expectation expected{order - 0.05, order + 0.05, 0.5, 1e-6,
                                 half_joint ? "lowest joint twice as stiff: 1/(4 n^2)" : "the same joint everywhere: 1/n"};
      studies.measure(
          scheme.name() + (half_joint ? ", lowest joint of half a block" : ", equal joints"), "1/n [-]", halved(0.5, 5), expected,
          [&](double per_n) {
            const int n = static_cast<int>(std::lround(1.0 / per_n));
            Simulation simulation = studies.simulate(column(scheme, n, half_joint ? 2.0 : 1.0));
            if (!settle(simulation).settled) return not_measured();
            const double y = half_joint ? bar_height * (1.0 - 0.5 * per_n) : bar_height;
            const double bar = weight_over_stiffness * (bar_height * y - 0.5 * y * y);
            return std::abs(-simulation.system().displacement(n)[1] / bar - 1.0);
          },
          [](double) { return not_measured(); });
    }
  }
}

const Registered<Study> registered{{"blocks", "a column of more and more blocks", &block_number}};

}  // namespace
}  // namespace openclose::verification
