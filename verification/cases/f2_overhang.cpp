// F2: a stack of blocks that leans over an edge as far as it can: a thousandth less stands, a thousandth more falls.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/stacked_blocks.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

/// Blocks of 1 m x 0.25 m on a table that ends at x = 0; the overhangs are `scale` times the largest ones.
Scene stack(int blocks, double scale, const std::string& method, double stiffness) {
  Scene scene = empty_scene();
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = stiffness;
  scene.joints[0].friction_angle = 45.0 * analytical::degree;
  scene.method.contact = method;
  scene.method.penalty = stiffness;
  scene.method.penalty_shear_ratio = 1.0;
  scene.step.dt = 1e-3;
  scene.settle.failure_displacement = 0.01;
  // From rest on slack springs: in a first step of a second the blocks may pass a rest that they are near to losing.
  scene.settle.first_dt = 1e-3;
  scene.blocks.push_back(fixed_block("table", rectangle(-3.0, -1.0, 3.0, 1.0)));
  double end = 0.0;
  for (int from_top = blocks, i = 0; from_top > 0; --from_top, ++i) {
    end += scale * (analytical::largest_overhang(from_top) - (from_top > 1 ? analytical::largest_overhang(from_top - 1) : 0.0));
    scene.blocks.push_back(free_block("block " + std::to_string(i + 1), rectangle(end - 1.0, 0.25 * i, 1.0, 0.25)));
  }
  return scene;
}

void overhang(Report& report) {
  // On springs a stack reaches less far by its closures over its lengths: here by 1e-6 for 4 blocks, far less than the thousandth.
  constexpr double stiff = 1e11;  // [Pa/m]
  for (const int n : {4, 10}) {
    const double largest = analytical::largest_overhang(n);
    for (const std::string& method : all_methods) {
      for (const double change : {-1e-3, 1e-3}) {
        report.near(std::to_string(n) + " blocks, overhang " + text("{:.6f}", largest) + text(" times 1{:+g}: stands", change), method,
                    change < 0.0 ? 1.0 : 0.0, stands(report, stack(n, 1.0 + change, method, stiff)), 0.0, "-", "sum of 1/(2k)");
      }
    }
  }
  constexpr double soft = 1e9;  // [Pa/m] the softest; lacks a ten-thousandth
  for (const std::string method : {"soft", "shi"}) {
    std::vector<double> compliance, errors;
    for (const double factor : {1.0, 4.0, 16.0}) {
      compliance.push_back(1.0 / (factor * soft));
      const double scale = threshold(1.0, 0.999, 1e-8, [&](double s) { return stands(report, stack(4, s, method, factor * soft)); });
      errors.push_back(1.0 - scale);
    }
    report.order("4 blocks, lack of overhang", method, compliance, errors, 0.95, 1.05, "the blocks tilt by their closures: order 1 in 1/kn",
                 "compliance_m_per_pa");
  }
  report.leave_out("4 blocks, lack of overhang", "dem",
                   "settling starts from slack springs in motion; by how far the blocks swing beyond their rest has no order in 1/kn");
}

const Registered<Case> registered{{"F2", "overhang of a stack", &overhang}};

}  // namespace
}  // namespace openclose::verification
