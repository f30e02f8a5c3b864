// What the user wrote, as plain data. SI units and radians; names resolved by the reader, so that every index below is valid.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "openclose/core/error.h"
#include "openclose/core/tolerance.h"
#include "openclose/core/vector.h"
#include "openclose/scene/acceleration_record.h"

namespace openclose {

struct Material {
  std::string name;
  double density = 0.0;  ///< [kg/m3]
};

/// What happens to the cohesion of a joint that has failed; its tensile strength is gone once it has opened, whatever this says.
enum class CohesionBehaviour {
  ductile,          ///< kept for ever
  lost_on_opening,  ///< gone once the contact has opened
  lost_on_slip,     ///< gone once the contact has slipped or opened
};

/// Mohr-Coulomb joint with tension cut-off, for one unordered pair of materials.
struct JointProperties {
  std::array<int, 2> materials{};  ///< indices into Scene::materials
  double normal_stiffness = 0.0;   ///< [Pa/m]
  double shear_stiffness = 0.0;    ///< [Pa/m]
  double friction_angle = 0.0;     ///< [rad]
  double cohesion = 0.0;           ///< [Pa]
  double tensile_strength = 0.0;   ///< [Pa]
  CohesionBehaviour cohesion_behaviour = CohesionBehaviour::ductile;
  double damping_ratio = 0.0;  ///< [-] of dashpots parallel to the springs, see law/joint_law.h
};

struct BlockInput {
  std::string name;
  int material = 0;
  std::vector<Vec2> vertices;  ///< [m] counter-clockwise, simple, no repeated first vertex
  bool fixed = false;
  bool rotation_locked = false;
  Vec2 velocity = Vec2::Zero();               ///< [m/s]
  double angular_velocity = 0.0;              ///< [rad/s] counter-clockwise
  int line = 0;                               ///< where it was read, for errors; see Scene::place_of()
  std::shared_ptr<const std::string> source;  ///< null: the scene's file
};

/// A spring that holds one material point of a block at its initial place.
struct Support {
  int block = 0;
  Vec2 point = Vec2::Zero();      ///< [m]
  Vec2 stiffness = Vec2::Zero();  ///< [N/m] in x and y; 0 leaves that direction free
};

/// A constant force at a material point of a block.
struct Load {
  int block = 0;
  Vec2 point = Vec2::Zero();  ///< [m]
  Vec2 force = Vec2::Zero();  ///< [N]
};

struct MeasuredPoint {
  std::string name;
  int block = 0;
  Vec2 point = Vec2::Zero();  ///< [m]
};

/// The joint between two blocks at a point of it, of which forces, gap and slip are recorded.
struct MeasuredContact {
  std::string name;
  int block_a = 0, block_b = 0;
  Vec2 point = Vec2::Zero();  ///< [m] on the boundaries of both, as drawn
};

enum class BaseMotionKind {
  pulses,    ///< rectangular ones; where they overlap they add up
  harmonic,  ///< amplitude sin(2 pi frequency t + phase) from time 0 on
  record,    ///< linear between its times, one for each direction
};

struct BasePulse {
  double start = 0.0;                ///< [s]
  double duration = 0.0;             ///< [s]
  Vec2 acceleration = Vec2::Zero();  ///< [m/s2]
};

/// Acceleration of the ground during the motion, from time 0 on. Only what belongs to the kind is used.
struct BaseMotionInput {
  BaseMotionKind kind = BaseMotionKind::pulses;
  double factor = 1.0;  ///< [-] on all accelerations
  std::vector<BasePulse> pulses;
  Vec2 amplitude = Vec2::Zero();  ///< [m/s2]
  double frequency = 0.0;         ///< [Hz]
  double phase = 0.0;             ///< [rad]
  AccelerationRecord horizontal;  ///< positive to the right; empty: none
  AccelerationRecord vertical;    ///< positive upwards; empty: none
};

/// How a run starts.
enum class Start {
  unloaded,         ///< gravity drops on unloaded springs at t = 0
  settled,          ///< static equilibrium first
  normal_balanced,  ///< normal forces and moments in balance, shear springs relaxed
  steady_sliding,   ///< as normal_balanced, with friction fully mobilised against the driving force
};

enum class RotationKind {
  exact,   ///< rotation matrix
  linear,  ///< Shi's first-order rotation, which makes spinning blocks grow
};

/// Damping of the blocks' motion, for `dem`.
enum class MassDamping {
  none,
  local,      ///< against the motion, in proportion to the unbalanced force
  automatic,  ///< viscous, its coefficient following what the kinetic energy does
};

/// How the linear equations of a step are solved.
enum class LinearSolverKind {
  automatic,  ///< directly, and for many blocks iteratively
  direct,     ///< every matrix is factored
  iterative,  ///< with an incomplete factor, or that of an earlier matrix, as preconditioner
  plain,      ///< by the library's sparse LU, to compare with
};

/// How `soft` finds the balance of a static step.
enum class StaticSolver {
  automatic,   ///< by Newton's method, and for many blocks by relaxation
  newton,      ///< by linear equations
  relaxation,  ///< every block follows the force on it, with momentum: no linear equations
};

inline constexpr double default_rho_inf = 0.5;  ///< [-] of MethodInput::rho_inf

/// How contacts are enforced and steps are taken.
struct MethodInput {
  std::string contact = "soft";  ///< name in the registry of enforcements (analysis looks it up): soft, hard, shi, dem
  SourceLocation contact_where;  ///< for the error of an unknown name
  std::optional<std::string>
      integrator;                 ///< soft: name in the list of integrators (analysis looks it up); absent: theta if there is one, else the default
  std::optional<double> theta;    ///< [-] theta: 1: Newmark (1/2, 1), Shi's; 1/2: trapezoid (Newmark (1/4, 1/2))
  std::optional<double> rho_inf;  ///< [-] generalized_alpha: spectral radius at infinite frequency; absent: default_rho_inf
  std::optional<double> dissipation;            ///< [-] path_average: see Soft; absent: none
  std::optional<std::string> first_integrator;  ///< soft: the integrator of steps that begin before the next one; absent: there are none
  double first_integrator_time = 0.0;           ///< [s]
  RotationKind rotation = RotationKind::exact;
  Start start = Start::settled;
  bool statics = false;               ///< dynamic coefficient 0: every step starts from rest
  double residual_tolerance = 1e-12;  ///< [-] unbalanced force left by Newton, as a fraction of the largest force in the system
  int max_iterations = 60;            ///< per step, before the step is cut
  LinearSolverKind linear_solver = LinearSolverKind::automatic;
  StaticSolver static_solver = StaticSolver::automatic;  ///< soft
  bool skip_search = true;                               ///< search candidates only once something has moved beyond the skin
  bool skip_narrow_phase = true;       ///< find the contacts of two blocks anew only once they have moved against each other beyond the skin
  bool skip_looks = true;              ///< see DetectionSkips
  std::optional<double> contact_skin;  ///< [m] the default is that of the blocks, see default_contact_skin()
  bool skip_reload = true;             ///< dem: exchange only the contacts that were found anew, and leave the others in the loop
  int threads = 1;                     ///< that share the work; the results are the same to the last bit
  bool skip_factorisation = true;      ///< factor only rows of the matrix that have changed, and no weak couplings
  bool skip_symbolic = true;           ///< plan a factorisation only once the pattern of the matrix has changed
  bool skip_unmoved = true;            ///< after parts were solved, evaluate only contacts of what moved with them
  bool skip_balanced = true;           ///< between iterations of large systems in motion, iterate only where forces are far from balance
  bool skip_resting = false;           ///< leave blocks alone that are at rest, see RestInput
  double gap_tolerance = 3e-7;         ///< [m] hard: a closed contact may differ from its target gap, a sticking one from its place, by this much
  std::optional<double> penalty;       ///< [Pa/m] shi: normal penalty, times the tributary length like any stiffness; absent: 10 times the joint's
  double penalty_shear_ratio = 0.4;    ///< [-] shi: shear penalty over normal penalty
  std::optional<double> penetration_tolerance;  ///< [m] shi: deeper contacts cut the step; absent: see Shi
  double closing_tolerance = 1e-9;              ///< [m] shi: an open contact closes beyond this penetration
  int max_open_close_iterations = 6;            ///< shi: per step, before the step is cut
  double step_cut = 0.3;                        ///< [-] shi: factor on the step when open-close does not settle
  double step_fraction = 0.5;                   ///< [-] dem: longest step over the critical one
  MassDamping damping = MassDamping::none;      ///< dem: of the motion; settling takes `local` instead of `none`
  double local_damping = 0.8;                   ///< [-] dem: of the unbalanced force
};

struct StepInput {
  double dt = 0.0;                  ///< [s]
  double max_displacement = 0.1;    ///< [m] of any vertex in one step; a step that would move more is cut
  double smallest_fraction = 1e-6;  ///< [-] of dt, below which cutting is given up
  bool adaptive = false;            ///< steps up to dt as long as error_tolerance allows
  double error_tolerance = 1e-4;    ///< [m] adaptive: local error of a step, of any vertex
  double look_ahead = 0.0;          ///< [-] part of the step after which the blocks are where its contacts are found, if they keep their velocities
  SourceLocation adaptive_where{}, look_ahead_where{};  ///< for the errors of methods that have no use for them
};

/// When a block is at rest in a motion, and when it is not any more; the rule is in analysis/resting.h. A tenth of a second is some periods of blocks
/// on joints (300 rad/s in the paper's example 3.4), 3 % of gravity what impacts elsewhere send through a slope; there skipping changes the times at
/// which the failing mass has gone 10 to 40 m by 0.04 % at most. A tenth of a millimetre in a tenth of a second is creep that may be left out.
struct RestInput {
  double time = 0.1;           ///< [s] for which it and those it touches have been quiet; fading of the change of forces
  double displacement = 1e-4;  ///< [m] of any point in that time
  double acceleration = 0.3;   ///< [m/s2] of any point on the average of a step; of blocks at rest: change of the forces over the mass
};

/// What tells that a scene has settled.
enum class SettleCriterion {
  unbalanced_force,  ///< static steps until forces are in balance
  paper,             ///< the reference paper's: steps in time until blocks move little in a step; dem: until a force in newtons is left
};

/// Static settling: when it is done, and when it has failed.
struct SettleInput {
  double unbalanced_fraction = 1e-8;  ///< [-] largest unbalanced force over the weight of the heaviest free block
  double first_dt = 1.0;              ///< [s] first pseudo-time step; grows tenfold while steps succeed
  int max_steps = 200;
  double failure_displacement = 1.0;  ///< [m] a block that moved farther is failing
  SettleCriterion criterion = SettleCriterion::unbalanced_force;
  double relative_displacement = 1e-5;  ///< [-] paper: of a step, over half the height of the model
  int steady_steps = 100;               ///< paper: steps in a row that must stay below
  int max_time_steps = 10000;           ///< paper: of step.dt, for the first settling; dem: explicit ones, for each settling
  double unbalanced_force = 1e3;        ///< [N] paper, dem: that may be left on a block
  int max_explicit_steps = 1000000;     ///< dem: instead of max_steps
  bool keep_bonds = true;               ///< dem: joints lose strength only at rest, not on the way there
};

/// Which factor of safety is meant.
enum class FactorDefinition {
  small_displacements,  ///< of the drawn geometry: lengths and directions of contacts stay as drawn; no stiffness scale, no length counts
  joint_closures,       ///< the same on the geometry that the joints' closures under gravity leave
  large_displacements,  ///< blocks move as far as they do; failed is what moves beyond settle.failure_displacement_m
};

struct StrengthReductionInput {
  FactorDefinition definition = FactorDefinition::small_displacements;
  bool limit_analysis = true;         ///< rigid-block limit analysis beside it: a proof of failure and a second opinion
  double width = 1e-4;                ///< [-] of the final bracket; times the factor where that is below 1
  double upper_limit = 100.0;         ///< [-] strength reduction factor beyond which the search stops
  std::vector<double> curve;          ///< [-] further factors at which displacement is recorded
  std::optional<double> curve_time;   ///< [s] physical time of a dynamic run at each of them; absent: settled displacement only
  SourceLocation curve_time_where{};  ///< for the error of a definition that knows no motion
};

/// What the joints made of a domain.
struct CuttingSummary {
  int blocks = 0;
  double area = 0.0;            ///< [m2] of these blocks
  double domain_area = 0.0;     ///< [m2]
  double smallest_block = 0.0;  ///< [m2]
  int traces = 0;
  int dangling_ends = 0;  ///< trace ends cut back to their last meeting with another trace or the boundary
  int slivers_merged = 0;
  double slivers_area = 0.0;  ///< [m2]
  int enclosed_groups = 0;    ///< of joints within one block, dropped
  std::vector<std::string> warnings;
};

struct Scene {
  SourceLocation where;
  std::string title;
  Vec2 gravity{0.0, -9.81};  ///< [m/s2]
  std::vector<Material> materials;
  std::vector<JointProperties> joints;
  std::vector<BlockInput> blocks;         ///< those written as they are, then those cut out of the domain
  std::optional<CuttingSummary> cutting;  ///< if there is a domain
  std::vector<Support> supports;
  std::vector<Load> loads;
  std::vector<MeasuredPoint> measured_points;
  std::vector<MeasuredContact> measured_contacts;
  std::optional<BaseMotionInput> base_motion;
  MethodInput method;
  StepInput step;
  RestInput rest;
  double run_strength_reduction_factor = 1.0;  ///< [-] on the strength of the joints in the motion, see RunResult
  std::optional<std::string> settled_by;       ///< contact method that finds the equilibrium a run starts from; absent: that of the motion
  SourceLocation settled_by_where;             ///< for the error of a method that cannot
  double end_time = 0.0;                       ///< [s]
  std::optional<double> end_displacement;      ///< [m] of any measured point; ends the run before its time
  double output_every = 0.0;                   ///< [s] interval of the history rows; 0: every step
  double checkpoint_every = 0.0;               ///< [s] interval of the checkpoints; 0: none, not even at the end
  std::vector<double> milestones;              ///< [m] displacements of the first measured point to be timed, increasing
  std::vector<double> snapshot_times;          ///< [s] at which the state is written, increasing
  double snapshots_every = 0.0;                ///< [s] interval at which it is written besides; 0: never
  bool vtk = false;                            ///< the states are written for ParaView, too
  SettleInput settle;
  StrengthReductionInput strength_reduction;

  SourceLocation place_of(const BlockInput& block) const { return {block.source ? *block.source : where.file, block.line}; }
  /// The joint between two materials, in either order; null if the scene gives none.
  const JointProperties* joint(int material_a, int material_b) const;
};

/// [bytes] Of the list of blocks with their names and vertices.
std::size_t bytes_of_blocks(const Scene& scene);

}  // namespace openclose
