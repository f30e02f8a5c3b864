// A run from its start state to its end time.
#pragma once

#include <functional>
#include <string>

#include "openclose/analysis/settle.h"
#include "openclose/analysis/simulation.h"

namespace openclose {

/// Motion of a measured point since time 0.
struct PointMotion {
  std::string name;
  Vec2 displacement = Vec2::Zero();  ///< [m]
  double rotation = 0.0;             ///< [rad]
  Vec2 velocity = Vec2::Zero();      ///< [m/s]
};

/// The measured points of a scene; without any, the centroids of the free blocks.
template <int N>
class MeasuredPoints {
 public:
  explicit MeasuredPoints(Simulation<N>& simulation);
  /// Displacements count from here.
  void restart();
  std::vector<PointMotion> motions() const;
  double largest_displacement() const;  ///< [m]

 private:
  struct Point {
    std::string name;
    int number;  ///< of the system's followed points
    Vec2 start_arm;
    typename Motion<N>::Unknowns start_displacement;
  };
  Simulation<N>& simulation_;
  std::vector<Point> points_;
};

struct RunResult {
  bool converged = false;
  std::string reason;
  SettleResult settling;  ///< if the start was `settled`
};

/// What a run tells while it goes on.
template <int N>
struct RunObserver {
  std::function<void(const Simulation<N>&)> started;  ///< the start state is reached, time is 0
  std::function<void(const Simulation<N>&)> output;   ///< at time 0 and at every output time
  std::function<void(double fraction)> progress;      ///< after every step
};

/// Brings the simulation into the scene's start state.
template <int N>
RunResult prepare_start(Simulation<N>& simulation);

template <int N>
RunResult run(Simulation<N>& simulation, const RunObserver<N>& observer);

}  // namespace openclose
