#include "openclose/analysis/watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/overlap.h"
#include "openclose/integrator/integrators.h"

namespace openclose {
namespace {

/// Steps that are checked one by one; after them each doubling of their number has half as many checks.
constexpr long first_steps = 128;
/// [-] Part of the pairs that a check looks at, so that each is looked at some times in a run and this is no more work than the rest of a check.
constexpr std::size_t turns = 32;
/// [-] A remedy asks for this much more than what would just have been enough.
constexpr double margin = 2.0;

/// [-] Of energies [J]. None is no part, also of a run that came to nothing and had no energy; what is no number stays none, so no bound holds it.
double part_of(double energy, double available) {
  return energy <= 0.0 ? 0.0 : energy / available;
}

/// How many blocks stand on each other: in the scene as it starts, from what is fixed to the block that the most others part from it; no fewer than
/// in a pile of all.
double stacked_blocks(const Simulation& simulation) {
  const BlockSystem& system = simulation.system();
  const double pile = std::sqrt(static_cast<double>(system.free_count()));
  const int far = system.block_count();
  std::vector<int> level(system.block_count(), far);
  for (int b = 0; b < system.block_count(); ++b) {
    if (system.block(b).equation == BlockSystem::fixed) level[b] = 0;
  }
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (const Contact& c : simulation.contacts()) {
      for (const auto& [from, to] : {std::pair(c.vertex_block, c.edge_block), std::pair(c.edge_block, c.vertex_block)}) {
        if (level[from] + 1 >= level[to]) continue;
        level[to] = level[from] + 1;
        is_new = true;
      }
    }
  }
  double most = pile;
  for (const int l : level) most = std::max(most, l < far ? static_cast<double>(l) : 0.0);
  return most;
}

/// [m] To which a method tells where blocks are: rigid contacts may be off by their tolerance, and where blocks stand on each other these add up.
double undetermined_length(const Simulation& simulation) {
  if (simulation.enforcement().has_elastic_contacts()) return tolerance::rounding_of_ways_m;
  const double tolerated = watch_bound::gap_tolerances * simulation.scene().method.gap_tolerance;
  return std::max(stacked_blocks(simulation) * tolerated, tolerance::rounding_of_ways_m);
}

/// The corners of a block where it is, in the memory of others.
void take_corners(const BlockSystem& system, int b, Polygon& corners) {
  const auto& block = system.block(b);
  const Vec2 centroid = system.centroid(b);
  corners.clear();
  for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) corners.push_back(centroid + system.arm(v));
}

double perimeter(const Polygon& polygon) {
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) length += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
  return length;
}

std::string shorter_step(const Scene& scene, double factor) {
  return fmt::format("step.dt_s = {:.2g} would be a remedy", scene.step.dt / factor);
}

/// The key that makes a contact stiffer by a factor, with its value.
std::string stiffer_contact(const Simulation& simulation, int joint, double factor) {
  const MethodInput& method = simulation.scene().method;
  const double stiffness = simulation.scene().joints[joint].normal_stiffness;
  if (method.contact == "shi" && method.penalty)
    return fmt::format("method.penalty_pa_per_m = {:.2g} or more would be a remedy", factor * *method.penalty);
  return fmt::format("joint[{}].normal_stiffness_pa_per_m = {:.2g} or more would be a remedy", joint, factor * stiffness);
}

}  // namespace

/// What loads rigid contacts at once, or has them in each other, in a start that is not settled, leaves more than shorter steps mend.
std::string Watch::held_apart(const Simulation& simulation, std::initializer_list<int> blocks) const {
  const Scene& scene = simulation.scene();
  if (!is_rigid(simulation) || scene.method.start != Start::unloaded) return shorter_step(scene, margin);
  const auto has_moved = [&](int b) {
    return (Motion::translation(simulation.system().displacement(b)) - start_[b]).norm() > tolerance::contact_skin_m;
  };
  if (std::ranges::any_of(blocks, has_moved)) return shorter_step(scene, margin) + ", or method.start = \"settled\" if the blocks rest at first";
  return "method.start = \"settled\" would be a remedy if the blocks rest at first";
}

