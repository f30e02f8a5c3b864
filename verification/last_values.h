// Values that the program itself gave, so that a change of a result that stays within its check's tolerance is noticed. last_values.csv lists the
// rows of verify.csv that are watched; only what has a physical meaning and does not hang on rounding belongs there. A line may be added with any
// value (its name, not its number, says what is watched); `openclose-verify --renew-last-values` then writes the numbers. To be renewed only with a
// reason that the commit gives.
#pragma once

#include <string>
#include <vector>

#include "harness.h"

namespace openclose::verification {

struct LastValue {
  std::string case_name;
  std::string quantity;
  std::string method;
  double value = 0.0;
  double relative_tolerance = 0.0;  ///< [-]
};

/// \throws std::runtime_error for a file that cannot be read, naming the line
std::vector<LastValue> read_last_values(const std::string& path);
void write_last_values(const std::string& path, const std::vector<LastValue>& values);

/// Takes over what was measured, for the rows that were run; returns how many changed.
int renew(std::vector<LastValue>& values, const std::vector<Check>& checks);

/// Adds a check for each value whose case was run. One whose row is not there any more fails.
void compare(Report& report, const std::vector<LastValue>& values);

}  // namespace openclose::verification
