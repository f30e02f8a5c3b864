// `shi`, the original DDA: penalty springs, open-close iterations over three contact states, friction of sliding contacts as a known force.
//
// G.-H. Shi (1988, 1993), as the paper describes it. Every pass linearises the contacts at the start of the step, solves once, and lets each contact
// change its state: open <-> closed by the sign of the normal spring, locked -> sliding when the shear spring exceeds the strength, sliding -> locked
// when the slip runs against its friction. The pass is the last when no state changes; the friction of a sliding contact is then still the one of the
// pass before. Where that misses much of the work of friction, passes go on until it does not, or to the last of them. A step that does not settle,
// or that leaves a contact deeper than the penetration tolerance, is cut. With contact damping the sign that opens and closes is that of spring and
// dashpot together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "openclose/integrator/registry.h"
#include "openclose/integrator/tangent_system.h"

namespace openclose {
namespace {

/// [-] Default penalty over the joint's stiffness: the original takes about 50 E, and rigid blocks have no E.
constexpr double default_penalty_over_joint = 10.0;
/// [-] Of the size of the free blocks: what contacts may penetrate by default, and no less than what blocks may overlap in the file, which is no
/// reason to cut steps of small ones. A hundredth of a block turns the normals of its contacts by no more than that (the original scales with the
/// height of the model, a slope of 1 km then has 0.1 m), and penalties that are no stiffer than ten times the joints yield by more than a thousandth
/// where blocks hit each other.
constexpr double default_penetration_of_size = 1e-2;

/// [-] Of the penetration that is tolerated: a corner is found up to four times as deep as this, and its contact closes by more before it carries.
constexpr double entry_of_penetration = 0.1;

/// [-] Of the work of friction in a step: what the contacts of a block that slide may miss of it, to either side: what the watch lets pass of the
/// energy.
constexpr double missable_part_of_friction = 0.01;
/// Passes in a step in which no state changes. Where each leaves 0.9 of what friction misses, it takes 44 to come to the hundredth.
constexpr int most_passes_for_friction = 44;

class Shi : public Enforcement {
 public:
  ContactSprings springs(const StepProblem& problem, const Contact& contact) const override {
    const double joint = problem.joints.joint(contact.joint).normal_stiffness;
    const double normal = problem.method.penalty.value_or(default_penalty_over_joint * joint) * contact.length;
    ContactSprings s = springs_of_stiffness(contact, normal, problem.method.penalty_shear_ratio * normal);
    add_dashpots(problem, contact, s);
    return s;
  }

  void solve(const StepProblem& problem, StepSolution& solution) override {
    // Where friction does not settle, as at the tip of a rod that it jams, the step is the one of the original.
    if (!iterate(problem, solution, problem.statics ? 0 : most_passes_for_friction) && solution.reason.empty()) iterate(problem, solution, 0);
    memory_of_solution_.grow_to(solution.memory());
  }

  std::unique_ptr<TimeScheme> make_time_scheme(const MethodInput& method) const override {
    refuse_integrators(method);
    return make_theta_scheme(1.0);
  }
  bool follows_gaps() const override { return false; }  // they add up first-order changes
  /// A contact that is found deeper than what is tolerated of closed ones would have no step.
  double deepest_entry(const MethodInput& method) const override {
    return entry_of_penetration * method.penetration_tolerance.value_or(tolerance::deepest_initial_overlap_m);
  }
  double step_cut(const MethodInput& method) const override { return method.step_cut; }
  LinearCounters linear_counters() const override { return tangent_.counters(); }
  Memory memory() const override {
    Memory of = tangent_.memory() + memory_of_solution_;
    of.contacts += bytes_of(kinematics_, applied_shear_, work_of_block_);
    return of;
  }
  void exchange(Archive& archive) override { tangent_.exchange(archive); }

 private:
  using Unknowns = Motion::Unknowns;

