#include <chipmunk/chipmunk.h>

#include <algorithm>
#include <cmath>

#include "engine.h"

namespace openclose::peers {
namespace {

constexpr double slop = 0.005;  // [m] overlap that is left alone: Box2D's; Chipmunk's own 0.1 is meant for pixels

cpVect vector(const Vec2& v) {
  return cpv(v.x(), v.y());
}

class Chipmunk : public Engine {
 public:
  Chipmunk(const std::vector<PeerBlock>& blocks, double friction, const Vec2& gravity) : space_(cpSpaceNew(), cpSpaceFree) {
    cpSpaceSetGravity(space_.get(), vector(gravity));
    cpSpaceSetCollisionSlop(space_.get(), slop);
    cpSpaceSetSleepTimeThreshold(space_.get(), static_cast<cpFloat>(INFINITY));
    for (const PeerBlock& block : blocks) {
      bodies_.emplace_back(block.fixed ? cpBodyNewStatic() : cpBodyNew(block.mass, block.inertia), cpBodyFree);
      cpBody* body = bodies_.back().get();
      cpBodySetPosition(body, vector(block.centroid));
      cpSpaceAddBody(space_.get(), body);
      for (const Polygon& piece : block.pieces) {
        std::vector<cpVect> vertices;
        for (const Vec2& v : piece) vertices.push_back(vector(v));
        shapes_.emplace_back(cpPolyShapeNew(body, static_cast<int>(vertices.size()), vertices.data(), cpTransformIdentity, 0.0), cpShapeFree);
        // The coefficient of a contact is the product of those of its shapes.
        cpShapeSetFriction(shapes_.back().get(), std::sqrt(friction));
        cpSpaceAddShape(space_.get(), shapes_.back().get());
      }
    }
  }
  ~Chipmunk() override {
    for (const auto& shape : shapes_) cpSpaceRemoveShape(space_.get(), shape.get());
    for (const auto& body : bodies_) cpSpaceRemoveBody(space_.get(), body.get());
  }

  void step(double dt) override { cpSpaceStep(space_.get(), dt); }
  Vec2 position(std::size_t block) const override {
    const cpVect p = cpBodyGetPosition(bodies_[block].get());
    return {p.x, p.y};
  }
  double deepest_penetration() const override {
    double deepest = 0.0;
    const auto look = [](cpBody*, cpArbiter* arbiter, void* found) {
      auto& most = *static_cast<double*>(found);
      for (int i = 0; i < cpArbiterGetCount(arbiter); ++i) most = std::max(most, -cpArbiterGetDepth(arbiter, i));
    };
    for (const auto& body : bodies_) cpBodyEachArbiter(body.get(), look, &deepest);
    return deepest;
  }
  std::string name() const override { return std::string("Chipmunk ") + cpVersionString; }
  std::string settings() const override { return "10 iterations, no sleep, overlap of 5 mm left alone, double precision"; }

 private:
  // In the order of their making: shapes and bodies go before the space.
  std::unique_ptr<cpSpace, void (*)(cpSpace*)> space_;
  std::vector<std::unique_ptr<cpBody, void (*)(cpBody*)>> bodies_;
  std::vector<std::unique_ptr<cpShape, void (*)(cpShape*)>> shapes_;
};

}  // namespace

std::unique_ptr<Engine> make_chipmunk(const std::vector<PeerBlock>& blocks, double friction, const Vec2& gravity) {
  return std::make_unique<Chipmunk>(blocks, friction, gravity);
}

}  // namespace openclose::peers