std::string Watch::better_energy(const Simulation& simulation) const {
  const Scene& scene = simulation.scene();
  if (simulation.is_explicit()) {
    // The step taken is the shorter one of the two.
    return fmt::format("method.step_fraction = {:.2g}, or step.dt_s = {:.2g}, would be a remedy", scene.method.step_fraction / margin,
                       std::min(scene.step.dt, simulation.state().counters.longest_step) / margin);
  }
  // What the open-close iteration takes from the pass before need not shrink with the step.
  if (scene.method.contact == "shi") return std::string(soft_instead_of_shi);
  if (scene.method.contact == "soft" && integrator_name(scene.method) != "path_average")
    return shorter_step(scene, margin) + ", or method.integrator = \"path_average\"";
  return held_apart(simulation, {static_cast<int>(std::ranges::max_element(energies_) - energies_.begin())});
}

bool Watch::is_due(long step) {
  long interval = 1;
  while (step / interval > first_steps) interval *= 2;
  return step % interval == 0;
}

void Watch::find_widths(const Simulation& simulation) {
  const BlockSystem& system = simulation.system();
  widths_.clear();
  convex_.clear();
  Polygon corners;
  for (int b = 0; b < system.block_count(); ++b) {
    const auto& block = system.block(b);
    take_corners(system, b, corners);
    widths_.push_back(2.0 * block.area / perimeter(corners));
    bool convex = true;
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) convex &= !system.is_reflex(v);
    convex_.push_back(convex);
  }
}

std::string Watch::begin(const Simulation& simulation) {
  const BlockSystem& system = simulation.system();
  find_widths(simulation);
  start_.clear();
  double weights = 0.0, kinetic = 0.0, supports = 0.0;
  for (int b = 0; b < system.block_count(); ++b) {
    start_.push_back(Motion::translation(system.displacement(b)));
    if (system.block(b).equation < 0) continue;
    weights += simulation.external().weight(system, b).norm();
    const auto v = simulation.velocity(b);
    kinetic += 0.5 * v.dot(system.block(b).mass.cwiseProduct(v));
  }
  for (const auto& element : simulation.external().elements()) {
    const ElementPath start = element->path(system, Motion::Unknowns::Zero());
    if (element->account() == ForceAccount::loads) weights += element->magnitude(start);
    supports += element->stored_energy(start);
  }
  const double undetermined = undetermined_length(simulation);
  undetermined_energy_ = weights * undetermined;
  groups_.begin(simulation, undetermined);
  energy_at_start_ = kinetic + supports + simulation.state().stored_contact_energy();
  report_.available_energy = energy_at_start_;
  depth_at_start_ = std::numeric_limits<double>::infinity();  // rigid contacts begin with what the drawing has
  std::string found = check_contacts(simulation);
  if (found.empty()) found = check_overlaps(simulation, 0, simulation.state().detector.candidate_pairs().size());
  depth_at_start_ = report_.depth;
  return found;
}

bool Watch::is_due(const Simulation& simulation, long step) const {
  return is_rigid(simulation) || is_due(step);
}

std::string Watch::check(const Simulation& simulation) {
  if (is_rigid(simulation)) return check_at_end(simulation);
  const std::size_t pairs = simulation.state().detector.candidate_pairs().size(), checks = static_cast<std::size_t>(report_.checks);
  const std::size_t now = (checks + 1) * pairs / turns - checks * pairs / turns;
  if (next_pair_ >= pairs) next_pair_ = 0;
  const std::size_t first = next_pair_;
  next_pair_ += now;
  return check(simulation, first, now);
}

std::string Watch::check_at_end(const Simulation& simulation) {
  return check(simulation, 0, simulation.state().detector.candidate_pairs().size());
}

std::string Watch::check(const Simulation& simulation, std::size_t first_pair, std::size_t pairs) {
  ++report_.checks;
  if (std::string wrong = check_finite(simulation); !wrong.empty()) return wrong;
  follow_energy(simulation);
  // What is deepest in each other comes first: it is where energy comes from, too, and has the better remedy.
  if (std::string wrong = check_places(simulation, first_pair, pairs); !wrong.empty()) return wrong;
  if (std::string wrong = check_energy(simulation); !wrong.empty()) return wrong;
  if (std::string wrong = check_groups(simulation); !wrong.empty()) return wrong;
  if (std::string wrong = check_friction(simulation); !wrong.empty()) return wrong;
  return check_reach(simulation);
}