  /// Passes until no state changes and, if there may be passes for it, every block slides by its own friction, or the last of them misses no more of
  /// it than the first one did. False if friction does not settle, or with a reason.
  bool iterate(const StepProblem& problem, StepSolution& solution, int passes_for_friction) {
    begin(problem, solution.contacts);
    double missed_at_first = 0.0;  // [J]
    for (int of_states = 0, of_friction = 0; of_states < problem.method.max_open_close_iterations;) {
      if (!solve_once(problem, solution)) return false;
      if (change_states(problem, solution)) {
        ++of_states;
        continue;
      }
      const bool is_enough = passes_for_friction == 0 || slides_by_its_friction(problem, solution.contacts);
      if (!is_enough && of_friction == 0) missed_at_first = missed_work(solution.contacts);
      if (!is_enough && ++of_friction < passes_for_friction) continue;
      if (!is_enough && missed_work(solution.contacts) > missed_at_first) return false;
      finish(problem, solution);
      return true;
    }
    solution.reason = "open-close iterations did not settle";
    return false;
  }

  void begin(const StepProblem& problem, ContactTrial& contacts) {
    contacts.prepare(problem, springs_of(problem));
    kinematics_.clear();
    applied_shear_.assign(contacts.size(), 0.0);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Contact& c = problem.contacts[i];
      CarriedForces f;
      f.status = c.status == ContactStatus::open && closes(problem, contacts, i, c.stretch()) ? ContactStatus::sticking : c.status;
      f.normal = c.normal_force;
      f.shear = std::copysign(contacts.strength(i).shear_bound(c.normal_force).value, c.shear_force);
      contacts.set(i, f, 0.0, 0.0);
      kinematics_.emplace_back(contacts.pose_at_start(i));
    }
    tangent_.fit(problem.method, problem.system.free_count(), contacts);
  }

  /// Whether an open contact closes at this stretch: where it is compressed, or where its tensile strength holds the two together, as it does in a
  /// joint from which a block hangs.
  static bool closes(const StepProblem& problem, const ContactTrial& contacts, std::size_t c, double stretch) {
    const double tension = contacts.strength(c).tension;
    return stretch < -problem.method.closing_tolerance || (tension > 0.0 && contacts.springs(c).normal * stretch <= tension);
  }

  bool solve_once(const StepProblem& problem, StepSolution& solution) {
    const BlockSystem& system = problem.system;
    tangent_.matrix().set_zero();
    Eigen::VectorXd right = Eigen::VectorXd::Zero(dofs * system.free_count());
    const Unknowns still = Unknowns::Zero();
    for (int b : system.free_blocks()) {
      const auto& block = system.block(b);
      Motion::Matrix diagonal = problem.external.stiffness(system, b, still);
      diagonal += (problem.inertia * block.mass).asDiagonal();
      tangent_.matrix().add(block.equation, block.equation, diagonal);
      right.segment<dofs>(dofs * block.equation) =
          problem.inertia * problem.dt * block.mass.cwiseProduct(problem.velocity(b)) + problem.external.force(system, b, still);
    }
    for (std::size_t c = 0; c < solution.contacts.size(); ++c) add_contact(problem, solution.contacts, c, right);
    for (int b : system.free_blocks()) {
      const auto& block = system.block(b);
      if (!block.rotation_locked) continue;
      tangent_.matrix().eliminate(block.equation, Motion::rotation_index);
      right[dofs * block.equation + Motion::rotation_index] = 0.0;
    }
    ++solution.effort.iterations;
    const bool regular = tangent_.factor(0.0);
    if (regular) solution.d = tangent_.solve(right);
    if (!regular || solution.d.size() != right.size() || !solution.d.allFinite()) {
      solution.reason = "singular matrix";
      return false;
    }
    return true;
  }

