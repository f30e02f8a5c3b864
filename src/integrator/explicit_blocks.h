// The blocks in the loop of the explicit method: what has changed of them since they were loaded, the forces on them, and their motion by these. One
// slot for each free block, in the order of their equations, one for all that are fixed, and then one for each block at rest.
#pragma once

#include <vector>

#include "openclose/core/archive.h"
#include "openclose/core/memory.h"
#include "openclose/integrator/enforcement.h"
#include "openclose/model/energies.h"

namespace openclose {

/// Displacement since the load, in one line of cache with the rotation's cosine and sine: once a block, not a contact.
struct alignas(32) ExplicitPose {
  double x = 0.0, y = 0.0;  ///< [m]
  double cos_minus_1 = 0.0, sin = 0.0;

  void exchange(Archive& archive) {
    auto& [a, b, c, d] = *this;
    archive(a, b, c, d);
  }
};

struct alignas(32) ExplicitRate {
  double x = 0.0, y = 0.0, turn = 0.0;  ///< velocity [m/s, m/s, rad/s], or force [N, N, N m]
  double angle = 0.0;                   ///< [rad] since the load; of velocities only

  void exchange(Archive& archive) {
    auto& [a, b, c, d] = *this;
    archive(a, b, c, d);
  }
};

struct ExplicitInertia {
  double mass, moment;          ///< [kg], [kg m2]
  double per_mass, per_moment;  ///< their inverses
  double turns;                 ///< 0 if the rotation is locked, else 1
  double weight_x, weight_y;    ///< [N]
  double radius;                ///< [m]

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g, h] = *this;
    archive(a, b, c, d, e, f, g, h);
  }
};

/// How a step moves the blocks.
struct ExplicitMotion {
  double h;              ///< [s] the step
  double span;           ///< [s] between the middles of the last and this step
  Vec2 base;             ///< [m/s2] mean acceleration of the base over it
  double local_damping;  ///< [-] `local`, see central_difference.h
  double viscous;        ///< [1/s] `automatic`
};

class ExplicitBlocks {
 public:
  using Unknowns = Motion::Unknowns;

  /// With velocities of the middle of the last step.
  void load(const StepProblem& problem);
  int count() const { return static_cast<int>(inertia_.size()); }  ///< of free blocks
  int fixed_slot() const { return count(); }
  /// Of block b of the system.
  int slot(const BlockSystem& system, int b) const { return system.block(b).equation >= 0 ? system.block(b).equation : rest_slot_[b]; }
  const ExplicitPose& pose(int slot) const { return poses_[slot]; }
  const ExplicitRate& rate(int slot) const { return rates_[slot]; }
  const ExplicitPose* poses() const { return poses_.data(); }
  const ExplicitRate* rates() const { return rates_.data(); }
  ExplicitRate* forces() { return forces_.data(); }

  /// The forces are the weights, until others are added.
  void begin_forces();
  struct Trial {
    double farthest;           ///< [m] no block moves by more in the step
    double unbalanced_square;  ///< [N2] of the largest force on a block
  };
  /// Finds the velocities of the middle of a step; nothing else changes.
  Trial try_motion(const ExplicitMotion& motion);
  struct Work {
    double kinetic_change;  ///< [J]
    double mass_damping;    ///< [J] taken by damping of the motion
  };
  /// Moves by the velocities of the last try_motion().
  Work advance(const ExplicitMotion& motion, EnergyLedger& energies);
  /// [m/s2, m/s2, rad/s2] By the forces, without damping; 0 of what does not move.
  ExplicitRate acceleration(int slot, const Vec2& base) const;

  /// Ways are counted from here.
  void mark_way();
  double farthest_way() const;  ///< [m] of any point of a block since then

  /// [N] Largest; on blocks that are much lighter than the heaviest weight [N] it counts for more, see emphasis_at_rest(). 0: all forces alike.
  double unbalanced_force(double heaviest) const;
  /// At the end of a step with this motion, half a step after the middle that the rates are of.
  Unknowns velocity_at_end(int equation, const ExplicitMotion& motion) const;
  /// [W] Of all forces but weights.
  double power() const;
  /// [N, N m] On the blocks that were at rest at the load, in the system's order.
  void rest_forces(std::vector<Unknowns>& forces) const;
  /// Moves the blocks of the system to where they are now, with the velocities of the middle of the last step.
  void store(BlockSystem& system) const;

  std::size_t bytes() const { return bytes_of(poses_, rates_, next_rates_, forces_, inertia_, blocks_, rest_slot_, loaded_at_, marked_at_); }
  void exchange(Archive& archive) { archive(poses_, rates_, next_rates_, forces_, inertia_, blocks_, rest_slot_, loaded_at_, marked_at_); }
  /// Whether what was read is of these blocks.
  bool fits(const BlockSystem& system) const;
  bool has_slot(int slot) const { return slot >= 0 && slot < static_cast<int>(poses_.size()); }

 private:
  double force_squared(std::size_t i) const;  ///< [N2] on a block, a moment counting at the block's radius

  struct Way {
    double x, y, angle;

    void exchange(Archive& archive) {
      auto& [a, b, c] = *this;
      archive(a, b, c);
    }
  };

  std::vector<ExplicitPose> poses_;
  std::vector<ExplicitRate> rates_, next_rates_, forces_;
  std::vector<ExplicitInertia> inertia_;
  std::vector<int> blocks_;          ///< of the system, per free block
  std::vector<int> rest_slot_;       ///< per block of the system; of others than those at rest the one of fixed blocks
  std::vector<Unknowns> loaded_at_;  ///< displacement of the free blocks at the load
  std::vector<Way> marked_at_;       ///< since the load
};

}  // namespace openclose
