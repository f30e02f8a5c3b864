// Scenes that several cases share, built in memory.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "harness.h"
#include "openclose/analytical/block_on_plane.h"
#include "openclose/analytical/limit_analysis.h"
#include "openclose/scene/scene.h"

namespace openclose::verification {

inline const std::array<std::string, 4> all_methods = {"soft", "hard", "shi", "dem"};

/// A way of stepping contacts with springs: what `method.contact` and `method.theta` are to be, and its order in dt.
struct ElasticScheme {
  const char* contact;
  double theta;
  double order;
};
/// All of them: a new one is a line here, and every case that follows springs in time runs with it.
inline constexpr std::array elastic_schemes = {ElasticScheme{"soft", 1.0, 1.0}, ElasticScheme{"soft", 0.5, 2.0}, ElasticScheme{"shi", 1.0, 1.0},
                                               ElasticScheme{"dem", 1.0, 2.0}};
void set_scheme(Scene& scene, const ElasticScheme& scheme);
/// "..., theta = 0.5", as a name of a check.
std::string with_theta(const std::string& quantity, const ElasticScheme& scheme);

/// [m] That closed forms allow `hard`; scenes ask for a hundredth of it, because contacts whose gaps exclude each other may keep a multiple of what is asked.
inline constexpr double gap_tolerance = 1e-11;

/// One material "rock", gravity 9.81 downwards, joint without cohesion as the block's; `unloaded` start; no blocks yet.
Scene empty_scene(const analytical::BlockOnPlane& data = {});

std::vector<Vec2> rectangle(double x, double y, double width, double height);

BlockInput free_block(const std::string& name, std::vector<Vec2> vertices);
BlockInput fixed_block(const std::string& name, std::vector<Vec2> vertices);

/// A fixed plane (as long as asked for downhill, 20 m uphill) and on it the block of `data`, whose lower left corner touches at the origin, falling
/// to the right. Stiffness, friction and density from `data`.
Scene block_on_plane(const analytical::BlockOnPlane& data, double length_downhill = 25.0);

/// Displacement down the plane [m].
double downhill(const analytical::BlockOnPlane& data, const Vec2& displacement);
/// Displacement normal to it, away from it [m].
double off_plane(const analytical::BlockOnPlane& data, const Vec2& displacement);

/// `shi` with the joint's own springs as penalties, so that soft-contact references hold for it too.
void use_joint_springs_as_penalty(Scene& scene, const analytical::BlockOnPlane& data);

/// The energy ledger of a run: what it leaves unexplained over its turnover, to the level that rounding of a run of many steps leaves. `done`: the
/// run got to its end.
void check_ledger(Report& report, const std::string& name, const std::string& method, const RigidSimulation& simulation, bool done);

/// Displacements [m] downhill at the output times, of which there must be as many as asked for; else NaN.
std::vector<double> downhill_history(RigidSimulation& simulation, const analytical::BlockOnPlane& data, std::size_t count);
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

/// Limit analysis of a scene's blocks, handed over as the text of their file.
analytical::LimitState limit_state(const Scene& scene);

}  // namespace openclose::verification
