#include <cmath>

#include "openclose/analytical/bounce.h"
#include "openclose/analytical/event_ode.h"
#include "openclose/analytical/single_spring.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

Bounce case_d2() {
  return {1.0, std::sqrt(1e8 / 5400.0), 9.81};
}

}  // namespace

TEST_CASE("bounce: the numbers of case D2", "[bounce]") {
  CHECK(case_d2().contact_time() == Approx(0.02332507).epsilon(1e-6));
  CHECK(case_d2().depth() == Approx(0.03308370).epsilon(1e-6));
  CHECK(case_d2().period() == Approx(0.92637235).epsilon(1e-8));
}

TEST_CASE("bounce against the ODE", "[bounce]") {
  for (const Bounce& b : {case_d2(), Bounce{0.01, 40.0, 9.81}, Bounce{0.3, 5.0, 1.6}}) {
    bool closed = false;
    EventOde ode;
    ode.rates = [&](double, const double* y, double* rates) {
      rates[0] = y[1];
      rates[1] = -b.gravity - (closed ? b.frequency * b.frequency * y[0] : 0.0);
    };
    ode.roots = [](double, const double* y, double* values) {
      values[0] = y[0];
      values[1] = y[1];
    };
    ode.root_count = 2;
    ode.absolute_tolerances = {1e-15, 1e-14};
    ode.longest_step = 0.1 * b.contact_time();
    EventIntegration session(ode, 0.0, {b.drop, 0.0});
    double touch = 0.0, deepest = 0.0;
    int touches = 0;
    const double end = b.fall_time() + 3.3 * b.period();
    for (;;) {
      const auto found = session.advance(end);
      if (found.empty()) break;
      if (found.front().root == 0) {
        closed = found.front().direction < 0;
        if (closed && ++touches == 1) touch = session.time();
        if (closed && touches == 2) CHECK(session.time() - touch == Approx(b.period()).epsilon(1e-11));
        if (!closed && touches == 1) CHECK(session.time() - touch == Approx(b.contact_time()).epsilon(1e-11));
        session.restart();
      } else if (closed) {
        deepest = session.y()[0];
      }
      const auto state = b.at(session.time());
      CHECK(state[0] == Approx(session.y()[0]).margin(1e-10 * b.drop));
      CHECK(std::abs(state[1]) == Approx(std::abs(session.y()[1])).margin(1e-9 * b.impact_speed()));
    }
    CHECK(touches == 4);
    CHECK(touch == Approx(b.fall_time()).epsilon(1e-12));
    CHECK(deepest == Approx(-b.depth()).epsilon(1e-11));
    const auto state = b.at(end);
    CHECK(state[0] == Approx(session.y()[0]).epsilon(1e-10));
    CHECK(state[1] == Approx(session.y()[1]).epsilon(1e-10));
  }
}

TEST_CASE("bounce of a stepped spring: its order, and the decay of the spectral radius", "[bounce]") {
  const Bounce b = case_d2();
  const double v0 = b.impact_speed(), contact = b.contact_time();
  // Once round the spring and off it, carried back to y = 0.
  const auto restitution = [&](double theta, int steps) {
    const SteppedRebound r = stepped_rebound(b, theta, contact / steps);
    return std::sqrt(r.velocity * r.velocity + 2 * b.gravity * r.height) / v0;
  };
  for (const int n : {400, 1600}) CHECK(restitution(0.5, n) == Approx(1.0).margin(20.0 / (n * n)));
  for (const int n : {1000, 10000}) {
    const double dt = contact / n;
    const double decay = std::pow(spectral_radius({1.0, b.frequency, dt}), n);
    INFO(n);
    // What decays by the spectral radius is v^2 + w^2 u^2 + (w dt) w u v, to first order; u = g/w^2 is the same at both ends of the contact, v is
    // not.
    const double mixed = 0.5 * b.frequency * dt * b.gravity / (b.frequency * v0);
    CHECK(std::abs(std::log(restitution(1.0, n) / decay)) == Approx(mixed).epsilon(0.1));
  }
}
