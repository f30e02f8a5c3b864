#include "openclose/analytical/stacked_blocks.h"

#include <cmath>
#include <numbers>

namespace openclose::analytical {

double largest_overhang(int blocks) {
  double sum = 0;
  for (int k = blocks; k > 0; --k) sum += 0.5 / k;
  return sum;
}

std::vector<double> column_frequencies(int blocks, double mass, double stiffness) {
  std::vector<double> frequencies;
  for (int j = 1; j <= blocks; ++j) {
    frequencies.push_back(2 * std::sqrt(stiffness / mass) * std::sin((2 * j - 1) * std::numbers::pi / (2 * (2 * blocks + 1))));
  }
  return frequencies;
}

std::vector<double> column_shape(int blocks, int mode) {
  std::vector<double> shape;
  for (int i = 1; i <= blocks; ++i) shape.push_back(std::sin(i * (2 * mode - 1) * std::numbers::pi / (2 * blocks + 1)));
  return shape;
}

}  // namespace openclose::analytical
