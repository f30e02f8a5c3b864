#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "blocks.h"
#include "openclose/analytical/incline.h"
#include "openclose/analytical/sliding_block_reference.h"
#include "openclose/analytical/stopping_distance.h"
#include "openclose/analytical/two_spring_block.h"
#include "openclose_traps.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

double displacement(const BlockOnPlane& block, const SlidingBlockState& start, double time, const ReferenceOptions& options = {}) {
  SlidingBlockReference reference(block, start, options);
  return reference.advance(time).x;
}

// Error against eq. (8) in per cent at 0.5, 1, 2, 3 s.
std::array<double, 4> errors_percent(const BlockOnPlane& block, const SlidingBlockState& start) {
  SlidingBlockReference reference(block, start);
  std::array<double, 4> errors;
  const auto states = reference.states_at({0.5, 1, 2, 3});
  for (int i = 0; i < 4; ++i) errors[i] = 100 * (states[i].x / sliding_displacement(block, states[i].time) - 1);
  return errors;
}

// Fixed steps, no events: velocity Verlet for the motion, shear spring cut back to its bound after every step. Shares no code with the reference.
struct SteppedBlock {
  BlockOnPlane block;
  double x = 0, y = 0, rotation = 0, vx = 0, vy = 0, omega = 0;
  double slip[2] = {0, 0}, shear[2] = {0, 0};
  double ax = 0, ay = 0, angular = 0;

  void update_forces() {
    const double b = block.width / 2;
    const double h = block.height / 2;
    double fx = block.weight() * std::sin(block.slope_angle);
    double fy = -block.weight() * std::cos(block.slope_angle);
    double moment = 0;
    for (int i = 0; i < 2; ++i) {
      const double rx = i == 0 ? b : -b;
      const double px = std::cos(rotation) * rx + std::sin(rotation) * h;
      const double py = std::sin(rotation) * rx - std::cos(rotation) * h;
      const double normal = std::max(0.0, -block.normal_stiffness * (y + h + py));
      const double bound = block.friction() * normal / block.shear_stiffness;
      shear[i] = std::clamp(shear[i] + (x + px - slip[i]), -bound, bound);
      slip[i] = x + px;
      const double tangential = -block.shear_stiffness * shear[i];
      fx += tangential;
      fy += normal;
      moment += px * normal - py * tangential;
    }
    ax = fx / block.mass();
    ay = fy / block.mass();
    angular = moment / block.moment_of_inertia();
  }

  double run(double end, int steps) {
    const double dt = end / steps;
    slip[0] = block.width / 2;
    slip[1] = -block.width / 2;
    update_forces();
    for (int n = 0; n < steps; ++n) {
      vx += dt / 2 * ax;
      vy += dt / 2 * ay;
      omega += dt / 2 * angular;
      x += dt * vx;
      y += dt * vy;
      rotation += dt * omega;
      update_forces();
      vx += dt / 2 * ax;
      vy += dt / 2 * ay;
      omega += dt / 2 * angular;
    }
    return x;
  }
};

}  // namespace

TEST_CASE("sliding block: start with relaxed shear springs, errors of case B1 (b)") {
  const struct {
    double phi;
    std::array<double, 4> percent;
    double rounding;
  } printed[] = {{10, {0.69, 0.34, 0.17, 0.12}, 0.005001}, {20, {3.95, 1.98, 0.99, 0.66}, 0.005001}, {25, {11.3, 5.65, 2.83, 1.89}, 0.005001}};
  for (const auto& row : printed) {
    const BlockOnPlane block = block_on(30, row.phi);
    const auto errors = errors_percent(block, normal_balanced_start(block));
    for (int i = 0; i < 4; ++i) CHECK(std::abs(errors[i] - row.percent[i]) < (row.percent[i] > 10 ? 0.05 : row.rounding));
  }
}

TEST_CASE("sliding block: gravity dropped on unloaded springs, errors of case B1 (a)") {
  const auto at_20 = errors_percent(block_on(30, 20), unloaded_start());
  const auto at_25 = errors_percent(block_on(30, 25), unloaded_start());
  const double printed_20[] = {0.102, 0.010, 0.009, 0.003};
  const double printed_25[] = {1.77, 0.82, 0.40, 0.26};
  for (int i = 0; i < 4; ++i) {
    CHECK(std::abs(at_20[i] - printed_20[i]) < 5e-4);
    CHECK(std::abs(at_25[i] - printed_25[i]) < 5e-3);
  }
}

