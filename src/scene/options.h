// The options of an analysis: what each table of the scene file holds and, below its members, its table of keys.
//
// A key is one row: its name with its unit, what it does, the member and what is accepted. The default is that of the member. From the rows come the
// reader, --set, the scene as it was read, the options in summary.json, the scene of a checkpoint, docs/keys.md, docs/scene.schema.json and
// `openclose explain`; whoever goes through them is a visitor with
//
//   void table(const KeyTable&);
//   template <class T, class Accepted> void operator()(const Key&, T& member, const Accepted&, place = nullptr);
//
// where the place, if there is one, takes the line on which the key is given.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "openclose/core/error.h"
#include "openclose/core/parallel.h"
#include "openclose/core/tolerance.h"
#include "openclose/scene/key.h"

namespace openclose {

/// How a run starts.
enum class Start { unloaded, settled, normal_balanced, steady_sliding };

inline constexpr std::array start_words{
    Word{"unloaded", Start::unloaded, "gravity drops on unloaded springs at time 0"},
    Word{"settled", Start::settled, "static equilibrium first; refused where the blocks do not stand"},
    Word{"normal_balanced", Start::normal_balanced, "normal forces and moments in balance, shear springs relaxed"},
    Word{"steady_sliding", Start::steady_sliding, "as normal_balanced, with friction fully mobilised against the driving force"},
};

enum class RotationKind { exact, linear };

inline constexpr std::array rotation_words{
    Word{"exact", RotationKind::exact, "by the rotation matrix"},
    Word{"linear", RotationKind::linear, "Shi's first-order rotation, for comparison; it makes spinning blocks grow"},
};

/// Damping of the blocks' motion, for `dem`.
enum class MassDamping { none, local, automatic };

inline constexpr std::array mass_damping_words{
    Word{"none", MassDamping::none, "no damping of the blocks' motion"},
    Word{"local", MassDamping::local, "against the motion, in proportion to the unbalanced force"},
    Word{"automatic", MassDamping::automatic, "viscous, its coefficient following what the kinetic energy does"},
};

/// How the linear equations of a step are solved.
enum class LinearSolverKind { automatic, direct, iterative, plain };

inline constexpr std::array linear_solver_words{
    Word{"automatic", LinearSolverKind::automatic, "directly, and for many blocks iteratively"},
    Word{"direct", LinearSolverKind::direct, "every matrix is factored"},
    Word{"iterative", LinearSolverKind::iterative, "with an incomplete factor as preconditioner; what that does not serve is factored"},
    Word{"plain", LinearSolverKind::plain, "by the library's sparse LU, to compare with"},
};

/// How `soft` finds the balance of a static step.
enum class StaticSolver { automatic, newton, relaxation };

inline constexpr std::array static_solver_words{
    Word{"automatic", StaticSolver::automatic, "by Newton's method, and for many blocks by relaxation"},
    Word{"newton", StaticSolver::newton, "by linear equations"},
    Word{"relaxation", StaticSolver::relaxation, "every block follows the force on it, with momentum: no linear equations"},
};

inline constexpr double default_rho_inf = 0.5;  ///< [-] of MethodInput::rho_inf

/// How contacts are enforced and steps are taken: [method], and most of [solver].
struct MethodInput {
  std::string contact = "soft";  ///< name in the registry of enforcements (integrator/registry.h looks it up)
  SourceLocation contact_where;  ///< for the error of an unknown name
  std::optional<std::string>
      integrator;  ///< soft: name in the list of integrators (integrators.h looks it up); absent: theta if there is one, else the default
  std::optional<double> theta;                  ///< [-] theta: 1: Newmark (1/2, 1), Shi's; 1/2: trapezoid (Newmark (1/4, 1/2))
  std::optional<double> rho_inf;                ///< [-] generalized_alpha: spectral radius at infinite frequency; absent: default_rho_inf
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
  std::optional<double> contact_skin;  ///< [m] the default is that of the blocks, see LengthsOfBlocks
  bool skip_reload = true;             ///< dem: exchange only the contacts that were found anew, and leave the others in the loop
  int threads = 1;                     ///< that share the work; the results are the same to the last bit
  bool skip_factorisation = true;      ///< factor only rows of the matrix that have changed, and no weak couplings
  bool skip_symbolic = true;           ///< plan a factorisation only once the pattern of the matrix has changed
  bool skip_balanced = true;           ///< between iterations of large systems in motion, iterate only where forces are far from balance
  bool skip_still_steps = true;        ///< do a step in which nothing can happen once, and count it as often as it would be repeated
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

/// The keys of [method].
template <class Method, class Visitor>
void visit_method_keys(Method& m, Visitor& visit) {
  visit.table({"method", Audience::user, "how contacts are enforced and how steps in time are taken"});
  visit({"contact", "how contacts are enforced, see [methods](methods.md)"}, m.contact, NameIn::enforcements, &m.contact_where);
  visit({"start", "the state at time 0"}, m.start, start_words);
  visit({"integrator", "time integration of `soft`, see [methods](methods.md)", "\"shi\"; \"theta\" where `theta` is given"}, m.integrator,
        NameIn::integrators);
  visit({"first_integrator",
         "the integrator of all steps of a run that begin before `first_integrator_s`, with the defaults of its own parameters; a start that "
         "`settle.criterion = \"paper\"` settles in time begins with it, too",
         "none"},
        m.first_integrator, NameIn::integrators);
  visit({"first_integrator_s", "until when `first_integrator` takes the steps; asked for with it", "none"}, m.first_integrator_time, positive);
  visit({"theta", "integrator \"theta\": weight of the forces at the end of the step", "1"}, m.theta,
        Range{.low = 0.5, .high = 1.0, .low_included = true, .high_included = true});
  visit({"rho_inf", "integrator \"generalized_alpha\": spectral radius of infinitely fast vibrations", "0.5"}, m.rho_inf, from_0_to_1);
  visit({"dissipation",
         "integrator \"path_average\": a contact takes min(0.1, this times its w dt) of the change of its forces out of the motion, w^2 its "
         "stiffness over the reduced mass",
         "0"},
        m.dissipation, from_0_to_1);
  visit({"rotation", "how blocks turn"}, m.rotation, rotation_words);
  visit({"statics", "true: every step starts from rest (dynamic coefficient 0)"}, m.statics, Flag{});
  visit({"penalty_pa_per_m", "`shi`: normal penalty", "10 times the joint's normal stiffness"}, m.penalty, positive);
  visit({"penalty_shear_ratio", "`shi`: shear over normal penalty"}, m.penalty_shear_ratio, positive);
  visit({"step_fraction",
         "`dem`: longest step over the critical one; impacts need 0.5 or less to return their energy to 1 %, beyond it they lose some"},
        m.step_fraction, between_0_and_1);
  visit({"damping", "`dem`: damping of the blocks' motion; settling takes \"local\" instead of \"none\""}, m.damping, mass_damping_words);
  visit({.name = "threads",
         .says = "threads that share the work, see [solvers](solvers.md); the results are the same to the last bit",
         .may_change_on_restart = true},
        m.threads, Range{.low = 1.0, .high = most_threads, .low_included = true, .high_included = true});
}

struct StepInput {
  double dt = 0.0;                         ///< [s]
  std::optional<double> max_displacement;  ///< [m] of any vertex in one step; a step that would move more is cut; the default is that of the blocks
  double smallest_fraction = 1e-6;         ///< [-] of dt, below which cutting is given up
  bool adaptive = false;                   ///< steps up to dt as long as error_tolerance allows
  double error_tolerance = 1e-4;           ///< [m] adaptive: local error of a step, of any vertex
  double look_ahead = 0.0;  ///< [-] part of the step after which the blocks are where its contacts are found, if they keep their velocities
  SourceLocation adaptive_where{}, look_ahead_where{};  ///< for the errors of methods that have no use for them
};

/// The keys of [step].
template <class Step, class Visitor>
void visit_step_keys(Step& s, Visitor& visit) {
  visit.table({"step", Audience::user, "the steps in time"});
  visit({"dt_s", "the step; with `adaptive` the longest one",
         "needed by `run`, by `check --spectrum`, and by `fos` with `strength_reduction.curve_time_s` or `settle.criterion = \"paper\"`"},
        s.dt, positive);
  visit({"max_displacement_m", "of any vertex in one step; a step that would move more is cut", "0.1, or a quarter of the size of small free blocks"},
        s.max_displacement, Range{.low = 0.0, .high = tolerance::farthest_coordinate_m, .high_included = true});
  visit({"adaptive", "true, for `soft`: each step is as long as `error_tolerance_m` allows"}, s.adaptive, Flag{}, &s.adaptive_where);
  visit({"error_tolerance_m",
         "local error of a step, dt^2/12 times the change of the accelerations, at any vertex; a step beyond it is repeated shorter"},
        s.error_tolerance, positive);
  visit({"look_ahead",
         "for `soft` and `hard`: the contacts of a step are those of where the blocks will be after this part of it if they keep their velocities, "
         "see [methods](methods.md)"},
        s.look_ahead, from_0_to_1, &s.look_ahead_where);
}

/// How equations are solved.
template <class Method, class Step, class Visitor>
void visit_equation_keys(Method& m, Step& s, Visitor& visit) {
  visit({"residual_tolerance", "unbalanced force that Newton's method may leave, over the largest force", {}, "method.residual_tolerance"},
        m.residual_tolerance, between_0_and_1);
  visit(
      {"max_iterations",
       "Newton iterations of a motion's step before it is cut; what 30 of them have not halved is given up, with `hard` what 10 have not as long as "
       "there are softer springs to be tried; statics may begin anew, with other tangents",
       {},
       "method.max_iterations",
       true},
      m.max_iterations, at_least_one);
  visit({"smallest_fraction", "part of `step.dt_s` below which cutting a step is given up", {}, "step.smallest_fraction", true}, s.smallest_fraction,
        Range{.low = 0.0, .high = 1.0, .high_included = true});
  visit({"linear_solver", "how the linear equations of an iteration are solved, see [solvers](solvers.md)", {}, "method.linear_solver"},
        m.linear_solver, linear_solver_words);
  visit({"static_solver", "`soft`: how static steps are balanced, see [solvers](solvers.md)", {}, "method.static_solver"}, m.static_solver,
        static_solver_words);
}

/// What work is skipped.
template <class Method, class Visitor>
void visit_skip_keys(Method& m, Visitor& visit) {
  visit({"skip_search", "false: search contact candidates in every step, and find all contacts anew", {}, "method.skip_search"}, m.skip_search,
        Flag{});
  visit({"skip_narrow_phase",
         "false: find all contacts anew in every step, not only those of blocks that moved by more than `contact_skin_m` against each other",
         {},
         "method.skip_narrow_phase"},
        m.skip_narrow_phase, Flag{});
  visit({"skip_looks",
         "false: check in every step of all pairs of blocks whether they have moved against each other, not only of those that have gone far enough",
         {},
         "method.skip_looks"},
        m.skip_looks, Flag{});
  visit({"contact_skin_m",
         "by which blocks may move against each other before the contacts of the two are found anew (`skip_narrow_phase`; all of `dem`): lengths are "
         "off, and corners that come over an edge found late, by less than it, gaps are exact",
         "1e-3, or a thousandth of the size of small free blocks", "method.contact_skin_m"},
        m.contact_skin, positive);
  visit({"skip_reload",
         "false: `dem` takes over all blocks and contacts anew whenever some contacts were found anew, not only those contacts",
         {},
         "method.skip_reload"},
        m.skip_reload, Flag{});
  visit({"skip_factorisation",
         "false: factor all rows of every matrix, weak couplings included, see [solvers](solvers.md)",
         {},
         "method.skip_factorisation"},
        m.skip_factorisation, Flag{});
  visit({"skip_symbolic",
         "false: order the equations and plan the fill of the factor for every matrix, not only for a new pattern of contacts",
         {},
         "method.skip_symbolic"},
        m.skip_symbolic, Flag{});
  visit({"skip_balanced",
         "false: in the motion of 600 free blocks and more let every iteration be one of all blocks, see [solvers](solvers.md)",
         {},
         "method.skip_balanced"},
        m.skip_balanced, Flag{});
  visit({"skip_still_steps",
         "false: solve every step, also those that begin and end like the one before, in balance and without velocities",
         {},
         "method.skip_still_steps"},
        m.skip_still_steps, Flag{});
  visit({"skip_resting",
         "true: blocks that have come to rest in a motion are left alone until the forces on them change, see [solvers](solvers.md)",
         {},
         "method.skip_resting"},
        m.skip_resting, Flag{});
}

/// Of single methods.
template <class Method, class Visitor>
void visit_method_own_keys(Method& m, Visitor& visit) {
  visit({"gap_tolerance_m",
         "`hard`: a closed contact may differ from its target gap, a sticking one from its place, by this much in a step",
         {},
         "method.gap_tolerance_m"},
        m.gap_tolerance, positive);
  visit({"penetration_tolerance_m", "`shi`: deeper contacts cut the step",
         "the larger of 1e-3 and a hundredth of the root of the free blocks' median area", "method.penetration_tolerance_m"},
        m.penetration_tolerance, positive);
  visit({"closing_tolerance_m", "`shi`: an open contact closes beyond this penetration", {}, "method.closing_tolerance_m"}, m.closing_tolerance,
        not_negative);
  visit({"max_open_close_iterations",
         "`shi`: passes in which a contact changes its state, before the step is cut; those for friction alone are not counted",
         {},
         "method.max_open_close_iterations"},
        m.max_open_close_iterations, at_least_one);
  visit({"step_cut", "`shi`: factor on a step that is cut", {}, "method.step_cut"}, m.step_cut, between_0_and_1);
  visit({"local_damping", "`dem`: part of the unbalanced force that opposes the motion", {}, "method.local_damping"}, m.local_damping,
        between_0_and_1);
}

/// The keys of [solver].
template <class Method, class Step, class Visitor>
void visit_solver_keys(Method& m, Step& s, Visitor& visit) {
  visit.table({"solver", Audience::developer, "how equations are solved and what work is skipped: for measurements and comparisons"});
  visit_equation_keys(m, s, visit);
  visit_skip_keys(m, visit);
  visit_method_own_keys(m, visit);
}

/// When a block is at rest in a motion, and when it is not any more; the rule is in analysis/resting.h. A tenth of a second is some periods of blocks
/// on joints (300 rad/s in the paper's example 3.4), 3 % of gravity what impacts elsewhere send through a slope; there skipping changes the times at
/// which the failing mass has gone 10 to 40 m by 0.04 % at most. A tenth of a millimetre in a tenth of a second is creep that may be left out.
struct RestInput {
  double time = 0.1;           ///< [s] for which it and those it touches have been quiet; fading of the change of forces
  double displacement = 1e-4;  ///< [m] of any point in that time
  double acceleration = 0.3;   ///< [m/s2] of any point on the average of a step; of blocks at rest: change of the forces over the mass
};

/// The keys of [rest].
template <class Rest, class Visitor>
void visit_rest_keys(Rest& r, Visitor& visit) {
  visit.table({"rest", Audience::developer, "when `solver.skip_resting` puts a block to rest"});
  visit({"time_s", "for which a block and those it touches have been quiet before it is put to rest"}, r.time, positive);
  visit({"displacement_m", "of any point in that time"}, r.displacement, positive);
  visit({"acceleration_m_per_s2",
         "of any point on the average of a step; of blocks at rest: change of the forces, its mean fading with `time_s`, over the mass"},
        r.acceleration, positive);
}

/// What tells that a scene has settled.
enum class SettleCriterion { unbalanced_force, paper };

inline constexpr std::array settle_criterion_words{
    Word{"unbalanced_force", SettleCriterion::unbalanced_force, "static steps until forces are in balance"},
    Word{"paper", SettleCriterion::paper,
         "the reference paper's: steps in time until blocks move little in a step, with `dem` until no more than a force in newtons is left; the "
         "last four of these keys belong to it"},
};

/// Static settling: when it is done, and when it has failed.
struct SettleInput {
  double unbalanced_fraction = 1e-8;  ///< [-] largest unbalanced force over the weight of the heaviest free block, see emphasis_at_rest()
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

/// The keys of [settle].
template <class Settle, class Visitor>
void visit_settle_keys(Settle& s, Visitor& visit) {
  visit.table({"settle", Audience::user, "static equilibrium, for the start \"settled\" and for factors of safety that ask for motion"});
  visit({"criterion", "what tells equilibrium"}, s.criterion, settle_criterion_words);
  visit({"unbalanced_fraction",
         "largest unbalanced force over the weight of the heaviest free block, or over 1000 times the block's own weight if that is less; steps of "
         "`soft` may leave half of it in their equations"},
        s.unbalanced_fraction, between_0_and_1);
  visit({"first_dt_s", "first pseudo-time step; it grows tenfold while steps succeed"}, s.first_dt, positive);
  visit({"max_steps", "steps before settling is given up"}, s.max_steps, at_least_one);
  visit({"max_explicit_steps", "`dem`: instead of `max_steps`"}, s.max_explicit_steps, at_least_one);
  visit({"keep_bonds",
         "`dem`, unless the criterion is the paper's: joints lose cohesion and tensile strength at rest only; false: on the way there, too"},
        s.keep_bonds, Flag{});
  visit({"failure_displacement_m", "a block that moved farther is failing; of factors of safety only that of `large_displacements` asks for it"},
        s.failure_displacement, positive);
  visit({"relative_displacement", "\"paper\": way of the farthest point of a block in a step, over half the height of the model"},
        s.relative_displacement, between_0_and_1);
  visit({"steady_steps", "\"paper\": steps in a row that must stay below it"}, s.steady_steps, at_least_one);
  visit({"max_time_steps", "\"paper\": steps of `step.dt_s` that the first settling may take; `dem`: its own steps, of every settling"},
        s.max_time_steps, at_least_one);
  visit({"unbalanced_force_n", "\"paper\", `dem`: largest unbalanced force that counts as rest"}, s.unbalanced_force, positive);
}

/// Which factor of safety is meant.
enum class FactorDefinition { small_displacements, joint_closures, large_displacements };

inline constexpr std::array factor_definition_words{
    Word{"small_displacements", FactorDefinition::small_displacements, "of the drawn geometry: lengths and directions of contacts stay as drawn"},
    Word{"joint_closures", FactorDefinition::joint_closures, "the same on the geometry that the closures of the joints under gravity leave"},
    Word{"large_displacements", FactorDefinition::large_displacements,
         "blocks move in every trial, what settles is stable, what moves beyond `settle.failure_displacement_m` has failed"},
};

struct StrengthReductionInput {
  FactorDefinition definition = FactorDefinition::small_displacements;
  bool limit_analysis = true;           ///< rigid-block limit analysis beside it: a proof of failure and a second opinion
  std::optional<std::string> increase;  ///< the load that is increased instead, see increased_load.h
  double width = 1e-4;                  ///< [-] of the final bracket; times the factor where that is below 1, and times every multiplier
  double upper_limit = 100.0;           ///< [-] strength reduction factor, or multiplier, beyond which the search stops
  std::vector<double> curve;            ///< [-] further factors at which displacement is recorded
  std::optional<double> curve_time;     ///< [s] physical time of a dynamic run at each of them; absent: settled displacement only
  /// For the errors of a load that is not there, of a factor below 1, and of a definition that knows no motion.
  SourceLocation increase_where{}, upper_limit_where{}, curve_time_where{};
};

/// The keys of [strength_reduction].
template <class Reduction, class Visitor>
void visit_strength_reduction_keys(Reduction& r, Visitor& visit) {
  visit.table(
      {"strength_reduction", Audience::user, "`fos` divides the tangents of both friction angles, cohesion and tensile strength by the factor"});
  visit({"definition", "which factor is meant, see [factor of safety](factor_of_safety.md)"}, r.definition, factor_definition_words);
  visit({"limit_analysis",
         "a second opinion: rigid-block limit analysis, which also proves failure above it, and the factor at shear to normal stiffness ratios of "
         "0.1 and 1"},
        r.limit_analysis, Flag{});
  visit({"increase",
         "the strength stays, and the factor multiplies this load instead, from 0 up: \"gravity_x\" or \"gravity_y\", a body force of so many times "
         "gravity to the right or upwards, or the `name` of loads and surcharges; a minus before it turns it around, see [factor of "
         "safety](factor_of_safety.md#the-multiplier-of-a-load)",
         "none"},
        r.increase, LoadName{}, &r.increase_where);
  visit({"width", "of the final bracket of the factor; below a factor of 1, and of a multiplier always, that part of it"}, r.width, positive);
  visit({"upper_limit", "factor, above 1, or multiplier beyond which the search stops"}, r.upper_limit, positive, &r.upper_limit_where);
  visit({"curve", "further factors at which the displacement is recorded"}, r.curve, ListOf{positive});
  visit({"curve_time_s", "also the displacement after this time of motion at each of them; with \"large_displacements\"", "none"}, r.curve_time,
        positive, &r.curve_time_where);
}

}  // namespace openclose
