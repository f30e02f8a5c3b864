// What the steps of a simulation have cost.
#pragma once

#include <chrono>

#include "openclose/core/archive.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

struct StepCounters {
  long steps = 0;
  long cuts = 0;                        ///< attempts thrown away
  long error_cuts = 0;                  ///< of these: because of step.error_tolerance_m
  long entry_cuts = 0;                  ///< of these: `hard`, because a corner entered a block that it was not in contact with
  long iterations = 0;                  ///< linear solves of the whole system, thrown-away attempts included
  long parts = 0;                       ///< of the system, solved for themselves between these
  long part_iterations = 0;             ///< linear solves of parts
  long part_rows = 0;                   ///< block rows in these
  long relaxation_steps = 0;            ///< evaluations of all forces in static steps that are relaxed, thrown-away attempts included
  long relaxation_estimates = 0;        ///< of the stiffness of the whole system, made for these
  long eased = 0;                       ///< steps of `hard` that were balanced with a longer ramp of the cohesion only
  long still = 0;                       ///< steps in which nothing happened, counted without being solved again
  long dissipative = 0;                 ///< steps of path_average that found a solution only with dissipation
  long loads = 0;                       ///< times the explicit loop took over the state anew
  long loads_skipped = 0;               ///< times it took over only contacts that were found anew
  long block_steps = 0;                 ///< moves of a block in all steps
  long block_steps_skipped = 0;         ///< not made because the block was at rest
  long put_to_rest = 0;                 ///< blocks that were put to rest
  long woken = 0;                       ///< blocks that were woken
  long repeated_to_wake = 0;            ///< steps that were done again because they woke blocks
  double smallest_critical_step = 0.0;  ///< [s] of explicit steps, 0 if there were none
  double longest_step = 0.0;            ///< [s] of explicit steps

  void add(const StepEffort& effort) {
    iterations += effort.iterations;
    parts += effort.parts;
    part_iterations += effort.part_iterations;
    part_rows += effort.part_rows;
    relaxation_steps += effort.relaxation_steps;
    relaxation_estimates += effort.estimates;
  }

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v] = *this;
    archive(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v);
  }
};

/// Wall time [s] of the stages; one thread.
struct StageTimes {
  double detection = 0.0;
  double solution = 0.0;
  double bookkeeping = 0.0;
};

/// Adds the time of its own life to an account. Wall time: asking for CPU time costs more than a step of a small scene.
class Stopwatch {
 public:
  explicit Stopwatch(double& account) : account_(account) {}
  ~Stopwatch() { account_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& account_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace openclose
