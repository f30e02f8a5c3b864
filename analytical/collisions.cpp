#include "openclose/analytical/collisions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "openclose/analytical/event_ode.h"

namespace openclose::analytical {
namespace {

void require_row(const MassRow& row) {
  const std::size_t n = row.masses.size();
  if (n < 2 || row.velocities.size() != n || row.gaps.size() != n - 1) throw std::invalid_argument("as many velocities as masses, one gap less");
  for (double m : row.masses) {
    if (!(m > 0)) throw std::invalid_argument("masses must be positive");
  }
  for (double g : row.gaps) {
    if (!(g >= 0)) throw std::invalid_argument("gaps must not be negative");
  }
  if (!(row.stiffness > 0)) throw std::invalid_argument("the stiffness must be positive");
}

void require_pair(const MassRow& pair) {
  require_row(pair);
  if (pair.masses.size() != 2) throw std::invalid_argument("two masses");
}

}  // namespace

std::vector<double> elastic_collision(const MassRow& pair) {
  require_pair(pair);
  const double m1 = pair.masses[0], m2 = pair.masses[1], v1 = pair.velocities[0], v2 = pair.velocities[1];
  return {((m1 - m2) * v1 + 2 * m2 * v2) / (m1 + m2), ((m2 - m1) * v2 + 2 * m1 * v1) / (m1 + m2)};
}

double contact_duration(const MassRow& pair) {
  require_pair(pair);
  return std::numbers::pi * std::sqrt(pair.masses[0] * pair.masses[1] / ((pair.masses[0] + pair.masses[1]) * pair.stiffness));
}

MassRowState elastic_row(const MassRow& row, double time, double relative_tolerance) {
  require_row(row);
  const std::size_t n = row.masses.size();
  std::vector<bool> closed(n - 1);
  const auto gap = [&](const double* y, std::size_t i) { return row.gaps[i] + y[i + 1] - y[i]; };
  EventOde ode;
  ode.rates = [&](double, const double* y, double* rates) {
    std::copy_n(y + n, n, rates);
    std::fill_n(rates + n, n, 0.0);
    for (std::size_t i = 0; i + 1 < n; ++i) {
      if (!closed[i]) continue;
      const double push = -row.stiffness * gap(y, i);
      rates[n + i] -= push / row.masses[i];
      rates[n + i + 1] += push / row.masses[i + 1];
    }
  };
  ode.roots = [&](double, const double* y, double* values) {
    for (std::size_t i = 0; i + 1 < n; ++i) values[i] = gap(y, i);
  };
  ode.root_count = static_cast<int>(n - 1);
  ode.relative_tolerance = relative_tolerance;
  // A fast mass compresses a contact by v/w; a hundred steps in the shortest vibration keep two events of one contact apart.
  const double frequency = std::sqrt(4 * row.stiffness / *std::min_element(row.masses.begin(), row.masses.end()));
  double speed = 0;
  for (double v : row.velocities) speed = std::max(speed, std::abs(v));
  ode.absolute_tolerances.assign(2 * n, relative_tolerance * speed / frequency);
  std::fill_n(ode.absolute_tolerances.begin() + n, n, relative_tolerance * speed);
  ode.longest_step = 2 * std::numbers::pi / (100 * frequency);

  std::vector<double> y(n, 0.0);
  y.insert(y.end(), row.velocities.begin(), row.velocities.end());
  for (std::size_t i = 0; i + 1 < n; ++i) closed[i] = row.gaps[i] == 0 && row.velocities[i] > row.velocities[i + 1];
  EventIntegration session(ode, 0.0, y);
  for (;;) {
    const std::vector<Crossing> found = session.advance(time);
    if (found.empty()) break;
    for (const Crossing& c : found) closed[c.root] = c.direction < 0;
    session.restart();
  }
  return {{session.y().begin(), session.y().begin() + n}, {session.y().begin() + n, session.y().end()}};
}

MassRowState plastic_row(const MassRow& row, double time) {
  require_row(row);
  const std::size_t n = row.masses.size();
  MassRowState s{std::vector<double>(n, 0.0), row.velocities};
  std::vector<bool> joined(n - 1, false);
  for (double now = 0; now < time;) {
    // Time until the next pair meets.
    double wait = time - now;
    std::size_t next = n;
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double approach = s.velocities[i] - s.velocities[i + 1];
      if (joined[i] || approach <= 0) continue;
      const double t = (row.gaps[i] + s.displacements[i + 1] - s.displacements[i]) / approach;
      if (t <= wait) {
        wait = std::max(t, 0.0);
        next = i;
      }
    }
    for (std::size_t i = 0; i < n; ++i) s.displacements[i] += wait * s.velocities[i];
    now += wait;
    if (next == n) break;
    joined[next] = true;
    std::size_t first = next, last = next + 1;
    while (first > 0 && joined[first - 1]) --first;
    while (last + 1 < n && joined[last]) ++last;
    double mass = 0, momentum = 0;
    for (std::size_t i = first; i <= last; ++i) {
      mass += row.masses[i];
      momentum += row.masses[i] * s.velocities[i];
    }
    for (std::size_t i = first; i <= last; ++i) s.velocities[i] = momentum / mass;
  }
  return s;
}

}  // namespace openclose::analytical
