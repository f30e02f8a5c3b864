#include "openclose/analytical/sliding_block_reference.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "openclose/analytical/incline.h"
#include "openclose/analytical/two_spring_block.h"

namespace openclose::analytical {
namespace {

constexpr int corners = 2;
constexpr std::size_t root_count = 2 * corners;

// CVODE's root functions of a corner: its gap, and the friction condition of its mode.
std::size_t gap_root(int corner) {
  return 2 * static_cast<std::size_t>(corner);
}
std::size_t friction_root(int corner) {
  return gap_root(corner) + 1;
}

// A start written by hand meets the friction bound to rounding only; this part of it counts as being on it.
constexpr double bound_rounding = 1e-12;

enum Unknown { pos_x, pos_y, angle, vel_x, vel_y, spin, shear_lower, shear_upper, friction_work, unknowns };

bool slips(ContactMode mode) {
  return mode == ContactMode::slip_downhill || mode == ContactMode::slip_uphill;
}
double slip_direction(ContactMode mode) {
  return mode == ContactMode::slip_uphill ? -1.0 : 1.0;
}
ContactMode slip_mode(double direction) {
  return direction < 0 ? ContactMode::slip_uphill : ContactMode::slip_downhill;
}

/// A corner in the plane's frame [m, m/s].
struct CornerMotion {
  double arm_x, arm_y;  // from the centroid
  double gap;
  double slip_rate, gap_rate;
};

struct Acceleration {
  double x, y, angular;
};

}  // namespace

/// The equations for given modes, and the rules by which modes follow each other. The CVODE session is kept beside them.
class SlidingBlockReference::Integration {
 public:
  Integration(const BlockOnPlane& block, const SlidingBlockState& start, const ReferenceOptions& options);
  ~Integration();
  Integration(const Integration&) = delete;
  Integration& operator=(const Integration&) = delete;

  void advance(double time);
  void shake(const GroundPiece& piece);
  double energy() const;
  double normal_force(int corner) const { return normal_force(state_, corner); }
  double tangential_force(int corner) const { return tangential_force(state_, corner); }

  SlidingBlockState state_;
  std::vector<ContactEvent> events_;

 private:
  static int rates_callback(realtype elapsed, N_Vector y, N_Vector rates, void* self);
  static int roots_callback(realtype elapsed, N_Vector y, realtype* values, void* self);

  CornerMotion motion(const SlidingBlockState& s, int corner) const;
  double normal_force(const SlidingBlockState& s, int corner) const;
  double tangential_force(const SlidingBlockState& s, int corner) const;
  Acceleration acceleration(const SlidingBlockState& s) const;
  double plastic_rate(const SlidingBlockState& s, int corner) const;
  double friction_margin(const SlidingBlockState& s, int corner) const;
  void corner_accelerations(const SlidingBlockState& s, int corner, double& slip, double& gap) const;

  void take_first_modes();
  ContactMode first_mode(int corner) const;
  ContactMode closing_mode(int corner, double slip_rate, double gap_rate) const;
  ContactMode mode_at_bound(int corner) const;
  ContactMode mode_after_root(int corner, bool gap_crossed, bool friction_crossed) const;
  void change_modes(const std::array<int, root_count>& roots);
  void slave_shear(int corner);

  SlidingBlockState unpack(double time, const double* y) const;
  void pack();
  void open_session();
  void restart();
  void set_root_directions();

  BlockOnPlane block_;
  ReferenceOptions options_;
  double friction_;

  std::function<std::array<double, 2>(double)> ground_;  // empty: at rest

