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
#include "openclose/scene/force_inputs.h"
#include "openclose/scene/joint_properties.h"
#include "openclose/scene/options.h"

namespace openclose {

struct Material {
  std::string name;
  double density = 0.0;  ///< [kg/m3]
};

struct BlockInput {
  static constexpr int by_materials = -1;  ///< in place of a joint: the one of the materials of the two blocks

  std::string name;
  int material = 0;
  std::vector<Vec2> vertices;  ///< [m] counter-clockwise, simple, no repeated first vertex
  bool fixed = false;
  bool rotation_locked = false;
  Vec2 velocity = Vec2::Zero();   ///< [m/s]
  double angular_velocity = 0.0;  ///< [rad/s] counter-clockwise
  /// Of the edge from each vertex to the next: index into Scene::joints, or by_materials. Empty: all by_materials.
  std::vector<int> edge_joints;
  int joint_of_edge(std::size_t edge) const { return edge_joints.empty() ? by_materials : edge_joints[edge]; }
  int line = 0;                               ///< where it was read, for errors; see Scene::place_of()
  std::shared_ptr<const std::string> source;  ///< null: the scene's file
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

enum class BaseMotionKind { pulses, harmonic, record };

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
  Vec2 amplitude = Vec2::Zero();   ///< [m/s2]
  double frequency = 0.0;          ///< [Hz]
  double phase = 0.0;              ///< [rad]
  AccelerationRecord horizontal;   ///< positive to the right; empty: none
  AccelerationRecord vertical;     ///< positive upwards; empty: none
  std::vector<std::string> files;  ///< from which records were read
};

/// Of a joint set that was written by the dip and dip direction of its planes in space: its lines in the section.
struct SetInSection {
  std::string place;     ///< where it is written
  double dip = 0.0;      ///< [rad] apparent, counter-clockwise from the horizontal
  double spacing = 0.0;  ///< [m] at right angles to the lines
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
  std::vector<SetInSection> sets_in_section;
  std::vector<std::string> warnings;
};

struct Scene : ForceInputs {
  SourceLocation where;
  std::vector<std::string> warnings;  ///< of the reader
  std::string title;
  Vec2 gravity{0.0, -9.81};  ///< [m/s2]
  std::vector<Material> materials;
  std::vector<JointProperties> joints;
  std::vector<BlockInput> blocks;         ///< those written as they are, then those cut out of the domain
  std::optional<CuttingSummary> cutting;  ///< if there is a domain
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
  std::vector<std::string> formats;            ///< in which results are written besides the tables (io looks them up)
  SourceLocation formats_where;                ///< for the error of an unknown one
  SettleInput settle;
  StrengthReductionInput strength_reduction;

  SourceLocation place_of(const BlockInput& block) const { return {block.source ? *block.source : where.file, block.line}; }
  /// The joint between two materials, in either order; null if the scene gives none.
  const JointProperties* joint(int material_a, int material_b) const;
};

/// [bytes] Of the list of blocks with their names and vertices.
std::size_t bytes_of_blocks(const Scene& scene);

/// All keys of tables that a file has once, in the order in which they are written.
template <class Input, class Visitor>
void visit_keys(Input& scene, Visitor& visit) {
  visit_method_keys(scene.method, visit);
  visit_step_keys(scene.step, visit);
  visit_solver_keys(scene.method, scene.step, visit);
  visit_rest_keys(scene.rest, visit);
  visit.table({"run", Audience::user, "what `run` does with the strength and with the start"});
  visit({"strength_reduction_factor",
         "the tangents of both friction angles, cohesion and tensile strength are divided by it for the motion; the start \"settled\" is reached "
         "with full strength, "
         "before time 0, the other starts have the reduced one from the beginning"},
        scene.run_strength_reduction_factor, positive);
  visit({"settled_by",
         "the method that finds the equilibrium of the start \"settled\": \"soft\" and \"dem\" can do so for each other, see [scenes](scene.md)",
         "`method.contact`"},
        scene.settled_by, NameIn::enforcements, &scene.settled_by_where);
  visit.table({"end", Audience::user, "when a run ends"});
  visit({.name = "time_s", .says = "at the latest; > 0 is needed by `run`", .may_change_on_restart = true}, scene.end_time, not_negative);
  visit({"displacement_m", "the run ends when a measured point has moved this far since time 0", "none"}, scene.end_displacement, positive);
  visit.table({"output", Audience::user, "what is written"});
  visit({.name = "every_s",
         .says = "interval of the history, in whole steps; 0: every step; longer than the run: its ends only",
         .may_change_on_restart = true},
        scene.output_every, not_negative);
  visit({.name = "checkpoint_every_s",
         .says = "interval, in whole steps, at which the state is saved for a restart, also at the end (alone, if longer than the run) and where a "
                 "step does not converge; 0: never",
         .may_change_on_restart = true},
        scene.checkpoint_every, not_negative);
  visit({"milestones_m", "when has the first measured point moved so far, and at what CPU time"}, scene.milestones, Increasing{positive});
  visit({"snapshots_s", "the state at these times, each after the step that ends nearest to it"}, scene.snapshot_times, Increasing{not_negative});
  visit({"snapshots_every_s", "interval, in whole steps, at which the state is written besides; 0: never"}, scene.snapshots_every, not_negative);
  visit({"formats",
         "in which the results are written besides the tables, see [output](output.md): each in a folder of its name",
         {},
         "output.vtk",
         true},
        scene.formats, NameIn::formats, &scene.formats_where);
  visit_settle_keys(scene.settle, visit);
  visit_strength_reduction_keys(scene.strength_reduction, visit);
}

}  // namespace openclose