  void add_contact(const StepProblem& problem, const ContactTrial& contacts, std::size_t c, Eigen::VectorXd& right) {
    const Contact& contact = problem.contacts[c];
    if (contacts.status(c) == ContactStatus::open) return;
    const bool locked = contacts.status(c) == ContactStatus::sticking;
    const ContactSprings springs = contacts.springs(c);
    const double kn = springs.normal + springs.normal_damping, ks = locked ? springs.shear + springs.shear_damping : 0.0;
    const double normal = -springs.normal * (springs.gap - springs.target) + viscous_normal(springs, contacts.strength(c), 0.0);
    const double shear = locked ? springs.initial_shear : contacts.forces(c).shear;
    applied_shear_[c] = shear;
    const ContactKinematics& k = kinematics_[c];
    const int equations[] = {problem.system.block(contact.vertex_block).equation, problem.system.block(contact.edge_block).equation};
    const Unknowns normals[] = {k.normal_vertex, k.normal_edge}, shears[] = {k.shear_vertex, k.shear_edge};
    for (int i = 0; i < 2; ++i) {
      if (equations[i] < 0) continue;
      right.segment<dofs>(dofs * equations[i]) += normal * normals[i] + shear * shears[i];
      for (int j = 0; j < 2; ++j) {
        if (equations[j] < 0) continue;
        const Motion::Matrix stiffness = kn * normals[i] * normals[j].transpose() + ks * shears[i] * shears[j].transpose();
        tangent_.matrix().add(equations[i], equations[j], stiffness);
      }
    }
  }

  /// Moves every contact to the state its springs ask for; true if any state has changed. Forces are updated either way.
  bool change_states(const StepProblem& problem, StepSolution& solution) {
    ContactTrial& contacts = solution.contacts;
    bool changed = false;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const Contact& contact = problem.contacts[c];
      const ContactKinematics& k = kinematics_[c];
      const auto path = [&](int b, const Unknowns& gradient) {
        const int i = problem.system.block(b).equation;
        return i < 0 ? 0.0 : gradient.dot(solution.d.segment<dofs>(dofs * i));
      };
      const double gap_change = path(contact.vertex_block, k.normal_vertex) + path(contact.edge_block, k.normal_edge);
      const double slip_change = path(contact.vertex_block, k.shear_vertex) + path(contact.edge_block, k.shear_edge);
      const ContactStatus before = contacts.status(c);
      contacts.set(c, next_forces(problem, contacts, c, gap_change, slip_change), gap_change, slip_change);
      // A contact locks again with the friction it has, not with what its spring held before it slid.
      if (before == ContactStatus::sliding && contacts.status(c) == ContactStatus::sticking)
        contacts.start(c).initial_shear[ContactTrial::lane(c)] = contacts.forces(c).shear;
      changed |= contacts.status(c) != before;
    }
    return changed;
  }

  static CarriedForces next_forces(const StepProblem& problem, const ContactTrial& contacts, std::size_t c, double gap_change, double slip_change) {
    const ContactSprings springs = contacts.springs(c);
    const ContactStrength strength = contacts.strength(c);
    const ContactStatus before = contacts.status(c);
    const double shear_before = contacts.forces(c).shear;
    const double stretch = (springs.gap - springs.target) + gap_change;
    const double elastic = -springs.normal * stretch, normal = elastic + viscous_normal(springs, strength, gap_change);
    const double elastic_trial = springs.initial_shear - springs.shear * slip_change;
    const double trial = elastic_trial - springs.shear_damping * slip_change;
    const bool opens = normal < -strength.tension || (strength.tension == 0.0 && normal <= 0.0);
    CarriedForces f;
    if (opens || (before == ContactStatus::open && !closes(problem, contacts, c, stretch))) return f;
    f.normal = normal;
    f.elastic_normal = elastic;
    if (before == ContactStatus::open) {
      f.status = ContactStatus::sticking;
      f.shear = trial;
      f.elastic_shear = elastic_trial;
      return f;
    }
    const double bound = strength.shear_bound(normal).value;
    if (before == ContactStatus::sticking) {
      f.status = std::abs(trial) > bound ? ContactStatus::sliding : ContactStatus::sticking;
      f.shear = std::clamp(trial, -bound, bound);
      f.elastic_shear = std::clamp(elastic_trial, -bound, bound);
      return f;
    }
    const bool runs_against_friction = shear_before * slip_change > 0.0;
    f.status = runs_against_friction ? ContactStatus::sticking : ContactStatus::sliding;
    f.shear = f.elastic_shear = std::copysign(bound, shear_before);
    return f;
  }

