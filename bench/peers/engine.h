// Another engine behind one interface: rigid blocks with friction, no cohesion, restitution 0, nothing asleep.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "convex_pieces.h"
#include "openclose/scene/scene.h"

namespace openclose::peers {

/// A block as an engine takes it: convex pieces that share one body.
struct PeerBlock {
  bool fixed = false;
  double density = 0.0;         ///< [kg/m3]
  Vec2 centroid;                ///< [m]
  double mass = 0.0;            ///< [kg], of a metre of thickness
  double inertia = 0.0;         ///< [kg m2] about the centroid
  std::vector<Polygon> pieces;  ///< [m] about the centroid
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual void step(double dt) = 0;
  virtual Vec2 position(std::size_t block) const = 0;  ///< [m] of the centroid
  /// [m] Deepest overlap of two blocks as the engine's own contacts tell it; >= 0.
  virtual double deepest_penetration() const = 0;
  virtual std::string name() const = 0;
  virtual std::string settings() const = 0;
};

/// \param friction  [-] coefficient of every contact  \param gravity [m/s2]
std::unique_ptr<Engine> make_box2d(const std::vector<PeerBlock>& blocks, double friction, const Vec2& gravity);
std::unique_ptr<Engine> make_chipmunk(const std::vector<PeerBlock>& blocks, double friction, const Vec2& gravity);

}  // namespace openclose::peers
