#include "openclose/analytical/limit_analysis.h"

#include <ClpSimplex.hpp>
#include <CoinPackedMatrix.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace openclose::analytical {
namespace {

constexpr double smallest_factor = 1e-3;
constexpr double bracket_ratio = 1.5;       // between the factors tried first
constexpr double program_tolerance = 1e-9;  // [-] of constraints and reduced costs, in weights of blocks

/// Strength of one end of an interface: |t| <= (constant + slope n)/F, n >= -tension/F.
struct Envelope {
  double constant;  // [N]
  double slope;     // [-]
  double tension;   // [N]
};

std::vector<Envelope> coulomb_envelopes(const RigidBlockAssembly& assembly) {
  std::vector<Envelope> envelopes;
  for (const Interface& i : assembly.interfaces) {
    const double half = i.length() / 2;
    const Envelope envelope{i.strength.cohesion * half, i.strength.friction, i.strength.tension * half};
    envelopes.insert(envelopes.end(), {envelope, envelope});
  }
  return envelopes;
}

/// The linear program for one set of envelopes and one F at a time. Rows: the equilibrium of each free block (force over its weight; moment over
/// weight and radius), then the strength of each end. Columns: n, t+ and t- of each end over a weight, then a pair of artificial forces for each
/// equilibrium row, which cost what they are.
class Program {
 public:
  explicit Program(const RigidBlockAssembly& assembly) : assembly_(assembly) {
    count_rows();
    build();
  }

  /// \throws std::runtime_error if it is not solved
  bool feasible(double factor, const std::vector<Envelope>& envelopes) {
    set_strength(factor, envelopes);
    solve();
    // Each equilibrium row may be off by the tolerance, and none costs more than what it is off by.
    return model_.objectiveValue() <= program_tolerance * equilibrium_rows_;
  }

  std::vector<std::array<EndForce, 2>> forces() const {
    const double* x = model_.primalColumnSolution();
    std::vector<std::array<EndForce, 2>> forces(assembly_.interfaces.size());
    for (int p = 0; p < end_count(); ++p) {
      forces[p / 2][p % 2] = {x[3 * p] * end_scales_[p], (x[3 * p + 1] - x[3 * p + 2]) * end_scales_[p]};
    }
    return forces;
  }

  std::vector<BlockVelocity> mechanism() const {
    const double* price = model_.dualRowSolution();
    std::vector<BlockVelocity> motions(assembly_.blocks.size());
    double fastest = 0;
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const BlockRows& rows = rows_[b];
      if (rows.first < 0) continue;
      motions[b].velocity = Point(price[rows.first], price[rows.first + 1]) / -rows.weight;
      if (rows.turns) motions[b].rotation = -price[rows.first + 2] / (rows.weight * rows.radius);
      for (const Point& vertex : assembly_.blocks[b].vertices) {
        fastest = std::max(fastest, velocity_at(assembly_.blocks[b], motions[b], vertex).norm());
      }
    }
    for (BlockVelocity& motion : motions) {
      motion.velocity /= fastest;
      motion.rotation /= fastest;
    }
    return motions;
  }

  int solved() const { return solved_; }

 private:
  struct BlockRows {
    int first = -1;  // -1: fixed
    bool turns = false;
    double weight = 0;  // [N]
    double radius = 0;  // [m] of the farthest vertex
  };

  int end_count() const { return 2 * static_cast<int>(assembly_.interfaces.size()); }

  void count_rows() {
    for (const RigidBlock& block : assembly_.blocks) {
      BlockRows rows;
      if (!block.fixed) {
        rows.first = equilibrium_rows_;
        rows.turns = !block.rotation_locked;
        rows.weight = block.load.head<2>().norm();
        if (!(rows.weight > 0)) throw std::invalid_argument("block " + block.name + " is free and has no weight");
        for (const Point& vertex : block.vertices) rows.radius = std::max(rows.radius, (vertex - block.centroid).norm());
        equilibrium_rows_ += rows.turns ? 3 : 2;
      }
      rows_.push_back(rows);
    }
    if (equilibrium_rows_ == 0) throw std::invalid_argument("no block is free");
    for (const Interface& i : assembly_.interfaces) {
      const double a = rows_[i.a].weight, b = rows_[i.b].weight;
      const double scale = a > 0 && b > 0 ? std::sqrt(a * b) : std::max(a, b);
      end_scales_.insert(end_scales_.end(), {scale, scale});
    }
  }

  /// Entries of a unit force on a block at a point.
  void enter(int block, const Point& point, const Point& force, int column, double scale) {
    const BlockRows& rows = rows_[block];
    if (rows.first < 0) return;
    add(rows.first, column, scale * force.x() / rows.weight);
    add(rows.first + 1, column, scale * force.y() / rows.weight);
    if (!rows.turns) return;
    const Point arm = point - assembly_.blocks[block].centroid;
    add(rows.first + 2, column, scale * (arm.x() * force.y() - arm.y() * force.x()) / (rows.weight * rows.radius));
  }

