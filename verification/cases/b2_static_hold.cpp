// B2: a block at rest on an incline, from a settled start: corner forces, the friction angle that decides between stick and slip, and no drift.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/static_hold.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

struct Hold {
  double holds = not_measured();                                      ///< 1 if it settled, 0 if it slid away
  double lower = not_measured(), upper = not_measured();              ///< normal forces [N]
  double lower_shear = not_measured(), upper_shear = not_measured();  ///< [N]
};

/// Forces of the two corners, the downhill one first.
Hold forces_of(Simulation& simulation, double holds) {
  Hold hold;
  hold.holds = holds;
  double downhill_x = -1e300;
  for (const Contact& c : simulation.change_contacts()) {
    if (c.status == ContactStatus::open) continue;
    const double x = simulation.system().position(c.vertex_block, c.vertex).x();
    if (x > downhill_x) {
      hold.upper = hold.lower;
      hold.upper_shear = hold.lower_shear;
      hold.lower = c.normal_force;
      hold.lower_shear = std::abs(c.shear_force);
      downhill_x = x;
    } else {
      hold.upper = c.normal_force;
      hold.upper_shear = std::abs(c.shear_force);
    }
  }
  return hold;
}

Hold settle_on(const Report& report, const analytical::BlockOnPlane& data, const std::string& method) {
  Scene scene = block_on_plane(data);
  scene.method.contact = method;
  scene.step.dt = 0.01;
  use_joint_springs_as_penalty(scene);
  Simulation simulation = report.simulate(scene);
  const SettleResult result = settle(simulation);
  return forces_of(simulation, result.settled ? 1.0 : result.criterion == "displacement" ? 0.0 : not_measured());
}

/// Hard contacts give the rigid forces; springs tilt the block by (N_low - N_up)/(kn b), and the forces differ by that angle, so the error is
/// proportional to 1/kn.
void corner_forces(Report& report) {
  analytical::BlockOnPlane data;
  data.friction_angle = 40.0 * analytical::degree;
  const auto expected = analytical::holding_corner_forces(data);
  for (const std::string method : {"soft", "shi", "dem"}) {
    std::vector<double> compliance, lower, upper;
    for (const double factor : {1.0, 4.0, 16.0}) {
      analytical::BlockOnPlane stiffer = data;
      stiffer.normal_stiffness *= factor;
      stiffer.shear_stiffness *= factor;
      const Hold hold = settle_on(report, stiffer, method);
      compliance.push_back(1.0 / stiffer.normal_stiffness);
      lower.push_back(std::abs(hold.lower / expected.lower - 1.0));
      upper.push_back(std::abs(hold.upper / expected.upper - 1.0));
    }
    report.order("force of the lower corner, error over compliance", method, compliance, lower, 0.95, 1.05, "elastic tilt: order 1 in 1/kn",
                 compliance_name);
    report.order("force of the upper corner, error over compliance", method, compliance, upper, 0.95, 1.05, "elastic tilt: order 1 in 1/kn",
                 compliance_name);
  }
  const Hold hold = settle_on(report, data, "hard");
  report.relative("force of the lower corner", "hard", expected.lower, hold.lower, 1e-8, "N", "rigid block; settled to 1e-8 of the weight");
  report.relative("force of the upper corner", "hard", expected.upper, hold.upper, 1e-8, "N", "rigid block; settled to 1e-8 of the weight");
}

/// 1 if the block settled under its weight, 0 if it slid away, NaN if the contacts do not carry the weight or settling came to another end.
double holds(const Hold& hold, const analytical::BlockOnPlane& data) {
  if (hold.holds != 1.0) return hold.holds;
  return std::abs((hold.lower + hold.upper) / data.normal_weight() - 1.0) < 1e-3 ? 1.0 : not_measured();
}

void threshold(Report& report) {
  for (const std::string& method : all_methods) {
    for (const double excess : {0.01, -0.01}) {
      analytical::BlockOnPlane data;
      data.friction_angle = data.slope_angle + excess * analytical::degree;
      report.near(text("phi - alpha = {} deg: holds", excess), method, excess > 0.0 ? 1.0 : 0.0, holds(settle_on(report, data, method), data), 0.0,
                  "-", "phi > alpha holds, phi < alpha slides");
    }
  }
}

