#include "openclose/analysis/run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "openclose/analysis/start.h"

namespace openclose {

template <int N>
MeasuredPoints<N>::MeasuredPoints(Simulation<N>& simulation) : simulation_(simulation) {
  const Scene& scene = simulation.scene();
  auto& system = simulation.system();
  const auto follow = [&](const std::string& name, int block, const Vec2& position) {
    points_.push_back({name, system.follow_point(block, position), Vec2::Zero(), {}});
  };
  for (const MeasuredPoint& p : scene.measured_points) follow(p.name, p.block, p.point);
  if (points_.empty()) {
    for (int b : system.free_blocks()) follow(scene.blocks[b].name, b, system.block(b).reference_centroid + system.origin());
  }
  restart();
}

template <int N>
void MeasuredPoints<N>::restart() {
  const auto& system = simulation_.system();
  for (Point& p : points_) {
    p.start_displacement = system.displacement(system.point_block(p.number));
    p.start_arm = system.point_arm(p.number);
  }
}

template <int N>
std::vector<PointMotion> MeasuredPoints<N>::motions() const {
  const auto& system = std::as_const(simulation_).system();
  std::vector<PointMotion> list;
  for (const Point& p : points_) {
    const int b = system.point_block(p.number);
    const auto moved = (system.displacement(b) - p.start_displacement).eval();
    const auto velocity = simulation_.velocity(b);
    PointMotion m;
    m.name = p.name;
    m.displacement = Motion<N>::translation(moved) + (system.point_arm(p.number) - p.start_arm);
    m.rotation = Motion<N>::rotation(moved);
    m.velocity = Motion<N>::translation(velocity) + Motion<N>::rotation(velocity) * perpendicular(system.point_arm(p.number));
    list.push_back(m);
  }
  return list;
}

template <int N>
double MeasuredPoints<N>::largest_displacement() const {
  double largest = 0.0;
  for (const PointMotion& m : motions()) largest = std::max(largest, m.displacement.norm());
  return largest;
}

template <int N>
RunResult prepare_start(Simulation<N>& simulation) {
  RunResult result;
  result.converged = true;
  switch (simulation.scene().method.start) {
    case Start::unloaded:
      break;
    case Start::settled:
      result.settling = settle(simulation);
      result.converged = result.settling.settled;
      if (!result.converged)
        result.reason = "no static equilibrium to start from (" + result.settling.criterion + "); method.start = \"unloaded\" starts in motion";
      simulation.restore_velocities();
      break;
    case Start::normal_balanced:
      balance_normal_forces(simulation, false);
      break;
    case Start::steady_sliding:
      balance_normal_forces(simulation, true);
      break;
  }
  simulation.contacts();
  simulation.restart_clock();
  return result;
}

template <int N>
RunResult run(Simulation<N>& simulation, const RunObserver<N>& observer) {
  RunResult result = prepare_start(simulation);
  if (observer.started) observer.started(simulation);
  if (observer.output) observer.output(simulation);
  if (!result.converged) return result;

  const Scene& scene = simulation.scene();
  // The last step is shorter where the end is no multiple of the step.
  const long steps = std::lround(std::ceil(scene.end_time / scene.step.dt * (1.0 - 1e-12)));
  const long every = std::max(1L, std::lround(scene.output_every / scene.step.dt));
  for (long i = 1; i <= steps; ++i) {
    const double begin = static_cast<double>(i - 1) * scene.step.dt;
    const bool whole = begin + scene.step.dt <= scene.end_time * (1.0 + 1e-12);
    if (!simulation.advance(whole ? scene.step.dt : scene.end_time - begin)) {
      result.converged = false;
      result.reason = simulation.reason();
      if (observer.output) observer.output(simulation);
      return result;
    }
    simulation.set_time(whole ? static_cast<double>(i) * scene.step.dt : scene.end_time);
    if (observer.output && (i % every == 0 || i == steps)) observer.output(simulation);
    if (observer.progress) observer.progress(static_cast<double>(i) / static_cast<double>(steps));
  }
  return result;
}

template class MeasuredPoints<3>;
template RunResult prepare_start<3>(Simulation<3>&);
template RunResult run<3>(Simulation<3>&, const RunObserver<3>&);

}  // namespace openclose
