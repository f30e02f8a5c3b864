#include "openclose/analytical/newmark_block.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "openclose/analytical/event_ode.h"

namespace openclose::analytical {
namespace {

/// [-] Steps of CVODE within a piece of the ground motion, at least: the shortest stick or slip that is not overlooked is such a part of it.
constexpr double steps_per_piece = 50;
/// [-] The same within a swing of the spring.
constexpr double steps_per_swing = 50;
/// [m], [m/s] what is small against any slip of interest.
constexpr double length_tolerance = 1e-15, velocity_tolerance = 1e-14;

struct Pull {
  double driving, normal;  // [m/s2]
};

class Motion {
 public:
  Motion(const BlockOnPlane& block, const GroundMotion& ground, double tolerance, const GroundSpring& spring)
      : block_(block), spring_(spring), ground_(ground) {
    EventOde ode;
    ode.rates = [this](double t, const double* y, double* rates) {
      const Pull p = pull(t, y[0]);
      rates[0] = y[1];
      rates[1] = direction_ == 0 ? 0 : p.driving - direction_ * block_.friction() * p.normal;
    };
    ode.roots = [this](double t, const double* y, double* values) {
      const Pull p = pull(t, y[0]);
      values[0] = direction_ == 0 ? std::abs(p.driving) - block_.friction() * p.normal : y[1];
      values[1] = p.normal;
    };
    ode.root_count = 2;
    ode.relative_tolerance = tolerance;
    ode.absolute_tolerances = {length_tolerance, velocity_tolerance};
    // One session for all pieces: its longest step must suit the shortest.
    for (const GroundPiece& piece : ground_) ode.longest_step = std::min(ode.longest_step, std::max(piece.to - piece.from, 1e-3) / steps_per_piece);
    if (spring_.stiffness_over_mass > 0)
      ode.longest_step = std::min(ode.longest_step, 2 * std::numbers::pi / std::sqrt(spring_.stiffness_over_mass) / steps_per_swing);
    session_ = std::make_unique<EventIntegration>(std::move(ode), 0.0, std::vector<double>{spring_.start, 0});
  }

  NewmarkMotion follow(const std::vector<double>& times) {
    NewmarkMotion motion;
    std::size_t next = 0;
    for (piece_ = 0; piece_ < ground_.size() && next < times.size(); ++piece_) {
      begin_piece();
      const double end = ground_[piece_].to;
      for (; next < times.size() && times[next] <= end; ++next) {
        advance(times[next]);
        motion.states.push_back({times[next], session_->y()[0], session_->y()[1]});
      }
      if (next < times.size()) advance(end);
    }
    motion.events = events_;
    return motion;
  }

 private:
  Pull pull(double t, double x) const {
    const auto [horizontal, vertical] = ground_[piece_].acceleration(t);
    const double sine = std::sin(block_.slope_angle), cosine = std::cos(block_.slope_angle), down = block_.gravity + vertical;
    return {down * sine - horizontal * cosine - spring_.stiffness_over_mass * x, down * cosine + horizontal * sine};
  }
  Pull pull_now() const { return pull(session_->time(), session_->y()[0]); }

  /// At rest: which way it goes now. On the bound the derivative decides.
  int direction_from_rest() const {
    const double now = session_->time(), ahead = 1e-9;
    const Pull p = pull_now(), soon = pull(now + ahead, session_->y()[0]);
    const double margin = std::abs(p.driving) - block_.friction() * p.normal;
    const double growth = std::abs(soon.driving) - block_.friction() * soon.normal - margin;
    const double rounding = 1e-12 * block_.gravity;
    if (margin > rounding || (margin > -rounding && growth > 0)) return p.driving > 0 ? 1 : -1;
    return 0;
  }

  void set_direction(int direction) {
    if (direction != direction_) events_.push_back({session_->time(), direction});
    direction_ = direction;
  }

  void begin_piece() {
    if (pull_now().normal <= 0) throw std::domain_error("the block lifts off");
    if (direction_ == 0) set_direction(direction_from_rest());
    session_->restart();
  }

  void advance(double time) {
    for (;;) {
      const std::vector<Crossing> found = session_->advance(time);
      if (found.empty()) return;
      for (const Crossing& c : found) {
        if (c.root == 1) throw std::domain_error("the block lifts off");
      }
      std::vector<double> y = session_->y();
      if (direction_ == 0) {
        set_direction(found.front().direction > 0 ? (pull_now().driving > 0 ? 1 : -1) : 0);
      } else if (found.front().direction == -direction_) {
        y[1] = 0;
        const int was = direction_;
        direction_ = 0;
        const int next = direction_from_rest();
        direction_ = was;
        set_direction(next);
      }
      session_->restart(y);
    }
  }

  BlockOnPlane block_;
  GroundSpring spring_;
  const GroundMotion& ground_;
  std::size_t piece_ = 0;
  int direction_ = 0;
  std::vector<NewmarkEvent> events_;
  std::unique_ptr<EventIntegration> session_;
};

}  // namespace

PulseSlip pulse_slip(const BlockOnPlane& block, double pulse, double duration) {
  if (block.slope_angle != 0) throw std::domain_error("the closed form is for a level plane");
  const double yield = block.gravity * block.friction();
  if (!(pulse > yield)) throw std::domain_error("the pulse does not exceed friction");
  const double velocity = pulse * duration;
  return {velocity * velocity / (2 * yield) * (1 - yield / pulse), duration * pulse / yield};
}

CycleSlip harmonic_slip(const BlockOnPlane& block, double amplitude, double frequency) {
  const double difference = block.friction_angle - block.slope_angle, w = 2 * std::numbers::pi * frequency;
  const double yield = block.gravity * std::tan(difference), kappa = std::cos(difference) / std::cos(block.friction_angle);
  if (!(yield > 0 && amplitude > yield)) throw std::domain_error("A must exceed k_y > 0");
  if (!(amplitude < block.gravity * std::tan(block.friction_angle + block.slope_angle))) throw std::domain_error("the block slips uphill too");
  const double t1 = std::asin(yield / amplitude) / w;
  // The velocity rises until the pull is back at k_y and falls from there: its zero lies between that and the next cycle's start.
  const auto velocity = [&](double t) { return amplitude / w * (std::cos(w * t1) - std::cos(w * t)) - yield * (t - t1); };
  double low = std::numbers::pi / w - t1, high = 2 * std::numbers::pi / w + t1;
  if (!(velocity(high) < 0)) throw std::domain_error("the slip of a cycle runs into the next");
  for (int i = 0; i < 200 && high - low > 0; ++i) {
    const double middle = low + (high - low) / 2;
    if (middle == low || middle == high) break;
    (velocity(middle) > 0 ? low : high) = middle;
  }
  const double span = low - t1;
  const double d = amplitude / w * (span * std::cos(w * t1) - (std::sin(w * low) - std::sin(w * t1)) / w) - yield * span * span / 2;
  return {yield, t1, low, kappa * d};
}

NewmarkMotion newmark_block(const BlockOnPlane& block, const GroundMotion& ground, const std::vector<double>& times, double relative_tolerance,
                            const GroundSpring& spring) {
  require_valid(block);
  if (times.empty()) return {};
  const GroundMotion whole = without_gaps(ground, times.back() + 1e-9);
  return Motion(block, whole, relative_tolerance, spring).follow(times);
}

}  // namespace openclose::analytical