void drift(Report& report) {
  analytical::BlockOnPlane data;
  data.friction_angle = data.slope_angle + 0.01 * analytical::degree;
  for (const Scheme& scheme : schemes()) {
    const std::string& method = scheme.contact;
    Scene scene = block_on_plane(data);
    set_scheme(scene, scheme);
    scene.method.start = Start::settled;
    scene.step.dt = 1e-3;
    scene.end_time = 100.0;
    scene.output_every = 1.0;
    Simulation simulation = report.simulate(scene);
    double worst = 0.0;
    const auto samples = history(simulation);
    // From the first second on: before, the 1e-8 of the weight that settling leaves unbalanced is worked off.
    for (const Sample& s : samples) {
      if (s.time >= 1.0) worst = larger(worst, (s.motion.displacement - samples[1].motion.displacement).norm());
    }
    const bool carried = !samples.empty() && holds(forces_of(simulation, 1.0), data) == 1.0;
    // The explicit method has nothing that damps the vibration with which the last of the unbalanced force is worked off.
    const double vibration = method == "dem" ? 2.0 * scene.settle.unbalanced_fraction * data.weight() / (2.0 * data.normal_stiffness) : 0.0;
    report.near(with_variant("drift over 1e5 steps", scheme), method, 0.0, carried ? worst : not_measured(), 1e-12 + vibration, "m",
                "static equilibrium");
  }
}

/// Springs tilt the block by (N_low - N_up)/(kn b), which changes lever arms and weight's parts by that angle and twice the slenderness.
void sliding_forces(Report& report) {
  const analytical::BlockOnPlane data;
  const auto expected = analytical::sliding_corner_forces(data);
  const double tilt = (expected.lower - expected.upper) / (data.normal_stiffness * data.width);
  for (const Scheme& scheme : schemes()) {
    const std::string& method = scheme.contact;
    Scene scene = block_on_plane(data);
    set_scheme(scene, scheme);
    scene.method.start = Start::steady_sliding;
    scene.step.dt = 1e-3;
    scene.end_time = scene.output_every = 0.5;
    use_joint_springs_as_penalty(scene);
    Simulation simulation = report.simulate(scene);
    const bool slid = downhill_history(simulation, data, 2).back() > 0.1;
    const Hold hold = slid ? forces_of(simulation, 0.0) : Hold{};
    const double tolerance = method == "hard" ? 1e-8 : 2.0 * tilt;
    const char* source = method == "hard" ? "W cos(alpha)/2 (1 +- mu h/b)" : "W cos(alpha)/2 (1 +- mu h/b); twice the elastic tilt";
    report.relative(with_variant("while sliding: force of the lower corner over the weight", scheme), method, expected.lower / data.weight(),
                    hold.lower / data.weight(), tolerance, "-", source);
    report.relative(with_variant("while sliding: force of the upper corner over the weight", scheme), method, expected.upper / data.weight(),
                    hold.upper / data.weight(), tolerance, "-", source);
  }
}

/// Both corners move as far along the plane, so that their springs share W sin(alpha) equally, until the upper one, which carries less, slips:
/// between 39.07 degrees, where mu N_up = W sin(alpha)/2, and 30 it does, and the lower one sticks with the rest.
void upper_corner_slips(Report& report) {
  for (const double friction_deg : {45.0, 33.0}) {
    analytical::BlockOnPlane data;
    data.friction_angle = friction_deg * analytical::degree;
    const auto normal = analytical::holding_corner_forces(data);
    const double driving = data.weight() * std::sin(data.slope_angle), bound = data.friction() * normal.upper;
    const double upper = std::min(0.5 * driving, bound), lower = driving - upper;
    const double tilt = (normal.lower - normal.upper) / (data.normal_stiffness * data.width);
    const std::string name = text("at rest, friction {:g} deg: ", friction_deg);
    const char* source =
        upper < bound ? "W sin(alpha)/2 each; twice the elastic tilt" : "mu N of the upper corner, which slips, and the rest; twice the tilt";
    for (const std::string method : {"soft", "shi"}) {
      const Hold hold = settle_on(report, data, method);
      report.relative(name + "shear force of the upper corner over the weight", method, upper / data.weight(), hold.upper_shear / data.weight(),
                      2.0 * tilt, "-", source);
      report.relative(name + "shear force of the lower corner over the weight", method, lower / data.weight(), hold.lower_shear / data.weight(),
                      2.0 * tilt, "-", source);
    }
  }
  report.leave_out("at rest: shear forces of the corners", "dem",
                   "the way to rest slips at both corners, and what friction holds in the end depends on it");
  report.leave_out("at rest: shear forces of the corners", "hard", "rigid contacts share them in any way that friction allows");
}

void static_hold(Report& report) {
  upper_corner_slips(report);
  corner_forces(report);
  sliding_forces(report);
  threshold(report);
  drift(report);
}

const Registered<Case> registered{{"B2", "static hold", &static_hold}};

}  // namespace
}  // namespace openclose::verification
