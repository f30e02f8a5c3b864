#include "openclose/limit_analysis/simplex.h"

namespace openclose::limit_analysis {

void Columns::add(double low, double high, double cost) {
  low_.push_back(low);
  high_.push_back(high);
  cost_.push_back(cost);
  starts_.push_back(static_cast<int>(values_.size()));
}

void Columns::enter(int row, double value) {
  if (row < 0 || value == 0) return;
  rows_.push_back(row);
  values_.push_back(value);
}

}  // namespace openclose::limit_analysis
