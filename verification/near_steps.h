// Errors of motions with events that fall anywhere within a step.
#pragma once

#include <cmath>

#include "harness.h"

namespace openclose::verification {

/// A method of second order changes between sticking and sliding at the end of a step, a part p of it late. That costs a velocity of order dt^2 times
/// a factor that depends on p, beside the smooth error of order dt^2 of the integration; the two may have opposite signs, so that at some steps they
/// cancel and the error of a single one tells no order. Over steps that differ by a few per cent p takes all values: their largest error falls as
/// dt^2. All of them divide `every`.
template <class Error>
double largest_error_near(double dt, double every, Error error_at) {
  double largest = 0.0;
  for (const double part : {1.0, 1.03, 1.07, 1.12, 1.18}) largest = larger(largest, error_at(every / std::round(part * every / dt)));
  return largest;
}

}  // namespace openclose::verification