  void add(int row, int column, double value) {
    row_of_.push_back(row);
    column_of_.push_back(column);
    value_.push_back(value);
  }

  void build() {
    for (int p = 0; p < end_count(); ++p) {
      const Interface& i = assembly_.interfaces[p / 2];
      const Point& point = i.ends[p % 2];
      const Point directions[] = {i.normal, i.tangent(), -i.tangent()};
      for (int k = 0; k < 3; ++k) {
        enter(i.a, point, directions[k], 3 * p + k, end_scales_[p]);
        enter(i.b, point, -directions[k], 3 * p + k, end_scales_[p]);
        // The first is the slope of the strength, set for each factor; not zero here so that its place is kept.
        add(equilibrium_rows_ + p, 3 * p + k, k == 0 ? -1.0 : 1.0);
      }
    }
    const int artificial = 3 * end_count();
    for (int row = 0; row < equilibrium_rows_; ++row) {
      add(row, artificial + 2 * row, 1.0);
      add(row, artificial + 2 * row + 1, -1.0);
    }
    const int columns = artificial + 2 * equilibrium_rows_, rows = equilibrium_rows_ + end_count();
    const CoinPackedMatrix matrix(true, row_of_.data(), column_of_.data(), value_.data(), static_cast<CoinBigIndex>(value_.size()));
    const double infinity = std::numeric_limits<double>::infinity();
    std::vector<double> column_low(columns, 0.0), column_high(columns, COIN_DBL_MAX), cost(columns, 0.0);
    std::fill(cost.begin() + artificial, cost.end(), 1.0);
    std::vector<double> row_low(rows, -infinity), row_high(rows, infinity);
    for (std::size_t b = 0; b < rows_.size(); ++b) {
      if (rows_[b].first < 0) continue;
      const Eigen::Vector3d load = assembly_.blocks[b].load / -rows_[b].weight;
      for (int k = 0; k < (rows_[b].turns ? 3 : 2); ++k) {
        row_low[rows_[b].first + k] = row_high[rows_[b].first + k] = k < 2 ? load[k] : load[k] / rows_[b].radius;
      }
    }
    model_.setLogLevel(0);
    model_.setPrimalTolerance(program_tolerance);
    model_.setDualTolerance(program_tolerance);
    model_.loadProblem(matrix, column_low.data(), column_high.data(), cost.data(), row_low.data(), row_high.data());
  }

  void set_strength(double factor, const std::vector<Envelope>& envelopes) {
    for (int p = 0; p < end_count(); ++p) {
      const Envelope& e = envelopes[p];
      model_.modifyCoefficient(equilibrium_rows_ + p, 3 * p, -e.slope / factor, true);
      model_.setRowUpper(equilibrium_rows_ + p, e.constant / (factor * end_scales_[p]));
      model_.setColumnLower(3 * p, -e.tension / (factor * end_scales_[p]));
    }
  }

  void solve() {
    ++solved_;
    // Warm: the basis of the factor before. From scratch the basis without contact forces is dual feasible, since nothing costs less than zero.
    if (solved_ > 1) {
      model_.primal();
      if (model_.isProvenOptimal()) return;
    }
    model_.allSlackBasis(true);
    model_.dual();
    if (!model_.isProvenOptimal()) throw std::runtime_error("limit analysis: a linear program was not solved");
  }

  const RigidBlockAssembly& assembly_;
  std::vector<BlockRows> rows_;
  std::vector<double> end_scales_;  // [N] unit of the forces of each end
  int equilibrium_rows_ = 0;
  std::vector<int> row_of_, column_of_;
  std::vector<double> value_;
  ClpSimplex model_;
  int solved_ = 0;
};

/// Brackets the largest feasible factor, starting at `state.factor`, and bisects.
class Search {
 public:
  Search(Program& program, const LimitAnalysisOptions& options) : program_(program), options_(options) {}

  LimitState run(const std::vector<Envelope>& envelopes, double first, double ratio) {
    LimitState state;
    const auto attempt = [&](double factor) {
      const bool feasible = program_.feasible(factor, envelopes);
      if (feasible) {
        state.factor = factor;
        state.forces = program_.forces();
      } else {
        state.failed = factor;
        state.mechanism = program_.mechanism();
      }
      return feasible;
    };
    if (attempt(first)) {
      while (state.failed == 0 && state.factor < options_.upper_limit) attempt(std::min(state.factor * ratio, options_.upper_limit));
    } else {
      while (state.factor == 0 && state.failed > smallest_factor) attempt(state.failed / ratio);
    }
    state.found = state.factor > 0 && state.failed > 0;
    if (!state.found) state.reason = state.factor > 0 ? "stands at every factor" : "no equilibrium at any factor";
    while (state.found && state.failed - state.factor > options_.width) attempt((state.factor + state.failed) / 2);
    state.programs = program_.solved();
    return state;
  }

 private:
  Program& program_;
  const LimitAnalysisOptions& options_;
};

