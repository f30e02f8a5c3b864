// Critical time step of the explicit method: the longest for which central difference is stable in linear vibration.
//
// With stiffness K, dashpots C (whose velocity is half a step old) and mass M a step h is stable while h^2 K + 2 h C < 4 M, which without dashpots is
// h < 2/w_max. Two numbers that bound the eigenvalues of M^-1 K and M^-1 C from above, a and b, give the step a h^2 + 2 b h = 4. Local damping adds
// -alpha |F| sign(v) to the unbalanced force F, which holds the forces of springs and dashpots: it acts as both being stiffer by the share alpha, at
// most, so that a and b are to be multiplied by 1 + alpha.
//
// They come from a bound of Gershgorin's kind, by blocks: what a contact stores, k (x_1 + x_2)^2/2 with x_i the parts of its two blocks in the
// closure, is at most the sum of k (1 + m_1/m_2) x_1^2/2 and k (1 + m_2/m_1) x_2^2/2, so that no eigenvalue exceeds the largest one of a single block
// with its contacts stiffened so (not at all against a fixed block). The factor makes it exact for two blocks on one spring, and for blocks on fixed
// ones. Power iteration was the other choice: it comes nearer, but from the unsafe side (6 passes: 5 % too long), and takes some fifty passes over
// the contacts, which the run pays again whenever they change; the bound takes one. Measured on the paper's examples 3.3 and 3.4: 0.93 and 0.94 of
// 2/w_max (0.00238 of 0.00256 s, 0.000814 of 0.000863 s), and never more than it.
#pragma once

#include <vector>

#include "openclose/integrator/enforcement.h"

namespace openclose {

/// Whether a contact is closed or closes when its blocks approach by `approach` [m].
inline bool may_close(const ContactStrength& strength, double normal_stiffness, double gap, double approach) {
  return gap <= strength.tension / normal_stiffness + approach;
}

/// What a contact adds to one of its blocks. Normal, tangent and lever may be taken in any frame that turns with the block, the same for all its
/// contacts.
struct StiffnessPart {
  int equation;                              ///< of the block
  double share;                              ///< 1 + m/m_other
  Vec2 normal;                               ///< of the contact
  Vec2 arm;                                  ///< [m] from the block's centroid to the corner
  double normal_stiffness, shear_stiffness;  ///< [N/m]
  double normal_dashpot, shear_dashpot;      ///< [N s/m]
};

/// The bound, kept up to date contact by contact: a change costs its two blocks, and of those only blocks are solved that may decide. Sliding counts
/// as sticking.
class CriticalStepBound {
 public:
  /// The blocks with their supports, no contacts.
  void begin(const StepProblem& problem);
  /// Puts a contact's part on its block, or takes it away again with sign = -1.
  void add(const StiffnessPart& part, double sign = 1.0);
  /// [s], infinite if nothing holds any block.
  /// \param local_damping  [-] alpha
  double step(double local_damping = 0.0);
  void exchange(Archive& archive) { archive(scales_, stiffness_, damping_, damped_, changed_, stiffest_, most_damped_); }
  /// Whether what was read is of so many blocks.
  bool fits(std::size_t blocks) const { return scales_.size() == blocks && stiffness_.size() == blocks && damping_.size() == blocks; }
  std::size_t bytes() const { return bytes_of(scales_, stiffness_, damping_); }

 private:
  /// Of one block, symmetric, for unknowns scaled by the root of the mass; the largest eigenvalue is found when it is asked for.
  struct Matrix {
    double xx = 0.0, xy = 0.0, yy = 0.0, xr = 0.0, yr = 0.0, rr = 0.0;
    double largest = -1.0;  ///< [1/s2] or [1/s]; negative: not known
    double bound() const;   ///< of the largest eigenvalue: the largest sum of a row
    double largest_eigenvalue() const;

    void exchange(Archive& archive) {
      auto& [a, b, c, d, e, f, g] = *this;
      archive(a, b, c, d, e, f, g);
    }
  };
  struct Scale {
    double mass, moment, lever;  ///< 1/m, 1/I, 1/sqrt(m I); the last two 0 if the rotation is locked

    void exchange(Archive& archive) {
      auto& [a, b, c] = *this;
      archive(a, b, c);
    }
  };
  void add(Matrix& matrix, const Scale& scale, const StiffnessPart& part, double normal, double shear);
  static double largest(std::vector<Matrix>& matrices);

  std::vector<Scale> scales_;
  std::vector<Matrix> stiffness_, damping_;
  bool damped_ = false, changed_ = true;       ///< since the two numbers below were found
  double stiffest_ = 0.0, most_damped_ = 0.0;  ///< [1/s2], [1/s] a and b
};

}  // namespace openclose
