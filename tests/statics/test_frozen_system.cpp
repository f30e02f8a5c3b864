#include <cmath>

#include "openclose/statics/frozen_system.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

Scene scaled(Scene scene, double size, const Vec2& shift) {
  for (BlockInput& block : scene.blocks) {
    for (Vec2& v : block.vertices) v = size * v + shift;
  }
  return scene;
}

}  // namespace

TEST_CASE("a frozen system has the scene's weights and contacts in numbers of the order of one", "[statics]") {
  const Scene scene = test::block_on_base();
  const FrozenSystem system(scene);
  REQUIRE(system.rows() == 1);
  CHECK(system.length_unit() == Approx(std::sqrt(2.0)));
  CHECK(system.force_unit() == Approx(test::block_weight));
  CHECK(system.blocks()[0].load.isApprox(Eigen::Vector3d(0.0, -1.0, 0.0)));
  REQUIRE(system.contacts().size() == 2);
  for (const FrozenContact& c : system.contacts()) {
    CHECK(c.normal_stiffness == Approx(1.0));
    CHECK(c.source.length == Approx(0.5 * test::block_edge));
  }
}

TEST_CASE("the same scene at another size and place is the same frozen system", "[statics]") {
  const Scene scene = test::block_on_incline(20.0 * test::degree);
  const FrozenSystem system(scene);
  for (const double size : {1e-3, 1.0, 1e3}) {
    const Vec2 shift(size == 1.0 ? 5e6 : 0.0, 0.0);
    const FrozenSystem other(scaled(scene, size, shift));
    REQUIRE(other.contacts().size() == system.contacts().size());
    // Coordinates of 5e6 m are known to 1e-9 m.
    for (std::size_t i = 0; i < system.contacts().size(); ++i) {
      CHECK((other.contacts()[i].normal_a - system.contacts()[i].normal_a).norm() < 1e-8);
      CHECK((other.contacts()[i].shear_b - system.contacts()[i].shear_b).norm() < 1e-8);
      CHECK(other.contacts()[i].normal_stiffness == Approx(system.contacts()[i].normal_stiffness).epsilon(1e-8));
    }
  }
}

TEST_CASE("joints drawn a little open are closed, unless something lies in them", "[statics]") {
  Scene scene = test::block_on_base();
  for (Vec2& v : scene.blocks[1].vertices) v.y() += 5e-4;
  CHECK(FrozenSystem(scene).contacts().size() == 2);
  for (Vec2& v : scene.blocks[1].vertices) v.y() += 5e-3;
  CHECK(FrozenSystem(scene).contacts().empty());
}
