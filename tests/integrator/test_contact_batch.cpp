// Contacts four at a time against the same contacts one by one: the same to the last bit.
#include <array>
#include <random>
#include <vector>

#include "openclose/contact/mean_pose.h"
#include "openclose/integrator/contact_batch.h"
#include "openclose/law/path_average.h"
#include "support/catch.h"
#include "support/contact_stiffness.h"
#include "support/dense.h"

using namespace openclose;

namespace {

constexpr int block_count = 12, free_count = 9;  // the last ones are fixed

/// Contacts in every state: open and closed, bonded or not, with dashpots that outweigh the spring or not, sliding both ways, on the cohesion's ramp.
struct RandomContacts {
  explicit RandomContacts(unsigned seed, std::size_t count) : random(seed), moves(block_count + 1) {
    for (int b = 0; b < free_count; ++b) {
      moves[b] = BlockMove({number(1e-3), number(1e-3), number(1e-3)}, seed % 2 == 0 ? RotationKind::exact : RotationKind::linear, 7.0);
    }
    for (std::size_t c = 0; c < count; ++c) {
      ContactPlace at;
      const double angle = number(3.0);
      at.edge = (5.0 + number(4.0)) * Vec2(std::cos(angle), std::sin(angle));
      at.vertex_arm = {number(5.0), number(5.0)};
      at.end_arm = {number(5.0), number(5.0)};
      at.lever = number(1.0) * at.edge + number(1e-3) * Vec2(-std::sin(angle), std::cos(angle));
      places.push_back(at);
      starts.emplace_back(at);
      ContactSprings s;
      s.normal = 1e9 * (2.0 + number(1.0));
      s.shear = 1e9 * (2.0 + number(1.0));
      s.gap = number(3e-3);
      s.target = chance(0.3) ? number(1e-3) : 0.0;
      s.shift = chance(0.3) ? number(1e6) : 0.0;
      s.initial_shear = number(3e6);
      if (chance(0.3)) {  // sticks while the normal force passes a kink of the shear bound
        s.shear *= 1e-2;
        s.initial_shear *= 1e-2;
      }
      if (chance(0.5)) s.normal_damping = 3e9 * std::abs(number(1.0));
      if (chance(0.5)) s.shear_damping = 3e9 * std::abs(number(1.0));
      if (chance(0.1)) s.dissipation = 0.1;
      springs.push_back(s);
      ContactStrength strength;
      strength.friction = chance(0.1) ? 0.0 : std::abs(number(1.0));
      if (chance(0.5)) strength.cohesion = std::abs(number(3e6));
      if (chance(0.3)) strength.tension = std::abs(number(2e6));
      strengths.push_back(strength);
      const int a = index(block_count);
      vertex_blocks.push_back(a);
      edge_blocks.push_back((a + 1 + index(block_count - 1)) % block_count);
    }
  }

  std::vector<ContactBatch> batches() const {
    std::vector<ContactBatch> list((starts.size() + batch_size - 1) / batch_size);
    for (std::size_t c = 0; c < batch_size * list.size(); ++c) {
      ContactBatch& batch = list[c / batch_size];
      const int lane = static_cast<int>(c % batch_size);
      const bool is_one = c < starts.size();
      batch.set_places(lane, is_one ? vertex_blocks[c] : block_count, is_one ? edge_blocks[c] : block_count);
      if (!is_one) continue;
      batch.set_geometry(lane, places[c]);
      batch.set_strength(lane, strengths[c]);
      batch.set_springs(lane, springs[c]);
    }
    return list;
  }
  /// [N] of a spring before anything has moved.
  double largest_start_force() const {
    double largest = 0.0;
    for (const ContactSprings& s : springs) largest = std::max({largest, s.shift - s.normal * (s.gap - s.target), std::abs(s.initial_shear)});
    return largest;
  }

  double number(double largest) { return std::uniform_real_distribution<double>(-largest, largest)(random); }
  int index(int end) { return std::uniform_int_distribution<int>(0, end - 1)(random); }
  bool chance(double probability) { return std::bernoulli_distribution(probability)(random); }

