#include "openclose/limit_analysis/program.h"

#include <algorithm>
#include <cmath>

namespace openclose::limit_analysis {
namespace {

constexpr double program_tolerance = 1e-9;  // [-] of constraints and reduced costs, in loads of blocks

/// Of an artificial force in a program that is solved once more because neither forces nor mechanism hold: of such prices of the rows
/// `program_tolerance` is a negligible part.
///
/// Vertices far from the origin are rounded, so that a joint of many faces, drawn straight, is rough by 1e-10 of its length. Prices that are right to
/// 1e-9 let blocks sink into what is rough, and near the limit, where the loads do hardly more work than the strength, such a mechanism proves
/// nothing. A smaller tolerance does less: the simplex method excuses errors of its own beside it. Only there, since any other price everywhere would
/// change which of many possible forces a program that is decided without it ends with.
constexpr double sharp_price = 1e4;

/// [-] A barrier that ends with larger errors than this has not got to the end; the crossover does better.
constexpr double clean_barrier = 1e-9;

/// [-] So near to a program whose basis is known the simplex method takes less time than the barrier; the second program so near to another pays for
/// the crossover that gives a basis.
constexpr double nearby = 0.05;

Trial undecided(double factor, const char* reason) {
  Trial trial;
  trial.factor = factor;
  trial.reason = reason;
  return trial;
}

}  // namespace

LimitAnalysis::Program::Program(Problem problem) : problem_(std::move(problem)), simplex_(program_tolerance) {
  check(problem_);
  number_rows();
  number_columns();
}

void LimitAnalysis::Program::number_rows() {
  for (const Block& block : problem_.blocks) {
    BlockRows rows;
    for (int k = 0; k < 3; ++k) {
      if (block.free[k]) rows.row[k] = row_count_++;
    }
    rows.load = block.fixed() ? 0 : block.load.head<2>().norm();
    rows.radius = block.radius;
    rows_.push_back(rows);
  }
}

void LimitAnalysis::Program::replace_contacts(std::vector<Contact> contacts) {
  Problem next{problem_.blocks, std::move(contacts), problem_.free_forces, problem_.varied};
  check(next);
  const std::vector<ContactColumns> before = columns_;
  const int count_before = column_count_;
  problem_ = std::move(next);
  number_columns();
  if (basis_.empty()) return;
  // The status of what has still a column is kept.
  const auto tail = basis_.begin() + count_before;
  Simplex::Basis basis(column_count_, Simplex::at_lower_bound);
  for (std::size_t p = 0; p < std::min(before.size(), columns_.size()); ++p) {
    for (const auto column : {&ContactColumns::first_ray, &ContactColumns::second_ray, &ContactColumns::shear}) {
      if (before[p].*column >= 0 && columns_[p].*column >= 0) basis[columns_[p].*column] = basis_[before[p].*column];
    }
  }
  basis.insert(basis.end(), tail, basis_.end());
  basis_ = std::move(basis);
}

void LimitAnalysis::Program::number_columns() {
  columns_.clear();
  column_count_ = 0;
  for (const Contact& c : problem_.contacts) {
    ContactColumns columns;
    const double a = rows_[c.a].load, b = c.b < 0 ? 0 : rows_[c.b].load;
    columns.unit = a > 0 && b > 0 ? std::sqrt(a * b) : std::max(a, b);
    if (columns.unit > 0) {
      columns.first_ray = column_count_++;
      if (c.friction > 0) columns.second_ray = column_count_++;
      if (c.cohesion > 0) columns.shear = column_count_++;
    }
    columns_.push_back(columns);
  }
}

Eigen::Vector3d LimitAnalysis::Program::in_rows(int block, const Point& point, const Point& force) const {
  const BlockRows& rows = rows_[block];
  const Point arm = point - problem_.blocks[block].centroid;
  return Eigen::Vector3d(force.x(), force.y(), (arm.x() * force.y() - arm.y() * force.x()) / rows.radius) / rows.load;
}

void LimitAnalysis::Program::build(double factor, double price) {
  price_ = price;
  std::vector<double> right_side(row_count_);
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    const Eigen::Vector3d load = problem_.load(static_cast<int>(b), factor);
    for (int k = 0; k < 3; ++k) {
      if (rows_[b].row[k] >= 0) right_side[rows_[b].row[k]] = -load[k] / (k < 2 ? rows_[b].load : rows_[b].load * rows_[b].radius);
    }
  }
  const double infinity = Columns::infinity;
  Columns columns;
  for (std::size_t p = 0; p < columns_.size(); ++p) {
    if (columns_[p].first_ray < 0) continue;
    const Contact& c = problem_.contacts[p];
    const Cone cone(c, problem_.strength_factor(factor));
    const double unit = columns_[p].unit;
    const Point normal = c.normal, tangent = c.tangent();
    const auto enter = [&](const Point& force) {
      for (const auto& [block, sign] : {std::pair(c.a, unit), std::pair(c.b, -unit)}) {
        if (block < 0 || rows_[block].load == 0) continue;
        const Eigen::Vector3d entries = sign * in_rows(block, c.point, force);
        for (int k = 0; k < 3; ++k) columns.enter(rows_[block].row[k], entries[k]);
      }
    };
    columns.add(0, infinity, 0);
    enter(normal + cone.friction * tangent);
    if (columns_[p].second_ray >= 0) {
      columns.add(0, infinity, 0);
      enter(normal - cone.friction * tangent);
    }
    if (columns_[p].shear >= 0) {
      columns.add(-cone.half_width / unit, cone.half_width / unit, 0);
      enter(tangent);
    }
    if (cone.tension == 0) continue;
    for (const auto& [block, sign] : {std::pair(c.a, 1.0), std::pair(c.b, -1.0)}) {
      if (block < 0 || rows_[block].load == 0) continue;
      const Eigen::Vector3d entries = sign * cone.tension * in_rows(block, c.point, normal);
      for (int k = 0; k < 3; ++k) {
        if (rows_[block].row[k] >= 0) right_side[rows_[block].row[k]] += entries[k];
      }
    }
  }
  for (const FreeForce& f : problem_.free_forces) {
    const BlockRows& rows = rows_[f.block];
    columns.add(-infinity, infinity, 0);
    if (rows.load == 0) continue;
    for (int k = 0; k < 3; ++k) columns.enter(rows.row[k], f.unit[k] / (k < 2 ? 1.0 : rows.radius));
  }
  for (int row = 0; row < row_count_; ++row) {
    for (const double sign : {1.0, -1.0}) {
      columns.add(0, infinity, price);
      columns.enter(row, sign);
    }
  }
  simplex_.load(columns, right_side);
}