  /// [J] By the strength of a contact that slides.
  static double friction_work(const ContactTrial& contacts, std::size_t c) { return std::abs(contacts.forces(c).shear * contacts.slip_change(c)); }
  /// [J] What the friction of the last pass missed that by.
  double missed_work(const ContactTrial& contacts, std::size_t c) const {
    return std::abs((applied_shear_[c] - contacts.forces(c).shear) * contacts.slip_change(c));
  }
  double missed_work(const ContactTrial& contacts) const {
    double missed = 0.0;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if (contacts.status(c) == ContactStatus::sliding) missed += missed_work(contacts, c);
    }
    return missed;
  }
  /// Every block for itself, so that none hides behind what others do; of what a block's contacts share the sum counts.
  bool slides_by_its_friction(const StepProblem& problem, const ContactTrial& contacts) {
    work_of_block_.assign(static_cast<std::size_t>(problem.system.free_count()), {});
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if (contacts.status(c) != ContactStatus::sliding) continue;
      for (const int b : {problem.contacts[c].vertex_block, problem.contacts[c].edge_block}) {
        const int equation = problem.system.block(b).equation;
        if (equation < 0) continue;
        FrictionWork& work = work_of_block_[static_cast<std::size_t>(equation)];
        work.of_strength += friction_work(contacts, c);
        work.missed += missed_work(contacts, c);
      }
    }
    return std::ranges::all_of(work_of_block_, [](const FrictionWork& work) { return work.missed <= missable_part_of_friction * work.of_strength; });
  }

  /// [m]
  static double default_penetration_tolerance(const BlockSystem& system) {
    return std::max(tolerance::deepest_initial_overlap_m, default_penetration_of_size * system.median_size());
  }

  void finish(const StepProblem& problem, StepSolution& solution) {
    std::optional<double> tolerated = problem.method.penetration_tolerance;
    ContactTrial& contacts = solution.contacts;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const double depth = contacts.status(c) == ContactStatus::open ? 0.0 : -(problem.contacts[c].gap + contacts.gap_change(c));
      if (depth <= tolerated.value_or(tolerance::deepest_initial_overlap_m)) continue;
      if (!tolerated) tolerated = default_penetration_tolerance(problem.system);
      if (depth > *tolerated) {
        solution.reason =
            fmt::format("penetration of {:.6g} m exceeds solver.penetration_tolerance_m = {:.6g}; a larger method.penalty_pa_per_m would reduce it",
                        depth, *tolerated);
        return;
      }
    }
    solution.converged = solution.first_order = true;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      // What a sliding contact carried in this step is the friction of the pass before.
      if (contacts.status(c) != ContactStatus::sliding) continue;
      CarriedForces f = contacts.forces(c);
      solution.friction_work += friction_work(contacts, c);
      solution.lagging_friction_work += missed_work(contacts, c);
      f.shear = f.elastic_shear = applied_shear_[c];
      contacts.set(c, f, contacts.gap_change(c), contacts.slip_change(c));
    }
  }

  std::vector<ContactKinematics> kinematics_;  ///< at the start of the step: changes of gap and slip are linear in the displacement
  struct FrictionWork {
    double of_strength = 0.0, missed = 0.0;  ///< [J]
  };
  std::vector<FrictionWork> work_of_block_;  ///< by equation, of the last pass
  std::vector<double> applied_shear_;        ///< [N] right side of the last pass
  TangentSystem tangent_;
  Memory memory_of_solution_;
};

}  // namespace

std::unique_ptr<Enforcement> make_shi() {
  return std::make_unique<Shi>();
}

}  // namespace openclose
