#include <gsl/gsl_eigen.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "openclose/analytical/two_spring_block.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

// Generalised eigenvalues of K, M by GSL.
std::array<double, 2> frequencies_by_gsl(const BlockOnPlane& block) {
  const double b = block.width;
  const double h = block.height;
  gsl_matrix* stiffness = gsl_matrix_calloc(2, 2);
  gsl_matrix* mass = gsl_matrix_calloc(2, 2);
  gsl_matrix_set(stiffness, 0, 0, 2 * block.shear_stiffness);
  gsl_matrix_set(stiffness, 0, 1, block.shear_stiffness * h);
  gsl_matrix_set(stiffness, 1, 0, block.shear_stiffness * h);
  gsl_matrix_set(stiffness, 1, 1, block.normal_stiffness * b * b / 2 + block.shear_stiffness * h * h / 2 - block.weight() * h / 2);
  gsl_matrix_set(mass, 0, 0, block.mass());
  gsl_matrix_set(mass, 1, 1, block.moment_of_inertia());
  gsl_vector* squares = gsl_vector_alloc(2);
  gsl_eigen_gensymm_workspace* workspace = gsl_eigen_gensymm_alloc(2);
  gsl_eigen_gensymm(stiffness, mass, squares, workspace);
  const double first = std::sqrt(gsl_vector_get(squares, 0));
  const double second = std::sqrt(gsl_vector_get(squares, 1));
  gsl_eigen_gensymm_free(workspace);
  gsl_vector_free(squares);
  gsl_matrix_free(mass);
  gsl_matrix_free(stiffness);
  return {std::min(first, second), std::max(first, second)};
}

}  // namespace

TEST_CASE("two-spring block: values of case D3") {
  const BlockOnPlane block;
  CHECK(std::abs(bounce_frequency(block) - 136.083) < 5e-4);
  CHECK(std::abs(sway_rock_frequencies(block)[0] - 116.668) < 5e-4);
  CHECK(std::abs(sway_rock_frequencies(block)[1] - 245.867) < 5e-4);
  CHECK(std::abs(critical_explicit_step(block) - 0.00813447) < 5e-9);
}

TEST_CASE("two-spring block: closed form against GSL") {
  const double cases[][5] = {{2, 1, 50e6, 50e6, 2700}, {0.5, 2, 50e6, 20e6, 2500}, {1, 1, 1e7, 3e8, 2000}, {8, 0.3, 4e5, 1e5, 3000}};
  for (const auto& [b, h, kn, ks, rho] : cases) {
    BlockOnPlane block;
    block.width = b;
    block.height = h;
    block.normal_stiffness = kn;
    block.shear_stiffness = ks;
    block.density = rho;
    const auto expected = frequencies_by_gsl(block);
    const auto found = sway_rock_frequencies(block);
    for (int i = 0; i < 2; ++i) CHECK(std::abs(found[i] / expected[i] - 1) < 1e-12);
    CHECK(highest_frequency(block) >= bounce_frequency(block));
    CHECK(highest_frequency(block) >= found[1]);
  }
}

TEST_CASE("two-spring block: a plate of no height sways and rocks apart") {
  BlockOnPlane block;
  block.height = 1e-9;
  const auto found = sway_rock_frequencies(block);
  const double sway = std::sqrt(2 * block.shear_stiffness / block.mass());
  CHECK(std::abs(found[0] / sway - 1) < 1e-7);
  CHECK(std::abs(found[1] / (sway * std::sqrt(3.0)) - 1) < 1e-7);  // kn b^2/2 over m b^2/12
}

TEST_CASE("two-spring block: springs too soft for the weight buckle") {
  BlockOnPlane block;
  block.width = 0.5;
  block.height = 2;
  const double buckling = block.weight() * block.height / (block.width * block.width);  // kn b^2/2 = W h/2
  block.normal_stiffness = buckling * 1.001;
  CHECK(sway_rock_frequencies(block)[0] < 0.1 * sway_rock_frequencies(block)[1]);
  block.normal_stiffness = buckling * 0.999;
  CHECK_THROWS_AS(sway_rock_frequencies(block), std::domain_error);
}