TEST_CASE("sliding block: the steady start follows eq. (8)") {
  for (const double phi : {0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 29.0}) {
    const BlockOnPlane block = block_on(30, phi);
    const SlidingBlockState start = steady_sliding_start(block);
    SlidingBlockReference reference(block, start);
    for (const double time : {0.5, 1.0, 2.0, 3.0}) {
      const SlidingBlockState& s = reference.advance(time);
      CHECK(std::abs(s.x / sliding_displacement(block, time) - 1) < 1e-11);
      CHECK(std::abs(s.rotation - start.rotation) < 1e-14);
    }
    CHECK(reference.events().empty());
  }
}

TEST_CASE("sliding block: rotation locked, relaxed start against its closed form") {
  for (const double phi : {5.0, 20.0, 28.0}) {
    BlockOnPlane block = block_on(30, phi);
    block.shear_stiffness = 20e6;
    ReferenceOptions locked;
    locked.rotation_locked = true;
    SlidingBlockReference reference(block, normal_balanced_start(block), locked);
    const RelaxedStart start = relaxed_start(block);
    CHECK(std::abs(reference.advance(start.stick_time / 2).x / relaxed_start_displacement(block, start.stick_time / 2) - 1) < 1e-10);
    for (const double time : {0.5, 3.0}) CHECK(std::abs(reference.advance(time).x / relaxed_start_displacement(block, time) - 1) < 1e-11);
    CHECK(reference.state().rotation == 0.0);
    REQUIRE(reference.events().size() == 2);
    for (const ContactEvent& event : reference.events()) {
      CHECK(event.before == ContactMode::stick);
      CHECK(event.after == ContactMode::slip_downhill);
      CHECK(std::abs(event.time / start.stick_time - 1) < 1e-10);
    }
    const double lead = reference.state().x - sliding_displacement(block, 3.0);
    CHECK(std::abs(lead / relaxed_start_lead(block, 3.0) - 1) < 1e-9);
  }
}

TEST_CASE("sliding block: x + mu y while both corners slip, with bouncing and rotation") {
  for (const double phi : {5.0, 10.0}) {
    const BlockOnPlane block = block_on(30, phi);
    SlidingBlockReference reference(block, unloaded_start());
    double largest_swing = 0;
    for (const double time : {0.003, 0.05, 0.4, 1.0, 3.0}) {
      const SlidingBlockState& s = reference.advance(time);
      CHECK(std::abs(s.x + block.friction() * s.y - sliding_invariant(block, time)) < 1e-12 * (1 + sliding_invariant(block, time)));
      largest_swing = std::max(largest_swing, std::abs(s.rotation));
    }
    CHECK(largest_swing > 1e-6);
    for (const ContactEvent& event : reference.events()) CHECK(event.after != ContactMode::stick);
  }
}

TEST_CASE("sliding block: the unloaded start sticks in the first bounces only where friction is high") {
  const auto sticking_time = [](double phi) {
    SlidingBlockReference reference(block_on(30, phi), unloaded_start());
    reference.advance(3.0);
    // Corners start in slip: each stretch of stick is between two events.
    double sum = 0;
    for (const ContactEvent& event : reference.events()) {
      if (event.after == ContactMode::stick) sum -= event.time;
      if (event.before == ContactMode::stick) sum += event.time;
    }
    return sum;
  };
  CHECK(sticking_time(10) == 0.0);
  CHECK(sticking_time(20) == 0.0);
  CHECK(std::abs(sticking_time(25) - 0.016) < 0.0005);  // the lower corner, once
}

TEST_CASE("sliding block: an event-free stepper converges on the reference") {
  const double end = 0.1;
  for (const double phi : {20.0, 25.0}) {
    const BlockOnPlane block = block_on(30, phi);
    const double exact = displacement(block, unloaded_start(), end);
    const double coarse = std::abs(SteppedBlock{block}.run(end, 20000) - exact);
    const double fine = std::abs(SteppedBlock{block}.run(end, 200000) - exact);
    CHECK(coarse > 1e-12);
    CHECK(fine < coarse / 5);
    CHECK(fine < 1e-8 * exact);
  }
}

