// Factor of safety by strength reduction: settle with full strength, then find the largest factor by which tan(phi), c and the tensile strength can
// be divided so that the system still settles.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "openclose/analysis/run.h"

namespace openclose {

struct StrengthTrial {
  double srf = 1.0;   ///< [-] strength reduction factor
  std::string stage;  ///< bracket, bisect or curve
  bool stable = false;
  std::string criterion;  ///< what decided, see SettleResult
  int steps = 0;
  double displacement = 0.0;  ///< [m] largest of a measured point since the settled state
};

/// Displacement after a stated time of motion with reduced strength, from the settled state.
struct CurvePoint {
  double srf = 1.0;
  std::string point;
  double displacement = 0.0;  ///< [m]
};

template <int N>
struct FactorOfSafety {
  bool found = false;
  std::string reason;     ///< why not
  double stable = 0.0;    ///< [-] the largest factor that settled: the factor of safety, to within failed - stable
  double failed = 0.0;    ///< [-] the smallest one that did not
  std::string criterion;  ///< what decided there
  std::vector<std::string> warnings;
  std::vector<StrengthTrial> trials;
  std::vector<CurvePoint> curve;
  typename Simulation<N>::Snapshot settled_state;
  typename Simulation<N>::Snapshot failed_state;
};

template <int N>
FactorOfSafety<N> factor_of_safety(Simulation<N>& simulation, const std::function<void(double fraction)>& progress = {});

}  // namespace openclose
