// Momentum of an iteration that goes the last way once more, by a part of it (Y. Nesterov, 1983).
#pragma once

#include <cmath>

namespace openclose {

/// Grows while it helps, begins anew when the iteration turns against it (B. O'Donoghue and E. Candes, Adaptive restart for accelerated gradient
/// schemes, Found. Comput. Math. 15 (2015) 715-732).
class Momentum {
 public:
  void restart() { age_ = 1.0; }
  /// [-] Of the last way that is gone once more.
  double next() {
    const double last = age_;
    age_ = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * last * last));
    return (last - 1.0) / age_;
  }

 private:
  double age_ = 1.0;
};

}  // namespace openclose