TEST_CASE("sliding block: a looser tolerance converges on the tight one") {
  const BlockOnPlane block = block_on(30, 25);
  ReferenceOptions options;
  options.steps_per_period = 20;
  const double exact = displacement(block, unloaded_start(), 3.0);
  std::array<double, 2> errors;
  const std::array<double, 2> tolerances = {1e-6, 1e-10};
  for (int i = 0; i < 2; ++i) {
    options.relative_tolerance = tolerances[i];
    errors[i] = std::abs(displacement(block, unloaded_start(), 3.0, options) / exact - 1);
  }
  CHECK(errors[0] > 1e-10);
  CHECK(errors[1] < 1e-8);
  CHECK(errors[1] < errors[0] / 10);
  options = {};
  options.steps_per_period = 400;
  CHECK(std::abs(displacement(block, unloaded_start(), 3.0, options) / exact - 1) < 1e-10);
}

TEST_CASE("sliding block: energy is kept, friction only takes") {
  for (const double phi : {0.0, 10.0, 20.0, 25.0, 35.0}) {
    const BlockOnPlane block = block_on(30, phi);
    SlidingBlockReference reference(block, unloaded_start());
    const double scale = block.mass() * std::pow(block.normal_weight() / (2 * block.normal_stiffness) * bounce_frequency(block), 2);
    double dissipated = 0;
    for (int i = 1; i <= 60; ++i) {
      const SlidingBlockState& s = reference.advance(0.05 * i);
      CHECK(std::abs(reference.energy()) < 1e-10 * (scale + block.weight() * std::abs(s.x)));
      CHECK(s.dissipated >= dissipated - 1e-12 * scale);
      dissipated = s.dissipated;
    }
    if (phi == 0) {
      CHECK(dissipated == 0.0);
    } else {
      CHECK(dissipated > 1e-3 * scale);
    }
  }
}

TEST_CASE("sliding block: contact laws hold at every output") {
  const BlockOnPlane block = block_on(30, 25);
  SlidingBlockReference reference(block, unloaded_start());
  for (int i = 1; i <= 2000; ++i) {
    const SlidingBlockState& s = reference.advance(1e-4 * i);
    for (int corner = 0; corner < 2; ++corner) {
      const double normal = reference.normal_force(corner);
      const double bound = block.friction() * normal;
      CHECK(normal >= -1e-9 * block.weight());
      CHECK(std::abs(reference.tangential_force(corner)) <= bound + 1e-9 * block.weight());
      CHECK(std::abs(reference.tangential_force(corner) + block.shear_stiffness * s.shear[corner]) < 1e-8 * block.weight());
    }
  }
}

TEST_CASE("sliding block: held above the friction angle, at rest or swinging without end") {
  const BlockOnPlane block = block_on(30, 35);
  SlidingBlockReference reference(block, normal_balanced_start(block));
  double largest = 0;
  for (int i = 1; i <= 100; ++i) largest = std::max(largest, std::abs(reference.advance(0.03 * i).x));
  CHECK(largest > 1e-4);
  CHECK(largest < 2e-2);
  SlidingBlockReference steady(block, steady_sliding_start(block));
  CHECK(steady.state().modes[0] == ContactMode::stick);
  CHECK(steady.state().modes[1] == ContactMode::stick);
  CHECK(steady.advance(0.01).x < 0);  // the stretched springs pull it uphill
}

TEST_CASE("sliding block: thrown on a level plane with rotation locked it stops and rebounds as the closed form says") {
  BlockOnPlane block = block_on(0, 0);
  block.friction_angle = std::atan(0.5);
  ReferenceOptions locked;
  locked.rotation_locked = true;
  for (const double direction : {1.0, -1.0}) {
    SlidingBlockReference reference(block, steady_sliding_start(block, 5 * direction, true), locked);
    const Stop stop = stopping(block, 5, 1);
    const Rebound rebound = rebound_after_stop(block, 5);
    CHECK(std::abs(reference.advance(stop.time).x * direction - stop.distance) < 1e-11);
    for (const double later : {0.001, 0.011, 0.1, 0.5}) {
      const double expected = rebound.centre + rebound.amplitude * std::cos(rebound.frequency * later);
      CHECK(std::abs(reference.advance(stop.time + later).x * direction - expected) < 1e-7 * rebound.amplitude);
    }
    REQUIRE(!reference.events().empty());
    CHECK(std::abs(reference.events()[0].time - stop.time) < 1e-10);
    CHECK(std::abs(reference.state().dissipated / (block.mass() * 12.5) - 1) < 1e-11);
  }
}

