// D4: blocks that collide face to face without gravity: two of them, and a row of five with gaps.
#include <cmath>
#include <numeric>

#include "harness.h"
#include "openclose/analytical/collisions.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double density = 2500.0;  // [kg/m3]
/// Blocks 1 m high in a row; their faces touch over 1 m, so that the joint's stiffness is that of the contact.
Scene scene_of(const Scheme& scheme, const analytical::MassRow& row, double dt) {
  analytical::BlockOnPlane data;
  Scene scene = empty_scene(data);
  scene.gravity = Vec2::Zero();
  scene.materials[0].density = density;
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = row.stiffness;
  set_scheme(scene, scheme);
  use_joint_springs_as_penalty(scene);
  scene.step.dt = dt;
  double x = 0.0;
  for (std::size_t i = 0; i < row.masses.size(); ++i) {
    const double width = row.masses[i] / density;
    scene.blocks.push_back(free_block("block " + std::to_string(i), rectangle(x, 0.0, width, 1.0)));
    scene.blocks.back().velocity = {row.velocities[i], 0.0};
    x += width + (i < row.gaps.size() ? row.gaps[i] : 0.0);
  }
  return scene;
}

struct Outcome {
  std::vector<double> displacements, velocities;
  double momentum = 0.0;  ///< change, over the sum of |m v| at the start
  double impact = 0.0;    ///< [J] of the ledger
};

Outcome follow(const Report& report, const Scheme& scheme, const analytical::MassRow& row, double dt, int steps) {
  Simulation simulation = report.simulate(scene_of(scheme, row, dt));
  bool done = true;
  for (int i = 0; i < steps && done; ++i) done = simulation.advance(dt);
  Outcome outcome;
  double size = 0.0;
  for (std::size_t i = 0; i < row.masses.size(); ++i) {
    const int b = static_cast<int>(i);
    outcome.displacements.push_back(done ? simulation.system().displacement(b)[0] : not_measured());
    outcome.velocities.push_back(done ? simulation.velocity(b)[0] : not_measured());
    outcome.momentum += row.masses[i] * (outcome.velocities.back() - row.velocities[i]);
    size += row.masses[i] * std::abs(row.velocities[i]);
  }
  outcome.momentum /= size;
  outcome.impact = simulation.ledger().impact;
  return outcome;
}

analytical::MassRow pair_of(double first, double second) {
  return {{first, second}, {3.0, -0.6}, {0.0}, 2e8};
}

/// The touch falls on a step, and so does the exact end of the contact.
void elastic_pairs(Report& report, const Scheme& scheme) {
  for (const double second : {2500.0, 7500.0}) {
    analytical::MassRow pair = pair_of(2500.0, second);
    const double contact = analytical::contact_duration(pair);
    pair.gaps[0] = 0.5 * contact * (pair.velocities[0] - pair.velocities[1]);
    const auto exact = analytical::elastic_collision(pair);
    std::vector<double> steps, errors;
    double momentum = 0.0;
    for (const int n : {40, 80, 160, 320}) {
      const Outcome o = follow(report, scheme, pair, contact / n, 2 * n);
      steps.push_back(contact / n);
      errors.push_back(largest_difference(o.velocities, exact));
      momentum = larger(momentum, std::abs(o.momentum));
      const bool collided = o.velocities[0] < o.velocities[1];
      if (!collided) errors.back() = momentum = not_measured();
    }
    const std::string name = second == 2500.0 ? "equal masses swap velocities" : "masses 1:3, velocities after";
    const bool settles = scheme.contact == "dem";
    const double expected = scheme.order == 1.0 ? 1.0 : settles ? 4.0 : 3.0;
    if (scheme.conserves) {
      report.near(with_variant(name + ": largest error at 4 steps", scheme), scheme.contact, 0.0, largest(errors), residual_share * 3.6, "m/s",
                  "energy and momentum are kept at any step; what a residual may leave of the closing speed");
    } else {
      report.order(with_variant(name, scheme), scheme.contact, steps, errors, expected - 0.1, expected + 0.1,
                   expected == 1.0 ? "closed form; spectral radius of D1: order 1"
                   : settles       ? "closed form; ends on steps leave e of order 3, and what settles it e^2/(k D^2), D of order 1: order 4"
                                   : "closed form; on the spring no energy is lost, ends on steps leave order 3");
    }
    report.against(Reference::conservation)
        .near(with_variant(name + ": momentum", scheme), scheme.contact, 0.0, momentum, 1e-12, "-",
              "action = reaction: 1e-13 a step that has contact, which are few; over the sum of |m v|");
  }
}

analytical::MassRow row_of_five() {
  return {{2500.0, 1250.0, 3750.0, 2000.0, 2500.0}, {4.0, 0.0, 0.0, 0.0, -1.0}, {0.02, 0.015, 0.01, 0.012}, 2e8};
}

