#include "openclose/analytical/goodman_bray.h"

#include <algorithm>
#include <cmath>

namespace openclose::analytical {

double GoodmanBray::height(int k) const {
  const double to_crest = std::min(k, crest) * (rise_to_crest - step);
  return to_crest - std::max(0, k - crest) * (fall_beyond + step);
}

double toe_force(const GoodmanBray& c, double friction) {
  const double s = std::sin(c.dip), n = std::cos(c.dip);
  double force = 0;  // P_k
  for (int k = c.count; k >= 1; --k) {
    const double y = c.height(k), weight = c.unit_weight * c.width * y;
    const double slides = force - weight * (n * friction - s) / (1 - friction * friction);
    if (k == 1) return slides;
    const double upper = k < c.crest ? y : y - c.fall_beyond, lower = k > c.crest ? y : y - c.rise_to_crest;
    const double topples = (force * (upper - c.width * friction) + weight * (y * s - c.width * n) / 2) / lower;
    force = std::max({0.0, slides, topples});
  }
  return force;
}

double limiting_friction(const GoodmanBray& columns) {
  // The toe force falls as friction grows; below tan(dip) even single blocks slide, and from 1 on the recursion's sliding has no meaning.
  double low = std::tan(columns.dip), high = 1 - 1e-9;
  while (high - low > 1e-14) {
    const double middle = (low + high) / 2;
    (toe_force(columns, middle) > 0 ? low : high) = middle;
  }
  return high;
}

RigidBlockAssembly assembly_of(const GoodmanBray& c, double friction) {
  const Point gravity(-c.gravity * std::sin(c.dip), -c.gravity * std::cos(c.dip));
  const auto add = [&](RigidBlockAssembly& assembly, const std::string& name, std::vector<Point> vertices, bool fixed) {
    RigidBlock block;
    block.name = name;
    block.vertices = std::move(vertices);
    block.density = c.unit_weight / c.gravity;
    block.fixed = fixed;
    complete_block(block, gravity);
    assembly.blocks.push_back(block);
  };
  RigidBlockAssembly assembly;
  const double depth = 2 * c.width;
  std::vector<Point> steps;
  for (int k = 1; k <= c.count; ++k) {
    const double x = (k - 1) * c.width, foot = (k - 1) * c.step, top = foot + c.height(k);
    add(assembly, std::to_string(k), {{x, foot}, {x + c.width, foot}, {x + c.width, top}, {x, top}}, false);
    steps.insert(steps.end(), {{x, foot}, {x + c.width, foot}});
  }
  std::vector<Point> base = {{0, -depth}, {c.count * c.width, -depth}};
  base.insert(base.end(), steps.rbegin(), steps.rend());
  add(assembly, "base", base, true);
  assembly.interfaces = find_interfaces(assembly.blocks);
  for (Interface& i : assembly.interfaces) i.strength = {friction, 0, 0};
  return assembly;
}

}  // namespace openclose::analytical