TEST_CASE("sliding block: thrown up or down a slope it stops at the rigid distance") {
  const BlockOnPlane block = block_on(20, 30);
  for (const int direction : {1, -1}) {
    const Stop stop = stopping(block, 5, direction);
    SlidingBlockReference reference(block, steady_sliding_start(block, 5.0 * direction));
    CHECK(std::abs(direction * reference.advance(stop.time).x - stop.distance) < 1e-11 * stop.distance);
    reference.advance(stop.time * (1 + 1e-9));
    REQUIRE(!reference.events().empty());
    CHECK(std::abs(reference.events()[0].time / stop.time - 1) < 1e-10);
    // Held there: from then on it only swings on its springs.
    const double scale = block.weight() / block.shear_stiffness;
    for (const double later : {0.05, 0.5, 1.0}) CHECK(std::abs(direction * reference.advance(stop.time + later).x - stop.distance) < 2 * scale);
  }
}

TEST_CASE("sliding block: uphill throw that slides back down") {
  const BlockOnPlane block = block_on(30, 20);
  const Stop up = stopping(block, 2, -1);
  ReferenceOptions locked;
  locked.rotation_locked = true;
  SlidingBlockReference reference(block, steady_sliding_start(block, -2.0, true), locked);
  reference.advance(up.time + 1.0);
  std::vector<ContactMode> modes;
  for (const ContactEvent& event : reference.events()) {
    if (event.corner == 0) modes.push_back(event.after);
  }
  CHECK(modes == std::vector<ContactMode>{ContactMode::stick, ContactMode::slip_downhill});
  // From the turn at the uphill bound the block falls through the spring range, then slides: m v^2/2 is the work done on the way.
  const double bound = block.friction() * block.normal_weight() / (2 * block.shear_stiffness);
  const double pull = block.weight() * std::sin(block.slope_angle);
  const double way = 2 * bound;
  const double slip_velocity = std::sqrt(2 * pull * way / block.mass());  // the spring gives back on one half what it takes on the other
  const double t = reference.events().back().time;
  const double rest = up.time + 1.0 - t;
  const double expected = -up.distance + way + slip_velocity * rest + sliding_displacement(block, rest);
  CHECK(std::abs(reference.state().x - expected) < 1e-10);
}

TEST_CASE("sliding block: small vibration has the frequencies of the two-spring block") {
  BlockOnPlane block = block_on(0, 45);
  // Bounce: 50 periods later the block is back.
  const double static_drop = block.normal_weight() / (2 * block.normal_stiffness);
  SlidingBlockState start = normal_balanced_start(block);
  start.y -= 0.3 * static_drop;
  SlidingBlockReference bounce(block, start);
  const double period = 2 * std::numbers::pi / bounce_frequency(block);
  bounce.advance(50 * period);
  CHECK(std::abs(bounce.state().y / start.y - 1) < 1e-9);
  CHECK(std::abs(bounce.advance(50.5 * period).y / (-0.7 * static_drop) - 1) < 1e-9);
  // Sway-rock: swing released in the lower mode stays in it. Mode shape from the first row of K - w^2 M.
  const double w = sway_rock_frequencies(block)[0];
  const double rotation = 1e-9;
  start = normal_balanced_start(block);
  start.rotation = rotation;
  start.x = -block.shear_stiffness * block.height * rotation / (2 * block.shear_stiffness - w * w * block.mass());
  start.shear.fill(start.x + block.height / 2 * rotation);
  SlidingBlockReference sway(block, start);
  const double swing = 20 * 2 * std::numbers::pi / w;
  CHECK(std::abs(sway.advance(swing).rotation / rotation - 1) < 1e-5);
  CHECK(std::abs(sway.state().x / start.x - 1) < 1e-5);
  CHECK(sway.events().empty());
}

