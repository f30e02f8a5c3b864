#include "openclose/limit_analysis/limit_analysis.h"
#include "scenes.h"
#include "support/catch.h"

using namespace openclose::limit_analysis;

namespace {

constexpr double degree = 3.14159265358979323846 / 180;

/// [-] Of the bracket.
double width(Varied varied, double factor) {
  const double size = std::max(factor, Options().lower_limit), part = varied == Varied::strength ? std::min(1.0, size) : size;
  return std::max(Options().width * part, narrowest_bracket * size);
}

/// Both ends of the bracket, by adding up.
void check_bracket(const Problem& problem, const Bracket& bracket) {
  REQUIRE(bracket.found());
  CHECK(bracket.failed > bracket.factor);
  CHECK(bracket.failed - bracket.factor <= width(problem.varied, bracket.factor));
  CHECK(check_forces(problem, bracket.factor, bracket.forces).holds());
  CHECK(check_mechanism(problem, bracket.failed, bracket.mechanism).holds());
  // The certificates are of these ends: neither holds on the other side.
  CHECK_FALSE(check_forces(problem, bracket.factor * 1.05, bracket.forces).holds());
  CHECK_FALSE(check_mechanism(problem, bracket.factor * 0.95, bracket.mechanism).holds());
}

/// What the tolerance of the forces, in loads, comes to in a factor of about this size.
double slack(double factor) {
  return 10 * force_tolerance * factor;
}

}  // namespace

TEST_CASE("limit analysis: a block on a plane, by friction and cohesion") {
  for (const double slope : {10 * degree, 35 * degree, 60 * degree}) {
    for (const double friction : {0.0, 0.3, 1.2}) {
      for (const double cohesion : {0.0, 20.0, 1e4}) {
        if (friction == 0 && cohesion == 0) continue;
        // Flat, so that it slides before it topples.
        const Problem problem = block_on_plane(10, 1, slope, 100, cohesion, friction);
        const double expected = friction / std::tan(slope) + cohesion / (100 * std::sin(slope));
        const Bracket bracket = limit_analysis(problem);
        check_bracket(problem, bracket);
        CHECK(bracket.factor <= expected + slack(expected));
        CHECK(bracket.failed >= expected - slack(expected));
        CHECK(bracket.programs <= 25);
      }
    }
  }
}

TEST_CASE("limit analysis: the bracket is as narrow for weak joints as for strong ones, in parts of the factor") {
  for (const double friction_angle : {5 * degree, 1 * degree, 0.1 * degree}) {
    for (const double first : {1.0, 1.002 * std::tan(friction_angle)}) {
      const double expected = std::tan(friction_angle);
      const Problem problem = block_on_plane(10, 1, 45 * degree, 100, 0, expected);
      const Bracket bracket = limit_analysis(problem, {.first = first});
      check_bracket(problem, bracket);
      CHECK(bracket.factor <= expected + slack(expected));
      CHECK(bracket.failed >= expected - slack(expected));
      CHECK(bracket.programs <= 25);
    }
  }
}

TEST_CASE("limit analysis: a joint that rounding has made rough bears what a straight one bears") {
  // Far from the origin vertices are rounded to 1e-9 m: the faces along a straight joint are no longer in line.
  const double slope = 35 * degree, expected = std::tan(30 * degree) / std::tan(slope) + 60 / (100 * std::sin(slope));
  for (const int faces : {2, 8, 32}) {
    for (const double rounding : {0.0, 1e-10, 1e-9, 1e-8}) {
      Problem problem = block_on_plane(60, 1, slope, 100, 0, 0);
      problem.contacts.clear();
      const auto rounded = [&](int corner) { return rounding * std::sin(7.0 * corner * corner); };
      const double length = 60.0 / faces;
      for (int face = 0; face < faces; ++face) {
        const double from = rounded(face), to = rounded(face + 1);
        const Point normal = Point(from - to, length).normalized();
        for (const auto& [x, y] : {std::pair(face * length, from), std::pair((face + 1) * length, to)})
          problem.contacts.push_back({0, -1, {x, y}, normal, 60.0 / (2 * faces), std::tan(30 * degree), 0});
      }
      const Bracket bracket = limit_analysis(problem);
      check_bracket(problem, bracket);
      CHECK(bracket.factor <= expected + slack(expected) + rounding);
      CHECK(bracket.failed >= expected - slack(expected) - rounding);
    }
  }
}

TEST_CASE("limit analysis: toppling is no matter of strength without tension") {
  const double tips = std::atan(0.5);
  CHECK(limit_analysis(block_on_plane(1, 2, tips - 1e-5, 1, 1e5, 2)).verdict == Bracket::Verdict::stands_at_every_factor);
  const Bracket falls = limit_analysis(block_on_plane(1, 2, tips + 1e-5, 1, 1e5, 2));
  CHECK(falls.verdict == Bracket::Verdict::no_equilibrium);
  CHECK_FALSE(falls.found());
  CHECK(falls.factor == 0);
}

