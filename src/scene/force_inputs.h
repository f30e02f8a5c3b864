// Forces on blocks, beside gravity and the motion of the base, as the user wrote them. A kind of force is a struct with
//
//   static KeyTable table();                        its table, [[name]]
//   visit_keys(self, visitor)                       its rows: reader, writer, summary.json, docs/keys.md and the schema go through them
//   visit_points(self, f)                           its material points, f(Vec2&)
//   std::vector<Force> completed(table, blocks) const   with the block that its points find where the file names none, or the pieces of it that lie
//                                                   on several; throws InputError for what no single key shows
//   void change_unit_of_length(double)              what holds metres beside the points, for forces that keep their unit
//   static constexpr bool holds                     whether it can hold a block against gravity
//   void multiply(double)                           makes it so many times as large, unless it holds
//   std::vector<DrawnForce> drawn() const           arrows of drawings
//
// and a list of its own in ForceInputs. What it does to its block stands in model/force_elements.cpp.
#pragma once

#include <string>
#include <vector>

#include "openclose/core/vector.h"
#include "openclose/scene/key.h"

namespace openclose {

class Table;
struct BlockInput;

struct DrawnForce {
  Vec2 point = Vec2::Zero();      ///< [m]
  Vec2 force = Vec2::Zero();      ///< [N] in all
  bool turns_with_block = false;  ///< or keeps its direction
  Vec2 spread = Vec2::Zero();     ///< [m] along which it is spread evenly, with its middle at the point
};

inline constexpr int unnamed_block = -1;  ///< of a force whose block completed() is to find

/// A constant force at a material point of a block.
struct Load {
  int block = 0;
  Vec2 point = Vec2::Zero();  ///< [m]
  Vec2 force = Vec2::Zero();  ///< [N]
  std::string name{};

  static constexpr bool holds = false;
  static KeyTable table() { return {"load", Audience::user, "A constant force per metre of thickness on a point of a block", true}; }
  template <class Self, class Visitor>
  static void visit_keys(Self& self, Visitor& visit) {
    visit({"name", "for `--set` and `strength_reduction.increase`; loads and surcharges of one name increase together", "none"}, self.name,
          OwnName{});
    visit({"block", "name of a block", "that at the point"}, self.block, BlockName{});
    visit({.name = "point_m", .says = "in the block or on its boundary", .required = true}, self.point, any_number);
    visit({.name = "force_n", .says = "[x, y]", .required = true}, self.force, any_number);
  }
  template <class Self, class F>
  static void visit_points(Self& self, F f) {
    f(self.point);
  }
  std::vector<Load> completed(const Table& table, const std::vector<BlockInput>& blocks) const;
  void change_unit_of_length(double) {}
  void multiply(double factor) { force *= factor; }
  std::vector<DrawnForce> drawn() const { return {{point, force}}; }
};

/// A spring that holds one material point of a block at its initial place.
struct Support {
  int block = 0;
  Vec2 point = Vec2::Zero();      ///< [m]
  Vec2 stiffness = Vec2::Zero();  ///< [N/m] in x and y; 0 leaves that direction free
  std::string name{};

  static constexpr bool holds = true;
  static KeyTable table() {
    return {"support", Audience::user,
            "Springs that hold a point of a block where it was drawn: an anchor without prestress and without a strength limit", true};
  }
  template <class Self, class Visitor>
  static void visit_keys(Self& self, Visitor& visit) {
    visit({"name", "for `--set`", "none"}, self.name, OwnName{});
    visit({"block", "name of a block", "that at the point"}, self.block, BlockName{});
    visit({.name = "point_m", .says = "in the block or on its boundary", .required = true}, self.point, any_number);
    visit({.name = "stiffness_n_per_m", .says = "[kx, ky], not both 0", .required = true}, self.stiffness, not_negative);
  }
  template <class Self, class F>
  static void visit_points(Self& self, F f) {
    f(self.point);
  }
  std::vector<Support> completed(const Table& table, const std::vector<BlockInput>& blocks) const;
  /// Stiffnesses stay: displacements keep their unit.
  void change_unit_of_length(double) {}
  /// Drawn as springs, not as arrows.
  std::vector<DrawnForce> drawn() const { return {}; }
};

/// A traction on an edge of a block, or a part of one, that moves and turns with the block.
struct Surcharge {
  int block = 0;
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();  ///< [m] on one edge, in the order in which the outline runs counter-clockwise
  double pressure = 0.0;                        ///< [Pa] onto the block
  double shear = 0.0;                           ///< [Pa] in the direction in which the outline runs
  std::string name{};

  static constexpr bool holds = false;
  static KeyTable table() {
    return {"surcharge", Audience::user, "A traction on a straight stretch of the outlines of blocks; each part of it moves and turns with its block",
            true};
  }
  template <class Self, class Visitor>
  static void visit_keys(Self& self, Visitor& visit) {
    visit({"name", "for `--set` and `strength_reduction.increase`; loads and surcharges of one name increase together", "none"}, self.name,
          OwnName{});
    visit({"block", "name of a block", "those along whose edges it lies"}, self.block, BlockName{});
    visit({.name = "from_m", .says = "one end, on an edge of a block", .required = true}, self.from, any_number);
    visit({.name = "to_m",
           .says = "the other end, on the same edge or one in line with it; which of the two comes first does not matter",
           .required = true},
          self.to, any_number);
    visit({.name = "pressure_pa", .says = "normal to the edge, onto the block; a negative one pulls", .required = true}, self.pressure, any_number);
    visit({"shear_pa", "along the edge, positive counter-clockwise around the block"}, self.shear, any_number);
  }
  template <class Self, class F>
  static void visit_points(Self& self, F f) {
    f(self.from);
    f(self.to);
  }
  /// A stretch over several edges in one line becomes a surcharge of the same name on each of them.
  std::vector<Surcharge> completed(const Table& table, const std::vector<BlockInput>& blocks) const;
  void change_unit_of_length(double unit) { multiply(unit); }
  void multiply(double factor) { pressure *= factor, shear *= factor; }
  std::vector<DrawnForce> drawn() const { return {{0.5 * (from + to), resultant(to - from), true, to - from}}; }
  /// [N] The traction times the length.
  /// \param along  [m] from one end to the other, as the block lies now
  Vec2 resultant(const Vec2& along) const { return pressure * perpendicular(along) + shear * along; }
};

struct ForceInputs {
  std::vector<Load> loads;
  std::vector<Support> supports;
  std::vector<Surcharge> surcharges;

  /// f(list) for the list of every kind, in the order in which their forces are added up.
  template <class Self, class F>
  static void visit(Self& self, F f) {
    f(self.loads);
    f(self.supports);
    f(self.surcharges);
  }
};

/// f(force) for every force.
template <class Inputs, class F>
void for_each_force(Inputs& inputs, F f) {
  ForceInputs::visit(inputs, [&](auto& list) {
    for (auto& force : list) f(force);
  });
}

}  // namespace openclose
