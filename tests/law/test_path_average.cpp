#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "openclose/law/path_average.h"
#include "support/catch.h"

using namespace openclose;

namespace {

struct Path {
  ContactSprings springs;
  ContactStrength strength;
  double gap_change = 0.0, slip_change = 0.0;
};

ContactStrength strength_of(double friction, double cohesion, double tension) {
  JointProperties joint;
  joint.friction_angle = std::atan(friction);
  joint.cohesion = cohesion;
  joint.tensile_strength = tension;
  Contact contact;
  contact.length = 1.0;
  return ContactStrength(TabulatedJoint(joint), contact);
}

ContactSprings springs_at(double gap, double shear) {
  ContactSprings springs;
  springs.normal = 1000.0;
  springs.shear = 400.0;
  springs.gap = gap;
  springs.initial_shear = shear;
  return springs;
}

/// Forces of the order of 1000 N, changes of gap and slip of the order of 1 m; every fourth without cohesion, tension or dashpots.
Path random_path(std::mt19937& generator) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(generator); };
  const auto often = [&](double value) { return uniform(0.0, 1.0) < 0.25 ? 0.0 : value; };
  Path path{springs_at(uniform(-1.5, 0.7), uniform(-900.0, 900.0)),
            strength_of(uniform(0.1, 0.9), often(uniform(0.0, 800.0)), often(uniform(0.0, 600.0))), uniform(-1.5, 1.5), uniform(-2.0, 2.0)};
  path.springs.normal_damping = often(uniform(0.0, 300.0));
  path.springs.shear_damping = often(uniform(0.0, 200.0));
  return path;
}

PathAverage average(const Path& p, double dissipation = 0.0) {
  return path_average(p.springs, p.strength, p.gap_change, p.slip_change, dissipation);
}

/// The same by many small steps of the joint law, each with the forces at its middle: error of the order of one step's share of the largest force.
struct SmallSteps {
  double normal = 0.0, shear = 0.0, elastic_shear_end = 0.0;
  bool slid = false;
  SmallSteps(const Path& p, int steps) {
    double elastic_shear = p.springs.initial_shear;
    const double way = p.slip_change / steps;
    bool was_open = p.springs.normal * p.springs.gap > p.strength.tension;
    if (was_open) elastic_shear = 0.0;
    for (int i = 0; i < steps; ++i) {
      const double gap = p.springs.gap + (i + 0.5) / steps * p.gap_change;
      const CarriedForces f = carry(p.strength, {-p.springs.normal * gap, -p.springs.normal_damping * p.gap_change,
                                                 elastic_shear - p.springs.shear * way, -p.springs.shear_damping * p.slip_change});
      normal += f.normal / steps;
      shear += f.shear / steps;
      elastic_shear = f.elastic_shear;
      slid = slid || f.status == ContactStatus::sliding;
    }
    elastic_shear_end = elastic_shear;
  }
};

std::string what_happens(const Path& p) {
  const PathAverage a = average(p);
  const double opening = p.strength.tension / p.springs.normal;
  const bool closed_before = p.springs.gap < opening, closed_after = p.springs.gap + p.gap_change < opening;
  if (!closed_before && !closed_after) return "open";
  const std::string contact = closed_before && closed_after ? "closed" : closed_before ? "opens" : "closes";
  return contact + (a.energies.friction > 0.0 ? " and slides" : " and sticks");
}

constexpr double largest_force = 3000.0;  // [N] of these paths
constexpr int paths = 4000;

}  // namespace

TEST_CASE("path average: the joint law in small steps along the same path", "[law][path]") {
  std::mt19937 generator(1);
  constexpr int steps = 4000;
  // Midpoint rule: of second order but in the few steps with a kink or jump, each of which counts 1/steps.
  constexpr double tolerance = 4.0 * largest_force / steps;
  for (int i = 0; i < 400; ++i) {
    const Path p = random_path(generator);
    const PathAverage a = average(p);
    const SmallSteps small(p, steps);
    CAPTURE(i, what_happens(p), p.strength.friction, p.strength.cohesion, p.strength.tension, p.springs.normal_damping, p.springs.shear_damping);
    CHECK(std::abs(a.mean.normal - small.normal) < tolerance);
    CHECK(std::abs(a.mean.shear - small.shear) < tolerance);
    CHECK(std::abs(a.end.elastic_shear - (a.end.status == ContactStatus::open ? 0.0 : small.elastic_shear_end)) < tolerance);
  }
}

