// What the verification cases rest on: NaN fails every kind of row, bounds hold from both sides, and rows are counted by what they are compared with.
#include <cmath>
#include <vector>

#include "harness.h"
#include "openclose_traps.h"
#include "support/catch.h"

using namespace openclose::verification;

namespace {

int passed(const Report& report) {
  int count = 0;
  for (const Check& c : report.checks()) count += c.status == Status::pass;
  return count;
}

}  // namespace

TEST_CASE("a row that was not measured fails, whatever its kind", "[harness]") {
  const openclose::NonStop non_stop;
  Report report(false);
  const double none = not_measured();
  report.near("", "soft", 0.0, none, 1e300, "m", "");
  report.near("", "soft", 0.0, 0.0, none, "m", "");
  report.relative("", "soft", 1.0, none, 1e300, "m", "");
  report.between("", "soft", -1e300, 1e300, none, "m", "");
  report.order("", "soft", {1.0, 0.5}, {0.1, none}, -10.0, 10.0, "");
  CHECK(passed(report) == 0);
  CHECK(report.checks().size() == 5);
}

TEST_CASE("one NaN in a history is its largest value, wherever it comes", "[harness]") {
  const openclose::NonStop non_stop;
  for (const int at : {0, 1, 2}) {
    std::vector<double> values = {1.0, 2.0, 3.0};
    values[at] = not_measured();
    double worst = 0.0, least = 10.0;
    for (const double value : values) {
      worst = larger(worst, value);
      least = smaller(least, value);
    }
    CHECK(std::isnan(worst));
    CHECK(std::isnan(least));
    CHECK(std::isnan(largest(values)));
  }
  CHECK(largest({1.0, 3.0, 2.0}) == 3.0);
  CHECK(smaller(1.0, 2.0) == 1.0);
  CHECK(smaller(2.0, 1.0) == 1.0);
  CHECK(larger(1.0, 2.0) == 2.0);
  CHECK(larger(2.0, 1.0) == 2.0);
  CHECK(std::isnan(exceedance(not_measured(), 1.0)));
  CHECK(exceedance(3.0, 1.0) == 2.0);
  CHECK(exceedance(0.5, 1.0) == 0.0);
}

TEST_CASE("rows are bounded from both sides", "[harness]") {
  for (const double sign : {-1.0, 1.0}) {
    Report report(false);
    report.near("", "soft", 1.0, 1.0 + sign * 0.09, 0.1, "m", "");
    report.relative("", "soft", 2.0, 2.0 * (1.0 + sign * 0.09), 0.1, "m", "");
    report.between("", "soft", 0.9, 1.1, 1.0 + sign * 0.09, "m", "");
    CHECK(passed(report) == 3);
    report.near("", "soft", 1.0, 1.0 + sign * 0.11, 0.1, "m", "");
    report.relative("", "soft", 2.0, 2.0 * (1.0 + sign * 0.11), 0.1, "m", "");
    report.between("", "soft", 0.9, 1.1, 1.0 + sign * 0.11, "m", "");
    CHECK(passed(report) == 3);
  }
}

TEST_CASE("rows that passed are counted by what they are compared with", "[harness]") {
  Report report(false);
  report.begin_case("X1", Reference::invariance);
  report.near("", "soft", 0.0, 0.0, 1.0, "m", "");
  report.against(Reference::ode).near("", "soft", 0.0, 0.0, 1.0, "m", "");
  report.near("", "soft", 0.0, 0.0, 1.0, "m", "");
  report.against(Reference::ledger).near("", "soft", 0.0, 2.0, 1.0, "m", "");
  report.leave_out("", "soft", "");
  report.begin_case("X2");
  report.near("", "soft", 0.0, 0.0, 1.0, "m", "");
  CHECK(passed_by_reference(report.checks()) == "1 closed forms, 1 ODEs, 2 invariance");
}