// Gilbert et al. take 0.6 for both.
constexpr double memory_of_normal_force = 0.4;  // [-] share of the normal forces of the repetition before the last
constexpr double fading = 0.6;                  // [-] of the dependence on n, from one repetition to the next
constexpr double faded = 1e-3;                  // [-] below which it is zero
constexpr double bracket_ratio_nearby = 1.01;   // between the factors tried first in a repetition
constexpr double slowest_slip = 1e-6;           // [m/s] where the fastest vertex has 1 m/s; above the tolerance of the program
constexpr int most_repetitions = 100;
constexpr int repetitions_that_agree = 3;

double excess_over(const RigidBlockAssembly& assembly, const std::vector<Envelope>& coulomb, const LimitState& state) {
  double worst = 0, heaviest = 0;
  for (const RigidBlock& block : assembly.blocks) heaviest = std::max(heaviest, block.fixed ? 0 : block.load.head<2>().norm());
  for (std::size_t p = 0; p < coulomb.size(); ++p) {
    const EndForce& force = state.forces[p / 2][p % 2];
    worst = std::max(worst, std::abs(force.shear) - (coulomb[p].constant + coulomb[p].slope * force.normal) / state.factor);
  }
  return worst / heaviest;
}

/// Repeats with strengths that depend less and less on the present normal forces, at every end that slips in the mechanism of any repetition. The
/// others keep their own strength: where blocks stand, forces are not determined, and those of one repetition say nothing about the next.
class ConstantVolume {
 public:
  ConstantVolume(const RigidBlockAssembly& assembly, Search& search, const LimitAnalysisOptions& options)
      : assembly_(assembly),
        search_(search),
        options_(options),
        coulomb_(coulomb_envelopes(assembly)),
        envelopes_(coulomb_),
        normal_(coulomb_.size()) {}

  /// \param state  with the strengths as they are
  LimitState run(LimitState state) {
    double dependence = 1;
    int agreeing = 0;
    for (int repetition = 1; repetition <= most_repetitions; ++repetition) {
      dependence = dependence > faded ? dependence * fading : 0;
      const bool same_ends = !take_up(state, dependence);
      LimitState next = search_.run(envelopes_, state.factor, bracket_ratio_nearby);
      if (!next.found) return next;
      next.excess = excess_over(assembly_, coulomb_, next);
      const bool agrees =
          dependence == 0 && same_ends && next.excess <= options_.excess && std::abs(next.factor - state.factor) <= 2 * options_.width;
      agreeing = agrees ? agreeing + 1 : 0;
      state = std::move(next);
      state.repetitions = repetition;
      if (agreeing == repetitions_that_agree) return state;
    }
    state.found = false;
    state.reason = "the repetitions of zero dilatancy do not converge";
    return state;
  }

 private:
  /// True if an end slips that has not slipped before.
  bool take_up(const LimitState& state, double dependence) {
    bool another = false;
    for (std::size_t p = 0; p < coulomb_.size(); ++p) {
      const double present = state.forces[p / 2][p % 2].normal;
      if (!normal_[p] && slips(assembly_.interfaces[p / 2], p % 2, state)) {
        another = true;
        normal_[p] = present;
      }
      if (!normal_[p]) continue;
      normal_[p] = memory_of_normal_force * *normal_[p] + (1 - memory_of_normal_force) * present;
      envelopes_[p].slope = dependence * coulomb_[p].slope;
      envelopes_[p].constant = std::max(0.0, coulomb_[p].constant + (1 - dependence) * coulomb_[p].slope * *normal_[p]);
    }
    return another;
  }

  bool slips(const Interface& i, std::size_t end, const LimitState& state) const {
    const auto velocity = [&](int block) { return velocity_at(assembly_.blocks[block], state.mechanism[block], i.ends[end]); };
    return std::abs((velocity(i.a) - velocity(i.b)).dot(i.tangent())) > slowest_slip;
  }

  const RigidBlockAssembly& assembly_;
  Search& search_;
  const LimitAnalysisOptions& options_;
  std::vector<Envelope> coulomb_, envelopes_;
  std::vector<std::optional<double>> normal_;  // [N] n' of each end that has slipped
};

}  // namespace

LimitState limit_analysis(const RigidBlockAssembly& assembly, const LimitAnalysisOptions& options) {
  Program program(assembly);
  Search search(program, options);
  LimitState state = search.run(coulomb_envelopes(assembly), 1.0, bracket_ratio);
  if (!options.zero_dilatancy || !state.found) return state;
  return ConstantVolume(assembly, search, options).run(std::move(state));
}

CriticalFriction critical_friction(RigidBlockAssembly assembly, const LimitAnalysisOptions& options) {
  for (Interface& i : assembly.interfaces) i.strength = {1.0, 0.0, 0.0};
  CriticalFriction result;
  result.state = limit_analysis(assembly, options);
  result.found = result.state.found;
  if (result.found) result.angle = std::atan(1 / result.state.factor);
  return result;
}

Point velocity_at(const RigidBlock& block, const BlockVelocity& motion, const Point& point) {
  const Point arm = point - block.centroid;
  return motion.velocity + motion.rotation * Point(-arm.y(), arm.x());
}

}  // namespace openclose::analytical
