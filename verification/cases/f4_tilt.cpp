// F4: the slope at which a column tips over its lower corner.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/toppling_chart.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double bracket = 1e-9;  // [rad]

analytical::BlockOnPlane column(double stiffness_factor) {
  analytical::BlockOnPlane data;
  data.width = 0.5;
  data.height = 2.0;
  // 50 MPa/m on half the base.
  data.normal_stiffness = data.shear_stiffness = stiffness_factor * 50e6 * 0.5 * data.width;
  data.friction_angle = 60.0 * analytical::degree;
  return data;
}

/// The slope angle [rad] at which a column of this many blocks tips.
double tips_at(const Report& report, analytical::BlockOnPlane data, int blocks, const std::string& method) {
  const double limit = analytical::tipping_angle(data);
  return threshold(limit + 0.01, limit - 0.01, bracket, [&](double angle) {
    data.slope_angle = angle;
    Scene scene = block_on_plane(data, 2.0);
    const std::vector<Vec2> whole = scene.blocks.back().vertices;
    scene.blocks.pop_back();
    for (int i = 0; i < blocks; ++i) {
      const double low = static_cast<double>(i) / blocks, high = static_cast<double>(i + 1) / blocks;
      const auto up = [&](int corner, double share) { return Vec2((1.0 - share) * whole[corner] + share * whole[3 - corner]); };
      scene.blocks.push_back(free_block("block " + std::to_string(i + 1), {up(0, low), up(1, low), up(1, high), up(0, high)}));
    }
    scene.method.contact = method;
    scene.step.dt = 1e-3;
    scene.settle.failure_displacement = 0.1;
    use_joint_springs_as_penalty(scene);
    return stands(report, scene);
  });
}

double degrees(double radians) {
  return radians / analytical::degree;
}

void tilt(Report& report) {
  const analytical::BlockOnPlane data = column(1.0);
  const double rigid = analytical::tipping_angle(data);
  for (const int blocks : {1, 4}) {
    report.near("column of " + std::to_string(blocks) + ": tips at", "hard", degrees(rigid), degrees(tips_at(report, data, blocks, "hard")),
                degrees(bracket + SettleInput().unbalanced_fraction), "deg",
                "atan(b/h); width of the bracket, moment that settling leaves over the weight's");
  }
  const double elastic = analytical::elastic_tipping_angle(data), by_tilt = rigid - elastic;
  const std::string quantity = "block of 0.5 m x 2 m: tips at";
  for (const std::string method : {"soft", "shi"}) {
    // Where edges miss being parallel by the tilt, lengths are taken on the bisector: that changes the tilt by tilt^2/8 of it.
    report.near(quantity, method, degrees(elastic), degrees(tips_at(report, data, 1, method)), degrees(bracket + by_tilt * by_tilt * by_tilt), "deg",
                "atan(b/h) less the elastic tilt asin(W cos(alpha)/(kn b)); width of the bracket");
  }
  // A load that comes on at once moves a spring up to twice as far as one that is put on slowly, and damping then lets the block stand or fall.
  report.between(quantity, "dem", degrees(rigid - 2.0 * by_tilt), degrees(elastic + bracket), degrees(tips_at(report, data, 1, "dem")), "deg",
                 "atan(b/h) less one to two elastic tilts: weight that comes on at once");
  std::vector<double> compliance, errors;
  for (const double factor : {4.0, 16.0, 64.0}) {
    compliance.push_back(1.0 / column(factor).normal_stiffness);
    errors.push_back(rigid - tips_at(report, column(factor), 4, "soft"));
  }
  report.order("column of 4: tips before atan(b/h)", "soft", compliance, errors, 0.95, 1.05, "every joint tilts by its closures: order 1 in 1/kn",
               compliance_name);
}

const Registered<Case> registered{{"F4", "a column tips", &tilt}};

}  // namespace
}  // namespace openclose::verification
