// Micro-benchmarks of the parts of a step, on the slope of the paper's example 3.4 with closer and closer joints, settled and half a second into
// failure.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "openclose/analysis/run.h"
#include "openclose/analysis/simulation.h"
#include "openclose/integrator/newton.h"
#include "openclose/integrator/registry.h"
#include "openclose/scene/check.h"
#include "openclose/scene/reader.h"

namespace openclose {
namespace {

constexpr double dt = 0.01;                // [s]
constexpr double time_in_failure = 0.5;    // [s]
constexpr double horizontal_spacing = 40;  // [m] of the scene, as the next
constexpr double face_spacing = 10;
constexpr double blocks_of_scene = 482;

Scene scene_of(int blocks) {
  const double factor = std::sqrt(blocks_of_scene / blocks);
  Scene scene =
      read_scene(OPENCLOSE_PAPER_SCENES "/example_3_4_post_failure.toml",
                 {fmt::format("joint_set[0].spacing_m={}", factor * horizontal_spacing),
                  fmt::format("joint_set[1].spacing_m={}", factor * face_spacing), fmt::format("step.dt_s={}", dt),
                  fmt::format("end.time_s={}", time_in_failure), fmt::format("output.every_s={}", time_in_failure), "output.milestones_m=[]"});
  check_scene(scene);
  return scene;
}

/// A slope in failure, made once for each size.
class Slope {
 public:
  static Slope& of(long blocks) {
    static std::map<long, std::unique_ptr<Slope>> made;
    auto& slope = made[blocks];
    if (!slope) slope = std::make_unique<Slope>(static_cast<int>(blocks));
    return *slope;
  }

  explicit Slope(int blocks) : simulation_(scene_of(blocks)) {
    const RunResult result = run(simulation_, {});
    if (!result.converged) throw std::runtime_error(result.reason);
  }

  Simulation& simulation() { return simulation_; }
  StepProblem problem() { return simulation_.problem(dt, false); }

  std::vector<ContactSprings> springs() {
    const auto soft = make_soft();
    const StepProblem step = problem();
    std::vector<ContactSprings> list;
    for (const Contact& c : step.contacts) list.push_back(soft->springs(step, c));
    return list;
  }

 private:
  Simulation simulation_;
};

/// The derivatives of one contact's springs by the unknowns of its blocks, closed and sticking.
struct ContactMatrix {
  int vertex_row, edge_row;  // -1: fixed
  BlockMatrix::Block vertex, edge, vertex_edge;
};

std::vector<ContactMatrix> contact_matrices(Slope& slope) {
  const StepProblem step = slope.problem();
  const auto springs = slope.springs();
  const auto nothing = Motion::Unknowns::Zero().eval();
  std::vector<ContactMatrix> list;
  for (std::size_t c = 0; c < springs.size(); ++c) {
    const Contact& contact = step.contacts[c];
    if (contact.status == ContactStatus::open) continue;
    const ContactKinematics k(step.system, contact, nothing, nothing);
    const ContactSprings& s = springs[c];
    list.push_back({step.system.block(contact.vertex_block).equation, step.system.block(contact.edge_block).equation,
                    s.normal * k.normal_vertex * k.normal_vertex.transpose() + s.shear * k.shear_vertex * k.shear_vertex.transpose(),
                    s.normal * k.normal_edge * k.normal_edge.transpose() + s.shear * k.shear_edge * k.shear_edge.transpose(),
                    s.normal * k.normal_vertex * k.normal_edge.transpose() + s.shear * k.shear_vertex * k.shear_edge.transpose()});
  }
  return list;
}

void assemble(Slope& slope, const std::vector<ContactMatrix>& contacts, BlockMatrix& matrix) {
  matrix.set_zero();
  const auto& system = std::as_const(slope.simulation()).system();
  for (const int b : system.free_blocks()) {
    const auto& block = system.block(b);
    matrix.add(block.equation, block.equation, (block.mass * (2 / (dt * dt))).asDiagonal().toDenseMatrix());
  }
  for (const ContactMatrix& c : contacts) {
    if (c.vertex_row >= 0) matrix.add(c.vertex_row, c.vertex_row, c.vertex);
    if (c.edge_row >= 0) matrix.add(c.edge_row, c.edge_row, c.edge);
    if (c.vertex_row < 0 || c.edge_row < 0) continue;
    matrix.add(c.vertex_row, c.edge_row, c.vertex_edge);
    matrix.add(c.edge_row, c.vertex_row, c.vertex_edge.transpose());
  }
}

/// The matrix of a step and what it is made of.
struct Equations {
  explicit Equations(Slope& slope) : contacts(contact_matrices(slope)) {
    std::vector<std::pair<int, int>> couplings;
    for (const ContactMatrix& c : contacts) {
      if (c.vertex_row >= 0 && c.edge_row >= 0) couplings.emplace_back(c.vertex_row, c.edge_row);
    }
    matrix.set_pattern(std::as_const(slope.simulation()).system().free_count(), couplings);
    assemble(slope, contacts, matrix);
  }

