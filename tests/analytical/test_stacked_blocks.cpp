#include <gsl/gsl_eigen.h>

#include <algorithm>
#include <cmath>

#include "openclose/analytical/stacked_blocks.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("overhang of a stack") {
  CHECK(std::abs(largest_overhang(4) - 1.041667) < 5e-7);
  CHECK(std::abs(largest_overhang(10) - 1.464484) < 5e-7);
  // The blocks' ends, from the top: the centroid of the k upper ones lies over the edge of the next.
  for (const int n : {1, 3, 12}) {
    double end = 0, moment = 0;  // of the right end from the top's, of the centroids so far
    for (int k = 1; k <= n; ++k) {
      moment += end - 0.5;
      end = moment / k;  // the next edge lies under the common centroid
    }
    CHECK(std::abs(-end - largest_overhang(n)) < 1e-14);
  }
}

TEST_CASE("column of masses: closed form against GSL") {
  for (const int n : {1, 2, 5, 12}) {
    const double mass = 2700, stiffness = 3e7;
    gsl_matrix* k = gsl_matrix_calloc(n, n);
    for (int i = 0; i < n; ++i) {
      gsl_matrix_set(k, i, i, (i + 1 < n ? 2 : 1) * stiffness / mass);
      if (i + 1 < n) gsl_matrix_set(k, i, i + 1, -stiffness / mass);
      if (i + 1 < n) gsl_matrix_set(k, i + 1, i, -stiffness / mass);
    }
    gsl_vector* squares = gsl_vector_alloc(n);
    gsl_eigen_symm_workspace* workspace = gsl_eigen_symm_alloc(n);
    gsl_eigen_symm(k, squares, workspace);
    std::vector<double> found;
    for (int i = 0; i < n; ++i) found.push_back(std::sqrt(gsl_vector_get(squares, i)));
    std::sort(found.begin(), found.end());
    gsl_eigen_symm_free(workspace);
    gsl_vector_free(squares);
    gsl_matrix_free(k);
    const auto expected = column_frequencies(n, mass, stiffness);
    for (int i = 0; i < n; ++i) CHECK(std::abs(found[i] / expected[i] - 1) < 1e-11);
  }
}

TEST_CASE("column of masses: the shapes satisfy the equations of motion") {
  const int n = 6;
  const auto w = column_frequencies(n, 1, 1);
  for (int j = 1; j <= n; ++j) {
    const auto x = column_shape(n, j);
    for (int i = 0; i < n; ++i) {
      const double below = i > 0 ? x[i - 1] : 0, above = i + 1 < n ? x[i + 1] : x[i];
      CHECK(std::abs((2 * x[i] - below - above) - w[j - 1] * w[j - 1] * x[i]) < 1e-13);
    }
  }
}