std::string Watch::check_places(const Simulation& simulation, std::size_t first_pair, std::size_t pairs) {
  const StepCounters& counters = simulation.state().counters;
  const long moves = counters.steps - counters.still + simulation.state().changes;  // neither ever falls
  if (moves == seen_after_) return {};
  if (std::string wrong = check_contacts(simulation); !wrong.empty()) return wrong;
  if (std::string wrong = check_overlaps(simulation, first_pair, pairs); !wrong.empty()) return wrong;
  if (first_pair == 0 && pairs == simulation.state().detector.candidate_pairs().size()) seen_after_ = moves;
  return {};
}

std::string Watch::check_finite(const Simulation& simulation) const {
  const BlockSystem& system = simulation.system();
  for (int b : system.free_blocks()) {
    if (system.displacement(b).allFinite() && simulation.velocity(b).allFinite()) continue;
    return fmt::format("block \"{}\" has no finite position or velocity any more; {}", simulation.scene().blocks[b].name,
                       shorter_step(simulation.scene(), margin));
  }
  return {};
}

void Watch::follow_energy(const Simulation& simulation) {
  const BlockSystem& system = simulation.system();
  const EnergyLedger& ledger = simulation.ledger();
  energies_.assign(system.block_count(), 0.0);
  falls_.assign(system.block_count(), 0.0);
  double released = 0.0;
  const auto follow = [&](int b) {
    const auto& mass = system.block(b).mass;
    const auto v = simulation.velocity(b), w = system.velocity(b);
    // Where the two belong to different times, neither alone is a bound.
    energies_[b] = 0.5 * std::min(v.dot(mass.cwiseProduct(v)), w.dot(mass.cwiseProduct(w)));
    falls_[b] = mass[0] * simulation.external().gravity().dot(Motion::translation(system.displacement(b)) - start_[b]);
    released += std::max(0.0, falls_[b]);
  };
  for (int b : system.free_blocks()) follow(b);
  for (int b : system.resting_blocks()) follow(b);
  released_ = std::max(released_, released);
  work_ = std::max(work_, std::max(0.0, -ledger.loads) + std::max(0.0, -ledger.base_motion));
  report_.available_energy = energy_at_start_ + released_ + work_;
}

std::string Watch::check_energy(const Simulation& simulation) {
  const EnergyLedger& ledger = simulation.ledger();
  const double now = ledger.kinetic + ledger.gravity + ledger.contact_springs + ledger.support_springs + ledger.loads + ledger.base_motion;
  lowest_energy_ = std::min(lowest_energy_, now);
  // Of an explicit step the scheme's entry has what lies between friction at the end and motion at the middle of steps.
  const double by_scheme = simulation.is_explicit() ? 0.0 : -ledger.scheme;
  // Where gaps are followed to first order only, what the contact update corrects has gone to the scheme before.
  const double by_contacts = -ledger.redefinition + (simulation.enforcement().follows_gaps() ? 0.0 : -ledger.scheme);
  struct Source {
    double energy;
    const char* name;
  };
  const Source sources[] = {{now - lowest_energy_, "the mechanical energy rose"},
                            {by_contacts, "contacts that changed their edges or lengths released it"},
                            {-ledger.impact, "impacts released it"},
                            {by_scheme, "the time integration released it"},
                            {std::abs(ledger.imbalance()), "the energy ledger does not close"}};
  const double scale = energy_scale();
  // Comparisons pass over what is no number.
  if (!std::isfinite(scale) || !ledger.is_finite())
    return fmt::format("the energies are no finite numbers any more; {}", shorter_step(simulation.scene(), margin));
  const Source& worst = *std::ranges::max_element(sources, {}, &Source::energy);
  const double part = part_of(worst.energy, scale);
  report_.created_energy = std::max(report_.created_energy, part);
  if (part <= watch_bound::created_energy) return {};
  return fmt::format("energy was created: {:.3g} J where {:.3g} J were there to move anything ({:.2g} of it, at most {:g}; {}); {}", worst.energy,
                     scale, part, watch_bound::created_energy, worst.name, better_energy(simulation));
}