  std::vector<ContactMatrix> contacts;
  BlockMatrix matrix;
};

void say_size(benchmark::State& state, Slope& slope) {
  state.counters["blocks"] = static_cast<double>(std::as_const(slope.simulation()).system().block_count());
  state.counters["contacts"] = static_cast<double>(slope.simulation().contacts().size());
}

void detect(benchmark::State& state, bool search) {
  Slope& slope = Slope::of(state.range(0));
  const auto& simulation = std::as_const(slope.simulation());
  ContactSet contacts;
  DetectionSkips skips;
  skips.search = !search;
  skips.narrow_phase = false;
  Detector detector(simulation.state().lengths.longest_displacement, skips);
  detector.update(simulation.system(), slope.simulation().joints(), contacts);
  for (auto _ : state) detector.update(simulation.system(), slope.simulation().joints(), contacts);
  say_size(state, slope);
}
void narrow_phase(benchmark::State& state) {
  detect(state, false);
}
void search_and_narrow_phase(benchmark::State& state) {
  detect(state, true);
}

void residual(benchmark::State& state) {
  Slope& slope = Slope::of(state.range(0));
  const auto springs = slope.springs();
  const StepProblem step = slope.problem();
  StepEquations equations;
  ContactTrial contacts;
  for (auto _ : state) {
    equations.prepare(step, springs_in(springs), contacts);
    equations.sum_start_forces();
    benchmark::DoNotOptimize(equations.start_force().data());
  }
  say_size(state, slope);
}

void assembly(benchmark::State& state) {
  Slope& slope = Slope::of(state.range(0));
  Equations equations(slope);
  for (auto _ : state) {
    assemble(slope, equations.contacts, equations.matrix);
    benchmark::ClobberMemory();
  }
  say_size(state, slope);
}

void factor(benchmark::State& state) {
  Slope& slope = Slope::of(state.range(0));
  const Equations equations(slope);
  const auto solver = make_block_solver(Factoring::whole);
  if (!solver->factor(equations.matrix)) throw std::runtime_error("singular");
  for (auto _ : state) benchmark::DoNotOptimize(solver->factor(equations.matrix));
  say_size(state, slope);
}

void solve(benchmark::State& state) {
  Slope& slope = Slope::of(state.range(0));
  const Equations equations(slope);
  const auto solver = make_block_solver(Factoring::whole);
  if (!solver->factor(equations.matrix)) throw std::runtime_error("singular");
  const Eigen::VectorXd right_side = Eigen::VectorXd::Ones(equations.matrix.unknowns());
  for (auto _ : state) benchmark::DoNotOptimize(solver->solve(right_side).data());
  say_size(state, slope);
}

/// The same by GMRES with an incomplete factor, as accurate as Newton's method asks for; falls back on the other where that is quicker.
void incomplete_factor_and_solve(benchmark::State& state) {
  Slope& slope = Slope::of(state.range(0));
  const Equations equations(slope);
  const auto solver = make_incomplete_solver(make_block_solver(), 0);
  const Eigen::VectorXd right_side = Eigen::VectorXd::Ones(equations.matrix.unknowns());
  for (auto _ : state) {
    if (!solver->factor(equations.matrix)) throw std::runtime_error("singular");
    benchmark::DoNotOptimize(solver->solve(right_side, 1e-5).data());
  }
  say_size(state, slope);
  const LinearCounters& counters = solver->counters();
  state.counters["gmres_iterations"] = static_cast<double>(counters.krylov_iterations) / static_cast<double>(counters.incomplete);
  state.counters["given_up"] = static_cast<double>(counters.krylov_given_up);
}

/// A whole step with the solver that the program takes; the counter tells how many iterations it needs.
void step_of_soft(benchmark::State& state) {
  Slope& slope = Slope::of(state.range(0));
  const auto soft = make_soft();
  const StepProblem step = slope.problem();
  StepSolution solution;
  soft->solve(step, solution);
  for (auto _ : state) {
    soft->solve(step, solution);
    benchmark::DoNotOptimize(solution.d.data());
  }
  if (!solution.converged) throw std::runtime_error(solution.reason);
  say_size(state, slope);
  state.counters["newton_iterations"] = solution.effort.iterations;
}

void sizes(benchmark::internal::Benchmark* b) {
  b->Arg(482)->Arg(2000)->Arg(10000)->Unit(benchmark::kMicrosecond);
}
BENCHMARK(search_and_narrow_phase)->Apply(sizes);
BENCHMARK(narrow_phase)->Apply(sizes);
BENCHMARK(residual)->Apply(sizes);
BENCHMARK(assembly)->Apply(sizes);
BENCHMARK(factor)->Apply(sizes);
BENCHMARK(solve)->Apply(sizes);
BENCHMARK(incomplete_factor_and_solve)->Apply(sizes);
BENCHMARK(step_of_soft)->Apply(sizes);

}  // namespace
}  // namespace openclose

BENCHMARK_MAIN();
