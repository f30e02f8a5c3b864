#include <cmath>
#include <limits>
#include <random>

#include "openclose/model/motion.h"
#include "support/catch.h"

using namespace openclose;

namespace {

using Rigid = Motion;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Central differences lose h^2/6 of the third derivative and epsilon/h of the value; both are of size 1 to 10 here.
constexpr double h = 6e-6;
constexpr double quotient_error = 10.0 * (h * h + 4.0 * epsilon / h);

class RandomMotion {
 public:
  Vec2 vector() { return {number_(generator_), number_(generator_)}; }
  Rigid::Unknowns unknowns() { return {number_(generator_), number_(generator_), number_(generator_)}; }

 private:
  std::mt19937 generator_{1};
  std::uniform_real_distribution<double> number_{-2.0, 2.0};
};

}  // namespace

TEST_CASE("sine and cosine are those of the library, by series and beyond", "[model][motion]") {
  for (double angle = -0.05; angle < 0.05; angle += 1.23e-5) {
    const SineCosine found(angle);
    REQUIRE(std::abs(found.sine - std::sin(angle)) <= 2.0 * epsilon * std::abs(angle));
    REQUIRE(std::abs(found.cosine - std::cos(angle)) <= epsilon);
  }
  for (const double angle : {0.0, 1e-9, 1e-300}) CHECK(SineCosine(angle).sine == angle);
}

TEST_CASE("exact rotation is that of the rotation matrix", "[model][motion]") {
  const Vec2 r(0.3, -1.2);
  for (double angle = -7.0; angle < 7.0; angle += 0.1) {
    const Vec2 turned(std::cos(angle) * r.x() - std::sin(angle) * r.y(), std::sin(angle) * r.x() + std::cos(angle) * r.y());
    CHECK((r + Rigid::turned_by(angle, r, RotationKind::exact) - turned).norm() <= 8.0 * epsilon * r.norm());
  }
}

TEST_CASE("the change by a small exact rotation keeps its digits, the second-order ones too", "[model][motion]") {
  const Vec2 r(0.5, 2.0);
  for (const double angle : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const Vec2 change = Rigid::turned_by(angle, r, RotationKind::exact);
    // Across r: angle - angle^3/6; along r: -angle^2/2 (1 - angle^2/12). The product with r cancels to angle^2 of terms of size angle.
    CHECK(cross(r, change) == Approx(r.squaredNorm() * angle * (1.0 - angle * angle / 6.0)).epsilon(1e-12));
    CHECK(std::abs(r.dot(change) + 0.5 * angle * angle * r.squaredNorm()) <= angle * r.squaredNorm() * (4.0 * epsilon + angle * angle * angle));
  }
}

TEST_CASE("linear rotation is the first-order term", "[model][motion]") {
  const Vec2 r(0.5, 2.0);
  CHECK(Rigid::turned_by(0.25, r, RotationKind::linear) == Vec2(-0.5, 0.125));
}

TEST_CASE("points move by translation and rotation", "[model][motion]") {
  const double quarter = 0.5 * 3.14159265358979323846;
  const Vec2 moved = Rigid::displacement({10.0, 20.0, quarter}, {1.0, 0.0}, RotationKind::exact);
  CHECK((moved - Vec2(9.0, 21.0)).norm() < 1e-14);
  CHECK(Rigid::displacement({10.0, 20.0, 0.5}, {1.0, 0.0}, RotationKind::linear) == Vec2(10.0, 20.5));
}

TEST_CASE("gradient and hessian of a point's position are difference quotients", "[model][motion]") {
  RandomMotion random;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec2 reference = random.vector(), m = random.vector();
    const Rigid::Unknowns d = random.unknowns();
    const auto arm = [&](const Rigid::Unknowns& at) { return (reference + Rigid::turned_by(at[2], reference, RotationKind::exact)).eval(); };
    for (int k = 0; k < 3; ++k) {
      Rigid::Unknowns up = d, down = d;
      up[k] += h;
      down[k] -= h;
      const double by_k =
          m.dot(Rigid::displacement(up, reference, RotationKind::exact) - Rigid::displacement(down, reference, RotationKind::exact)) / (2.0 * h);
      CHECK(std::abs(Rigid::gradient(arm(d), m)[k] - by_k) <= quotient_error);
      const Rigid::Unknowns column = (Rigid::gradient(arm(up), m) - Rigid::gradient(arm(down), m)) / (2.0 * h);
      CHECK((Rigid::hessian(arm(d), m).col(k) - column).cwiseAbs().maxCoeff() <= quotient_error);
    }
  }
}

TEST_CASE("no point moves farther than the bound, and some block's point moves nearly as far", "[model][motion]") {
  RandomMotion random;
  double closest = 0.0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Rigid::Unknowns d = random.unknowns();
    const Vec2 r = random.vector();
    const double bound = Rigid::displacement_bound(d, r.norm());
    const double moved = Rigid::displacement(d, r, RotationKind::exact).norm();
    CHECK(moved <= bound * (1.0 + 4.0 * epsilon));
    CHECK(Rigid::displacement(d, r, RotationKind::linear).norm() <= bound * (1.0 + 4.0 * epsilon));
    closest = std::max(closest, moved / bound);
  }
  CHECK(closest > 0.95);
}

TEST_CASE("mass and force in the units of the unknowns", "[model][motion]") {
  CHECK(Rigid::mass(2000.0, 3.0, 0.5) == Rigid::Unknowns(6000.0, 6000.0, 1000.0));
  CHECK(Rigid::largest_force({3.0, -4.0, 2.0}, 1.0) == 5.0);
  CHECK(Rigid::largest_force({3.0, -4.0, -20.0}, 2.0) == 10.0);
}