bool LimitAnalysis::Program::solve_by(Way way) {
  ++solved_;
  switch (way) {
    case Way::warm_simplex:
      return simplex_.solve_from(basis_);
    case Way::barrier:
    case Way::barrier_and_crossover:
      return simplex_.solve_by_barrier(way == Way::barrier_and_crossover);
    case Way::simplex:
      // Without any contact force every price is right, since nothing costs less than zero.
      return simplex_.solve_from_zero();
  }
  return false;
}

Forces LimitAnalysis::Program::forces(double factor) const {
  const double* x = simplex_.columns();
  const auto value = [&](int column) { return column < 0 ? 0.0 : x[column]; };
  Forces forces;
  for (std::size_t p = 0; p < columns_.size(); ++p) {
    const Cone cone(problem_.contacts[p], problem_.strength_factor(factor));
    const ContactColumns& c = columns_[p];
    ContactForce force;
    if (c.first_ray >= 0) {
      force.normal = -cone.tension + c.unit * (value(c.first_ray) + value(c.second_ray));
      force.shear = c.unit * (cone.friction * (value(c.first_ray) - value(c.second_ray)) + value(c.shear));
    }
    forces.contacts.push_back(force);
  }
  for (std::size_t k = 0; k < problem_.free_forces.size(); ++k) {
    forces.free_forces.push_back(x[column_count_ + static_cast<int>(k)] * rows_[problem_.free_forces[k].block].load);
  }
  return forces;
}

/// The prices of the equilibrium rows, over that of an artificial force, as velocities with which the loads do work.
Mechanism LimitAnalysis::Program::mechanism() const {
  const double* price = simplex_.prices();
  Mechanism mechanism(problem_.blocks.size());
  for (std::size_t b = 0; b < mechanism.size(); ++b) {
    const BlockRows& rows = rows_[b];
    const auto component = [&](int k) { return rows.row[k] < 0 ? 0.0 : -price[rows.row[k]] / (price_ * rows.load); };
    mechanism[b] = {{component(0), component(1)}, rows.load > 0 ? component(2) / rows.radius : 0.0};
  }
  return mechanism;
}