void elastic_row(Report& report, const Scheme& scheme) {
  const analytical::MassRow row = row_of_five();
  constexpr double end = 0.08;
  const auto exact = analytical::elastic_row(row, end);
  std::vector<double> steps, errors;
  double momentum = 0.0;
  // Where in a step contacts begin and end is a random factor on each error: the mean over step sizes that lie close together is free of it.
  constexpr int near_sizes = 8;
  for (const int n : {400, 800, 1600, 3200}) {
    double squares = 0.0;
    for (int i = 0; i < near_sizes; ++i) {
      const int count = n + n * i / 25;
      const Outcome o = follow(report, scheme, row, end / count, count);
      squares += std::pow(largest_difference(o.displacements, exact.displacements), 2);
      momentum = larger(momentum, std::abs(o.momentum));
      if (!(o.velocities[0] < 2.0)) squares = momentum = not_measured();  // it has met the others
    }
    steps.push_back(end / n);
    errors.push_back(std::sqrt(squares / near_sizes));
  }
  report.against(Reference::ode)
      .order(with_variant("row of five: places, root mean square of 8 near steps", scheme), scheme.contact, steps, errors, scheme.order - 0.2,
             scheme.order + 0.2, "CVODE with events; order of the scheme");
  report.against(Reference::conservation)
      .near(with_variant("row of five: momentum", scheme), scheme.contact, 0.0, momentum, 2 * 4096 * 2.2e-16, "-",
            "action = reaction; over the sum of |m v|, rounded in each of up to 4096 steps, in both stages of tr_bdf2");
}

/// Rigid contact is plastic. The step of a blow closes the gap exactly and keeps the momentum, as the exact motion does in the same time: wherever in
/// the step the blow falls there is no error, but for what a closed gap may differ in a step.
void plastic(Report& report) {
  const Scheme& hard = scheme_named("hard");
  for (const double second : {2500.0, 7500.0}) {
    analytical::MassRow pair = pair_of(2500.0, second);
    pair.gaps[0] = 0.1;
    const auto exact = analytical::plastic_row(pair, 0.1);
    const double closing = pair.velocities[0] - pair.velocities[1], reduced = 2500.0 * second / (2500.0 + second);
    for (const double dt : {1e-3, 3e-4}) {
      const Outcome o = follow(report, hard, pair, dt, static_cast<int>(0.1 / dt));
      const std::string name = text("masses 1:{}", second / 2500.0) + text(", dt = {} s", dt);
      report.near(name + ": common velocity", "hard", 0.0, largest_difference(o.velocities, exact.velocities), gap_tolerance / dt, "m/s",
                  "momentum over mass; tolerance of the gap over dt");
      report.relative(name + ": energy of the impact", "hard", 0.5 * reduced * closing * closing, o.impact, 1e-10, "J",
                      "m* v^2/2 of the closing speed");
    }
  }
  const analytical::MassRow row{{2500.0, 1250.0, 3750.0, 2000.0, 2500.0}, {4.0, 0.0, 0.0, 0.0, -1.0}, {0.02, 0.015, 0.01, 0.012}, 2e8};
  for (const double dt : {1e-3, 3.1e-4, 1e-4}) {
    const int count = static_cast<int>(0.1 / dt);
    const Outcome o = follow(report, hard, row, dt, count);
    const auto exact = analytical::plastic_row(row, count * dt);
    const std::string name = text("row of five, dt = {} s", dt);
    const double places = largest_difference(o.displacements, exact.displacements);
    report.near(name + ": places", "hard", 0.0, places, count * gap_tolerance, "m",
                "event by event; the tolerance of a gap in a step is a speed that lasts: times the number of steps");
    report.near(name + ": common velocity", "hard", 0.0, largest_difference(o.velocities, exact.velocities), gap_tolerance / dt, "m/s",
                "momentum over mass; tolerance of the gap over dt");
    report.against(Reference::conservation)
        .near(name + ": momentum", "hard", 0.0, places < 1e-3 ? std::abs(o.momentum) : not_measured(), 1e-12, "-",
              "action = reaction; over the sum of |m v|");
  }
  report.leave_out("elastic collisions", "hard", "restitution 0: rigid contacts are plastic");
}

void collisions(Report& report) {
  for (const Scheme& scheme : spring_schemes()) {
    elastic_pairs(report, scheme);
    elastic_row(report, scheme);
  }
  plastic(report);
  for (const Scheme& scheme : schemes()) {
    Simulation simulation = report.simulate(scene_of(scheme, row_of_five(), 1e-4));
    bool done = true;
    for (int i = 0; i < 800 && done; ++i) done = simulation.advance(1e-4);
    check_ledger(report, with_variant("row of five", scheme), scheme.contact, simulation, done);
  }
}

const Registered<Case> registered{{"D4", "collisions", &collisions}};

}  // namespace
}  // namespace openclose::verification
