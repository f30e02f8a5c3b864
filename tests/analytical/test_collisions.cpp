#include <cmath>
#include <numeric>
#include <stdexcept>

#include "openclose/analytical/collisions.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

double momentum(const MassRow& row, const std::vector<double>& v) {
  return std::inner_product(v.begin(), v.end(), row.masses.begin(), 0.0);
}
double energy(const MassRow& row, const std::vector<double>& v) {
  double sum = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) sum += 0.5 * row.masses[i] * v[i] * v[i];
  return sum;
}

}  // namespace

TEST_CASE("elastic collision of two masses: closed form, ODE, duration", "[collisions]") {
  CHECK(elastic_collision({{3.0, 3.0}, {5.0, -1.0}, {0.1}, 1.0}) == std::vector<double>{-1.0, 5.0});
  for (const MassRow& pair :
       {MassRow{{3.0, 3.0}, {5.0, -1.0}, {0.1}, 1e4}, MassRow{{1.0, 7.0}, {2.0, 0.5}, {0.3}, 2e3}, MassRow{{9.0, 0.5}, {1.0, -3.0}, {0.2}, 5e5}}) {
    const auto expected = elastic_collision(pair);
    const double touch = pair.gaps[0] / (pair.velocities[0] - pair.velocities[1]), duration = contact_duration(pair);
    const MassRowState after = elastic_row(pair, touch + duration + 0.01);
    for (int i = 0; i < 2; ++i) CHECK(after.velocities[i] == Approx(expected[i]).epsilon(1e-10));
    // Half-way through they move together.
    const MassRowState middle = elastic_row(pair, touch + 0.5 * duration);
    CHECK(middle.velocities[0] == Approx(middle.velocities[1]).margin(1e-9));
    CHECK(momentum(pair, after.velocities) == Approx(momentum(pair, pair.velocities)).epsilon(1e-12));
    CHECK(energy(pair, after.velocities) == Approx(energy(pair, pair.velocities)).epsilon(1e-10));
  }
  CHECK_THROWS_AS(elastic_collision({{1.0, 1.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0}, 1.0}), std::invalid_argument);
  CHECK_THROWS_AS(elastic_row({{1.0, -1.0}, {0.0, 0.0}, {0.0}, 1.0}, 1.0), std::invalid_argument);
}

TEST_CASE("a row of five: equal masses pass the blow on, others by a tighter tolerance", "[collisions]") {
  // Gaps so wide that every blow is over before the next: the first mass's velocity arrives at the last.
  const MassRow equal{{2.0, 2.0, 2.0, 2.0, 2.0}, {3.0, 0.0, 0.0, 0.0, 0.0}, {0.5, 0.4, 0.3, 0.2}, 1e6};
  const MassRowState passed = elastic_row(equal, 2.0);
  for (int i = 0; i < 4; ++i) CHECK(passed.velocities[i] == Approx(0.0).margin(1e-9));
  CHECK(passed.velocities[4] == Approx(3.0).epsilon(1e-10));
  const MassRow mixed{{2.0, 1.0, 3.0, 0.5, 2.0}, {3.0, 0.0, 0.0, -1.0, 0.0}, {0.02, 0.01, 0.01, 0.005}, 5e3};
  const MassRowState fine = elastic_row(mixed, 0.4, 1e-14), coarse = elastic_row(mixed, 0.4, 1e-8);
  for (int i = 0; i < 5; ++i) CHECK(fine.velocities[i] == Approx(coarse.velocities[i]).margin(1e-5));
  CHECK(momentum(mixed, fine.velocities) == Approx(momentum(mixed, mixed.velocities)).epsilon(1e-12));
}

TEST_CASE("plastic row: common velocities, one after the other", "[collisions]") {
  const MassRow row{{1.0, 1.0, 2.0}, {4.0, 0.0, 0.0}, {1.0, 1.0}, 1.0};
  CHECK(plastic_row(row, 0.2).velocities == std::vector<double>{4.0, 0.0, 0.0});
  CHECK(plastic_row(row, 0.5).velocities == std::vector<double>{2.0, 2.0, 0.0});
  const MassRowState end = plastic_row(row, 1.75);
  for (double v : end.velocities) CHECK(v == Approx(1.0).epsilon(1e-15));
  // Met at 0.25 s and 0.75 s; a second at the common 1 m/s.
  CHECK(end.displacements[0] == Approx(1.0 + 1.0 + 1.0).epsilon(1e-14));
  CHECK(end.displacements[1] == Approx(1.0 + 1.0).epsilon(1e-14));
  CHECK(end.displacements[2] == Approx(1.0).epsilon(1e-14));
  // From both sides.
  const MassRowState pressed = plastic_row({{1.0, 1.0, 1.0}, {1.0, 0.0, -1.0}, {0.5, 0.25}, 1.0}, 5.0);
  for (double v : pressed.velocities) CHECK(v == Approx(0.0).margin(1e-15));
}
