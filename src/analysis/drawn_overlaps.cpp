#include "openclose/analysis/drawn_overlaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "openclose/analysis/watch.h"
#include "openclose/core/error.h"
#include "openclose/core/tolerance.h"
#include "openclose/law/joint_law.h"

namespace openclose {
namespace {

using Unknowns = Motion::Unknowns;

/// [rad] Faces of one direction differ by less.
constexpr double same_direction_rad = 1e-6;

/// What drawn overlaps do to a free block.
struct PressedBlock {
  int block = 0;
  std::vector<double> directions;   ///< [rad] of the forces
  double force = 0.0;               ///< [N] sum of the magnitudes
  double friction = 0.0;            ///< [N] that goes with them
  double energy = 0.0;              ///< [J]
  double resistance = 0.0;          ///< [N] shear and tension that all its contacts can carry besides
  Unknowns net = Unknowns::Zero();  ///< [N, N, N m] sum of the forces
  double deepest = 0.0;             ///< [m]
  int into = 0;                     ///< the block of the deepest
  bool is_between_fixed = true;     ///< all of those it overlaps are fixed
};

/// [rad] The widest angle between neighbouring forces: more than pi where a translation opens all overlaps, pi where they press along one line.
double widest_opening(std::vector<double> directions) {
  std::ranges::sort(directions);
  double widest = directions.front() + 2.0 * std::numbers::pi - directions.back();
  for (std::size_t i = 1; i < directions.size(); ++i) widest = std::max(widest, directions[i] - directions[i - 1]);
  return widest;
}

class Judge {
 public:
  Judge(Simulation& simulation, FirstMotion first_motion)
      : simulation_(simulation), scene_(simulation.scene()), at_once_(first_motion == FirstMotion::at_once) {}

  std::vector<std::string> judge() {
    collect();
    for (const PressedBlock& pressed : blocks_) {
      if (pressed.deepest > 0.0 && !is_at_rest(pressed)) judge(pressed);
    }
    std::vector<std::string> warnings;
    for (const Worst* worst : {&clamped_, &thrown_}) {
      if (worst->count == 0) continue;
      const std::string others = worst->count > 1 ? fmt::format(" (the worst of {} such blocks)", worst->count) : "";
      warnings.push_back(fmt::format("{}: {}{}; a remedy: {}", scene_.where.file, worst->text, others, worst->remedy));
    }
    return warnings;
  }

 private:
  /// The worst of one kind of finding.
  struct Worst {
    int count = 0;
    double size = 0.0;
    std::string text, remedy;
  };

  bool is_rigid() const { return !simulation_.enforcement().has_elastic_contacts(); }

  void collect() {
    const std::vector<Contact>& contacts = simulation_.change_contacts();
    const BlockSystem& system = simulation_.system();
    const StepProblem problem = simulation_.problem(scene_.step.dt, !at_once_);
    blocks_.resize(static_cast<std::size_t>(system.block_count()));
    for (int b = 0; b < system.block_count(); ++b) blocks_[b].block = b;
    for (const int b : system.free_blocks()) all_loads_ += loads(b);
    for (const Contact& contact : contacts) {
      const Unknowns still = Unknowns::Zero();
      const ContactKinematics at(system, contact, still, still);
      const double stiffness = is_rigid() ? JointSprings(simulation_.joints().joint(contact.joint), contact.length).normal
                                          : simulation_.enforcement().springs(problem, contact).normal;
      add(contact, contact.vertex_block, contact.edge_block, at.normal_vertex, stiffness);
      add(contact, contact.edge_block, contact.vertex_block, at.normal_edge, stiffness);
    }
  }

  void add(const Contact& contact, int block, int other, const Unknowns& direction, double stiffness) {
    if (simulation_.system().block(block).equation < 0) return;
    PressedBlock& pressed = blocks_[block];
    const double depth = std::max(0.0, -contact.stretch()), force = stiffness * depth;
    const ContactStrength strength(simulation_.joints().joint(contact.joint), contact);
    pressed.resistance += strength.largest_shear(force) + strength.tension;
    pressed.net += force * direction;
    if (depth <= overlap_bound::rounding_m) return;
    pressed.force += force;
    pressed.friction += strength.friction * force;
    pressed.energy += 0.5 * force * depth;
    pressed.directions.push_back(std::atan2(direction.y(), direction.x()));
    pressed.is_between_fixed &= simulation_.system().block(other).equation == BlockSystem::fixed;
    if (depth <= pressed.deepest) return;
    pressed.deepest = depth;
    pressed.into = other;
  }

  /// [N] sum of the magnitudes of what acts on a block besides its contacts.
  double loads(int block) const { return simulation_.external().magnitude(simulation_.system(), block, Unknowns::Zero()); }

