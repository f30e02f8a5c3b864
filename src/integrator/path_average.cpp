// Path-averaged contact forces: u1 = u0 + dt (v0 + v1)/2, M (v1 - v0) = dt F with the mean F of the forces along the straight path of the step, in
// the mean geometry (law/path_average.h, contact/mean_pose.h). The work of F is then what springs store and friction takes, and the angular
// momentum stays. Order 2, also over impacts and where contacts begin to slide.
#include "openclose/integrator/integrators.h"

namespace openclose {
namespace {

class PathAveraged : public TimeScheme {
 public:
  using Unknowns = TimeScheme::Unknowns;

  double inertia(double dt) const override { return 2.0 / (dt * dt); }
  double end_weight() const override { return 1.0; }
  bool averages_path() const override { return true; }
  Unknowns next_velocity(int, double dt, const Unknowns& d, const Unknowns& v) const override { return (2.0 / dt) * d - v; }
  Unknowns work_displacement(int, double, const Unknowns& d, const Unknowns&) const override { return d; }
  Unknowns velocity_at_end(int b, double dt, const Unknowns& d, const Unknowns& v) const override { return next_velocity(b, dt, d, v); }
};

}  // namespace

std::unique_ptr<TimeScheme> make_path_average() {
  return std::make_unique<PathAveraged>();
}

}  // namespace openclose
