#include "openclose/limit_analysis/problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace openclose::limit_analysis {
namespace {

double cross(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

constexpr double unit_tolerance = 1e-9;         // [-] of the length of a normal
constexpr double share_of_large_forces = 1e-8;  // [-] see ForceCheck::unbalanced

void require(bool holds, const char* what, std::size_t number, const char* why) {
  if (!holds) throw std::invalid_argument(std::string("limit analysis: ") + what + " " + std::to_string(number) + " " + why);
}

bool is_strength(double value) {
  return value >= 0 && std::isfinite(value);
}

void check_block(const Block& block, std::size_t number) {
  require(block.centroid.allFinite() && block.load.allFinite() && block.live.allFinite(), "block", number, "has a number that is not finite");
  if (block.fixed()) return;
  require(block.load.head<2>().norm() > 0, "block", number, "is free and has no weight");
  require(block.radius > 0 && std::isfinite(block.radius), "block", number, "is free and has no radius");
}

void check_contact(const Contact& c, std::size_t number, int blocks) {
  require(c.a >= 0 && c.a < blocks && c.b >= -1 && c.b < blocks && c.a != c.b, "contact", number, "joins no two blocks");
  require(c.point.allFinite() && std::abs(c.normal.norm() - 1) < unit_tolerance, "contact", number, "has no unit normal");
  require(is_strength(c.cohesion) && is_strength(c.friction) && is_strength(c.tension), "contact", number, "has a strength below zero");
}

/// A comparison with what is no number is false, and no error would be seen.
bool all_finite(const Forces& forces) {
  return std::all_of(forces.contacts.begin(), forces.contacts.end(),
                     [](const ContactForce& f) { return std::isfinite(f.normal) && std::isfinite(f.shear); }) &&
         std::all_of(forces.free_forces.begin(), forces.free_forces.end(), [](double f) { return std::isfinite(f); });
}

/// Load of a free block; infinite for what cannot move.
double load_of(const Problem& problem, int block) {
  if (block < 0 || problem.blocks[block].fixed()) return std::numeric_limits<double>::infinity();
  return problem.blocks[block].load.head<2>().norm();
}

double total_load(const Problem& problem, double factor) {
  double sum = 0;
  for (int b = 0; b < static_cast<int>(problem.blocks.size()); ++b) sum += problem.blocks[b].fixed() ? 0 : problem.load(b, factor).head<2>().norm();
  return sum;
}

Point velocity_of(const Problem& problem, const Mechanism& mechanism, int block, const Point& point) {
  return block < 0 ? Point(Point::Zero()) : velocity_at(problem.blocks[block], mechanism[block], point);
}

/// The most that cohesion and tension take up at a contact that opens by g - d >= 0 beyond the dilatancy of its sliding |h|.
double resistance_of(const Cone& cone, double opening, double sliding) {
  const double beyond = std::max(0.0, opening - cone.friction * sliding);
  return cone.largest_shear(0.0) * sliding + cone.tension * beyond;
}

}  // namespace

Cone::Cone(const Contact& c, double factor)
    : tension(c.tension / factor), friction(c.friction / factor), half_width(std::max(0.0, c.cohesion / factor - friction * tension)) {}

FreeForce support(const Block& block, int number, const Point& point, const Point& direction) {
  return {number, Eigen::Vector3d(direction.x(), direction.y(), cross(point - block.centroid, direction))};
}

void check(const Problem& problem) {
  bool any_free = false;
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    check_block(problem.blocks[b], b);
    any_free = any_free || !problem.blocks[b].fixed();
  }
  if (!any_free) throw std::invalid_argument("limit analysis: no block is free");
  const int blocks = static_cast<int>(problem.blocks.size());
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) check_contact(problem.contacts[c], c, blocks);
  for (std::size_t f = 0; f < problem.free_forces.size(); ++f) {
    const FreeForce& force = problem.free_forces[f];
    require(force.block >= 0 && force.block < blocks && force.unit.allFinite() && force.unit.norm() > 0, "free force", f, "acts on no block");
  }
}

Point velocity_at(const Block& block, const BlockVelocity& motion, const Point& point) {
  const Point arm = point - block.centroid;
  return motion.velocity + motion.rotation * Point(-arm.y(), arm.x());
}

