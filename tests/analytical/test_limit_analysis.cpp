#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "openclose/analytical/block_on_plane.h"
#include "openclose/analytical/goodman_bray.h"
#include "openclose/analytical/limit_analysis.h"
#include "openclose/analytical/planar_wedge.h"
#include "support/catch.h"

using namespace openclose::analytical;
using Catch::Matchers::ContainsSubstring;

namespace {

RigidBlock block_of(const std::vector<Point>& vertices, double density, const Point& gravity, bool fixed = false) {
  RigidBlock block;
  block.name = fixed ? "fixed" : "free";
  block.vertices = vertices;
  block.density = density;
  block.fixed = fixed;
  complete_block(block, gravity);
  return block;
}

RigidBlockAssembly assemble(std::vector<RigidBlock> blocks, const InterfaceStrength& strength) {
  RigidBlockAssembly assembly;
  assembly.interfaces = find_interfaces(blocks);
  assembly.blocks = std::move(blocks);
  for (Interface& i : assembly.interfaces) i.strength = strength;
  return assembly;
}

/// A block of width b and height h on a plane: in the frame of the plane, which falls to the right, gravity is inclined.
RigidBlockAssembly block_on_incline(double b, double h, double slope, const InterfaceStrength& strength) {
  const Point gravity(9.81 * std::sin(slope), -9.81 * std::cos(slope));
  return assemble({block_of({{-9, -1}, {9, -1}, {9, 0}, {-9, 0}}, 2500, gravity, true), block_of({{0, 0}, {b, 0}, {b, h}, {0, h}}, 2500, gravity)},
                  strength);
}

/// Force and moment about its centroid that each free block is short of, the largest over its weight.
double worst_imbalance(const RigidBlockAssembly& assembly, const LimitState& state) {
  std::vector<Eigen::Vector3d> sums;
  for (const RigidBlock& block : assembly.blocks) sums.push_back(block.load);
  for (std::size_t k = 0; k < assembly.interfaces.size(); ++k) {
    const Interface& i = assembly.interfaces[k];
    for (int e = 0; e < 2; ++e) {
      const Point force = state.forces[k][e].normal * i.normal + state.forces[k][e].shear * i.tangent();
      for (const auto& [number, sign] : {std::pair(i.a, 1.0), std::pair(i.b, -1.0)}) {
        const Point arm = i.ends[e] - assembly.blocks[number].centroid;
        sums[number] += sign * Eigen::Vector3d(force.x(), force.y(), arm.x() * force.y() - arm.y() * force.x());
      }
    }
  }
  double worst = 0;
  for (std::size_t b = 0; b < sums.size(); ++b) {
    const RigidBlock& block = assembly.blocks[b];
    if (block.fixed) continue;
    const double size = std::sqrt(block.area), weight = block.load.head<2>().norm();
    worst = std::max({worst, sums[b].head<2>().norm() / weight, std::abs(sums[b][2]) / (weight * size)});
  }
  return worst;
}

struct EndStrength {
  double constant, slope, tension;
};
EndStrength strength_of(const Interface& i, double factor) {
  const double half = i.length() / 2;
  return {i.strength.cohesion * half / factor, i.strength.friction / factor, i.strength.tension * half / factor};
}

/// By how much the forces exceed the strength, over the weight of the heaviest block.
double worst_excess(const RigidBlockAssembly& assembly, const LimitState& state) {
  double heaviest = 0, worst = 0;
  for (const RigidBlock& block : assembly.blocks) {
    if (!block.fixed) heaviest = std::max(heaviest, block.load.head<2>().norm());
  }
  for (std::size_t k = 0; k < assembly.interfaces.size(); ++k) {
    const EndStrength s = strength_of(assembly.interfaces[k], state.factor);
    for (const EndForce& f : state.forces[k]) {
      worst = std::max({worst, std::abs(f.shear) - s.constant - s.slope * f.normal, -s.tension - f.normal});
    }
  }
  return worst / heaviest;
}

struct WorkBalance {
  double loads = 0;              // [W]
  double strength = 0;           // [W] what sliding and tearing take up at the failed factor
  double worst_penetration = 0;  // [m/s] by which an interface opens less than the flow rule asks for
};

/// Of the mechanism, with the flow rule of `dilatancy` times the friction.
WorkBalance work_balance(const RigidBlockAssembly& assembly, const LimitState& state) {
  WorkBalance work;
  for (std::size_t b = 0; b < assembly.blocks.size(); ++b) {
    const BlockVelocity& m = state.mechanism[b];
    work.loads += assembly.blocks[b].load.dot(Eigen::Vector3d(m.velocity.x(), m.velocity.y(), m.rotation));
  }
  for (const Interface& i : assembly.interfaces) {
    const EndStrength s = strength_of(i, state.failed);
    for (const Point& end : i.ends) {
      const Point relative =
          velocity_at(assembly.blocks[i.a], state.mechanism[i.a], end) - velocity_at(assembly.blocks[i.b], state.mechanism[i.b], end);
      const double slip = std::abs(relative.dot(i.tangent())), opening = relative.dot(i.normal) - s.slope * slip;
      work.worst_penetration = std::max(work.worst_penetration, -opening);
      work.strength += s.constant * slip + s.tension * std::max(0.0, opening);
    }
  }
  return work;
}

double widest_bracket(double factor) {
  return std::max(LimitAnalysisOptions().width * std::min(1.0, factor), openclose::limit_analysis::narrowest_bracket * factor);
}

/// Both bounds of the bracket without the linear program: forces in equilibrium within the strength, and a mechanism that the loads drive.
/// \param slack  what the tolerance of the program, 1e-9 in weights, comes to in another block's weight
void check_bounds(const RigidBlockAssembly& assembly, const LimitState& state, double slack = 1e-7) {
  REQUIRE(state.found);
  CHECK(state.failed - state.factor <= widest_bracket(state.factor));
  CHECK(worst_imbalance(assembly, state) < slack);
  CHECK(worst_excess(assembly, state) < slack);
  const WorkBalance work = work_balance(assembly, state);
  CHECK(work.loads > work.strength);
  CHECK(work.worst_penetration < slack);
}

}  // namespace

