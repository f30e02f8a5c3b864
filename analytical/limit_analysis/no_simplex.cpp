// For machines that have no CLP.
#include "openclose/limit_analysis/simplex.h"

namespace openclose::limit_analysis {

class Simplex::Model {};

const unsigned char Simplex::at_lower_bound = 0;
const bool Simplex::available = false;

Simplex::Simplex(double) {}
Simplex::~Simplex() = default;
Simplex::Simplex(Simplex&&) noexcept = default;
Simplex& Simplex::operator=(Simplex&&) noexcept = default;

void Simplex::set_interruption(std::function<void()>) {}

void Simplex::load(const Columns&, const std::vector<double>&) {}

bool Simplex::solve_from(const Basis&) {
  return false;
}

bool Simplex::solve_by_barrier(bool) {
  return false;
}

bool Simplex::solve_from_zero() {
  return false;
}

const double* Simplex::columns() const {
  return nullptr;
}

const double* Simplex::prices() const {
  return nullptr;
}

double Simplex::cost() const {
  return 0.0;
}

Simplex::Basis Simplex::basis() const {
  return {};
}

}  // namespace openclose::limit_analysis