TEST_CASE("limit analysis: a locked rotation does not topple, a support carries what the plane does not") {
  Problem problem = block_on_plane(1, 4, 30 * degree, 100, 0, 1);
  REQUIRE(limit_analysis(problem).verdict == Bracket::Verdict::no_equilibrium);
  problem.blocks[0].free[2] = false;
  const Bracket locked = limit_analysis(problem);
  check_bracket(problem, locked);
  CHECK(std::abs(locked.factor - 1 / std::tan(30 * degree)) <= Options().width + slack(1));
  problem.blocks[0].free[2] = true;
  problem.free_forces.push_back(support(problem.blocks[0], 0, {0, 2}, {1, 0}));
  CHECK(limit_analysis(problem).verdict == Bracket::Verdict::stands_at_every_factor);
  // A couple keeps it from turning and from nothing else.
  problem.free_forces = {{0, {0, 0, 1}}};
  const Bracket held = limit_analysis(problem);
  check_bracket(problem, held);
  CHECK(std::abs(held.factor - locked.factor) <= Options().width + slack(1));
}

TEST_CASE("limit analysis: one factor at a time") {
  const Problem problem = block_on_plane(10, 1, 30 * degree, 100, 0, 1);
  LimitAnalysis analysis(problem);
  const Trial stands = analysis.at(1.7);
  CHECK(stands.verdict == Verdict::feasible);
  CHECK(check_forces(problem, 1.7, stands.forces).holds());
  const Trial fails = analysis.at(1.74);
  CHECK(fails.verdict == Verdict::infeasible);
  CHECK(check_mechanism(problem, 1.74, fails.mechanism).holds());
  CHECK(std::abs(speed(problem.blocks[0], fails.mechanism[0]) - 1) < 1e-12);
  // Warm programs and contacts that are replaced give what a new analysis gives.
  Problem stronger = problem;
  for (Contact& c : stronger.contacts) c.cohesion = 10;
  analysis.replace_contacts(stronger.contacts);
  const Bracket bracket = analysis.largest_factor();
  check_bracket(stronger, bracket);
  CHECK(std::abs(bracket.factor - limit_analysis(stronger).factor) <= Options().width);
}

TEST_CASE("limit analysis: the wall of Ferris and Tin-Loi's kind, at every size and place, from every first guess") {
  for (const double cohesion : {0.0, 0.3}) {
    const auto wall = [&](double size, const Point& origin) { return tilted_wall(8, 5, 4, 1.75, 15 * degree, cohesion * size, 0.65, size, origin); };
    const Bracket reference = limit_analysis(wall(1, Point::Zero()));
    check_bracket(wall(1, Point::Zero()), reference);
    for (const double size : {1e-3, 1.0, 1e3}) {
      for (const Point& origin : {Point(0, 0), Point(5e6, -3e6)}) {
        const Problem problem = wall(size, origin);
        const Bracket bracket = limit_analysis(problem);
        check_bracket(problem, bracket);
        // Points so far away are known to 1e-9 m.
        const double rounding = origin.isZero() ? 0 : 1e-8 / size;
        CHECK(std::abs(bracket.factor - reference.factor) <= Options().width + slack(reference.factor) + rounding);
      }
    }
    for (const double first : {0.01, 0.5, 3.0, 500.0}) {
      const Bracket bracket = limit_analysis(wall(1, Point::Zero()), {.first = first});
      check_bracket(wall(1, Point::Zero()), bracket);
      CHECK(std::abs(bracket.factor - reference.factor) <= Options().width + slack(reference.factor));
    }
  }
}

TEST_CASE("limit analysis: what is thrown while a program is solved comes out of it, and the next search finds what it would have found") {
  const Problem wall = tilted_wall(16, 10, 4, 1.75, 15 * degree, 0.0, 0.65, 1.0, Point::Zero());
  LimitAnalysis analysis(wall);
  int calls = 0;
  Options options;
  options.interruption = [&] { ++calls; };
  const Bracket whole = analysis.largest_factor(options);
  CHECK(calls > whole.programs);  // within programs, too
  struct Stop {};
  for (const int last : {1, 2, calls / 2, calls}) {
    LimitAnalysis stopped(wall);
    int count = 0;
    options.interruption = [&] {
      if (++count == last) throw Stop();
    };
    CHECK_THROWS_AS(stopped.largest_factor(options), Stop);
    CHECK(count == last);
    options.interruption = {};
    CHECK(stopped.largest_factor(options).factor == Approx(whole.factor).margin(Options().width));
  }
}