std::string Watch::in_words(const Simulation& simulation, const EnergyGroups::Worst& worst) {
  const std::string& name = simulation.scene().blocks[worst.block].name;
  const std::string group = worst.blocks > 1 ? fmt::format("the group of {} blocks around \"{}\"", worst.blocks, name) : fmt::format("\"{}\"", name);
  return fmt::format("{:.3g} J where {:.3g} J were there to move {}", worst.created, worst.scale, group);
}

std::string Watch::check_groups(const Simulation& simulation) {
  const EnergyGroups::Worst worst = groups_.worst(simulation, watch_bound::created_energy);
  if (worst.part > worst_group_.part) worst_group_ = worst;
  report_.created_energy = std::max(report_.created_energy, worst.part);
  if (worst.part <= watch_bound::created_energy_of_part) return {};
  return fmt::format("energy was created: {} ({:.2g} of it, at most {:g}; its mechanical energy rose); {}", in_words(simulation, worst), worst.part,
                     watch_bound::created_energy_of_part, better_energy(simulation));
}

std::string Watch::check_friction(const Simulation& simulation) {
  // What rigid contacts take in one blow their normal and shear forces may divide in any way.
  if (is_rigid(simulation)) return {};
  const double now = simulation.ledger().friction;
  most_friction_ = std::max(most_friction_, now);
  driven_ = std::max(driven_, most_friction_ - now);
  const double part = part_of(driven_, energy_scale());
  report_.created_energy = std::max(report_.created_energy, part);
  if (part <= watch_bound::created_energy_of_part) return {};
  return fmt::format(
      "energy was created: friction drove what slides by {:.3g} J where {:.3g} J were there to move anything ({:.2g} of it, at most {:g}); {}",
      driven_, energy_scale(), part, watch_bound::created_energy_of_part, better_energy(simulation));
}

std::vector<std::string> Watch::warnings(const Simulation& simulation) const {
  std::vector<std::string> list;
  if (worst_group_.part > watch_bound::created_energy)
    list.push_back(fmt::format("energy was created: {}, {:.2g} % of it; {}", in_words(simulation, worst_group_), 100.0 * worst_group_.part,
                               better_energy(simulation)));
  if (const double part = part_of(driven_, energy_scale()); part > watch_bound::created_energy)
    list.push_back(fmt::format("energy was created: friction drove what slides by {:.3g} J, {:.2g} % of the energy there was; {}", driven_,
                               100.0 * part, better_energy(simulation)));
  // See docs/methods.md.
  const bool is_exact = simulation.is_explicit() || simulation.state().scheme->end_weight() >= 1.0 || simulation.state().scheme->averages_path();
  const double damped = part_of(simulation.ledger().contact_damping, report_.available_energy);
  if (!is_exact && damped > watch_bound::noticeable_damping)
    list.push_back(
        fmt::format("dashpots took {:.2g} % of the energy, and with this integrator those that meet a bound converge to another motion (a "
                    "rebound of 0.33 for 0.21 at a damping ratio of 0.5); method.integrator = \"path_average\" would be a remedy",
                    100.0 * damped));
  return list;
}

std::string Watch::check_reach(const Simulation& simulation) {
  const BlockSystem& system = simulation.system();
  const double scale = energy_scale();
  for (int b : system.free_blocks()) {
    const double energy = energies_[b] + std::max(0.0, -falls_[b]);
    const double part = part_of(energy, scale);
    if (!(part <= report_.reach)) report_.reach = part;
    if (part <= 1.0 + watch_bound::created_energy) continue;
    const auto v = simulation.velocity(b);
    return fmt::format(
        "block \"{}\" moves at {:.3g} m/s, {:.3g} J above where it started, for which all of the energy that there was, {:.3g} J, is not enough; {}",
        simulation.scene().blocks[b].name, Motion::translation(v).norm(), std::max(0.0, -falls_[b]), scale, better_energy(simulation));
  }
  return {};
}

bool Watch::is_rigid(const Simulation& simulation) {
  return !simulation.enforcement().has_elastic_contacts();
}

double Watch::allowed_depth(const Simulation& simulation, double narrower) const {
  const double by_width = watch_bound::penetration * narrower;
  if (!is_rigid(simulation)) return by_width;
  const double tolerance = std::max(simulation.scene().method.gap_tolerance, tolerance::rounding_of_ways_m);
  return std::min(by_width, depth_at_start_ + watch_bound::gap_tolerances * tolerance);
}

