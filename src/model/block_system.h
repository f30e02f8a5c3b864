// The block system: geometry, mass and motion of all blocks. The only owner of their state.
//
// Blocks and vertices live in flat arrays; vertex v of a block is followed counter-clockwise by next(v), and edge v runs from vertex v to next(v).
// Coordinates are taken relative to origin(), the first vertex of the scene, so that a model far from zero loses no digits while it moves.
// Fixed blocks have no unknowns (negative equation), nor have blocks that are at rest for the time being: steps leave them where they are.
#pragma once

#include <vector>

#include "openclose/core/archive.h"
#include "openclose/core/memory.h"
#include "openclose/model/motion.h"
#include "openclose/scene/scene.h"

namespace openclose {

class BlockSystem {
 public:
  using Unknowns = Motion::Unknowns;

  static constexpr int fixed = -1;  ///< in place of an equation; blocks at rest have what lies below

  struct Block {
    int first_vertex = 0;
    int vertex_count = 0;
    int equation = fixed;  ///< block row of the unknowns, negative without any
    int material = 0;
    double area = 0.0;    ///< [m2]
    double radius = 0.0;  ///< [m] farthest vertex from the centroid
    bool rotation_locked = false;
    Unknowns mass = Unknowns::Zero();        ///< diagonal mass [kg, kg, kg m2]
    Vec2 reference_centroid = Vec2::Zero();  ///< [m] relative to origin()
  };

  /// Everything that changes in time; copied to save and restore a step.
  struct State {
    std::vector<Unknowns> displacement;  ///< accumulated since the reference configuration, per block
    std::vector<Unknowns> velocity;      ///< per block; zero for fixed blocks
    std::vector<Vec2> arm;               ///< [m] centroid to vertex, per vertex
    std::vector<Vec2> point_arm;         ///< [m] centroid to material point, per point

    void exchange(Archive& archive) {
      auto& [a, b, c, d] = *this;
      archive(a, b, c, d);
    }
    /// Whether all of its numbers are; those of a saved one may be anything.
    bool is_finite() const;
  };

  explicit BlockSystem(const Scene& scene);
  /// [m/s, m/s, rad/s] What the scene gives a block; zero for fixed ones.
  static Unknowns velocity_at_start(const BlockInput& input);

  const std::vector<Block>& blocks() const { return blocks_; }
  const Block& block(int b) const { return blocks_[b]; }
  int block_count() const { return static_cast<int>(blocks_.size()); }
  int free_count() const { return static_cast<int>(free_blocks_.size()); }
  const std::vector<int>& free_blocks() const { return free_blocks_; }        ///< those with unknowns, in the order of their equations
  const std::vector<int>& resting_blocks() const { return resting_blocks_; }  ///< neither fixed nor with unknowns
  bool is_at_rest(int b) const { return blocks_[b].equation < fixed; }
  int rest_number(int b) const { return fixed - 1 - blocks_[b].equation; }  ///< of a block at rest: its place among them
  const Vec2& origin() const { return origin_; }
  RotationKind rotation_kind() const { return rotation_kind_; }
  /// [m] The root of the median area of the blocks that are not fixed, be they at rest or not, so that single slivers or giants do not decide; 0 if
  /// there are none.
  double median_size() const;

  int next(int vertex) const { return next_[vertex]; }
  int previous(int vertex) const { return previous_[vertex]; }
  bool is_reflex(int vertex) const { return reflex_[vertex]; }  ///< interior angle above pi
  /// The joint that the scene names for an edge, or BlockInput::by_materials.
  int edge_joint(int edge) const { return edge_joints_.empty() ? BlockInput::by_materials : edge_joints_[edge]; }

  Vec2 centroid(int b) const { return blocks_[b].reference_centroid + Motion::translation(state_.displacement[b]); }
  const Vec2& arm(int vertex) const { return state_.arm[vertex]; }
  Vec2 position(int b, int vertex) const { return centroid(b) + state_.arm[vertex]; }  ///< [m] relative to origin()

  /// Follows the material point of block b that lies at `point` (scene coordinates, m) in the reference configuration; returns its number. To be
  /// called before the block has moved, if its rotation is linear.
  int follow_point(int b, const Vec2& point);
  int point_block(int point) const { return points_[point].block; }
  const Vec2& point_arm(int point) const { return state_.point_arm[point]; }
  Vec2 point_position(int point) const { return centroid(points_[point].block) + state_.point_arm[point]; }  ///< [m] relative to origin()

  const State& state() const { return state_; }
  std::size_t bytes() const {
    return bytes_of(blocks_, free_blocks_, resting_blocks_, next_, previous_, reflex_, edge_joints_, reference_arm_, points_, first_point_) +
           bytes_of(state_.displacement, state_.velocity, state_.arm, state_.point_arm);
  }
  void restore(const State& state) { state_ = state; }
  void exchange(Archive& archive);

  const Unknowns& displacement(int b) const { return state_.displacement[b]; }
  const Unknowns& velocity(int b) const { return state_.velocity[b]; }
  void set_velocity(int b, const Unknowns& v) { state_.velocity[b] = v; }
  void stop();  ///< all velocities to zero

  /// Takes the velocities and the unknowns of these blocks away.
  void put_to_rest(const std::vector<int>& blocks);
  /// Gives these blocks their unknowns back.
  void wake(const std::vector<int>& blocks);

  /// Moves block b by d.
  void advance(int b, const Unknowns& d);
  /// Moves block b to where it has this displacement; with exact rotation only.
  void move_to(int b, const Unknowns& displacement);

  double kinetic_energy() const;  ///< [J] per metre of thickness
  /// [kg] m_a m_b/(m_a + m_b), a fixed block counting as infinitely heavy; one of the two is not fixed.
  double reduced_mass(int a, int b) const;

 private:
  void name_joints(const Scene& scene);
  /// Equations in the order of the blocks; those of which is_free tells no get none.
  void number(const std::vector<char>& is_free);

  std::vector<Block> blocks_;
  std::vector<int> free_blocks_, resting_blocks_;
  std::vector<int> next_, previous_;
  std::vector<char> reflex_;
  std::vector<int> edge_joints_;  ///< empty where the scene names none
  struct Point {
    int block = 0;
    Vec2 reference_arm = Vec2::Zero();
    int next_of_block = -1;
  };

  std::vector<Vec2> reference_arm_;
  std::vector<Point> points_;
  std::vector<int> first_point_;  ///< per block, -1 without any
  Vec2 origin_ = Vec2::Zero();
  RotationKind rotation_kind_ = RotationKind::exact;
  State state_;
};

}  // namespace openclose
