// Linear programs: least cost of columns within bounds whose rows have given sums. CLP solves them; a build without CLP solves none.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace openclose::limit_analysis {

/// The columns of a linear program, filled one after the other.
class Columns {
 public:
  static constexpr double infinity = std::numeric_limits<double>::max();  ///< as a bound: none (COIN_DBL_MAX)

  void add(double low, double high, double cost);
  /// An entry of the column that was added last, unless the row is negative or the value zero.
  void enter(int row, double value);

  int count() const { return static_cast<int>(low_.size()); }

 private:
  friend class Simplex;
  std::vector<double> low_, high_, cost_, values_;
  std::vector<int> starts_, rows_;
};

/// One linear program after the other.
class Simplex {
 public:
  /// The status of each column and each row at a solution.
  using Basis = std::vector<unsigned char>;
  static const unsigned char at_lower_bound;

  /// False in a build without CLP: nothing is ever solved.
  static const bool available;

  /// \param tolerance [-] of rows and of reduced costs
  explicit Simplex(double tolerance);
  ~Simplex();
  Simplex(Simplex&&) noexcept;
  Simplex& operator=(Simplex&&) noexcept;

  /// Called every few iterations of the simplex methods from now on; what it throws ends the program and comes out of it.
  void set_interruption(std::function<void()> f);

  void load(const Columns& columns, const std::vector<double>& right_side);

  /// Ways to solve what was loaded; false if the solution is not proved to be the best. From a basis near the one of the solution:
  bool solve_from(const Basis& basis);
  /// From the middle; with the crossover to a basis or without.
  bool solve_by_barrier(bool with_crossover);
  /// From columns that are all zero, by the dual method.
  bool solve_from_zero();

  /// Of the solution: the columns, the prices of the rows, the cost.
  const double* columns() const;
  const double* prices() const;
  double cost() const;
  Basis basis() const;

 private:
  class Model;
  class Listener;
  std::unique_ptr<Model> model_;
};

}  // namespace openclose::limit_analysis