TEST_CASE("limit analysis: a sliver among large blocks") {
  // A block on a plane, and on it a chip of a hundred-millionth of its weight that slides at less.
  for (const double weight : {1e-2, 1e-4, 1e-6, 1e-8}) {
    Problem problem = block_on_plane(10, 1, 20 * degree, 1, 0, 1);
    const double size = std::sqrt(weight);
    Block chip;
    chip.centroid = {5, 1 + size / 2};
    chip.load = weight * problem.blocks[0].load;
    chip.radius = size;
    problem.blocks.push_back(chip);
    for (const double x : {5 - size, 5 + size}) problem.contacts.push_back({1, 0, {x, 1}, {0, 1}, 0, 0.5, 0});
    const double expected = 0.5 / std::tan(20 * degree);
    const Bracket bracket = limit_analysis(problem);
    check_bracket(problem, bracket);
    CHECK(std::abs(bracket.factor - expected) <= Options().width + slack(expected));
    // Only the chip moves.
    CHECK(speed(problem.blocks[0], bracket.mechanism[0]) < 1e-6);
  }
}

namespace {

/// A block on a plane that its own weight pushes sideways: a horizontal load, downhill.
Problem pushed_block(double b, double h, double slope, double cohesion, double friction) {
  Problem problem = block_on_plane(b, h, slope, 100, cohesion, friction);
  problem.blocks[0].live = 100 * Eigen::Vector3d(std::cos(slope), std::sin(slope), 0);
  problem.varied = Varied::live_loads;
  return problem;
}

}  // namespace

TEST_CASE("limit analysis: the multiplier of a horizontal load on a block on a plane") {
  for (const double slope : {0.0, 10 * degree, 30 * degree}) {
    for (const double friction : {0.7, 1.2}) {
      for (const double cohesion : {0.0, 20.0, 1e4}) {
        const Problem problem = pushed_block(100, 1, slope, cohesion, friction);
        const double cosine = std::cos(slope), sine = std::sin(slope);
        const double slides = (friction * cosine - sine + cohesion / 100) / (cosine + friction * sine);
        const double tips = (100 * cosine - sine) / (cosine + 100 * sine);
        const double expected = std::min(slides, tips);
        const Bracket bracket = limit_analysis(problem);
        check_bracket(problem, bracket);
        CHECK(bracket.factor <= expected + slack(1 + expected));
        CHECK(bracket.failed >= expected - slack(1 + expected));
        CHECK(bracket.programs <= 25);
      }
    }
  }
}

TEST_CASE("limit analysis: the multiplier at which a block tips, in any unit of the load") {
  for (const double unit : {1e-3, 1.0, 1e4}) {
    Problem problem = pushed_block(1, 4, 0, 0, 2);
    problem.blocks[0].live *= unit;
    Options options;
    options.upper_limit = 1e7;
    const Bracket bracket = limit_analysis(problem, options);
    check_bracket(problem, bracket);
    CHECK(bracket.factor * unit == Approx(0.25).epsilon(2e-5 + 10 * force_tolerance));
  }
}

TEST_CASE("limit analysis: loads that have no largest multiplier, and such that do not stand without it") {
  // Pressed on, it never slides; uphill of friction it slides before any load is there.
  Problem pressed = pushed_block(100, 1, 0, 0, 0.5);
  pressed.blocks[0].live = {0, -100, 0};
  CHECK(limit_analysis(pressed).verdict == Bracket::Verdict::stands_at_every_factor);
  const Bracket slides = limit_analysis(pushed_block(100, 1, 30 * degree, 0, 0.5));
  CHECK(slides.verdict == Bracket::Verdict::no_equilibrium);
  CHECK(slides.failed == 0);
  CHECK(check_mechanism(pushed_block(100, 1, 30 * degree, 0, 0.5), 0, slides.mechanism).holds());
  // At the limit of friction the load has nothing left to take.
  const double slope = 20 * degree;
  const Bracket nothing = limit_analysis(pushed_block(100, 1, slope, 0, std::tan(slope) * (1 + 1e-9)));
  CHECK(nothing.found());
  CHECK(nothing.failed < 1e-6);
}

TEST_CASE("limit analysis: a wall falls at the multiplier whose gravity a wall with its strength just bears") {
  const double friction = 0.65, multiplier = [&] {
    Problem wall = tilted_wall(5, 4, 0.4, 0.2, 0, 0, friction);
    for (Block& block : wall.blocks) block.live = Eigen::Vector3d(-block.load.y(), 0, 0);
    wall.varied = Varied::live_loads;
    const Bracket bracket = limit_analysis(wall);
    check_bracket(wall, bracket);
    return bracket.factor;
  }();
  CHECK(multiplier > 0.1);
  CHECK(multiplier < friction);
  // Without cohesion only the direction of gravity counts.
  LimitAnalysis below(tilted_wall(5, 4, 0.4, 0.2, std::atan(multiplier * (1 - 1e-4)), 0, friction));
  LimitAnalysis above(tilted_wall(5, 4, 0.4, 0.2, std::atan(multiplier * (1 + 1e-4)), 0, friction));
  CHECK(below.at(1).verdict == Verdict::feasible);
  CHECK(above.at(1).verdict == Verdict::infeasible);
}
