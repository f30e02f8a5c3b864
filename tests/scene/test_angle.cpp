#include <cmath>
#include <random>

#include "openclose/scene/angle.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("degrees to radians", "[scene][angle]") {
  CHECK(radians(180.0) == Approx(3.14159265358979323846).epsilon(1e-15));
  CHECK(radians(0.0) == 0.0);
  CHECK(degrees(0.0) == 0.0);
}

TEST_CASE("angles of a file come back as they were written", "[scene][angle]") {
  for (int tenths = 0; tenths < 900; ++tenths) {
    CHECK(degrees(radians(tenths / 10.0)) == tenths / 10.0);
  }
}

TEST_CASE("every angle that came from degrees has degrees that give it exactly", "[scene][angle]") {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> angle(0.0, 90.0);
  for (int i = 0; i < 20000; ++i) {
    const double from_file = radians(angle(generator));
    if (radians(degrees(from_file)) != from_file) FAIL("not exact: " << from_file);
  }
}

TEST_CASE("other angles come back to the last bit", "[scene][angle]") {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> angle(0.0, 1.5);
  for (int i = 0; i < 20000; ++i) {
    const double computed = angle(generator);
    if (std::abs(radians(degrees(computed)) - computed) > computed * 2.3e-16) FAIL("off: " << computed);
  }
}