TEST_CASE("path average: derivatives are those of difference quotients, whatever happens on the way", "[law][path]") {
  std::mt19937 generator(2);
  std::map<std::string, int> compared;
  constexpr double h = 1e-6;
  for (int i = 0; i < paths; ++i) {
    const Path p = random_path(generator);
    for (const double dissipation : {0.0, 0.1}) {
      const auto force = [&](double by_gap, double by_slip) {
        return path_average(p.springs, p.strength, p.gap_change + by_gap, p.slip_change + by_slip, dissipation).mean;
      };
      const ContactForces at = force(0, 0), g1 = force(h, 0), g0 = force(-h, 0), s1 = force(0, h), s0 = force(0, -h);
      // Second derivatives are of the order of a stiffness over the length of a path; a kink of the derivative within h of the point shows as a jump
      // of one-sided quotients and is left out.
      const auto smooth = [&](double before, double now, double after) { return std::abs(after - 2 * now + before) < 1e-2 * h; };
      const double tolerance = 1e-4;  // [N/m] rounding 3000 N * 2^-52/h and curvature
      CAPTURE(i, what_happens(p), dissipation, p.gap_change, p.slip_change);
      if (smooth(g0.normal, at.normal, g1.normal)) CHECK(std::abs(at.normal_by_gap - (g1.normal - g0.normal) / (2 * h)) < tolerance);
      if (smooth(g0.shear, at.shear, g1.shear)) CHECK(std::abs(at.shear_by_gap - (g1.shear - g0.shear) / (2 * h)) < tolerance);
      if (smooth(s0.shear, at.shear, s1.shear)) {
        CHECK(std::abs(at.shear_by_slip - (s1.shear - s0.shear) / (2 * h)) < tolerance);
        ++compared[what_happens(p)];
      }
      CHECK(s1.normal == at.normal);
    }
  }
  for (const char* kind :
       {"closed and sticks", "closed and slides", "opens and sticks", "opens and slides", "closes and sticks", "closes and slides", "open"}) {
    CAPTURE(kind);
    CHECK(compared[kind] > 20);
  }
}

TEST_CASE("path average: the short ways give the same numbers as the pieces", "[law][path]") {
  std::mt19937 generator(6);
  std::map<std::string, int> compared;
  for (int i = 0; i < paths; ++i) {
    const Path p = random_path(generator);
    const PathAverage a = average(p), b = path_average_by_pieces(p.springs, p.strength, p.gap_change, p.slip_change, 0.0);
    CAPTURE(i, what_happens(p), p.gap_change, p.slip_change);
    const auto numbers = [](const PathAverage& x) {
      return std::vector<double>{x.mean.normal,        x.mean.shear,         x.mean.elastic_normal, x.mean.elastic_shear,
                                 x.mean.normal_by_gap, x.mean.shear_by_gap,  x.mean.shear_by_slip,  x.end.normal,
                                 x.end.shear,          x.end.elastic_normal, x.end.elastic_shear,   x.energies.springs,
                                 x.energies.friction,  x.energies.damping,   x.energies.rupture,    x.energies.scheme};
    };
    CHECK(numbers(a) == numbers(b));
    CHECK(a.mean.status == b.mean.status);
    CHECK(a.end.status == b.end.status);
    ++compared[what_happens(p)];
  }
  CHECK(compared["closed and sticks"] > 100);
  CHECK(compared["open"] > 100);
}

TEST_CASE("path average: work is what is stored, rubbed, damped and let go", "[law][path]") {
  std::mt19937 generator(3);
  for (int i = 0; i < paths; ++i) {
    const Path p = random_path(generator);
    for (const double dissipation : {0.0, 0.1}) {
      const PathAverage a = average(p, dissipation);
      const double work = a.mean.normal * p.gap_change + a.mean.shear * p.slip_change;
      const PathEnergies& e = a.energies;
      CAPTURE(i, what_happens(p), dissipation);
      CHECK(std::abs(work + e.springs + e.friction + e.damping + e.rupture + e.scheme) < 1e-11 * largest_force);
      CHECK(e.friction >= 0.0);
      CHECK(e.damping >= -1e-11 * largest_force);
      if (dissipation == 0.0) CHECK(e.scheme == 0.0);
    }
  }
}

