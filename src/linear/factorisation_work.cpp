#include "openclose/linear/factorisation_work.h"

#include "openclose/linear/row_factor.h"

namespace openclose {

double products_of_factorisation(const BlockMatrix& matrix, Factoring factoring) {
  RowFactor factor;
  std::vector<LeftOut> left_out;
  plan_factor(matrix, factored_slots(matrix, factoring), factor, left_out);
  double products = 0.0;
  for (int k = 0; k < factor.rows(); ++k) {
    const double above = factor.row_start[k + 1] - factor.diagonal[k] - 1;
    products += above * (above + 1.0) + 1.0;
  }
  return products;
}

}  // namespace openclose
