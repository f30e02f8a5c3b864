// Factor of safety of a system of rigid blocks by limit analysis (Livesley, Int. J. Numer. Meth. Engng 12, 1978): the largest F for which forces
// exist that keep every free block in equilibrium and nowhere exceed the strength divided by F. Each end of an interface of length L carries a normal
// force n (compression positive) and a shear force t, with
//   n >= -f_t L/(2F),   |t| <= (c L/2 + n tan(phi))/F.
// The linear programs and their certificates are those of analytical/limit_analysis/; here is the way from interfaces to contact points, the friction
// angle at the limit, and zero dilatancy.
//
// Sliding opens the interfaces then at the friction angle (associated flow), which no real joint does: the factor is an upper bound of the one with
// sliding at constant volume. For this, zero_dilatancy repeats the analysis with strengths that do not depend on n, c L/2 + n' tan(phi), wherever an
// interface slips, n' being the normal force of the repetition before, until factor and forces stand (Gilbert, Casapulla & Ahmed, Comput. Struct.
// 84, 2006, who do so everywhere). There the dependence on n fades out from repetition to repetition, so that the forces can follow. What comes out
// is one such state. Without dilatancy it need not be the only one: which, depends on the forces that the programs happen to choose (the columns of
// Goodman and Bray: friction angles of 35 to 41 degrees, all consistent). A number for orientation, no bound.
//
// Valid for blocks that meet along edges. Forces on corners that touch edges at an angle are not part of it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "openclose/analytical/rigid_block_assembly.h"
#include "openclose/limit_analysis/limit_analysis.h"

namespace openclose::analytical {

struct LimitAnalysisOptions {
  double width = 1e-5;          // [-] of the bracket of F, see limit_analysis::Options
  double excess = 1e-4;         // [-] see LimitState; larger ones ask for another repetition
  double upper_limit = 1000;    // [-] stable beyond: no factor
  bool zero_dilatancy = false;  // sliding at constant volume
};

using EndForce = limit_analysis::ContactForce;  // shear on block a along the tangent of the interface
using BlockVelocity = limit_analysis::BlockVelocity;

struct LimitState {
  bool found = false;
  std::string reason;                           // why not
  double factor = 0;                            // the largest feasible F
  double failed = 0;                            // the smallest F that is not
  std::vector<std::array<EndForce, 2>> forces;  // at `factor`, for each interface and end
  std::vector<BlockVelocity> mechanism;         // at `failed`, for each block; the fastest block has 1 m/s
  int repetitions = 0;                          // of zero dilatancy
  double excess = 0;  // [-] of the shear forces over the strength that belongs to n itself, in weights of the heaviest block
  int programs = 0;   // linear programs solved
};

/// \throws std::invalid_argument if no block is free, or a free one has no weight; std::runtime_error if the programs are not solved
LimitState limit_analysis(const RigidBlockAssembly& assembly, const LimitAnalysisOptions& options = {});

/// The smallest friction angle, the same on all interfaces, with which the system stands without cohesion and tensile strength [rad].
struct CriticalFriction {
  bool found = false;
  double angle = 0;
  LimitState state;  // of tan(phi) = 1
};
CriticalFriction critical_friction(RigidBlockAssembly assembly, const LimitAnalysisOptions& options = {});

/// Velocity of a point that moves with a block.
Point velocity_at(const RigidBlock& block, const BlockVelocity& motion, const Point& point);

}  // namespace openclose::analytical