TEST_CASE("path average: a spring alone", "[law][path]") {
  const ContactStrength frictionless = strength_of(0.0, 0.0, 0.0);
  SECTION("that stays closed has the mean of its end forces") {
    const PathAverage a = path_average(springs_at(-1.0, 0.0), frictionless, 0.5, 0.0, 0.0);
    CHECK(a.mean.normal == Approx(750.0));
    CHECK(a.mean.normal_by_gap == Approx(-500.0));
    CHECK(a.end.normal == Approx(500.0));
  }
  SECTION("that opens half way has a quarter of its force") {
    const PathAverage a = path_average(springs_at(-1.0, 0.0), frictionless, 2.0, 0.0, 0.0);
    CHECK(a.mean.normal == Approx(250.0));
    CHECK(a.end.status == ContactStatus::open);
    // k (tb^2 - ta^2)/2 for the part of the path from ta to tb that is closed.
    CHECK(a.mean.normal_by_gap == Approx(-125.0));
  }
  SECTION("that closes half way") {
    const PathAverage a = path_average(springs_at(1.0, 0.0), frictionless, -2.0, 0.0, 0.0);
    CHECK(a.mean.normal == Approx(250.0));
    CHECK(a.mean.normal_by_gap == Approx(-375.0));
    CHECK(a.end.normal == Approx(1000.0));
  }
  SECTION("with dissipation 1/2 has the force at the end") {
    CHECK(path_average(springs_at(-1.0, 0.0), frictionless, 0.5, 0.0, 0.5).mean.normal == Approx(500.0));
    CHECK(path_average(springs_at(-1.0, 0.0), frictionless, 2.0, 0.0, 0.5).mean.normal == Approx(0.0).margin(1e-12));
  }
}

TEST_CASE("path average: sticking and sliding", "[law][path]") {
  const ContactStrength rough = strength_of(0.5, 0.0, 0.0);
  SECTION("sticks: mean of the shear forces at both ends") {
    const PathAverage a = path_average(springs_at(-1.0, 100.0), rough, 0.0, 0.5, 0.0);
    CHECK(a.mean.shear == Approx(0.0).margin(1e-12));
    CHECK(a.mean.shear_by_slip == Approx(-200.0));
    CHECK(a.end.elastic_shear == Approx(-100.0));
    CHECK(a.end.status == ContactStatus::sticking);
  }
  SECTION("slides from half the way on") {
    const PathAverage a = path_average(springs_at(-1.0, 0.0), rough, 0.0, 2.5, 0.0);
    CHECK(a.mean.shear == Approx(-375.0));
    CHECK(a.end.shear == Approx(-500.0));
    CHECK(a.end.status == ContactStatus::sliding);
    CHECK(a.energies.friction == Approx(500.0 * 1.25));
  }
  SECTION("opens while it slides: friction falls with the normal force") {
    const PathAverage a = path_average(springs_at(-1.0, -500.0), rough, 2.0, 10.0, 0.0);
    CHECK(a.mean.shear == Approx(-125.0));
    CHECK(a.energies.friction == Approx(1250.0 + 0.5 * 500.0 * 500.0 / 400.0));
  }
  SECTION("a force beyond a bound that has shrunk starts at the bound") {
    const PathAverage a = path_average(springs_at(-1.0, 900.0), rough, 0.0, 0.0, 0.0);
    CHECK(a.mean.shear == Approx(500.0));
  }
}

TEST_CASE("path average: strength that opening takes away goes continuously", "[law][path]") {
  // The end force of a bond under tension falls from -300 N to 0 where it breaks; the mean over the path does not jump.
  const ContactStrength bond = strength_of(0.5, 400.0, 300.0);
  const double breaks_at = 1.3;  // from a gap of -1 m
  const auto normal = [&](double gap_change) { return path_average(springs_at(-1.0, 100.0), bond, gap_change, 0.2, 0.0).mean; };
  const ContactForces before = normal(breaks_at - 1e-9), after = normal(breaks_at + 1e-9);
  CHECK(std::abs(after.normal - before.normal) < 1e-5);
  CHECK(std::abs(after.shear - before.shear) < 1e-5);
  CHECK(before.status != ContactStatus::open);
  CHECK(after.status == ContactStatus::open);
  CHECK(path_average(springs_at(-1.0, 0.0), bond, 2.0, 0.0, 0.0).energies.rupture == Approx(0.5 * 300.0 * 300.0 / 1000.0));
}

TEST_CASE("path average: dashpots", "[law][path]") {
  ContactSprings springs = springs_at(1.0, 0.0);
  springs.normal_damping = 100.0;
  const ContactStrength frictionless = strength_of(0.0, 0.0, 0.0);
  SECTION("work on the closed part of the path only") {
    // Closed for the second half: the spring's 250 N and c/dt times 1 m of closure.
    CHECK(path_average(springs, frictionless, -2.0, 0.0, 0.0).mean.normal == Approx(250.0 + 100.0));
  }
  SECTION("never pull") {
    springs.gap = -1.0;
    springs.normal_damping = 1e6;
    CHECK(path_average(springs, frictionless, 2.0, 0.0, 0.0).mean.normal == 0.0);
  }
}
