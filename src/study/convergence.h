// What a quantity tends to as the time step goes to zero, and how fast.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace openclose {

/// A quantity, computed with a step.
struct Refinement {
  double dt = 0.0;  ///< [s]
  double value = 0.0;
};

struct Limit {
  double value = 0.0;
  double order = 0.0;  ///< with which it is approached
};

/// Richardson's extrapolation (L. F. Richardson, 1911) from the three smallest steps h1 > h2 > h3 with h1/h2 = h2/h3 = r: the value q(h) = q + C h^p
/// gives r^p = (q1 - q2)/(q2 - q3) and q = q3 + (q3 - q2)/(r^p - 1). None if there are not three, their ratios differ, q2 and q3 differ by rounding,
/// or the differences shrink slower than with order 0.5 or faster than with order 3: then these steps say nothing of a limit. Of four steps or more
/// the order of the three before the last one must be the same to within a half. \param refinements  by falling steps
std::optional<Limit> richardson_limit(std::span<const Refinement> refinements);

/// Order between neighbouring steps, log(e1/e2) / log(h1/h2), where both errors are above zero; the first has none. Orders above 3 are left out, too:
/// the smaller of the two errors is small by chance. So are those of two errors that differ by rounding.
/// \param size  of the result that the errors are of
std::vector<std::optional<double>> observed_orders(std::span<const double> steps, std::span<const double> errors, double size);

}  // namespace openclose
