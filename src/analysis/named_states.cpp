#include "openclose/analysis/named_states.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace openclose {
namespace {

constexpr double drawn_travel = 0.5;      ///< [-] of the median block's size by which the fastest block of a mechanism is drawn away
constexpr double most_drawn_turn = 0.25;  ///< [rad] of any of its blocks: drawn to first order, areas grow by the square of it

void move_block(const FrozenSystem& system, int row, const BlockVector& d, BlockSystem& blocks) {
  const FrozenBlock& block = system.blocks()[row];
  blocks.advance(block.block, {d[0], d[1], d[2] / (block.radius * system.length_unit())});
}

}  // namespace

NamedState stable_state(const Scene& drawn, const FrozenSystem& system, const FrozenState& state) {
  NamedState named{"stable", BlockSystem(drawn), {}};
  for (int row = 0; row < system.rows(); ++row) move_block(system, row, state.displacement[row] * system.closure_unit(), named.system);
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const FrozenContactState& s = state.contacts[i];
    Contact contact = system.contacts()[i].source;
    contact.gap = s.gap * system.closure_unit();
    contact.normal_force = s.normal * system.force_unit();
    contact.shear_force = s.shear * system.force_unit();
    contact.status = s.status;
    contact.joint_state = s.joint_state;
    named.contacts.push_back(contact);
  }
  return named;
}

Mechanism mechanism_of(const Scene& drawn, const FrozenSystem& system, const Eigen::VectorXd& direction) {
  Scene first_order = drawn;
  first_order.method.rotation = RotationKind::linear;
  Mechanism mechanism{{"failed", BlockSystem(first_order), {}, true}, {}};
  BlockSystem& blocks = mechanism.state.system;
  double fastest = 0.0, fastest_turn = 0.0;
  const auto speed = [&](int row) { return direction.segment<2>(3 * row).norm() + std::abs(direction[3 * row + 2]); };
  for (int row = 0; row < system.rows(); ++row) {
    fastest = std::max(fastest, speed(row));
    fastest_turn = std::max(fastest_turn, std::abs(direction[3 * row + 2]) / system.blocks()[row].radius);
  }
  const double travel = fastest_turn > 0.0 ? std::min(drawn_travel, most_drawn_turn * fastest / fastest_turn) : drawn_travel;
  for (int row = 0; row < system.rows(); ++row) {
    const BlockVector velocity = direction.segment<3>(3 * row) / fastest;
    move_block(system, row, velocity * travel * system.length_unit(), blocks);
    if (speed(row) <= slowest_of_mechanism * fastest) continue;
    const FrozenBlock& block = system.blocks()[row];
    mechanism.blocks.push_back(
        {block.block, blocks.block(block.block).area, block.centroid, velocity.head<2>(), velocity[2] / (block.radius * system.length_unit())});
  }
  return mechanism;
}

}  // namespace openclose
