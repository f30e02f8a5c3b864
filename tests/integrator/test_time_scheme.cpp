#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "openclose/integrator/time_scheme.h"
#include "support/catch.h"

using namespace openclose;

namespace {

using Scheme = TimeScheme;
using Unknowns = Scheme::Unknowns;

const std::vector<double> uneven_steps = {0.1, 0.03, 0.25, 0.01, 0.01, 0.7};

/// Displacement of a step under the mean force per mass theta f1 + (1 - theta) f0.
Unknowns displacement(const Scheme& scheme, double dt, const Unknowns& v, const Unknowns& force) {
  return dt * v + force / scheme.inertia(dt);
}

/// All schemes there are, with theta over its range.
std::unique_ptr<Scheme> scheme_number(int i) {
  if (i == 0) return make_midstep_scheme();
  return make_theta_scheme(0.4 + 0.1 * i);
}
constexpr int scheme_count = 7;

/// x'' = -w^2 x from x = 1 at rest, n steps to the end; the error of x there.
double oscillator_error(Scheme& scheme, int n) {
  const double w = 3.0, end = 1.0, dt = end / n, theta = scheme.end_weight();
  double x = 1.0;
  Unknowns v = Unknowns::Zero();
  for (int i = 0; i < n; ++i) {
    const double k = scheme.inertia(dt);
    const double d = (k * dt * v[0] - w * w * x) / (k + theta * w * w);
    v = scheme.next_velocity(0, dt, Unknowns(d, 0.0, 0.0), v);
    scheme.accept(dt);
    x += d;
  }
  return std::abs(x - std::cos(w * end));
}

}  // namespace

TEST_CASE("constant forces are integrated exactly whatever the steps", "[integrator][time_scheme]") {
  const auto scheme = scheme_number(GENERATE(range(0, scheme_count)));
  const Unknowns v0(2.0, -1.0, 0.5), a(0.3, -9.81, -0.7);
  Unknowns x = Unknowns::Zero(), v = v0;
  double t = 0.0;
  for (const double dt : uneven_steps) {
    const Unknowns d = displacement(*scheme, dt, v, a);
    const Unknowns at_end = scheme->velocity_at_end(0, dt, d, v);
    v = scheme->next_velocity(0, dt, d, v);
    scheme->accept(dt);
    x += d;
    t += dt;
    // A few roundings of numbers of the order of 10 per step.
    CHECK((x - (v0 * t + 0.5 * t * t * a)).norm() < 1e-13);
    CHECK((at_end - (v0 + t * a)).norm() < 1e-13);
  }
}

TEST_CASE("the velocity after a step belongs to the step really taken", "[integrator][time_scheme]") {
  const auto theta = make_theta_scheme(0.7);
  const Unknowns v(1.0, 2.0, 3.0), d(0.01, 0.02, -0.01);
  CHECK(theta->next_velocity(0, 0.1, d, v) == Unknowns(2.0 / 0.1 * d - v));
  CHECK(theta->next_velocity(0, 0.05, d, v) == Unknowns(2.0 / 0.05 * d - v));
  const auto midstep = make_midstep_scheme();
  midstep->accept(0.1);
  CHECK(midstep->next_velocity(0, 0.05, d, v) == Unknowns(d / 0.05));
}

TEST_CASE("a step that is thrown away leaves no trace in the scheme", "[integrator][time_scheme]") {
  const auto scheme = make_midstep_scheme();
  CHECK(scheme->inertia(0.2) == Approx(2.0 / (0.2 * 0.2)).epsilon(1e-15));
  scheme->accept(0.1);
  scheme->next_velocity(0, 5.0, Unknowns::Ones(), Unknowns::Ones());
  CHECK(scheme->inertia(0.2) == Approx(1.0 / (0.2 * 0.15)).epsilon(1e-15));
}

TEST_CASE("forces times work displacement is the change of kinetic energy", "[integrator][time_scheme]") {
  const auto scheme = scheme_number(GENERATE(range(0, scheme_count)));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto vector = [&] { return Unknowns(number(random), number(random), number(random)); };
  Unknowns v = vector();
  for (const double dt : uneven_steps) {
    const Unknowns force = 10.0 * vector();
    const Unknowns d = displacement(*scheme, dt, v, force);
    const Unknowns path = scheme->work_displacement(0, dt, d, v), next = scheme->next_velocity(0, dt, d, v);
    const double turnover = force.cwiseProduct(path).cwiseAbs().sum() + v.squaredNorm() + next.squaredNorm();
    CHECK(std::abs(0.5 * (next.squaredNorm() - v.squaredNorm()) - force.dot(path)) < 1e-13 * turnover);
    v = next;
    scheme->accept(dt);
  }
}

TEST_CASE("observed order on an oscillator", "[integrator][time_scheme]") {
  const auto order = [](const auto& make) { return std::log2(oscillator_error(*make(), 200) / oscillator_error(*make(), 400)); };
  CHECK(order([] { return make_theta_scheme(1.0); }) == Approx(1.0).margin(0.05));
  CHECK(order([] { return make_theta_scheme(0.75); }) == Approx(1.0).margin(0.05));
  CHECK(order([] { return make_theta_scheme(0.5); }) == Approx(2.0).margin(0.05));
  // A force taken at the end of the step moves a velocity from mid-step to mid-step: it comes half a step late.
  CHECK(order([] { return make_midstep_scheme(); }) == Approx(1.0).margin(0.05));
}

TEST_CASE("the trapezoid keeps the energy of an oscillator, Newmark (1/2, 1) loses it as known", "[integrator][time_scheme]") {
  const double w = 3.0, dt = 0.1, theta = GENERATE(0.5, 0.6, 1.0);
  const auto scheme = make_theta_scheme(theta);
  double x = 1.0;
  Unknowns v = Unknowns::Zero();
  double lost = 0.0;
  for (int i = 0; i < 50; ++i) {
    const double k = scheme->inertia(dt);
    const double d = (k * dt * v[0] - w * w * x) / (k + theta * w * w);
    v = scheme->next_velocity(0, dt, Unknowns(d, 0.0, 0.0), v);
    x += d;
    lost += (theta - 0.5) * w * w * d * d;
  }
  const double energy = 0.5 * (v[0] * v[0] + w * w * x * x);
  CHECK(energy == Approx(0.5 * w * w - lost).epsilon(1e-13));
}