  /// Whether the overlaps may be closures at rest under what acts on the blocks: they balance it, and no force is larger than all of it.
  bool is_at_rest(const PressedBlock& pressed) const {
    const Unknowns sum = pressed.net + simulation_.external().force(simulation_.system(), pressed.block, Unknowns::Zero());
    const double unbalanced = Motion::largest_force(sum, simulation_.system().block(pressed.block).radius);
    return pressed.force <= 2.0 * all_loads_ && unbalanced <= pressed.resistance + overlap_bound::noticeable_force * loads(pressed.block);
  }

  void judge(const PressedBlock& pressed) {
    const double opening = widest_opening(pressed.directions);
    if (opening <= std::numbers::pi + same_direction_rad) {
      const bool is_locked = opening < std::numbers::pi - same_direction_rad;
      judge_clamped(pressed, is_locked ? 0.5 * pressed.force : pressed.friction);
    } else if (at_once_) {
      judge_thrown(pressed);
    }
  }

  /// \param holding  [N] what the clamping forces hold the block with: themselves, or their friction where they press along one line
  void judge_clamped(const PressedBlock& pressed, double holding) {
    if (holding == 0.0) return;
    const std::string overlap = overlap_in_words(pressed) + " and into others on opposite sides: ";
    if (is_rigid()) {
      const std::string text = overlap + "between rigid contacts it has no room, and what they press it with is undetermined";
      if (pressed.is_between_fixed) refuse(pressed, text, drawn_apart);
      note(clamped_, pressed.deepest, text, drawn_apart);
      return;
    }
    const double force = 0.5 * pressed.force, part = holding / loads(pressed.block);
    if (part <= overlap_bound::noticeable_force) return;
    const std::string text = fmt::format("{}the drawing alone clamps it with {:.3g} N, {}", overlap, force, in_weights(pressed.block, force));
    if (pressed.is_between_fixed && std::isfinite(part) && part > overlap_bound::deciding_force) refuse(pressed, text, drawn_apart);
    note(clamped_, part, text, drawn_apart);
  }

  void judge_thrown(const PressedBlock& pressed) {
    const std::string remedy = std::string(drawn_apart) + ", or method.start = \"settled\", by which overlaps come to rest before the motion begins";
    if (is_rigid()) {
      if (pressed.deepest <= watch_bound::gap_tolerances * scene_.method.gap_tolerance) return;
      const std::string text = fmt::format("{}: rigid contacts push it out at up to {:g} m/s, a speed that nothing but the drawing gives it",
                                           overlap_in_words(pressed), tolerance::hard_recovery_m_per_s);
      note(thrown_, pressed.deepest, text, remedy);
      return;
    }
    const BlockSystem::Block& block = simulation_.system().block(pressed.block);
    const double lift = pressed.energy / loads(pressed.block), way = std::sqrt(2.0 * pressed.energy / block.mass[0]) * scene_.end_time;
    const double part = std::min(lift, way) / std::sqrt(block.area);
    if (part <= overlap_bound::noticeable_way) return;
    const std::string text =
        fmt::format("{}: the drawing alone presses it with {:.3g} N, {}, and stores {:.3g} J, which can move it by {:.2g} of its size",
                    overlap_in_words(pressed), pressed.force, in_weights(pressed.block, pressed.force), pressed.energy, part);
    if (part > overlap_bound::deciding_way) refuse(pressed, text, remedy);
    note(thrown_, part, text, remedy);
  }

  std::string overlap_in_words(const PressedBlock& pressed) const {
    return fmt::format("\"{}\" is drawn {:.3g} m into \"{}\"", scene_.blocks[pressed.block].name, pressed.deepest, scene_.blocks[pressed.into].name);
  }

  std::string in_weights(int block, double force) const {
    const double acting = loads(block);
    return acting > 0.0 ? fmt::format("{:.2g} times its weight and loads", force / acting) : "while nothing else acts on it";
  }

  [[noreturn]] void refuse(const PressedBlock& pressed, const std::string& text, const std::string& remedy) const {
    throw InputError(scene_.place_of(scene_.blocks[pressed.block]), "block", text, remedy);
  }

  static void note(Worst& worst, double size, const std::string& text, const std::string& remedy) {
    if (++worst.count > 1 && size <= worst.size) return;
    worst.size = size;
    worst.text = text;
    worst.remedy = remedy;
  }

  static constexpr const char* drawn_apart = "blocks that touch or lie apart (move vertices_m by that much)";

  Simulation& simulation_;
  const Scene& scene_;
  bool at_once_;
  double all_loads_ = 0.0;  ///< [N] of all free blocks
  std::vector<PressedBlock> blocks_;
  Worst clamped_, thrown_;
};

}  // namespace

std::vector<std::string> judge_drawn_overlaps(Simulation& simulation, FirstMotion first_motion) {
  return Judge(simulation, first_motion).judge();
}

}  // namespace openclose
