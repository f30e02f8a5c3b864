#include "openclose/io/state_hash.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <string_view>

#include "openclose/core/check_sum.h"

namespace openclose {
namespace {

/// The sum of one block or contact, number after number.
class Sum {
 public:
  void add(double number) { add_bits(std::bit_cast<std::uint64_t>(number + 0.0)); }
  void add(int number) { add_bits(static_cast<std::uint64_t>(static_cast<std::int64_t>(number))); }
  void add(const Vec2& point) {
    add(point.x());
    add(point.y());
  }
  void add(const Motion::Unknowns& motion) {
    for (const double number : motion) add(number);
  }
  /// With its length, so that what follows cannot be taken for its end.
  void add(const std::string& text) {
    add(static_cast<int>(text.size()));
    sum_ = check_sum(text, sum_);
  }
  std::uint64_t value() const { return sum_; }

 private:
  /// From the lowest byte up, whatever the order in memory.
  void add_bits(std::uint64_t bits) {
    std::array<char, sizeof bits> bytes;
    for (char& byte : bytes) {
      byte = static_cast<char>(bits & 0xffu);
      bits >>= 8u;
    }
    sum_ = check_sum(std::string_view(bytes.data(), bytes.size()), sum_);
  }

  std::uint64_t sum_ = empty_check_sum;
};

std::uint64_t hash_of_block(const Scene& scene, const BlockSystem& system, int b, const Motion::Unknowns& velocity) {
  Sum sum;
  sum.add(scene.blocks[b].name);
  sum.add(system.displacement(b));
  sum.add(velocity);
  const BlockSystem::Block& block = system.block(b);
  for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) sum.add(system.arm(v));
  return sum.value();
}

std::uint64_t hash_of_contact(const Scene& scene, const BlockSystem& system, const Contact& c) {
  Sum sum;
  sum.add(scene.blocks[c.vertex_block].name);
  sum.add(c.vertex - system.block(c.vertex_block).first_vertex);
  sum.add(scene.blocks[c.edge_block].name);
  sum.add(c.edge - system.block(c.edge_block).first_vertex);
  sum.add(static_cast<int>(c.status));
  for (const double number : c.joint_state.numbers()) sum.add(number);
  for (const double number : {c.gap, c.normal_force, c.shear_force}) sum.add(number);
  return sum.value();
}

std::uint64_t hash_of_contacts(const Scene& scene, const BlockSystem& system, const std::vector<Contact>& contacts) {
  std::uint64_t total = 0;
  for (const Contact& c : contacts) total += hash_of_contact(scene, system, c);
  return total;
}

std::string digits(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

}  // namespace

std::string state_hash(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const BlockSystem& system = simulation.system();
  const ContactSet& contacts = simulation.state().contacts;
  std::uint64_t total = hash_of_contacts(scene, system, contacts.moving) + hash_of_contacts(scene, system, contacts.resting);
  for (int b = 0; b < system.block_count(); ++b) total += hash_of_block(scene, system, b, simulation.velocity(b));
  return digits(total);
}

std::string state_hash(const FactorOfSafety& safety, const Scene& scene) {
  std::uint64_t total = 0;
  for (const NamedState& state : safety.states) {
    total += hash_of_contacts(scene, state.system, state.contacts);
    for (int b = 0; b < state.system.block_count(); ++b) total += hash_of_block(scene, state.system, b, Motion::Unknowns::Zero());
  }
  for (const StrengthTrial& trial : safety.trials) {
    Sum sum;
    sum.add(trial.srf);
    sum.add(static_cast<int>(trial.outcome));
    total += sum.value();
  }
  return digits(total);
}

}  // namespace openclose