std::string Watch::too_deep(const Simulation& simulation, int a, int b, double depth, double allowed) const {
  const auto& blocks = simulation.scene().blocks;
  const bool by_width = allowed >= watch_bound::penetration * std::min(widths_[a], widths_[b]);
  const char* reason = by_width ? "a quarter of the width, 2 area / perimeter, of the narrower one"
                                : "ten times solver.gap_tolerance_m, and what there was at the start";
  return fmt::format("\"{}\" and \"{}\" are {:.3g} m deep in each other, at most {:.3g} m ({})", blocks[a].name, blocks[b].name, depth, allowed,
                     reason);
}

std::string Watch::check_contacts(const Simulation& simulation) {
  double worst = 0.0;  // [-] of what is allowed
  const Contact* deepest = nullptr;
  for (const Contact& c : simulation.contacts()) {
    if (c.gap >= 0.0) continue;
    const double narrower = std::min(widths_[c.vertex_block], widths_[c.edge_block]);
    report_.penetration = std::max(report_.penetration, -c.gap / narrower);
    const double part = -c.gap / (watch_bound::penetration * narrower);
    if (part <= worst) continue;
    worst = part;
    deepest = &c;
  }
  if (deepest) report_.depth = std::max(report_.depth, -deepest->gap);
  if (worst <= 1.0) return {};
  const int a = deepest->vertex_block, b = deepest->edge_block;
  const double narrower = std::min(widths_[a], widths_[b]);
  const std::string found = too_deep(simulation, a, b, -deepest->gap, watch_bound::penetration * narrower);
  if (is_rigid(simulation)) return "rigid contacts have not been held: " + found + "; " + held_apart(simulation, {a, b});
  // The square of the closure goes with the energy that the springs have to take: what they have, and what still moves the two blocks.
  double stored = 0.0;
  for (const Contact& c : simulation.contacts()) {
    if (std::minmax(c.vertex_block, c.edge_block) == std::minmax(a, b)) stored += c.stored_energy;
  }
  const double moving = energies_.empty() ? 0.0 : energies_[a] + energies_[b];
  const double factor = margin * worst * worst * (stored > 0.0 ? 1.0 + moving / stored : 1.0);
  return "the springs are too soft for these blocks: " + found + "; " + stiffer_contact(simulation, deepest->joint, factor);
}

std::string Watch::check_overlaps(const Simulation& simulation, std::size_t first_pair, std::size_t pairs) {
  const BlockSystem& system = simulation.system();
  const auto& candidates = simulation.state().detector.candidate_pairs();
  Outline one, other;
  int first_block = -1;
  for (std::size_t i = first_pair; i < std::min(first_pair + pairs, candidates.size()); ++i) {
    const auto [a, b] = candidates[i];
    const double narrower = std::min(widths_[a], widths_[b]), allowed = allowed_depth(simulation, narrower);
    const double apart = (system.centroid(a) - system.centroid(b)).norm();
    if (apart >= system.block(a).radius + system.block(b).radius) continue;
    // Of a block all pairs come one after another.
    if (a != std::exchange(first_block, a)) take_corners(system, a, one.corners);
    take_corners(system, b, other.corners);
    one.is_convex = convex_[a] != 0;
    other.is_convex = convex_[b] != 0;
    const double depth = overlap_depth_beyond(allowed, one, other);
    report_.overlap = std::max(report_.overlap, depth / narrower);
    report_.depth = std::max(report_.depth, depth);
    if (depth <= allowed) continue;
    return "blocks have passed into each other: " + too_deep(simulation, a, b, depth, allowed) + "; " + held_apart(simulation, {a, b});
  }
  return {};
}

bool Watch::fits(const Simulation& simulation) const {
  const auto blocks = static_cast<std::size_t>(simulation.system().block_count());
  const bool has_worst = worst_group_.part == 0.0 || (worst_group_.block >= 0 && worst_group_.block < static_cast<int>(blocks));
  return start_.size() == blocks && widths_.size() == blocks && convex_.size() == blocks && groups_.fits(simulation) && has_worst;
}

}  // namespace openclose
