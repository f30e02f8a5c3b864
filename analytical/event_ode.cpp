#include "openclose/analytical/event_ode.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace openclose::analytical {
namespace {

void require(int flag, const char* call) {
  if (flag < 0) throw std::runtime_error(std::string(call) + " failed with code " + std::to_string(flag));
}

}  // namespace

/// CVODE's own time begins at each restart, so that short first steps are not lost beside a late time.
struct EventIntegration::Session {
  const EventOde& ode;
  double start = 0;
  SUNContext context = nullptr;
  N_Vector y = nullptr, tolerances = nullptr;
  SUNNonlinearSolver solver = nullptr;
  void* cvode = nullptr;

  explicit Session(const EventOde& o) : ode(o) {}
  ~Session() {
    if (cvode) CVodeFree(&cvode);
    if (solver) SUNNonlinSolFree(solver);
    if (tolerances) N_VDestroy(tolerances);
    if (y) N_VDestroy(y);
    if (context) SUNContext_Free(&context);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  static int rates(realtype elapsed, N_Vector y, N_Vector rates, void* self) {
    const auto& s = *static_cast<const Session*>(self);
    s.ode.rates(s.start + elapsed, N_VGetArrayPointer(y), N_VGetArrayPointer(rates));
    return 0;
  }
  static int roots(realtype elapsed, N_Vector y, realtype* values, void* self) {
    const auto& s = *static_cast<const Session*>(self);
    s.ode.roots(s.start + elapsed, N_VGetArrayPointer(y), values);
    return 0;
  }
};

EventIntegration::EventIntegration(EventOde ode, double time, std::vector<double> y)
    : ode_(std::move(ode)), time_(time), y_(std::move(y)), session_(std::make_unique<Session>(ode_)) {
  if (ode_.absolute_tolerances.size() != y_.size()) throw std::invalid_argument("one absolute tolerance for each unknown");
  Session& s = *session_;
  s.start = time_;
  require(SUNContext_Create(nullptr, &s.context), "SUNContext_Create");
  s.y = N_VNew_Serial(static_cast<sunindextype>(y_.size()), s.context);
  s.tolerances = N_VClone(s.y);
  std::copy(y_.begin(), y_.end(), N_VGetArrayPointer(s.y));
  std::copy(ode_.absolute_tolerances.begin(), ode_.absolute_tolerances.end(), N_VGetArrayPointer(s.tolerances));
  s.cvode = CVodeCreate(CV_ADAMS, s.context);
  require(CVodeInit(s.cvode, &Session::rates, 0.0, s.y), "CVodeInit");
  require(CVodeSVtolerances(s.cvode, ode_.relative_tolerance, s.tolerances), "CVodeSVtolerances");
  require(CVodeSetUserData(s.cvode, &s), "CVodeSetUserData");
  s.solver = SUNNonlinSol_FixedPoint(s.y, 0, s.context);
  require(CVodeSetNonlinearSolver(s.cvode, s.solver), "CVodeSetNonlinearSolver");
  require(CVodeSetMaxNumSteps(s.cvode, -1), "CVodeSetMaxNumSteps");
  if (std::isfinite(ode_.longest_step)) require(CVodeSetMaxStep(s.cvode, ode_.longest_step), "CVodeSetMaxStep");
  if (ode_.root_count > 0) require(CVodeRootInit(s.cvode, ode_.root_count, &Session::roots), "CVodeRootInit");
  require(CVodeSetNoInactiveRootWarn(s.cvode), "CVodeSetNoInactiveRootWarn");
}

EventIntegration::~EventIntegration() = default;

std::vector<Crossing> EventIntegration::advance(double time) {
  if (!(time >= time_)) throw std::invalid_argument("the reference cannot go back in time");
  // CVODE cannot start towards a time within rounding of the present one.
  if (time - time_ <= 1e-14 * (1 + std::abs(time))) return {};
  Session& s = *session_;
  require(CVodeSetStopTime(s.cvode, time - s.start), "CVodeSetStopTime");
  realtype elapsed = 0;
  const int flag = CVode(s.cvode, time - s.start, s.y, &elapsed, CV_NORMAL);
  require(flag, "CVode");
  std::copy_n(N_VGetArrayPointer(s.y), y_.size(), y_.begin());
  if (flag != CV_ROOT_RETURN) {
    time_ = time;
    return {};
  }
  time_ = s.start + elapsed;
  std::vector<int> found(ode_.root_count);
  require(CVodeGetRootInfo(s.cvode, found.data()), "CVodeGetRootInfo");
  std::vector<Crossing> crossings;
  for (int i = 0; i < ode_.root_count; ++i) {
    if (found[i] != 0) crossings.push_back({i, found[i]});
  }
  return crossings;
}

void EventIntegration::restart(std::vector<double> y) {
  y_ = std::move(y);
  Session& s = *session_;
  std::copy(y_.begin(), y_.end(), N_VGetArrayPointer(s.y));
  s.start = time_;
  require(CVodeReInit(s.cvode, 0.0, s.y), "CVodeReInit");
}

}  // namespace openclose::analytical
