#include <cmath>
#include <numbers>
#include <stdexcept>

#include "openclose/analytical/limit_analysis.h"
#include "openclose/analytical/masonry_arch.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

/// The arch as rigid blocks on two fixed springers, with joints that do not slide.
bool stands_by_limit_analysis(int voussoirs, double thickness) {
  RigidBlockAssembly assembly;
  const auto add = [&](const std::vector<Point>& vertices, bool fixed) {
    RigidBlock block;
    block.name = std::to_string(assembly.blocks.size());
    block.vertices = vertices;
    block.density = 2000;
    block.fixed = fixed;
    complete_block(block, {0, -9.81});
    assembly.blocks.push_back(block);
  };
  for (const auto& v : straight_voussoirs(voussoirs, thickness)) {
    std::vector<Point> vertices;
    for (const auto& [x, y] : v) vertices.emplace_back(x, y);
    add(vertices, false);
  }
  for (const double x : {-1.0, 1.0}) add({{x - 0.3, -0.5}, {x + 0.3, -0.5}, {x + 0.3, 0}, {x - 0.3, 0}}, true);
  assembly.interfaces = find_interfaces(assembly.blocks);
  for (Interface& i : assembly.interfaces) i.strength = {1, 1e9, 0};  // does not slide at any factor up to the limit
  LimitAnalysisOptions options;
  options.upper_limit = 10;
  return limit_analysis(assembly, options).reason == "stands at every factor";
}

}  // namespace

TEST_CASE("masonry arch: smallest thickness") {
  const struct {
    int voussoirs;
    double straight, ring;
  } known[] = {{6, 0.10413, 0.10510}, {7, 0.09570, 0.09624}, {10, 0.10701, 0.10746}, {27, 0.10672, 0.10678}, {320, 0.10748, 0.10748}};
  for (const auto& [n, straight, ring] : known) {
    CHECK(std::abs(smallest_arch_thickness(n, VoussoirShape::straight) - straight) < 5.1e-6);
    CHECK(std::abs(smallest_arch_thickness(n, VoussoirShape::ring_sector) - ring) < 5.1e-6);
  }
  CHECK(std::abs(smallest_arch_thickness(2000, VoussoirShape::ring_sector) - 0.1075) < 5e-5);
  CHECK_THROWS_AS(smallest_arch_thickness(2, VoussoirShape::straight), std::invalid_argument);
}

TEST_CASE("masonry arch: linear programming on the same blocks agrees") {
  for (const int n : {5, 6, 7, 10, 27}) {
    const double thickness = smallest_arch_thickness(n, VoussoirShape::straight);
    CHECK(stands_by_limit_analysis(n, thickness * (1 + 1e-5)));
    CHECK_FALSE(stands_by_limit_analysis(n, thickness * (1 - 1e-5)));
  }
}