  std::mt19937 random;
  std::vector<BlockMove> moves;
  std::vector<ContactPlace> places;
  std::vector<ContactStart> starts;
  std::vector<ContactSprings> springs;
  std::vector<ContactStrength> strengths;
  std::vector<int> vertex_blocks, edge_blocks;
};

struct Evaluated {
  Evaluated(const RandomContacts& contacts, bool averaged, double ramp = tolerance::cohesion_ramp)
      : batches(contacts.batches()), trials(batches.size()), branches(batch_size * batches.size(), 77), rows(block_count + 1) {
    largest_at_start = openclose::begin(batches);
    largest = openclose::evaluate(averaged, ramp, batches, contacts.moves.data(), trials, branches, rows);
    elastic.resize(trials.size());
    openclose::find_elastic(ramp, batches, trials, elastic);
  }
  std::vector<ContactBatch> batches;
  std::vector<TrialBatch> trials;
  std::vector<ElasticBatch> elastic;
  std::vector<Branch> branches;
  std::vector<ForceRow> rows;
  double largest_at_start, largest;
};

/// As openclose::spring_slider(), for the joint law with any ramp of the cohesion.
ContactForces spring_slider(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change, double ramp) {
  ContactForces f;
  f.elastic_normal = springs.shift - springs.normal * ((springs.gap - springs.target) + gap_change);
  if (is_open(strength, f.elastic_normal)) return {};
  const double elastic_shear = springs.initial_shear - springs.shear * slip_change, shear = elastic_shear + -springs.shear_damping * slip_change;
  const MohrCoulomb<double> carried(strength.friction, strength.cohesion, strength.tension,
                                    f.elastic_normal + viscous_normal(springs, strength, gap_change), shear, ramp);
  f.status = carried.is_sticking ? ContactStatus::sticking : ContactStatus::sliding;
  f.normal = carried.normal;
  f.shear = carried.shear;
  f.elastic_shear = carried.limit.of(elastic_shear);
  const bool dashpot_outweighs = springs.normal_damping > 0.0 && f.normal <= -strength.tension;
  f.normal_by_gap = dashpot_outweighs ? 0.0 : -(springs.normal + springs.normal_damping);
  if (carried.is_sticking) {
    f.shear_by_slip = -(springs.shear + springs.shear_damping);
  } else {
    f.shear_by_gap = std::copysign(carried.limit.slope, shear) * f.normal_by_gap;
  }
  return f;
}

/// One contact by itself.
struct Single {
  Single(const RandomContacts& contacts, std::size_t c, bool averaged, double ramp = tolerance::cohesion_ramp)
      : pose(contacts.starts[c], contacts.moves[contacts.vertex_blocks[c]], contacts.moves[contacts.edge_blocks[c]]) {
    const ContactSprings& s = contacts.springs[c];
    acting = averaged ? mean_pose(contacts.starts[c], pose) : pose;
    forces = averaged                           ? path_average(s, contacts.strengths[c], pose.gap_change, pose.slip_change, s.dissipation).mean
             : ramp == tolerance::cohesion_ramp ? openclose::spring_slider(s, contacts.strengths[c], pose.gap_change, pose.slip_change)
                                                : spring_slider(s, contacts.strengths[c], pose.gap_change, pose.slip_change, ramp);
  }
  /// Open at the end of the step, it may have carried a force on the way.
  bool carries() const { return forces.status != ContactStatus::open || forces.normal != 0.0 || forces.normal_by_gap != 0.0; }

  ContactPose pose, acting;
  ContactForces forces;
};

/// How many differ, whatever the sign of zero.
int differences(const ContactPose& a, const ContactPose& b) {
  return (a.normal != b.normal) + (a.vertex_arm != b.vertex_arm) + (a.edge_arm != b.edge_arm) + (a.gap_change != b.gap_change) +
         (a.slip_change != b.slip_change);
}
int differences(const TrialBatch& a, int lane, const ContactForces& b) {
  return (a.normal[lane] != b.normal) + (a.shear[lane] != b.shear) + (a.normal_by_gap[lane] != b.normal_by_gap) +
         (a.shear_by_gap[lane] != b.shear_by_gap) + (a.shear_by_slip[lane] != b.shear_by_slip);
}

}  // namespace

