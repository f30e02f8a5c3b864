#include <cmath>
#include <stdexcept>

#include "openclose/analytical/newmark_block.h"
#include "openclose/analytical/sliding_block_reference.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

BlockOnPlane block_with(double slope_deg, double friction) {
  BlockOnPlane block;
  block.slope_angle = slope_deg * degree;
  block.friction_angle = std::atan(friction);
  return block;
}

}  // namespace

TEST_CASE("slip under a pulse: the numbers of case C1, and the ODE", "[newmark]") {
  CHECK(pulse_slip(block_with(0.0, 0.1), 0.4 * 9.81, 0.5).distance == Approx(1.47150).epsilon(1e-14));
  for (const double friction : {0.1, 0.3}) {
    for (const double pulse : {3.5, 8.0}) {
      for (const double duration : {0.2, 1.0}) {
        const BlockOnPlane block = block_with(0.0, friction);
        const PulseSlip expected = pulse_slip(block, pulse, duration);
        // The ground goes to the right, the block stays behind.
        const NewmarkMotion motion = newmark_block(block, rectangular_pulse(pulse, duration), {expected.stop_time + 1.0});
        CHECK(motion.states.back().x == Approx(-expected.distance).epsilon(1e-12));
        CHECK(motion.states.back().velocity == 0.0);
        REQUIRE(motion.events.size() == 2);
        CHECK(motion.events[0].direction == -1);
        CHECK(motion.events[0].time == 0.0);
        CHECK(motion.events[1].time == Approx(expected.stop_time).epsilon(1e-12));
      }
    }
  }
  CHECK_THROWS_AS(pulse_slip(block_with(10.0, 0.5), 8.0, 1.0), std::domain_error);
  CHECK_THROWS_AS(pulse_slip(block_with(0.0, 0.5), 4.9, 1.0), std::domain_error);
}

TEST_CASE("slip under harmonic shaking: the numbers of case C2, and the ODE", "[newmark]") {
  BlockOnPlane block = block_with(20.0, std::tan(25 * degree));
  const CycleSlip c = harmonic_slip(block, 0.3 * 9.81, 2.0);
  CHECK(c.yield / 9.81 == Approx(0.0874887).epsilon(1e-6));
  CHECK(c.start == Approx(0.0235493).epsilon(1e-5));
  CHECK(c.end == Approx(0.3544027).epsilon(1e-6));
  CHECK(c.distance == Approx(0.0556108469).epsilon(1e-9));
  for (const double slope : {20.0, 23.0}) {
    for (const double amplitude : {1.5, 2.5}) {
      for (const double frequency : {0.7, 2.0}) {
        block.slope_angle = slope * degree;
        if (slope == 23.0 && amplitude == 2.5) continue;  // it would not stop within the cycle
        const CycleSlip expected = harmonic_slip(block, amplitude, frequency);
        const double period = 1.0 / frequency;
        // Downhill inertia A sin: the ground moves to the left on a plane that falls to the right.
        const NewmarkMotion motion = newmark_block(block, harmonic_motion(-amplitude, frequency, 3.0 * period), {period, 2.0 * period});
        CHECK(motion.states[0].x == Approx(expected.distance).epsilon(1e-11));
        CHECK(motion.states[1].x == Approx(2.0 * expected.distance).epsilon(1e-11));
        REQUIRE(motion.events.size() >= 4);
        CHECK(motion.events[0].time == Approx(expected.start).epsilon(1e-11));
        CHECK(motion.events[1].time == Approx(expected.end).epsilon(1e-11));
        CHECK(motion.events[2].time == Approx(expected.start + period).epsilon(1e-11));
      }
    }
  }
  CHECK_THROWS_AS(harmonic_slip(block_with(30.0, 0.3), 3.0, 2.0), std::domain_error);
  CHECK_THROWS_AS(harmonic_slip(block_with(20.0, std::tan(25 * degree)), 20.0, 2.0), std::domain_error);
}

