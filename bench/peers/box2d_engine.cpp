#include <box2d/box2d.h>

#include <algorithm>

#include "engine.h"

namespace openclose::peers {
namespace {

constexpr int velocity_iterations = 8;
constexpr int position_iterations = 3;

float number(double x) {
  return static_cast<float>(x);
}
b2Vec2 vector(const Vec2& v) {
  return {number(v.x()), number(v.y())};
}

class Box2d : public Engine {
 public:
  Box2d(const std::vector<PeerBlock>& blocks, double friction, const Vec2& gravity) : world_(vector(gravity)) {
    world_.SetAllowSleeping(false);
    for (const PeerBlock& block : blocks) {
      b2BodyDef definition;
      definition.type = block.fixed ? b2_staticBody : b2_dynamicBody;
      definition.position = vector(block.centroid);
      definition.allowSleep = false;
      b2Body* body = world_.CreateBody(&definition);
      for (const Polygon& piece : block.pieces) {
        std::vector<b2Vec2> vertices;
        for (const Vec2& v : piece) vertices.push_back(vector(v));
        b2PolygonShape shape;
        shape.Set(vertices.data(), static_cast<int32>(vertices.size()));
        // Blocks that touch in the drawing shall touch: its skin of 1 cm would push all of them apart.
        shape.m_radius = 0.0F;
        b2FixtureDef fixture;
        fixture.shape = &shape;
        fixture.density = number(block.density);
        fixture.friction = number(friction);
        fixture.restitution = 0.0F;
        body->CreateFixture(&fixture);
      }
      bodies_.push_back(body);
    }
  }

  void step(double dt) override { world_.Step(number(dt), velocity_iterations, position_iterations); }
  Vec2 position(std::size_t block) const override {
    const b2Vec2& p = bodies_[block]->GetWorldCenter();
    return {p.x, p.y};
  }
  double deepest_penetration() const override {
    double deepest = 0.0;
    for (const b2Contact* c = world_.GetContactList(); c; c = c->GetNext()) {
      if (!c->IsTouching()) continue;
      b2WorldManifold manifold;
      c->GetWorldManifold(&manifold);
      for (int i = 0; i < c->GetManifold()->pointCount; ++i) deepest = std::max(deepest, -static_cast<double>(manifold.separations[i]));
    }
    return deepest;
  }
  std::string name() const override {
    return "Box2D " + std::to_string(b2_version.major) + "." + std::to_string(b2_version.minor) + "." + std::to_string(b2_version.revision);
  }
  std::string settings() const override { return "8 velocity and 3 position iterations, no sleep, polygons without skin, single precision"; }

 private:
  b2World world_;
  std::vector<b2Body*> bodies_;
};

}  // namespace

std::unique_ptr<Engine> make_box2d(const std::vector<PeerBlock>& blocks, double friction, const Vec2& gravity) {
  return std::make_unique<Box2d>(blocks, friction, gravity);
}

}  // namespace openclose::peers
