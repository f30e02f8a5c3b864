// Rigid blocks and the interfaces between them, as limit analysis sees them: read from the file that `openclose cut` writes, the interfaces found
// here from the geometry alone. SI units, radians, unit thickness; rotation counter-clockwise.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace openclose::analytical {

using Point = Eigen::Vector2d;  // [m]

struct RigidBlock {
  std::string name;
  std::vector<Point> vertices;   // counter-clockwise
  std::vector<int> edge_joints;  // of the edge from each vertex to the next, numbers of joints or Interface::by_materials; empty: all the latter
  bool fixed = false;
  bool rotation_locked = false;
  int material = 0;
  double density = 0;                              // [kg/m3]
  double area = 0;                                 // [m2]
  Point centroid = Point::Zero();                  // [m]
  Eigen::Vector3d load = Eigen::Vector3d::Zero();  // weight and point loads: force x, y [N], moment about the centroid [N m]
};

/// Strength of an interface: |shear stress| <= cohesion + normal stress * friction, normal stress >= -tension.
struct InterfaceStrength {
  double friction = 0;  // tan(phi) [-]
  double cohesion = 0;  // [Pa]
  double tension = 0;   // [Pa]
};

/// Straight line along which two blocks face each other.
struct Interface {
  static constexpr int by_materials = -1;

  int a = 0, b = 0;           // blocks; at least one of them is free
  std::array<Point, 2> ends;  // [m]
  Point normal;               // unit vector from b into a: compression pushes a along it
  int joint = by_materials;   // number of the joint that both edges name
  InterfaceStrength strength;

  double length() const { return (ends[1] - ends[0]).norm(); }  // [m]
  Point tangent() const { return {normal.y(), -normal.x()}; }   // the normal turned clockwise; shear on a is positive along it
};

struct RigidBlockAssembly {
  std::vector<RigidBlock> blocks;
  std::vector<Interface> interfaces;
};

/// Edges of two blocks that lie this near to each other along their overlap are an interface, if the overlap is longer than this. [m] Far above the
/// rounding of coordinates that were computed or written (1e-9 m), far below any joint.
inline constexpr double touching_distance = 1e-6;

/// Reads gravity, materials, joints, blocks and point loads of a scene file without a domain, and finds the interfaces. Stiffnesses and the
/// options of analyses are not looked at.
/// \throws std::invalid_argument for a file that cannot be read or lacks something; for springs (supports), which are no rigid bodies
RigidBlockAssembly read_rigid_blocks(const std::string& path);

/// The same from the text of such a file; `name` stands for it in messages.
RigidBlockAssembly parse_rigid_blocks(const std::string& text, const std::string& name = "(text)");

/// Area, centroid and weight from the vertices; turns them counter-clockwise. Loads that were there are kept.
/// \throws std::invalid_argument for fewer than three vertices or no area
void complete_block(RigidBlock& block, const Point& gravity);

/// Every pair of edges of two blocks that face each other along more than a point, at least one of the blocks free; ordered by blocks. Without
/// strength.
std::vector<Interface> find_interfaces(const std::vector<RigidBlock>& blocks);

}  // namespace openclose::analytical