TEST_CASE("limit analysis: block on an incline") {
  for (const double slope : {10 * degree, 30 * degree, 42 * degree}) {
    for (const double friction_angle : {0.0, 20 * degree, 35 * degree}) {
      for (const double cohesion : {0.0, 3000.0, 2e5}) {
        if (friction_angle == 0 && cohesion == 0) continue;
        const RigidBlockAssembly assembly = block_on_incline(2, 1, slope, {std::tan(friction_angle), cohesion, 0});
        const double weight = 2500 * 2 * 9.81;
        const double expected = std::tan(friction_angle) / std::tan(slope) + cohesion * 2 / (weight * std::sin(slope));
        const LimitState state = limit_analysis(assembly);
        check_bounds(assembly, state);
        CHECK(state.factor <= expected * (1 + 1e-8));
        CHECK(state.failed >= expected * (1 - 1e-8));
        // Forces along one plane: dilatancy changes nothing.
        LimitAnalysisOptions constant_volume;
        constant_volume.zero_dilatancy = true;
        // The bracket, and what the repetitions are still short of where they change by 2 widths and forget 0.4 of a change each time.
        CHECK(std::abs(limit_analysis(assembly, constant_volume).factor - expected) < widest_bracket(expected) * (1 + 2 * 0.4 / 0.6));
      }
    }
  }
}

TEST_CASE("limit analysis: a block topples when its weight points past its toe, at any strength without tension") {
  const double b = 1, h = 3, tips = std::atan(b / h);
  CHECK(limit_analysis(block_on_incline(b, h, tips - 1e-6, {2, 1e9, 0})).reason == "stands at every factor");
  const LimitState falls = limit_analysis(block_on_incline(b, h, tips + 1e-6, {2, 1e9, 0}));
  CHECK_FALSE(falls.found);
  CHECK(falls.reason == "no equilibrium at any factor");
  // The heel's half of the interface holds it back.
  for (const double slope : {25 * degree, 40 * degree}) {
    for (const double tension : {1e5, 4e5}) {
      const RigidBlockAssembly assembly = block_on_incline(b, h, slope, {5, 1e9, tension});
      const double weight = 2500 * b * h * 9.81;
      const double expected = tension * b * b / (weight * (h * std::sin(slope) - b * std::cos(slope)));
      const LimitState state = limit_analysis(assembly);
      check_bounds(assembly, state);
      CHECK(std::abs(state.factor - expected) < widest_bracket(expected) + 1e-8 * expected);
      // It turns about its toe.
      const Point toe = velocity_at(assembly.blocks[1], state.mechanism[1], {b, 0});
      CHECK(toe.norm() < 1e-6);
      CHECK(std::abs(std::abs(state.mechanism[1].rotation) * std::hypot(b, h) - 1) < 1e-6);
    }
  }
}

