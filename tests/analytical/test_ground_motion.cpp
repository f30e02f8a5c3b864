#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>

#include "openclose/analytical/ground_motion.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("pieces of ground motion", "[ground_motion]") {
  CHECK(rectangular_pulse(3.0, 0.5).front().acceleration(0.2)[0] == 3.0);
  CHECK(harmonic_motion(2.0, 0.25, 8.0).front().acceleration(1.0)[0] == Approx(2.0));
  const GroundMotion record = record_motion({0.5, 1.0, 1.5}, {1.0, 3.0, -1.0}, {0.0, 0.0, 4.0});
  REQUIRE(record.size() == 2);
  CHECK(record[0].acceleration(0.75)[0] == Approx(2.0));
  CHECK(record[1].acceleration(1.25)[0] == Approx(1.0));
  CHECK(record[1].acceleration(1.25)[1] == Approx(2.0));
  const GroundMotion whole = without_gaps(record, 3.0);
  REQUIRE(whole.size() == 4);
  CHECK(whole.front().from == 0.0);
  CHECK(whole.front().to == 0.5);
  CHECK(whole.front().acceleration(0.1)[0] == 0.0);
  CHECK(whole.back().to == 3.0);
  CHECK_THROWS_AS(record_motion({0.0, 0.0}, {1.0, 1.0}, {1.0, 1.0}), std::invalid_argument);
}

TEST_CASE("the synthetic record", "[ground_motion]") {
  const auto a = synthetic_record(7, 3.0, 10.0, 0.01);
  REQUIRE(a.size() == 1001);
  const auto [low, high] = std::minmax_element(a.begin(), a.end());
  CHECK(std::max(-*low, *high) == Approx(3.0).epsilon(1e-15));
  CHECK(a.front() == 0.0);
  CHECK(a.back() == 0.0);
  CHECK(a == synthetic_record(7, 3.0, 10.0, 0.01));
  CHECK(a != synthetic_record(8, 3.0, 10.0, 0.01));
  // The same motion, however densely it is written: a finer record meets it at every second time, but for its own peak.
  const auto fine = synthetic_record(7, 3.0, 10.0, 0.005);
  for (std::size_t i = 0; i < a.size(); i += 100) CHECK(fine[2 * i] * a[300] == Approx(a[i] * fine[600]).margin(1e-12));
  // It goes on long enough to shake: a third of it above a twentieth of the peak.
  CHECK(std::count_if(a.begin(), a.end(), [](double x) { return std::abs(x) > 0.15; }) > 333);
  CHECK_THROWS_AS(synthetic_record(0, 1.0, 1.0, 0.01), std::invalid_argument);
}

TEST_CASE("the records beside the verification scenes are those of the generator", "[ground_motion]") {
  struct Shipped {
    const char* file;
    unsigned seed;
    double peak;
  };
  for (const Shipped& s : {Shipped{"synthetic_record.csv", 1, 5.0}, Shipped{"synthetic_record_vertical.csv", 2, 2.5}}) {
    const auto expected = synthetic_record(s.seed, s.peak, 5.0, 0.01);
    std::ifstream file(std::string(OPENCLOSE_VERIFICATION_SCENES "/") + s.file);
    std::string line;
    std::getline(file, line);
    std::getline(file, line);
    REQUIRE(line == "time_s,acceleration_m_per_s2");
    std::size_t i = 0;
    for (; std::getline(file, line); ++i) {
      REQUIRE(i < expected.size());
      const std::size_t comma = line.find(',');
      CHECK(std::stod(line.substr(0, comma)) == Approx(0.01 * static_cast<double>(i)).margin(1e-12));
      CHECK(std::stod(line.substr(comma + 1)) == Approx(expected[i]).margin(0.5001e-6));
    }
    CHECK(i == expected.size());
  }
}