TEST_CASE("sliding block: a drop opens and closes both corners, a spinning one each in turn") {
  BlockOnPlane block = block_on(0, 30);
  SlidingBlockState start;
  start.y = 0.01;
  SlidingBlockReference flat(block, start);
  flat.advance(0.2);
  REQUIRE(flat.events().size() >= 4);
  const double fall = std::sqrt(2 * start.y / block.gravity);
  CHECK(std::abs(flat.events()[0].time - fall) < 1e-12);
  // Contact time of a bounce on K = 2 kn: (2/w)(pi - atan(v0 w/g)).
  const double w = bounce_frequency(block);
  const double contact = 2 / w * (std::numbers::pi - std::atan(block.gravity * fall * w / block.gravity));
  CHECK(flat.events()[2].after == ContactMode::open);
  CHECK(std::abs(flat.events()[2].time - fall - contact) < 1e-11);
  CHECK(std::abs(flat.energy() / (block.weight() * start.y) - 1) < 1e-10);
  start.angular_velocity = 0.1;
  start.velocity_x = 0.3;
  SlidingBlockReference spinning(block, start);
  spinning.advance(1.0);
  CHECK(spinning.events()[0].corner == 1);
  CHECK(spinning.events()[0].before == ContactMode::open);
  CHECK(spinning.events().size() > 10);
  CHECK(std::abs(spinning.energy() - (block.weight() * 0.01 + block.mass() * 0.045 + block.moment_of_inertia() * 0.005)) < 1e-9 * block.weight());
}

TEST_CASE("sliding block: mirrored on a level plane it moves mirrored") {
  const BlockOnPlane block = block_on(0, 25);
  SlidingBlockState start;
  start.y = 0.005;
  start.velocity_x = 0.4;
  start.angular_velocity = 0.05;
  SlidingBlockState mirrored = start;
  mirrored.velocity_x *= -1;
  mirrored.angular_velocity *= -1;
  SlidingBlockReference first(block, start);
  SlidingBlockReference second(block, mirrored);
  for (const double time : {0.05, 0.2, 0.5}) {
    const SlidingBlockState& a = first.advance(time);
    const SlidingBlockState& b = second.advance(time);
    CHECK(std::abs(a.x + b.x) < 1e-11);
    CHECK(std::abs(a.y - b.y) < 1e-11);
    CHECK(std::abs(a.rotation + b.rotation) < 1e-11);
    CHECK(std::abs(a.x) > 1e-3);
  }
}

TEST_CASE("sliding block: a corner that touches at rest is decided by its acceleration, turning included") {
  // The lower corner of a spinning block is at rest on the plane: g'' = -g + omega^2 h/2, s'' = -omega^2 b/2.
  const auto lower_mode = [](double omega, double friction_deg) {
    const BlockOnPlane block = block_on(0, friction_deg);
    SlidingBlockState start;
    start.angular_velocity = omega;
    start.velocity_x = -omega * block.height / 2;
    start.velocity_y = -omega * block.width / 2;
    return SlidingBlockReference(block, start).state().modes[0];
  };
  CHECK(lower_mode(5, 30) == ContactMode::open);         // 12.5 > 9.81
  CHECK(lower_mode(4, 82) == ContactMode::slip_uphill);  // 8 < 9.81; 16/1.81 = tan(83.5 deg)
  CHECK(lower_mode(4, 85) == ContactMode::stick);
  CHECK(lower_mode(1, 7) == ContactMode::stick);  // 1/9.31 = tan(6.13 deg)
  CHECK(lower_mode(1, 5) == ContactMode::slip_uphill);
}

TEST_CASE("sliding block: bad data are refused") {
  BlockOnPlane block = block_on(30, 20);
  SlidingBlockState start = steady_sliding_start(block);
  start.shear[0] *= 1.001;
  CHECK_THROWS_AS(SlidingBlockReference(block, start), std::invalid_argument);
  SlidingBlockReference reference(block, unloaded_start());
  reference.advance(0.1);
  CHECK_THROWS_AS(reference.advance(0.05), std::invalid_argument);
  {
    const openclose::NonStop non_stop;
    CHECK_THROWS_AS(reference.advance(std::nan("")), std::invalid_argument);
  }
  block.density = 0;
  CHECK_THROWS_AS(SlidingBlockReference(block, unloaded_start()), std::invalid_argument);
}