TEST_CASE("limit analysis: planar wedge") {
  const PlanarWedge wedges[] = {{},
                                {25, 70 * degree, 41 * degree, 40e3, 28 * degree, 24e3},
                                {260, 55 * degree, 35.2 * degree, 0.1e6, 40 * degree, 26.1e3},
                                {100, 90 * degree, 30 * degree, 0, 35 * degree, 26e3}};
  for (const PlanarWedge& wedge : wedges) {
    const auto v = wedge_vertices(wedge);
    const Point toe(v[0][0], v[0][1]), back(v[1][0], v[1][1]), crest(v[2][0], v[2][1]);
    const Point gravity(0, -10);
    const double density = wedge.unit_weight / 10;
    const RigidBlockAssembly assembly =
        assemble({block_of({toe, Point(back.x(), 0), back}, density, gravity, true), block_of({toe, back, crest}, density, gravity)},
                 {std::tan(wedge.friction_angle), wedge.cohesion, 0});
    const LimitState state = limit_analysis(assembly);
    check_bounds(assembly, state);
    CHECK(std::abs(state.factor - factor_of_safety(wedge)) < 1e-5);
  }
}

TEST_CASE("limit analysis: toppling columns of Goodman and Bray") {
  // Their recursion assumes where the forces between the columns act and finds tan(phi) = 0.78554; free to choose, the columns stand at less.
  const RigidBlockAssembly assembly = assembly_of(GoodmanBray(), 1);
  const CriticalFriction associated = critical_friction(assembly);
  check_bounds(assembly, associated.state);
  CHECK(std::abs(associated.angle / degree - 33.41) < 0.005);
  CHECK(std::tan(associated.angle) < 0.7855442);
  LimitAnalysisOptions constant_volume;
  constant_volume.zero_dilatancy = true;
  const CriticalFriction non_associated = critical_friction(assembly, constant_volume);
  // One of many states: which, depends on the forces that the programs happen to choose between columns.
  CHECK(non_associated.found);
  CHECK(non_associated.angle > associated.angle);
  // Factor and angle are two ways to say the same.
  const LimitState state = limit_analysis(assembly_of(GoodmanBray(), std::tan(38 * degree)));
  CHECK(std::abs(state.factor * std::tan(associated.angle) / std::tan(38 * degree) - 1) < 2e-5);
}

TEST_CASE("limit analysis: at constant volume the forces are within the strength and sliding does not open") {
  const RigidBlockAssembly assembly = assembly_of(GoodmanBray(), 1);
  LimitAnalysisOptions options;
  options.zero_dilatancy = true;
  const LimitState state = limit_analysis(assembly, options);
  REQUIRE(state.found);
  CHECK(worst_imbalance(assembly, state) < 1e-7);
  CHECK(worst_excess(assembly, state) <= options.excess);
  CHECK(state.factor < limit_analysis(assembly).factor);
}

TEST_CASE("limit analysis: what cannot be analysed") {
  RigidBlockAssembly assembly = block_on_incline(2, 1, 0.5, {0.5, 0, 0});
  assembly.blocks[1].load.setZero();
  CHECK_THROWS_AS(limit_analysis(assembly), std::invalid_argument);
  assembly.blocks[1].fixed = true;
  CHECK_THROWS_AS(limit_analysis(assembly), std::invalid_argument);
  const LimitState state = limit_analysis(block_on_incline(2, 1, 0.5, {0, 0, 0}));
  CHECK_FALSE(state.found);
  CHECK_THAT(state.reason, ContainsSubstring("no equilibrium"));
}