TEST_CASE("Newmark's block on a record: tolerance, steady acceleration, both directions", "[newmark]") {
  const auto a = synthetic_record(3, 6.0, 4.0, 0.02);
  std::vector<double> times, vertical;
  for (std::size_t i = 0; i < a.size(); ++i) {
    times.push_back(0.02 * static_cast<double>(i));
    vertical.push_back(-0.4 * a[a.size() - 1 - i]);
  }
  const GroundMotion ground = record_motion(times, a, vertical);
  const BlockOnPlane block = block_with(5.0, 0.2);
  const auto fine = newmark_block(block, ground, {1.0, 2.0, 4.5}, 1e-14), coarse = newmark_block(block, ground, {1.0, 2.0, 4.5}, 1e-9);
  for (int i = 0; i < 3; ++i) CHECK(fine.states[i].x == Approx(coarse.states[i].x).epsilon(1e-7));
  bool down = false, up = false, stick = false;
  for (const NewmarkEvent& e : fine.events) {
    down |= e.direction > 0;
    up |= e.direction < 0;
    stick |= e.direction == 0 && e.time > 0.0;
  }
  CHECK((down && up && stick));

  // Constant acceleration: x = (s - mu n) t^2/2.
  const auto steady = newmark_block(block, rectangular_pulse(-4.0, 10.0), {2.0});
  const double sine = std::sin(5 * degree), cosine = std::cos(5 * degree);
  CHECK(steady.states[0].x == Approx(0.5 * 4.0 * (9.81 * sine + 4.0 * cosine - 0.2 * (9.81 * cosine - 4.0 * sine))).epsilon(1e-12));
  // Below the bound nothing moves.
  CHECK(newmark_block(block, rectangular_pulse(0.5, 1.0), {2.0}).states[0].x == 0.0);
  CHECK_THROWS_AS(newmark_block(block_with(5.0, 0.5), record_motion({0.0, 1.0}, {0.0, 0.0}, {0.0, -20.0}), {1.0}), std::domain_error);
}

TEST_CASE("the block on springs under shaking: gravity turned, energy at rest, and Newmark's block as springs stiffen",
          "[newmark][sliding_block_reference]") {
  // A steady horizontal acceleration is another gravity: the same motion in a turned field.
  BlockOnPlane level = block_with(0.0, 0.3), turned = block_with(25.0, 0.3);
  const double a = level.gravity * std::tan(25 * degree);
  turned.gravity = std::hypot(level.gravity, a);
  const auto shaken = SlidingBlockReference(level, unloaded_start()).follow(rectangular_pulse(-a, 1.0), {0.05, 0.3});
  const auto inclined = SlidingBlockReference(turned, unloaded_start()).states_at({0.05, 0.3});
  for (int i = 0; i < 2; ++i) {
    CHECK(shaken[i].x == Approx(inclined[i].x).epsilon(1e-9));
    CHECK(shaken[i].y == Approx(inclined[i].y).epsilon(1e-9));
    CHECK(shaken[i].rotation == Approx(inclined[i].rotation).epsilon(1e-9));
  }

  const BlockOnPlane soft = block_with(20.0, std::tan(25 * degree));
  const double rigid = harmonic_slip(soft, 0.3 * 9.81, 2.0).distance;
  std::vector<double> errors;
  for (const double stiffness : {5e8, 5e9}) {
    BlockOnPlane block = soft;
    block.normal_stiffness = block.shear_stiffness = stiffness;
    ReferenceOptions locked;
    locked.rotation_locked = true;
    auto start = normal_balanced_start(block);
    start.shear.fill(block.weight() * std::sin(block.slope_angle) / (2 * stiffness));
    SlidingBlockReference reference(block, start, locked);
    const auto states = reference.follow(harmonic_motion(-0.3 * 9.81, 2.0, 1.0), {0.5, 1.0});
    errors.push_back(std::abs(states[1].x - states[0].x - rigid));
  }
  CHECK(errors[0] / errors[1] == Approx(10.0).margin(5.0));
}