double speed(const Block& block, const BlockVelocity& motion) {
  return motion.velocity.norm() + std::abs(motion.rotation) * block.radius;
}

bool ForceCheck::holds() const {
  return unbalanced <= force_tolerance && excess <= force_tolerance;
}

ForceCheck check_forces(const Problem& problem, double factor, const Forces& forces) {
  std::vector<Eigen::Vector3d> sums;
  std::vector<double> scales;  // [N]
  for (int b = 0; b < static_cast<int>(problem.blocks.size()); ++b) {
    sums.push_back(problem.load(b, factor));
    scales.push_back(problem.blocks[b].load.head<2>().norm());
  }
  const double reduction = problem.strength_factor(factor);
  ForceCheck result;
  if (!all_finite(forces)) return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < problem.contacts.size(); ++k) {
    const Contact& c = problem.contacts[k];
    const ContactForce& f = forces.contacts[k];
    const Point force = f.normal * c.normal + f.shear * c.tangent();
    for (const auto& [block, sign] : {std::pair(c.a, 1.0), std::pair(c.b, -1.0)}) {
      if (block < 0) continue;
      const Point arm = c.point - problem.blocks[block].centroid;
      sums[block] += sign * Eigen::Vector3d(force.x(), force.y(), cross(arm, force));
      scales[block] += share_of_large_forces * force.norm();
    }
    const Cone cone(c, reduction);
    const double beyond = std::max(std::abs(f.shear) - cone.largest_shear(f.normal), -cone.tension - f.normal);
    const double load = std::min(load_of(problem, c.a), load_of(problem, c.b));
    // Between blocks that cannot move any force is right.
    if (std::isfinite(load)) result.excess = std::max(result.excess, beyond / (load + share_of_large_forces * force.norm()));
  }
  for (std::size_t k = 0; k < problem.free_forces.size(); ++k)
    sums[problem.free_forces[k].block] += forces.free_forces[k] * problem.free_forces[k].unit;
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    const Block& block = problem.blocks[b];
    if (block.fixed()) continue;
    for (int k = 0; k < 3; ++k) {
      if (block.free[k]) result.unbalanced = std::max(result.unbalanced, std::abs(sums[b][k]) / (k < 2 ? scales[b] : scales[b] * block.radius));
    }
  }
  return result;
}

bool MechanismCheck::holds() const {
  return work > resistance && least_force >= least_force_of_a_proof;
}

MechanismCheck check_mechanism(const Problem& problem, double factor, const Mechanism& mechanism) {
  const double reduction = problem.strength_factor(factor);
  MechanismCheck result;
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    const Block& block = problem.blocks[b];
    const BlockVelocity& m = mechanism[b];
    const Eigen::Vector3d v(m.velocity.x(), m.velocity.y(), m.rotation);
    // Neither work nor anything else is right then.
    if (!v.allFinite()) return {};
    result.work += problem.load(static_cast<int>(b), factor).dot(v);
    for (int k = 0; k < 3; ++k) {
      if (!block.free[k]) result.support += std::abs(v[k]) * (k < 2 ? 1.0 : block.radius);
    }
  }
  for (const Contact& c : problem.contacts) {
    const Point relative = velocity_of(problem, mechanism, c.a, c.point) - velocity_of(problem, mechanism, c.b, c.point);
    const double opening = relative.dot(c.normal), sliding = std::abs(relative.dot(c.tangent()));
    const Cone cone(c, reduction);
    result.penetration += std::max(0.0, cone.friction * sliding - opening);
    result.resistance += resistance_of(cone, opening, sliding);
  }
  for (const FreeForce& f : problem.free_forces) {
    const BlockVelocity& m = mechanism[f.block];
    // A couple counts by the speed of the rim.
    const double unit = f.unit.head<2>().norm() > 0 ? f.unit.head<2>().norm() : std::abs(f.unit[2]) / problem.blocks[f.block].radius;
    result.support += std::abs(f.unit.dot(Eigen::Vector3d(m.velocity.x(), m.velocity.y(), m.rotation))) / unit;
  }
  const double beyond = (result.work - result.resistance) / total_load(problem, factor), barred = result.penetration + result.support;
  if (barred > 0) {
    result.least_force = beyond / barred;
  } else {
    result.least_force = beyond > 0 ? std::numeric_limits<double>::infinity() : 0;
  }
  return result;
}

}  // namespace openclose::limit_analysis
