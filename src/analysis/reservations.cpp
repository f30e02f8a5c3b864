#include "openclose/analysis/reservations.h"

#include <fmt/format.h>

#include <algorithm>

namespace openclose {
namespace {

bool is_of(const FrozenContact& contact, const std::vector<char>& chosen) {
  return (contact.a >= 0 && chosen[contact.a]) || (contact.b >= 0 && chosen[contact.b]);
}

std::vector<char> marked(const FrozenSystem& system, const std::vector<int>& rows) {
  std::vector<char> chosen(system.rows(), 0);
  for (const int row : rows) chosen[row] = 1;
  return chosen;
}

}  // namespace

std::vector<int> rows_of(const FrozenSystem& system, const std::vector<FailingBlock>& mechanism) {
  std::vector<int> failing;
  for (const FailingBlock& block : mechanism) failing.push_back(block.block);
  std::ranges::sort(failing);
  std::vector<int> rows;
  for (int row = 0; row < system.rows(); ++row) {
    if (std::ranges::binary_search(failing, system.blocks()[row].block)) rows.push_back(row);
  }
  return rows;
}

std::optional<CornerLoad> heaviest_lone_corner(const FrozenSystem& system, const FrozenState& state, const std::vector<int>& rows) {
  const std::vector<char> chosen = marked(system, rows);
  double weight = 0.0;
  for (const int row : rows) weight += system.blocks()[row].weight;
  CornerLoad heaviest;
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const FrozenContact& contact = system.contacts()[i];
    if (contact.joined_length > 0.0 || !is_of(contact, chosen)) continue;
    const double share = state.contacts[i].normal / weight;
    if (share > heaviest.share) heaviest = {static_cast<int>(i), share};
  }
  return heaviest.contact < 0 ? std::nullopt : std::optional(heaviest);
}

std::string in_words(const Scene& scene, const FrozenSystem& system, const CornerLoad& corner) {
  const FrozenContact& c = system.contacts()[corner.contact];
  return fmt::format("the corner at ({:.4g}, {:.4g}) m of block {}, alone on block {}, carries {:.0f} % of the weight of what fails", c.point.x(),
                     c.point.y(), scene.blocks[c.source.vertex_block].name, scene.blocks[c.source.edge_block].name, 100.0 * corner.share);
}

double withheld_strength(const FrozenSystem& system, const FrozenStrength& strength, const FrozenState& state, const std::vector<int>& rows) {
  const std::vector<char> chosen = marked(system, rows);
  double whole = 0.0, there = 0.0;
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    if (!is_of(system.contacts()[i], chosen)) continue;
    const FrozenContactState& s = state.contacts[i];
    const ContactStrength bounds = strength.of(i, s.joint_state);
    const double normal = std::max(s.normal, -bounds.tension);
    whole += std::max(0.0, bounds.friction * normal + bounds.cohesion);
    there += bounds.largest_shear(normal);
  }
  return whole > 0.0 ? 1.0 - there / whole : 0.0;
}

bool is_about_to_crack(const FrozenSystem& system, const FrozenStrength& strength, const FrozenState& state, const std::vector<int>& rows) {
  constexpr double nearly = 0.98;  // [-] of the strength at the edge
  const std::vector<char> chosen = marked(system, rows);
  const std::vector<double> pulls = strength.pulls_at_edges(state);
  for (std::size_t i = 0; i < pulls.size(); ++i) {
    if (is_of(system.contacts()[i], chosen) && pulls[i] > nearly) return true;
  }
  return false;
}

std::string withheld_in_words(double share) {
  return fmt::format(
      "it counts the whole cohesion of joints on which hardly anything presses, or that open; here {:.2g} % of the strength along what fails "
      "is not there, since cohesion comes with the normal force, up to ten times that",
      100.0 * share);
}

std::string interval_in_words(const StrengthBracket& bracket, const std::vector<StrengthTrial>& trials) {
  std::optional<double> first;
  for (const StrengthTrial& trial : trials) {
    const bool is_open = trial.outcome == TrialOutcome::undecided && trial.criterion != by_breaking_joints && trial.srf > *bracket.stable;
    if (is_open && (!first || trial.srf < *first)) first = trial.srf;
  }
  if (!first) return {};
  // A multiplier may stand at 0 alone.
  const std::string width = bracket.failed && *bracket.stable > 0.0
                                ? fmt::format("an interval, {:.2g} % wide", 100.0 * (*bracket.failed / *bracket.stable - 1.0))
                            : bracket.failed ? "an interval"
                                             : "an interval without an end";
  return fmt::format(
      "{}: at {:.4g} the blocks neither came to rest nor moved steadily; another method.contact or strength_reduction.definition may tell "
      "more, fewer blocks do",
      width, *first);
}

}  // namespace openclose