  // CVODE counts time from its last start, so that the tiny first steps are not lost beside it.
  double session_start_ = 0;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  N_Vector tolerances_ = nullptr;
  SUNNonlinearSolver solver_ = nullptr;
  void* cvode_ = nullptr;
};

namespace {

void require(int flag, const char* call) {
  if (flag >= 0) return;
  throw std::runtime_error(std::string(call) + " failed with code " + std::to_string(flag));
}

}  // namespace

// ---- equations
// -------------------------------------------------------------------------------------------------------------------------------------

CornerMotion SlidingBlockReference::Integration::motion(const SlidingBlockState& s, int corner) const {
  const double rx = corner == 0 ? block_.width / 2 : -block_.width / 2;
  const double ry = -block_.height / 2;
  const double sine = std::sin(s.rotation);
  const double half_sine = std::sin(s.rotation / 2);
  const double one_minus_cosine = 2 * half_sine * half_sine;
  CornerMotion m;
  m.arm_x = rx * (1 - one_minus_cosine) - ry * sine;
  m.arm_y = rx * sine + ry * (1 - one_minus_cosine);
  // Written with y and the small terms only, so that a penetration of 1e-4 m keeps its digits.
  m.gap = s.y + rx * sine - ry * one_minus_cosine;
  m.slip_rate = s.velocity_x - s.angular_velocity * m.arm_y;
  m.gap_rate = s.velocity_y + s.angular_velocity * m.arm_x;
  return m;
}

double SlidingBlockReference::Integration::normal_force(const SlidingBlockState& s, int corner) const {
  return s.modes[corner] == ContactMode::open ? 0.0 : -block_.normal_stiffness * motion(s, corner).gap;
}

double SlidingBlockReference::Integration::tangential_force(const SlidingBlockState& s, int corner) const {
  const ContactMode mode = s.modes[corner];
  if (mode == ContactMode::open) return 0.0;
  if (mode == ContactMode::stick) return -block_.shear_stiffness * s.shear[corner];
  return -slip_direction(mode) * friction_ * normal_force(s, corner);
}

Acceleration SlidingBlockReference::Integration::acceleration(const SlidingBlockState& s) const {
  double force_x = block_.weight() * std::sin(block_.slope_angle);
  double force_y = -block_.normal_weight();
  double moment = 0;
  if (ground_) {
    // Downhill is (cos, -sin), away from the plane (sin, cos).
    const auto [horizontal, vertical] = ground_(s.time);
    const double sine = std::sin(block_.slope_angle), cosine = std::cos(block_.slope_angle);
    force_x -= block_.mass() * (horizontal * cosine - vertical * sine);
    force_y -= block_.mass() * (horizontal * sine + vertical * cosine);
  }
  for (int i = 0; i < corners; ++i) {
    const CornerMotion m = motion(s, i);
    const double normal = normal_force(s, i);
    const double tangential = tangential_force(s, i);
    force_x += tangential;
    force_y += normal;
    moment += m.arm_x * normal - m.arm_y * tangential;
  }
  const double angular = options_.rotation_locked ? 0.0 : moment / block_.moment_of_inertia();
  return {force_x / block_.mass(), force_y / block_.mass(), angular};
}

void SlidingBlockReference::Integration::corner_accelerations(const SlidingBlockState& s, int corner, double& slip, double& gap) const {
  const Acceleration a = acceleration(s);
  const CornerMotion m = motion(s, corner);
  const double spin_squared = s.angular_velocity * s.angular_velocity;
  slip = a.x - a.angular * m.arm_y - spin_squared * m.arm_x;
  gap = a.y + a.angular * m.arm_x - spin_squared * m.arm_y;
}

/// d (s' - u') of a slipping corner, with u' = d mu N'/ks.
double SlidingBlockReference::Integration::plastic_rate(const SlidingBlockState& s, int corner) const {
  const CornerMotion m = motion(s, corner);
  return slip_direction(s.modes[corner]) * m.slip_rate + friction_ * block_.normal_stiffness * m.gap_rate / block_.shear_stiffness;
}

/// |ks u| - mu N of a sticking corner [N]; positive: beyond the bound.
double SlidingBlockReference::Integration::friction_margin(const SlidingBlockState& s, int corner) const {
  return block_.shear_stiffness * std::abs(s.shear[corner]) - friction_ * normal_force(s, corner);
}

int SlidingBlockReference::Integration::rates_callback(realtype elapsed, N_Vector y, N_Vector rates, void* self) {
  const auto& integration = *static_cast<const Integration*>(self);
  const SlidingBlockState s = integration.unpack(integration.session_start_ + elapsed, N_VGetArrayPointer(y));
  const Acceleration a = integration.acceleration(s);
  double* r = N_VGetArrayPointer(rates);
  r[pos_x] = s.velocity_x;
  r[pos_y] = s.velocity_y;
  r[angle] = s.angular_velocity;
  r[vel_x] = a.x;
  r[vel_y] = a.y;
  r[spin] = a.angular;
  r[friction_work] = 0;
  for (int i = 0; i < corners; ++i) {
    const ContactMode mode = s.modes[i];
    const double slip_rate = integration.motion(s, i).slip_rate;
    double& shear_rate = r[shear_lower + i];
    shear_rate = mode == ContactMode::open ? 0.0 : slip_rate;
    if (!slips(mode)) continue;
    const double plastic = integration.plastic_rate(s, i);
    shear_rate = slip_rate - slip_direction(mode) * plastic;
    r[friction_work] += std::abs(integration.tangential_force(s, i)) * plastic;
  }
  return 0;
}

int SlidingBlockReference::Integration::roots_callback(realtype elapsed, N_Vector y, realtype* values, void* self) {
  const auto& integration = *static_cast<const Integration*>(self);
  const SlidingBlockState s = integration.unpack(integration.session_start_ + elapsed, N_VGetArrayPointer(y));
  for (int i = 0; i < corners; ++i) {
    values[gap_root(i)] = integration.motion(s, i).gap;
    double& condition = values[friction_root(i)];
    condition = 1;  // no friction condition for an open or a frictionless corner
    if (s.modes[i] == ContactMode::open || integration.friction_ == 0) continue;
    condition = s.modes[i] == ContactMode::stick ? integration.friction_margin(s, i) : integration.plastic_rate(s, i);
  }
  return 0;
}

// ---- modes
// -----------------------------------------------------------------------------------------------------------------------------------------

/// N and u both grow from zero: the bound is met at once or not at all.
ContactMode SlidingBlockReference::Integration::closing_mode(int corner, double slip_rate, double gap_rate) const {
  if (block_.shear_stiffness * std::abs(slip_rate) < friction_ * block_.normal_stiffness * std::abs(gap_rate)) return ContactMode::stick;
  if (slip_rate == 0 && gap_rate == 0) {
    double slip = 0;
    double gap = 0;
    corner_accelerations(state_, corner, slip, gap);
    if (block_.shear_stiffness * std::abs(slip) < friction_ * block_.normal_stiffness * std::abs(gap)) return ContactMode::stick;
    return slip_mode(slip);
  }
  return slip_mode(slip_rate);
}

/// |ks u| = mu N > 0: slips on if the plastic rate, or where that is zero its derivative, is positive.
ContactMode SlidingBlockReference::Integration::mode_at_bound(int corner) const {
  SlidingBlockState slipping = state_;
  slipping.modes[corner] = slip_mode(state_.shear[corner]);
  const double rate = plastic_rate(slipping, corner);
  if (rate != 0) return rate > 0 ? slipping.modes[corner] : ContactMode::stick;
  double slip = 0;
  double gap = 0;
  corner_accelerations(slipping, corner, slip, gap);
  const double growth = slip_direction(slipping.modes[corner]) * slip + friction_ * block_.normal_stiffness * gap / block_.shear_stiffness;
  return growth > 0 ? slipping.modes[corner] : ContactMode::stick;
}

/// Expects every touching corner in mode stick, so that forces follow from positions alone.
ContactMode SlidingBlockReference::Integration::first_mode(int corner) const {
  const CornerMotion m = motion(state_, corner);
  if (m.gap > 0) return ContactMode::open;
  const double bound = friction_ * normal_force(state_, corner);
  const double margin = friction_margin(state_, corner);
  if (margin > bound_rounding * bound) throw std::invalid_argument("the start has a tangential force beyond friction");
  if (m.gap < 0) {
    if (friction_ == 0) return slip_mode(m.slip_rate);
    return margin < -bound_rounding * bound ? ContactMode::stick : mode_at_bound(corner);
  }
  double slip = 0;
  double gap = 0;
  corner_accelerations(state_, corner, slip, gap);
  const bool closes = m.gap_rate < 0 || (m.gap_rate == 0 && gap < 0);
  return closes ? closing_mode(corner, m.slip_rate, m.gap_rate) : ContactMode::open;
}

ContactMode SlidingBlockReference::Integration::mode_after_root(int corner, bool gap_crossed, bool friction_crossed) const {
  const ContactMode mode = state_.modes[corner];
  const CornerMotion m = motion(state_, corner);
  if (gap_crossed) return mode == ContactMode::open ? closing_mode(corner, m.slip_rate, m.gap_rate) : ContactMode::open;
  if (mode == ContactMode::stick && friction_crossed) return mode_at_bound(corner);
  // The rate may also have passed zero unreported, within the width of another corner's root.
  if (slips(mode) && friction_ > 0 && (friction_crossed || plastic_rate(state_, corner) < 0)) return ContactMode::stick;
  return mode;
}

void SlidingBlockReference::Integration::slave_shear(int corner) {
  const ContactMode mode = state_.modes[corner];
  if (mode == ContactMode::open) state_.shear[corner] = 0;
  if (slips(mode)) state_.shear[corner] = -tangential_force(state_, corner) / block_.shear_stiffness;
}

void SlidingBlockReference::Integration::change_modes(const std::array<int, root_count>& roots) {
  for (int i = 0; i < corners; ++i) slave_shear(i);
  const SlidingBlockState before = state_;
  std::array<ContactMode, corners> after = before.modes;
  for (int i = 0; i < corners; ++i) after[i] = mode_after_root(i, roots[gap_root(i)] != 0, roots[friction_root(i)] != 0);
  for (int i = 0; i < corners; ++i) {
    if (after[i] == before.modes[i]) continue;
    state_.modes[i] = after[i];
    if (before.modes[i] == ContactMode::open) state_.shear[i] = 0;
    slave_shear(i);
    events_.push_back({state_.time, i, before.modes[i], after[i]});
  }
}

// ---- integration
// -----------------------------------------------------------------------------------------------------------------------------------

SlidingBlockReference::Integration::Integration(const BlockOnPlane& block, const SlidingBlockState& start, const ReferenceOptions& options)
    : state_(start), block_(block), options_(options), friction_(block.friction()) {
  require_valid(block);
  if (!(options.relative_tolerance > 0 && options.relative_tolerance < 1)) throw std::invalid_argument("the tolerance must be in (0, 1)");
  if (!(options.steps_per_period > 0)) throw std::invalid_argument("the steps per period must be positive");
  if (options.rotation_locked) state_.angular_velocity = 0;
  take_first_modes();
  open_session();
}

void SlidingBlockReference::Integration::take_first_modes() {
  for (int i = 0; i < corners; ++i) state_.modes[i] = motion(state_, i).gap > 0 ? ContactMode::open : ContactMode::stick;
  const std::array<ContactMode, corners> modes = {first_mode(0), first_mode(1)};
  state_.modes = modes;
  for (int i = 0; i < corners; ++i) slave_shear(i);
}

SlidingBlockReference::Integration::~Integration() {
  if (cvode_) CVodeFree(&cvode_);
  if (solver_) SUNNonlinSolFree(solver_);
  if (tolerances_) N_VDestroy(tolerances_);
  if (y_) N_VDestroy(y_);
  if (context_) SUNContext_Free(&context_);
}

SlidingBlockState SlidingBlockReference::Integration::unpack(double time, const double* y) const {
  SlidingBlockState s;
  s.time = time;
  s.x = y[pos_x];
  s.y = y[pos_y];
  s.rotation = y[angle];
  s.velocity_x = y[vel_x];
  s.velocity_y = y[vel_y];
  s.angular_velocity = y[spin];
  s.shear = {y[shear_lower], y[shear_upper]};
  s.dissipated = y[friction_work];
  s.modes = state_.modes;
  return s;
}

void SlidingBlockReference::Integration::pack() {
  double* y = N_VGetArrayPointer(y_);
  y[pos_x] = state_.x;
  y[pos_y] = state_.y;
  y[angle] = state_.rotation;
  y[vel_x] = state_.velocity_x;
  y[vel_y] = state_.velocity_y;
  y[spin] = state_.angular_velocity;
  y[shear_lower] = state_.shear[0];
  y[shear_upper] = state_.shear[1];
  y[friction_work] = state_.dissipated;
}

void SlidingBlockReference::Integration::open_session() {
  require(SUNContext_Create(nullptr, &context_), "SUNContext_Create");
  y_ = N_VNew_Serial(unknowns, context_);
  tolerances_ = N_VClone(y_);
  pack();
  session_start_ = state_.time;

  // Absolute tolerances from the static penetration and the vibration about it.
  const double length = block_.normal_weight() / (2 * block_.normal_stiffness);
  const double frequency = highest_frequency(block_);
  double* tolerance = N_VGetArrayPointer(tolerances_);
  for (const int i : {pos_x, pos_y, shear_lower, shear_upper}) tolerance[i] = options_.relative_tolerance * length;
  tolerance[angle] = options_.relative_tolerance * length / block_.width;
  tolerance[vel_x] = tolerance[vel_y] = tolerance[pos_y] * frequency;
  tolerance[spin] = tolerance[angle] * frequency;
  tolerance[friction_work] = options_.relative_tolerance * block_.normal_weight() * length;

  cvode_ = CVodeCreate(CV_ADAMS, context_);
  require(CVodeInit(cvode_, rates_callback, 0.0, y_), "CVodeInit");
  require(CVodeSVtolerances(cvode_, options_.relative_tolerance, tolerances_), "CVodeSVtolerances");
  require(CVodeSetUserData(cvode_, this), "CVodeSetUserData");
  solver_ = SUNNonlinSol_FixedPoint(y_, 0, context_);
  require(CVodeSetNonlinearSolver(cvode_, solver_), "CVodeSetNonlinearSolver");
  require(CVodeSetMaxNumSteps(cvode_, -1), "CVodeSetMaxNumSteps");
  require(CVodeSetMaxStep(cvode_, 2 * std::numbers::pi / (frequency * options_.steps_per_period)), "CVodeSetMaxStep");
  require(CVodeRootInit(cvode_, static_cast<int>(root_count), roots_callback), "CVodeRootInit");
  require(CVodeSetNoInactiveRootWarn(cvode_), "CVodeSetNoInactiveRootWarn");
  set_root_directions();
}

void SlidingBlockReference::Integration::set_root_directions() {
  std::array<int, root_count> directions;
  for (int i = 0; i < corners; ++i) {
    directions[gap_root(i)] = state_.modes[i] == ContactMode::open ? -1 : 1;
    directions[friction_root(i)] = state_.modes[i] == ContactMode::stick ? 1 : -1;
  }
  require(CVodeSetRootDirection(cvode_, directions.data()), "CVodeSetRootDirection");
}

void SlidingBlockReference::Integration::restart() {
  pack();
  session_start_ = state_.time;
  require(CVodeReInit(cvode_, 0.0, y_), "CVodeReInit");
  set_root_directions();
}

void SlidingBlockReference::Integration::shake(const GroundPiece& piece) {
  ground_ = piece.acceleration;
  // Corners that just touch go by the accelerations.
  if (state_.time == 0) take_first_modes();
  restart();
}

void SlidingBlockReference::Integration::advance(double time) {
  if (!(time >= state_.time)) throw std::invalid_argument("the reference cannot go back in time");
  // CVODE cannot start towards a time within rounding of the present one.
  const double rounding = 1e-14 * (1 + std::abs(time));
  while (time - state_.time > rounding) {
    realtype elapsed = 0;
    const int flag = CVode(cvode_, time - session_start_, y_, &elapsed, CV_NORMAL);
    require(flag, "CVode");
    const bool root = flag == CV_ROOT_RETURN;
    state_ = unpack(root ? session_start_ + elapsed : time, N_VGetArrayPointer(y_));
    if (!root) continue;
    std::array<int, root_count> roots;
    require(CVodeGetRootInfo(cvode_, roots.data()), "CVodeGetRootInfo");
    change_modes(roots);
    restart();
  }
}

double SlidingBlockReference::Integration::energy() const {
  const SlidingBlockState& s = state_;
  double sum = s.dissipated + block_.normal_weight() * s.y - block_.weight() * std::sin(block_.slope_angle) * s.x +
               block_.mass() * (s.velocity_x * s.velocity_x + s.velocity_y * s.velocity_y) / 2 +
               block_.moment_of_inertia() * s.angular_velocity * s.angular_velocity / 2;
  for (int i = 0; i < corners; ++i) {
    const double normal = normal_force(s, i);
    const double tangential = tangential_force(s, i);
    sum += normal * normal / (2 * block_.normal_stiffness) + tangential * tangential / (2 * block_.shear_stiffness);
  }
  return sum;
}

// ---- interface
// -------------------------------------------------------------------------------------------------------------------------------------

SlidingBlockState unloaded_start() {
  return {};
}

SlidingBlockState normal_balanced_start(const BlockOnPlane& block) {
  SlidingBlockState s;
  s.y = -block.normal_weight() / (2 * block.normal_stiffness);
  return s;
}

SlidingBlockState steady_sliding_start(const BlockOnPlane& block, double velocity, bool rotation_locked) {
  const int direction = velocity < 0 ? -1 : 1;
  const double shear_per_force = direction * block.friction() / block.shear_stiffness;
  SlidingBlockState s = normal_balanced_start(block);
  s.velocity_x = velocity;
  s.shear.fill(shear_per_force * block.normal_weight() / 2);
  if (rotation_locked) return s;
  const SteadyPose pose = steady_pose(block, direction);
  s.y = -pose.drop;
  s.rotation = pose.tilt;
  s.shear = {shear_per_force * pose.lower_normal, shear_per_force * pose.upper_normal};
  return s;
}

SlidingBlockReference::SlidingBlockReference(const BlockOnPlane& block, const SlidingBlockState& start, const ReferenceOptions& options)
    : integration_(std::make_unique<Integration>(block, start, options)) {}
SlidingBlockReference::~SlidingBlockReference() = default;
SlidingBlockReference::SlidingBlockReference(SlidingBlockReference&&) noexcept = default;
SlidingBlockReference& SlidingBlockReference::operator=(SlidingBlockReference&&) noexcept = default;

const SlidingBlockState& SlidingBlockReference::advance(double time) {
  integration_->advance(time);
  return integration_->state_;
}

std::vector<SlidingBlockState> SlidingBlockReference::states_at(const std::vector<double>& times) {
  std::vector<SlidingBlockState> states;
  states.reserve(times.size());
  for (const double time : times) states.push_back(advance(time));
  return states;
}

std::vector<SlidingBlockState> SlidingBlockReference::follow(const GroundMotion& ground, const std::vector<double>& times) {
  std::vector<SlidingBlockState> states;
  if (times.empty()) return states;
  for (const GroundPiece& piece : without_gaps(ground, times.back())) {
    integration_->shake(piece);
    while (states.size() < times.size() && times[states.size()] <= piece.to) states.push_back(advance(times[states.size()]));
    if (states.size() == times.size()) break;
    advance(piece.to);
  }
  return states;
}

const SlidingBlockState& SlidingBlockReference::state() const {
  return integration_->state_;
}
const std::vector<ContactEvent>& SlidingBlockReference::events() const {
  return integration_->events_;
}
double SlidingBlockReference::energy() const {
  return integration_->energy();
}
double SlidingBlockReference::normal_force(int corner) const {
  return integration_->normal_force(corner);
}
double SlidingBlockReference::tangential_force(int corner) const {
  return integration_->tangential_force(corner);
}

}  // namespace openclose::analytical
