// Scenes that several cases share, built in memory.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness.h"
#include "openclose/analytical/block_on_plane.h"
#include "openclose/analytical/limit_analysis.h"
#include "openclose/scene/scene.h"
#include "support/builders.h"

namespace openclose::verification {

using namespace builders;
using builders::downhill;  // which the one below would hide

/// A contact method with its time integration.
struct Scheme {
  std::string contact;
  std::string variant;           ///< what rows add to the name of the method; empty for what it does by itself
  std::string integrator;        ///< of `soft`; empty: the method has its own
  std::optional<double> weight;  ///< [-] on the forces at the end of the step, in the theta family
  double order = 0.0;            ///< on smooth motion, from theory
  bool conserves = false;        ///< keeps the energy of springs at any step
  std::string why;               ///< the order
  std::string name() const { return contact + (variant.empty() ? "" : " " + variant); }
};
/// All of them: a new one is a line there, and every case and every study that follows motion in time runs with it.
const std::vector<Scheme>& schemes();
/// Those on the springs of the joint, for which references with springs hold.
std::vector<Scheme> spring_schemes();
const Scheme& scheme_named(const std::string& name);
void set_scheme(Scene& scene, const Scheme& scheme);
/// "..., trapezoid", as a name of a check.
std::string with_variant(const std::string& quantity, const Scheme& scheme);

/// [m] That closed forms allow `hard`; scenes ask for a hundredth of it, because contacts whose gaps exclude each other may keep a multiple of what
/// is asked.
inline constexpr double gap_tolerance = 1e-11;

/// [-] Residuals stay below 1e-12 of the largest force. Over a contact that goes like a sine their impulse is at most pi/2 times that part of the
/// impulse exchanged, which is at most twice the momentum: what they may add to velocities that are kept exactly, over the first velocity.
inline constexpr double residual_share = 4e-12;

/// One material "rock", gravity 9.81 downwards, joint without cohesion as the block's; `unloaded` start; no blocks yet.
Scene empty_scene(const analytical::BlockOnPlane& data = {});

/// A fixed plane (as long as asked for downhill, 20 m uphill) and on it the block of `data`, whose lower left corner touches at the origin, falling
/// to the right. Stiffness, friction and density from `data`.
Scene block_on_plane(const analytical::BlockOnPlane& data, double length_downhill = 25.0);

/// Displacement down the plane [m].
double downhill(const analytical::BlockOnPlane& data, const Vec2& displacement);
/// Displacement normal to it, away from it [m].
double off_plane(const analytical::BlockOnPlane& data, const Vec2& displacement);

/// The energy ledger of a run: what it leaves unexplained over its turnover, to the level that rounding of a run of many steps leaves. `done`: the
/// run got to its end.
void check_ledger(Report& report, const std::string& name, const std::string& method, const Simulation& simulation, bool done);

/// Displacements [m] downhill at the output times, of which there must be as many as asked for; else NaN.
std::vector<double> downhill_history(Simulation& simulation, const analytical::BlockOnPlane& data, std::size_t count);
/// Largest difference of two lists.
double largest_difference(const std::vector<double>& a, const std::vector<double>& b);
/// Whether the scene's blocks come to rest: 1 if they do and the fixed blocks carry their weight, 0 if one moves beyond settle.failure_displacement;
/// NaN for any other end.
double stands(const Report& report, const Scene& scene);

/// Where `holds` (1 or 0) changes between a value at which it does not and one at which it does, either of which may be the larger, to `width`; NaN
/// if it does not change so or is NaN on the way.
double threshold(double fails, double holds, double width, const std::function<double(double)>& stands);

/// The factor of safety by strength reduction; NaN if none was found.
double strength_reduction_factor(const Report& report, const Scene& scene);

/// What limit analysis says where sliding does not open joints and the normal forces are those of the program: the repetition of Gilbert, Casapulla
/// and Ahmed (2006), of which the factor of a path at small displacements must be a fixed point. Every contact has the shear strength, whatever its
/// normal force becomes, that the program's normal force at the largest stable factor gives it.
///
/// The program's forces are in equilibrium within that strength: `limit` is not below its factor. At failure blocks slide and open contacts that
/// carry nothing, which is a mechanism of this problem, too: `limit` is not above the factor at which they fail with these normal forces. A factor
/// found too low, because a trial did not get to its equilibrium, is exceeded by the limit by as much. Normal forces change in the last part of the
/// way to failure: the difference of both goes to zero with the width of the bracket.
struct SlidingLimit {
  double factor = not_measured();       ///< [-] of the program, the largest stable one
  double limit = not_measured();        ///< [-]
  double common_area = not_measured();  ///< [-] of blocks that move in both mechanisms, over that of blocks that move in one of them
};
SlidingLimit sliding_limit(const Report& report, const Scene& scene);

/// The multiplier of a load as strength_reduction.increase names it; NaN if none was found.
double load_multiplier(const Report& report, const Scene& scene, const std::string& load);

/// Limit analysis of a scene's blocks, handed over as the text of their file.
analytical::LimitState limit_state(const Scene& scene);

}  // namespace openclose::verification