TEST_CASE("four contacts at a time are where each is and carry what each carries", "[integrator][batch]") {
  const std::size_t count = GENERATE(0, 1, 3, 4, 401);
  const unsigned seed = GENERATE(1, 2);
  const bool averaged = GENERATE(false, true);
  const double ramp = averaged ? tolerance::cohesion_ramp : GENERATE(as<double>(), tolerance::cohesion_ramp, 1.0);
  const RandomContacts contacts(seed, count);
  const Evaluated all(contacts, averaged, ramp);
  std::vector<std::array<Eigen::Vector4d, 2>> sums(block_count + 1, {Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero()});
  double largest = 0.0;
  int wrong = 0, of_status[3] = {}, outweighed = 0, backward = 0, opened = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const int lane = static_cast<int>(c % batch_size), a = contacts.vertex_blocks[c], b = contacts.edge_blocks[c];
    const ContactSprings& s = contacts.springs[c];
    const Single one(contacts, c, averaged, ramp);
    const ContactForces& f = one.forces;
    const TrialBatch& trial = all.trials[c / batch_size];
    wrong += (trial.gap_change[lane] != one.pose.gap_change) + (trial.slip_change[lane] != one.pose.slip_change);
    wrong += differences(trial, lane, f) + (all.branches[c] != branch(f));
    if (!averaged) {
      const ElasticBatch& elastic = all.elastic[c / batch_size];
      wrong += (elastic.normal[lane] != f.elastic_normal) + (elastic.shear[lane] != f.elastic_shear);
    }
    wrong += differences(all.batches[c / batch_size].pose(lane, contacts.moves), one.pose);
    ++of_status[static_cast<int>(f.status)];
    outweighed += f.status != ContactStatus::open && f.normal_by_gap == 0.0;
    backward += all.branches[c] == branch(ContactStatus::sliding, true);
    if (!one.carries()) continue;
    opened += f.status == ContactStatus::open;
    const double moved = contacts.moves[a].bound + contacts.moves[b].bound;
    const double rounding =
        tolerance::rounding_of_sums * ((s.normal + s.normal_damping + s.shear + s.shear_damping) * moved + std::abs(f.normal) + std::abs(f.shear));
    const Vec2& n = one.acting.normal;
    const Vec2 force(f.normal * n.x() - f.shear * n.y(), f.normal * n.y() + f.shear * n.x());
    Eigen::Vector4d on_vertex, on_edge;
    on_vertex << Motion::gradient(one.acting.vertex_arm, force), rounding;
    on_edge << -Motion::gradient(one.acting.edge_arm, force), rounding;
    sums[a][c % 2] += on_vertex;
    sums[b][c % 2] += on_edge;
    largest = std::max({largest, std::abs(f.normal), std::abs(f.shear)});
  }
  CHECK(wrong == 0);
  for (std::size_t c = count; c < all.branches.size(); ++c) CHECK(all.branches[c] == 0);
  for (int row = 0; row <= block_count; ++row) {
    for (int i = 0; i < 4; ++i) {
      CHECK(all.rows[row].sums[i] == sums[row][0][i]);
      CHECK(all.rows[row].of_odd_lanes[i] == sums[row][1][i]);
    }
  }
  CHECK(all.largest == largest);
  CHECK(all.largest_at_start == contacts.largest_start_force());
  if (count < 100) return;
  for (const int number : of_status) CHECK(number > 20);
  CHECK(backward > 20);
  if (!averaged) CHECK(outweighed > 5);
  if (averaged) CHECK(opened > 20);
}

