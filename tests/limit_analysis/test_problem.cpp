#include <limits>

#include "openclose/limit_analysis/problem.h"
#include "scenes.h"
#include "support/catch.h"

using namespace openclose::limit_analysis;

namespace {

/// Of a block on a horizontal plane that half its friction holds against a horizontal load.
Forces at_rest(double weight, double shear) {
  return {{{weight / 2, -shear / 2}, {weight / 2, -shear / 2}}, {}};
}

Problem pushed_block(double push) {
  Problem problem = block_on_plane(2, 1, 0, 100, 10, 0.5);
  problem.blocks[0].load[0] = push;
  // Through the base, so that both ends carry the same.
  problem.blocks[0].load[2] = push * 0.5;
  return problem;
}

}  // namespace

TEST_CASE("certificates: forces hold in equilibrium within the strength and nowhere else") {
  const Problem problem = pushed_block(30);
  CHECK(check_forces(problem, 2.0, at_rest(100, 30)).holds());
  CHECK(check_forces(problem, 2.001, at_rest(100, 30)).excess > 1e-5);
  CHECK_FALSE(check_forces(problem, 2.001, at_rest(100, 30)).holds());
  CHECK_FALSE(check_forces(problem, 1.0, at_rest(100, 30.001)).holds());
  CHECK_FALSE(check_forces(problem, 1.0, at_rest(100.001, 30)).holds());
  Forces turned = at_rest(100, 30);
  turned.contacts[0].normal += 0.01;
  turned.contacts[1].normal -= 0.01;
  CHECK(std::abs(check_forces(problem, 1.0, turned).unbalanced - 0.02 / (std::hypot(2, 1) / 2 * std::hypot(30, 100))) < 1e-10);
  CHECK_FALSE(check_forces(problem, 1.0, turned).holds());
  turned.contacts[0].normal = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(check_forces(problem, 1.0, turned).holds());
}

TEST_CASE("certificates: tension counts as strength, beyond the tip of the cone, too") {
  Problem problem = block_on_plane(2, 1, 0, 100, 0, 0.5, 300);
  problem.blocks[0].load = {0, 200, 0};
  const Forces hanging{{{-100, 0}, {-100, 0}}, {}};
  // As the contacts of the program have it: who has tensile strength and no cohesion holds a pull.
  CHECK(check_forces(problem, 1.0, hanging).holds());
  CHECK_FALSE(check_forces(problem, 1.51, hanging).holds());
  for (Contact& c : problem.contacts) c.cohesion = 60;
  CHECK(check_forces(problem, 1.0, hanging).holds());
  CHECK(check_forces(problem, 1.5, hanging).holds());
  CHECK_FALSE(check_forces(problem, 1.51, hanging).holds());
  // Shear and pull together: a mixture of the pull of 150 N and of what friction and cohesion carry is not the strength of the law, but within the
  // cone that the bound is of. It narrows to the cone of cohesion and friction where the tension ends before its tip, at F = 1.25.
  const Forces mixed{{{-100, 24}, {-100, 24}}, {}};
  problem.blocks[0].load = {-48, 200, 48 * 0.5};
  CHECK(check_forces(problem, 1.0, mixed).excess <= 0.0);
  CHECK(check_forces(problem, 1.3, mixed).excess > 0.0);
  problem.blocks[0].load = {0, 200, 0};
  // Lifting it: the tension of 2 * 150 N resists at F = 1, though the tip of the cone is at 2 * 120 N.
  const Mechanism up{{{0, 1}, 0}};
  CHECK(std::abs(check_mechanism(problem, 1.0, up).resistance - 300) < 1e-12);
  CHECK(std::abs(check_mechanism(problem, 2.0, up).resistance - 150) < 1e-12);
}

TEST_CASE("certificates: a mechanism proves failure if it is admissible and the loads do more work than the strength") {
  const Problem problem = pushed_block(30);
  // The largest factor is (0.5 * 100 + 10)/30 = 2.
  const auto sliding = [](double factor) { return Mechanism{{{1, 0.5 / factor}, 0}}; };
  CHECK(check_mechanism(problem, 2.001, sliding(2.001)).holds());
  CHECK_FALSE(check_mechanism(problem, 2.0, sliding(2.0)).holds());
  CHECK_FALSE(check_mechanism(problem, 1.999, sliding(1.999)).holds());
  // What opens too little presses the blocks into each other: the work of the loads proves nothing.
  const MechanismCheck flat = check_mechanism(problem, 2.001, sliding(4.0));
  CHECK(flat.work > flat.resistance);
  CHECK_FALSE(flat.holds());
  // Equilibrium would need forces of the loads themselves.
  CHECK((flat.least_force > 0.01 && flat.least_force < 10));
  CHECK_FALSE(check_mechanism(problem, 2.001, {{{1, 0.25}, std::numeric_limits<double>::quiet_NaN()}}).holds());
}

TEST_CASE("certificates: what cannot move, and what a free force holds, must not move in a mechanism") {
  Problem problem = pushed_block(30);
  const Mechanism sliding{{{1, 0.2}, 0}};
  REQUIRE(check_mechanism(problem, 2.5, sliding).holds());
  problem.free_forces.push_back(support(problem.blocks[0], 0, {0, 1}, {1, 0}));
  CHECK_FALSE(check_mechanism(problem, 2.5, sliding).holds());
  problem.free_forces.clear();
  problem.blocks[0].free[0] = false;
  CHECK_FALSE(check_mechanism(problem, 2.5, sliding).holds());
}

TEST_CASE("problem: what cannot be analysed") {
  const Problem good = pushed_block(30);
  CHECK_NOTHROW(check(good));
  const auto refused = [&](auto change) {
    Problem problem = good;
    change(problem);
    CHECK_THROWS_AS(check(problem), std::invalid_argument);
  };
  refused([](Problem& p) { p.blocks[0].load.setZero(); });
  refused([](Problem& p) { p.blocks[0].free = {false, false, false}; });
  refused([](Problem& p) { p.blocks[0].radius = 0; });
  refused([](Problem& p) { p.contacts[0].normal = {1, 1}; });
  refused([](Problem& p) { p.contacts[0].b = 0; });
  refused([](Problem& p) { p.contacts[0].friction = -0.1; });
  refused([](Problem& p) { p.contacts[0].cohesion = std::numeric_limits<double>::infinity(); });
  refused([](Problem& p) { p.free_forces.push_back({0, Eigen::Vector3d::Zero()}); });
}
