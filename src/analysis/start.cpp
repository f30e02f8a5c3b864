#include "openclose/analysis/start.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [rad] Edges whose directions differ by more have no common direction of sliding.
constexpr double same_direction_rad = 1e-6;
/// [-] Balance is reached when the unbalanced part is below this fraction of the weight: rounding of a hundred products.
constexpr double balance_fraction = 1e-14;
constexpr int most_iterations = 50;

/// Balance of one free block on fixed ones, in two unknowns: the displacement along the common normal and the rotation.
class Balance {
 public:
  using Unknowns = Motion::Unknowns;

  Balance(Simulation& simulation, int block, bool mobilised) : simulation_(simulation), block_(block), mobilised_(mobilised) {
    const auto& contacts = simulation.change_contacts();
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if (touches(contacts[c])) contacts_.push_back(c);
    }
    find_normal();
  }

  void solve() {
    const auto& system = simulation_.system();
    const StepProblem problem = simulation_.problem(simulation_.scene().step.dt, false);
    const double weight = std::max(simulation_.state().force_scale(), 1e-300);
    const double radius = system.block(block_).radius;
    Unknowns d = Unknowns::Zero();
    for (int i = 0; i < most_iterations; ++i) {
      evaluate(problem, d);
      const Eigen::Vector2d r(residual_.dot(normal_direction()), locked() ? 0.0 : residual_.dot(rotation_direction()));
      if (i > 0 && r.cwiseProduct(Eigen::Vector2d(1.0, 1.0 / radius)).norm() <= balance_fraction * weight) break;
      Eigen::Matrix2d k = stiffness_;
      if (locked()) k.row(1) = Eigen::RowVector2d(0.0, 1.0);
      const Eigen::Vector2d step = k.partialPivLu().solve(r);
      if (!step.allFinite()) fail("cannot be balanced on its contacts");
      d += step[0] * normal_direction() + step[1] * rotation_direction();
    }
    evaluate(problem, d);
    store(d);
  }

 private:
  bool locked() const { return simulation_.system().block(block_).rotation_locked; }
  Unknowns normal_direction() const { return Motion::gradient(Vec2::Zero(), normal_); }
  Unknowns rotation_direction() const { return Unknowns::Unit(Motion::rotation_index); }

  [[noreturn]] void fail(const std::string& what) const {
    const Scene& scene = simulation_.scene();
    const BlockInput& input = scene.blocks[block_];
    throw InputError(scene.place_of(input), "block", fmt::format("\"{}\" {}", input.name, what),
                     "for this method.start, blocks that rest on fixed blocks along one direction");
  }

  bool touches(const Contact& c) const {
    const bool ours = c.vertex_block == block_ || c.edge_block == block_;
    // The corners that carry the block lie on the edge but for the rounding of the drawing.
    return ours && c.gap <= tolerance::edge_end_m;
  }

  void find_normal() {
    const auto& system = simulation_.system();
    for (std::size_t i : contacts_) {
      const Contact& c = simulation_.contacts()[i];
      const int other = c.vertex_block == block_ ? c.edge_block : c.vertex_block;
      if (system.block(other).equation >= 0) fail("rests on a block that is not fixed");
      const Unknowns still = Unknowns::Zero();
      const Vec2 n = ContactKinematics(system, c, still, still).normal * (c.vertex_block == block_ ? 1.0 : -1.0);
      if (i != contacts_.front() && std::abs(cross(normal_, n)) > same_direction_rad) fail("rests on edges of different directions");
      normal_ = n;
    }
    if (contacts_.empty()) fail("rests on nothing");
    const Vec2 drive = Motion::translation(simulation_.external().force(system, block_, Unknowns::Zero()));
    drive_ = perpendicular(normal_) * perpendicular(normal_).dot(drive);
  }

  /// Contact forces, their sum with the external ones, and the stiffness in the two unknowns, after the block has moved by d.
  void evaluate(const StepProblem& problem, const Unknowns& d) {
    const auto& system = simulation_.system();
    residual_ = simulation_.external().force(system, block_, d);
    stiffness_.setZero();
    forces_.clear();
    for (std::size_t i : contacts_) {
      const Contact& c = simulation_.contacts()[i];
      const bool owns_vertex = c.vertex_block == block_;
      const Unknowns still = Unknowns::Zero();
      const ContactKinematics k(system, c, owns_vertex ? d : still, owns_vertex ? still : d);
      const ContactSprings springs = simulation_.enforcement().springs(problem, c);
      const ContactStrength strength(simulation_.joints().joint(c.joint), c);
      const double normal = std::max(0.0, -springs.normal * ((springs.gap - springs.target) + k.gap_change));
      const auto bound = strength.shear_bound(normal);
      const Unknowns& gn = owns_vertex ? k.normal_vertex : k.normal_edge;
      const Unknowns& gt = owns_vertex ? k.shear_vertex : k.shear_edge;
      const double against_drive = Motion::translation(gt).dot(drive_) > 0.0 ? -1.0 : 1.0;
      const double mobilised = mobilised_ ? against_drive : 0.0;
      residual_ += normal * gn + mobilised * bound.value * gt;
      const Unknowns force_by_normal = gn + mobilised * bound.slope * gt;
      const Eigen::Vector2d row(force_by_normal.dot(normal_direction()), force_by_normal.dot(rotation_direction()));
      stiffness_ += springs.normal * row * Eigen::RowVector2d(gn.dot(normal_direction()), gn.dot(rotation_direction()));
      forces_.push_back({normal, mobilised * bound.value, springs.shear});
    }
  }

  void store(const Unknowns& d) {
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      Contact& c = simulation_.change_contacts()[contacts_[k]];
      if (forces_[k].normal <= 0.0) continue;
      c.status = mobilised_ ? ContactStatus::sliding : ContactStatus::sticking;
      c.normal_force = forces_[k].normal;
      c.shear_force = forces_[k].shear;
      c.elastic_slip = -forces_[k].shear / forces_[k].shear_stiffness;
    }
    // Rigid contacts carry the same forces without any closure.
    if (simulation_.enforcement().has_elastic_contacts()) simulation_.change_system().advance(block_, d);
  }

  struct Forces {
    double normal, shear, shear_stiffness;
  };

  Simulation& simulation_;
  int block_;
  bool mobilised_;
  std::vector<std::size_t> contacts_;
  std::vector<Forces> forces_;
  Vec2 normal_ = Vec2::Zero(), drive_ = Vec2::Zero();
  Unknowns residual_ = Unknowns::Zero();
  Eigen::Matrix2d stiffness_ = Eigen::Matrix2d::Zero();
};

}  // namespace

void balance_normal_forces(Simulation& simulation, bool mobilised_friction) {
  const std::vector<int> free_blocks = simulation.system().free_blocks();
  for (int b : free_blocks) Balance(simulation, b, mobilised_friction).solve();
  simulation.positions_changed();
}

}  // namespace openclose
