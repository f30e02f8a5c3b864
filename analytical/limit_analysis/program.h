// The linear program of one factor: the least artificial force that equilibrium needs besides forces within the strength.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "openclose/limit_analysis/limit_analysis.h"
#include "openclose/limit_analysis/simplex.h"

namespace openclose::limit_analysis {

/// Rows: the equilibrium of each free unknown, in loads of its block (moments over the radius as well). The forces of a contact are its cone's
///   (n, t) = (-tension/F, 0) + a (1, friction/F) + b (1, -friction/F) + q (0, 1),   a, b >= 0,   |q| <= (cohesion - friction tension/F)/F,
/// so that the strength needs no rows. Two artificial forces for each row, one for each sense, have a price; what else there is costs nothing.
class LimitAnalysis::Program {
 public:
  explicit Program(Problem problem);

  Trial at(double factor);
  /// Called often while a program is solved; may throw.
  void set_interruption(std::function<void()> f) { simplex_.set_interruption(std::move(f)); }
  void replace_contacts(std::vector<Contact> contacts);
  const Problem& problem() const { return problem_; }
  int solved() const { return solved_; }

  /// Where the least artificial force of the last infeasible program would vanish if it went on as it is there: a step of Newton's method. It is a
  /// convex function, piecewise linear, of a multiplier of loads, and nearly so of 1/F. 0 where it would not vanish.
  double root() const { return root_; }

 private:
  struct BlockRows {
    int row[3] = {-1, -1, -1};
    double load = 0;    // [N]
    double radius = 0;  // [m]
  };
  struct ContactColumns {
    int first_ray = -1, second_ray = -1, shear = -1;  // -1: not a column
    double unit = 0;                                  // [N] of the forces
  };

  void number_rows();
  void number_columns();
  Eigen::Vector3d in_rows(int block, const Point& point, const Point& force) const;
  /// \param price  of an artificial force
  void build(double factor, double price);
  enum class Way { warm_simplex, barrier, barrier_and_crossover, simplex };
  /// The ways to try, one after the other until forces or mechanism hold.
  std::vector<Way> ways(double factor) const;
  bool solve_by(Way way);
  /// Forces or mechanism of the program that was solved last, if they hold; the forces with errors up to `tolerance`.
  Trial judge(double factor, double tolerance);
  /// The program that was solved last, once more from its basis, with prices so large that they are right; `blunt` where it is not solved.
  Trial sharpened(double factor, Trial blunt);
  Forces forces(double factor) const;
  Mechanism mechanism() const;
  void normalise(Mechanism& mechanism) const;
  double root_of(double factor, double artificial, const Forces& forces, const Mechanism& mechanism) const;
  double slope_by_strength(double factor, const Forces& forces, const Mechanism& mechanism) const;
  double slope_by_live_loads(const Mechanism& mechanism) const;

  Problem problem_;
  std::vector<BlockRows> rows_;
  std::vector<ContactColumns> columns_;
  int row_count_ = 0, column_count_ = 0;
  Simplex simplex_;
  int solved_ = 0;
  double price_ = 1;  // of an artificial force in the program that was solved last
  double root_ = 0;
  double last_factor_ = 0;
  Simplex::Basis basis_;  // of the program of `basis_factor_`
  double basis_factor_ = 0;
};

}  // namespace openclose::limit_analysis
