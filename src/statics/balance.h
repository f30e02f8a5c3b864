// One overdamped increment of a FrozenSystem: find the displacements x of the blocks with
//     R(x) = eps M x - w - B' q(x) = 0,
// M the masses, w the loads, q the contact forces after the increment, eps a viscosity. The limit of small eps is equilibrium, or, where there is
// none, a motion whose velocity x is the acceleration of the rigid blocks divided by eps.
//
// Contact law: N = max(-tension, -k g); T = clip(T0 - k_s s, +-b(N)), b the Coulomb bound of joint_law.h, g the gap, s the slip of the increment. It
// is piecewise linear, and its tangent is not symmetric where contacts slide.
//
// A solution exists for every eps > 0: R is continuous, and x'R(x) > 0 for large x, since every normal spring and every friction force resists a
// large increment (Brouwer's theorem). It need not be unique.
#pragma once

#include <functional>
#include <memory>

#include "openclose/linear/solver.h"
#include "openclose/statics/increment_packs.h"

namespace openclose {

struct BalanceCounters {
  long factorisations = 0;
};

class Balance {
 public:
  Balance(const FrozenSystem& system, const FrozenStrength& strength);

  using Increment = Eigen::VectorXd;  ///< three numbers a block

  /// Sets the state from which the increment is taken, and the viscosity.
  void start(const FrozenState& state, double eps);
  /// Takes the strengths anew, after they have changed.
  void renew_strength(const FrozenState& state);

  /// From x on; true if |R| is down to rounding. `x` is the best found otherwise.
  bool solve(Increment& x);
  /// The same by Newton's method alone.
  bool solve_quickly(Increment& x);
  /// Shi's open-close iteration: linear solutions with the contacts' states, and the friction of sliding ones, as the pass before has left them,
  /// until no state changes; false if passes do not suffice. What friction has changed by in the last pass stays unbalanced for the next increment.
  bool solve_open_close(Increment& x);
  /// With elastic shear springs: the state of blocks whose joints neither slip nor open in shear.
  bool solve_bonded(Increment& x);
  /// [-] of R at x.
  double residual_norm(const Increment& x);
  /// The forces after the increment x.
  void accept(const Increment& x, FrozenState& state, ShearLaw law = ShearLaw::coulomb);
  /// Largest component of an increment.
  static double size(const Increment& x) { return x.size() == 0 ? 0.0 : x.cwiseAbs().maxCoeff(); }

  const BalanceCounters& counters() const { return counters_; }
  /// Called before every factorisation.
  void set_interruption(std::function<void()> f) { interruption_ = std::move(f); }
  /// What is kept from one state to the next: what has been counted, and how the solver rounds.
  void exchange(Archive& archive) {
    archive(counters_.factorisations);
    solver_->exchange(archive, matrix_);
  }

 private:
  /// A block of the matrix to which a contact adds: the products of its forces on one block by the motion of one.
  struct Share {
    int contact;
    bool force_on_b, motion_of_b;
  };

  void evaluate(const Increment& x, ShearLaw law);
  /// Whether the tangent has how friction changes with the normal force, or takes it as a known force.
  enum class Friction { coupled, known };
  void assemble(Friction friction = Friction::coupled);
  void list_shares();
  void mark_stale(int slot);
  void renew(int slot);
  const double* padded(const Increment& x);
  bool factor();
  bool newton(Increment& x, int most_iterations);
  bool convex(Increment& x, ShearLaw law);
  void begin_search(const Increment& x, const Increment& way);
  double slope_at(double part, ShearLaw law) const;
  double search(const Increment& x, const Increment& way, ShearLaw law);
  bool restart(Increment& x);
  double tolerance_at(const Increment& x) const;

  const FrozenSystem& system_;
  const FrozenStrength& strength_;
  std::unique_ptr<LinearSolver> solver_;
  BlockMatrix matrix_;
  IncrementPacks contacts_;
  std::vector<int> share_start_;  ///< of the slots of the matrix, in shares_
  std::vector<Share> shares_;
  std::vector<std::vector<int>> slots_of_contact_;
  std::vector<ContactResponse> assembled_;  ///< with whose tangents the matrix was assembled
  std::vector<char> is_stale_;              ///< slots
  std::vector<int> stale_;
  double assembled_eps_ = -1.0;
  Eigen::VectorXd padded_, forces_;  ///< with the row of fixed blocks
  std::vector<double> support_forces_;
  /// Of what is linear along the way of a line search: the slope of the energy at its start, and the curvature.
  double linear_slope_ = 0.0, curvature_ = 0.0;
  Eigen::VectorXd residual_;
  double eps_ = 1.0;
  BalanceCounters counters_;
  std::function<void()> interruption_;
};

}  // namespace openclose