TEST_CASE("the stiffness of four contacts at a time is that of each", "[integrator][batch]") {
  const std::size_t count = GENERATE(5, 401);
  const unsigned seed = GENERATE(1, 2);
  const bool exact = GENERATE(false, true);
  const bool averaged = GENERATE(false, true);
  const double end_weight = averaged ? 1.0 : GENERATE(1.0, 0.6);
  const RandomContacts contacts(seed, count);
  const Evaluated all(contacts, averaged);
  const BatchTangent tangent{averaged, exact, end_weight, exact ? 0.0 : GENERATE(0.0, 0.01), averaged ? true : GENERATE(false, true)};
  const double held = 5e8;  // [N/m] of open contacts, where they may have a stiffness
  std::vector<TrialBatch> trials = all.trials;
  for (std::size_t c = 0; c < count; ++c) {
    if (!averaged && tangent.open_ones_too && status(all.branches[c]) == ContactStatus::open)
      trials[c / batch_size].normal_by_gap[c % batch_size] = -held;
  }

  std::vector<std::pair<int, int>> couplings;
  for (int i = 0; i < free_count; ++i) {
    for (int j = 0; j < i; ++j) couplings.emplace_back(i, j);
  }
  BlockMatrix matrix, expected;
  matrix.set_pattern(free_count, couplings);
  expected.set_pattern(free_count, couplings);
  MatrixSlots slots{std::vector<ContactSlots>(all.branches.size(), {matrix.nobody(), matrix.nobody()}),
                    std::vector<int>(block_count + 1, matrix.nobody())};
  for (int row = 0; row < free_count; ++row) slots.diagonals[row] = matrix.diagonal(row);
  for (std::size_t c = 0; c < count; ++c) {
    const int a = contacts.vertex_blocks[c], b = contacts.edge_blocks[c];
    if (a < free_count && b < free_count) slots.of_contacts[c] = {matrix.find(a, b), matrix.find(b, a)};
  }
  openclose::add_stiffness(all.batches, contacts.moves.data(), trials, all.branches, tangent, slots, matrix);

  for (std::size_t c = 0; c < count; ++c) {
    const Single one(contacts, c, averaged);
    const ContactPose &pose = one.pose, &acting = exact ? one.acting : pose;
    ContactForces f = one.forces;
    if (!averaged && f.status == ContactStatus::open) {
      if (!tangent.open_ones_too) continue;
      f.normal_by_gap = -held;
    }
    const double nn = -end_weight * f.normal_by_gap, tn = exact ? -end_weight * f.shear_by_gap : 0.0;
    double tt = -end_weight * f.shear_by_slip;
    if (f.status == ContactStatus::sliding && tangent.static_slip_stiffness > 0.0) tt = tangent.static_slip_stiffness * contacts.springs[c].shear;
    const Vec2 n = pose.normal, t = pose.tangent(), force_n = acting.normal, force_t = acting.tangent();
    const Vec2 by_gap = nn * force_n + tn * force_t, by_slip = tt * force_t;
    test::ContactStiffness k;
    k.shift_xx = by_gap.x() * n.x() + by_slip.x() * t.x();
    k.shift_xy = by_gap.x() * n.y() + by_slip.x() * t.y();
    k.shift_yx = by_gap.y() * n.x() + by_slip.y() * t.x();
    k.shift_yy = by_gap.y() * n.y() + by_slip.y() * t.y();
    k.vertex_arm = pose.vertex_arm;
    k.edge_arm = pose.edge_arm;
    k.force_vertex_arm = acting.vertex_arm;
    k.force_edge_arm = acting.edge_arm;
    if (exact) {
      const double share = averaged ? 0.5 : end_weight;
      k.turning = share * (f.normal * n + f.shear * t);
      k.on_arms = share * (f.normal * force_n + f.shear * force_t);
    }
    const int a = contacts.vertex_blocks[c], b = contacts.edge_blocks[c];
    if (a < free_count) k.add_to_vertex(expected.value(expected.diagonal(a)));
    if (b < free_count) k.add_to_edge(expected.value(expected.diagonal(b)));
    if (a >= free_count || b >= free_count) continue;
    k.add_to_vertex_edge(expected.value(expected.find(a, b)));
    k.add_to_edge_vertex(expected.value(expected.find(b, a)));
  }
  INFO("exact " << exact << " count " << count << " theta " << end_weight << " slip " << tangent.static_slip_stiffness);
  CHECK((test::dense(matrix) - test::dense(expected)).cwiseAbs().maxCoeff() == 0.0);
  CHECK((count < 100 || test::dense(matrix).cwiseAbs().maxCoeff() > 1e9));
}
