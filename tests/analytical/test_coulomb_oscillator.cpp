#include <cmath>
#include <numbers>
#include <stdexcept>

#include "openclose/analytical/coulomb_oscillator.h"
#include "openclose/analytical/newmark_block.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("coulomb oscillator: values of case B10") {
  const CoulombRest rest = coulomb_oscillator({5400, 1e6, 0.2 * 5400 * 9.81, 0.1});
  CHECK(rest.half_cycles == 5);
  CHECK(std::abs(rest.place - 0.005948) < 5e-7);
  CHECK(std::abs(rest.time - 1.1542948) < 5e-8);
}

TEST_CASE("coulomb oscillator: followed in small steps it stops at the same place and time") {
  for (const double start : {0.3, -0.17, 0.05}) {
    const CoulombOscillator o{2.0, 50.0, 1.3, start};
    const CoulombRest rest = coulomb_oscillator(o);
    double x = start, v = 0.0, t = 0.0;
    const double dt = 1e-5;
    int turns = 0;
    while (std::abs(o.stiffness * x) > o.friction) {
      // One half cycle, whose friction is against the way back to the middle.
      const double friction = x > 0 ? o.friction : -o.friction;
      do {
        v += dt * (friction - o.stiffness * x) / o.mass;
        x += dt * v;
        t += dt;
      } while (v * friction < 0);
      v = 0.0;
      ++turns;
    }
    CHECK(turns == rest.half_cycles);
    // Each turn is found a step late, and the semi-implicit steps lag by half a step.
    CHECK(std::abs(x - rest.place) < 1e-4);
    CHECK(std::abs(t - rest.time) < 2 * dt * (turns + 1));
  }
}

TEST_CASE("coulomb oscillator: what friction holds does not move, what has no friction is refused") {
  CHECK(coulomb_oscillator({1, 1, 1, 0.9}).place == 0.9);
  CHECK(coulomb_oscillator({1, 1, 1, 0.9}).half_cycles == 0);
  CHECK(coulomb_oscillator({1, 1, 1, -0.9}).place == -0.9);
  CHECK_THROWS_AS(coulomb_oscillator({1, 1, 0, 1}), std::invalid_argument);
}

namespace {

BlockOnPlane block_on_level() {
  BlockOnPlane block;
  block.slope_angle = 0;
  block.friction_angle = std::atan(0.2);
  return block;
}

}  // namespace

TEST_CASE("coulomb oscillator: the ODE with its events stops where and when the closed form does") {
  const BlockOnPlane block = block_on_level();
  const CoulombOscillator oscillator{block.mass(), 1e6, block.friction() * block.weight(), 0.1};
  const CoulombRest rest = coulomb_oscillator(oscillator);
  const NewmarkMotion motion = newmark_block(block, {}, {0.5 * rest.time, 2 * rest.time}, 1e-13, {1e6 / block.mass(), 0.1});
  REQUIRE(motion.states.size() == 2);
  CHECK(std::abs(motion.states[1].x - rest.place) < 1e-11);
  REQUIRE_FALSE(motion.events.empty());
  CHECK(motion.events.back().direction == 0);
  CHECK(std::abs(motion.events.back().time - rest.time) < 1e-9);
}

TEST_CASE("driven coulomb oscillator: Den Hartog's amplitude is that to which the ODE with its events comes") {
  const BlockOnPlane block = block_on_level();
  const double stiffness = 1e6, own = std::sqrt(stiffness / block.mass()), pull = 4.0;
  for (const double ratio : {0.7, 1.3}) {
    const double frequency = ratio * own, period = 2 * std::numbers::pi / frequency;
    std::vector<double> times;
    for (int i = 0; i <= 400; ++i) times.push_back(period * (60 + i / 400.0));
    double farthest = 0;
    const GroundMotion ground = harmonic_motion(pull, frequency / (2 * std::numbers::pi), 61 * period);
    for (const NewmarkState& state : newmark_block(block, ground, times, 1e-12, {stiffness / block.mass()}).states)
      farthest = std::max(farthest, std::abs(state.x));
    const double amplitude = driven_amplitude({block.mass(), stiffness, block.friction() * block.weight(), 0}, block.mass() * pull, frequency);
    // A crest between two samples is missed by at most (pi/400)^2/2 of the acceleration there, which is below four times the amplitude.
    CHECK(std::abs(farthest / amplitude - 1) < 2e-4);
  }
  CHECK_THROWS_AS(driven_amplitude({1, 1, 10, 0}, 1, 0.7), std::domain_error);
}