/// d(least artificial force)/d(1/F): by the shear and tension that a larger 1/F gives to what the mechanism slides and tears.
double LimitAnalysis::Program::slope_by_strength(double factor, const Forces& forces, const Mechanism& mechanism) const {
  double slope = 0;
  for (std::size_t p = 0; p < columns_.size(); ++p) {
    if (columns_[p].first_ray < 0) continue;
    const Contact& c = problem_.contacts[p];
    const auto velocity = [&](int b) { return b < 0 ? Point(Point::Zero()) : velocity_at(problem_.blocks[b], mechanism[b], c.point); };
    const Point relative = velocity(c.a) - velocity(c.b);
    const double sliding = std::abs(relative.dot(c.tangent()));
    // Of friction (n + tension) + half_width, in which friction and tension both fall with F where nothing is left of the last one.
    const double cohesion = Cone(c, factor).half_width > 0 ? c.cohesion : std::max(c.cohesion, 2.0 * c.friction * c.tension / factor);
    slope += sliding * std::max(0.0, cohesion + c.friction * forces.contacts[p].normal);
    slope += c.tension * std::max(0.0, relative.dot(c.normal) - c.friction / factor * sliding);
  }
  return -slope;
}

/// d(least artificial force)/d(factor): by the work that the live loads do on the mechanism.
double LimitAnalysis::Program::slope_by_live_loads(const Mechanism& mechanism) const {
  double slope = 0;
  for (std::size_t b = 0; b < mechanism.size(); ++b) {
    const Eigen::Vector3d& live = problem_.blocks[b].live;
    slope += live.head<2>().dot(mechanism[b].velocity) + live[2] * mechanism[b].rotation;
  }
  return slope;
}

double LimitAnalysis::Program::root_of(double factor, double artificial, const Forces& forces, const Mechanism& mechanism) const {
  if (problem_.varied == Varied::live_loads) {
    const double slope = slope_by_live_loads(mechanism);
    return slope > 0 ? std::max(0.0, factor - artificial / slope) : 0;
  }
  const double slope = slope_by_strength(factor, forces, mechanism);
  return slope < 0 ? 1 / (1 / factor - artificial / slope) : 0;
}

std::vector<LimitAnalysis::Program::Way> LimitAnalysis::Program::ways(double factor) const {
  const auto near = [&](double other) { return other > 0 && std::abs(factor / other - 1) < nearby; };
  std::vector<Way> ways;
  if (near(basis_factor_)) {
    ways.push_back(Way::warm_simplex);
  } else if (!near(last_factor_)) {
    ways.push_back(Way::barrier);
  }
  ways.insert(ways.end(), {Way::barrier_and_crossover, Way::simplex});
  return ways;
}

Trial LimitAnalysis::Program::at(double factor) {
  if (!Simplex::available) return undecided(factor, "this program was built without linear programs");
  Trial trial;
  for (const Way way : ways(factor)) {
    build(factor, 1);
    const bool solved = solve_by(way);
    trial = solved ? judge(factor, way == Way::barrier ? clean_barrier : force_tolerance) : undecided(factor, "a linear program was not solved");
    if (solved && way != Way::barrier && trial.verdict == Verdict::undecided) trial = sharpened(factor, std::move(trial));
    if (trial.verdict == Verdict::undecided) continue;
    if (way != Way::barrier) {
      basis_ = simplex_.basis();
      basis_factor_ = factor;
    }
    break;
  }
  last_factor_ = factor;
  return trial;
}

Trial LimitAnalysis::Program::sharpened(double factor, Trial blunt) {
  const Simplex::Basis basis = simplex_.basis();
  build(factor, sharp_price);
  ++solved_;
  return simplex_.solve_from(basis) ? judge(factor, force_tolerance) : blunt;
}

Trial LimitAnalysis::Program::judge(double factor, double tolerance) {
  Trial trial;
  trial.factor = factor;
  const Forces forces = this->forces(factor);
  const ForceCheck check = check_forces(problem_, factor, forces);
  if (std::max(check.unbalanced, check.excess) <= tolerance) {
    trial.verdict = Verdict::feasible;
    trial.forces = forces;
    return trial;
  }
  Mechanism mechanism = this->mechanism();
  if (check_mechanism(problem_, factor, mechanism).holds()) {
    trial.verdict = Verdict::infeasible;
    root_ = root_of(factor, simplex_.cost() / price_, forces, mechanism);
    normalise(mechanism);
    trial.mechanism = std::move(mechanism);
    return trial;
  }
  return undecided(factor, "neither forces nor mechanism hold");
}

void LimitAnalysis::Program::normalise(Mechanism& mechanism) const {
  double fastest = 0;
  for (std::size_t b = 0; b < mechanism.size(); ++b) fastest = std::max(fastest, speed(problem_.blocks[b], mechanism[b]));
  for (BlockVelocity& motion : mechanism) {
    motion.velocity /= fastest;
    motion.rotation /= fastest;
  }
}

}  // namespace openclose::limit_analysis
