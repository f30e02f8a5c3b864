#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "openclose/law/joint_law.h"
#include "openclose/statics/increment_packs.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

/// A tower on the ground: more than one pack of contacts, one of them not full, and contacts with a fixed block.
Scene tower() {
  Scene scene = test::column_of_blocks(3);
  scene.joints[0].friction_angle = 30.0 * test::degree;
  scene.joints[0].cohesion = 2e4;
  scene.joints[0].tensile_strength = 1e4;
  return scene;
}

struct Plain {
  double normal, shear;
};

/// The law of balance.h for one contact, written with the joint law of one contact.
Plain plain(const FrozenContact& c, const FrozenContactState& state, const ContactStrength& strength, double opening, double slip) {
  const double trial = -c.normal_stiffness * (state.gap + opening);
  const double normal = std::max(trial, -strength.tension);
  const double shear = state.shear - c.shear_stiffness * slip, bound = strength.largest_shear(normal);
  return {normal, std::clamp(shear, -bound, bound)};
}

}  // namespace

TEST_CASE("packs of contacts carry what the joint law of one contact gives, to the last bit", "[statics]") {
  const Scene scene = tower();
  const FrozenSystem system(scene);
  REQUIRE(system.contacts().size() % batch_size != 0);
  const FrozenStrength strength(system, scene);
  FrozenState state(system);
  IncrementPacks packs(system);
  std::mt19937 random(20);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::array<int, 3> seen{};
  for (int round = 0; round < 50; ++round) {
    for (std::size_t i = 0; i < state.contacts.size(); ++i) {
      state.contacts[i].gap = number(random);
      state.contacts[i].shear = 0.3 * number(random);
      packs.start(i, state.contacts[i]);
      packs.set_strength(i, strength.of(i, {}));
    }
    Eigen::VectorXd motion = Eigen::VectorXd::NullaryExpr(3 * (system.rows() + 1), [&] { return number(random); });
    motion.tail<3>().setZero();
    Eigen::VectorXd force = Eigen::VectorXd::Zero(motion.size()), expected = force;
    packs.evaluate(motion.data(), ShearLaw::coulomb, force.data());
    for (std::size_t i = 0; i < state.contacts.size(); ++i) {
      const FrozenContact& c = system.contacts()[i];
      const auto of = [&](int row) { return row < 0 ? BlockVector(BlockVector::Zero()) : BlockVector(motion.segment<3>(3 * row)); };
      const auto along = [](const BlockVector& g, const BlockVector& d) { return g[0] * d[0] + g[1] * d[1] + g[2] * d[2]; };
      const double opening = (c.a < 0 ? 0.0 : along(c.normal_a, of(c.a))) + (c.b < 0 ? 0.0 : along(c.normal_b, of(c.b)));
      const double slip = (c.a < 0 ? 0.0 : along(c.shear_a, of(c.a))) + (c.b < 0 ? 0.0 : along(c.shear_b, of(c.b)));
      const Plain one = plain(c, state.contacts[i], strength.of(i, {}), opening, slip);
      const ContactResponse response = packs.response(i);
      CHECK(response.normal == one.normal);
      CHECK(response.shear == one.shear);
      ++seen[static_cast<std::size_t>(response.status())];
      if (c.a >= 0) expected.segment<3>(3 * c.a) += one.normal * c.normal_a + one.shear * c.shear_a;
      if (c.b >= 0) expected.segment<3>(3 * c.b) += one.normal * c.normal_b + one.shear * c.shear_b;
    }
    CHECK((force - expected).head(3 * system.rows()).cwiseAbs().maxCoeff() == 0.0);
  }
  // Each piece of the law was there.
  CHECK(std::ranges::all_of(seen, [](int count) { return count > 20; }));
}

TEST_CASE("derivatives of packs are difference quotients", "[statics]") {
  const Scene scene = tower();
  const FrozenSystem system(scene);
  const FrozenStrength strength(system, scene);
  IncrementPacks packs(system);
  std::mt19937 random(21);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(3 * (system.rows() + 1));
  Eigen::VectorXd unused = still;
  constexpr double small = 1e-6;
  int compared = 0;
  for (int round = 0; round < 50; ++round) {
    for (const ShearLaw law : {ShearLaw::coulomb, ShearLaw::fixed, ShearLaw::elastic}) {
      for (std::size_t i = 0; i < system.contacts().size(); ++i) {
        FrozenContactState state;
        state.gap = number(random);
        state.shear = 0.3 * number(random);
        packs.set_strength(i, strength.of(i, {}));
        packs.set_bound_of(i, std::max(0.0, -system.contacts()[i].normal_stiffness * state.gap));
        const auto carried = [&](double gap, double shear) {
          FrozenContactState moved = state;
          moved.gap += gap;
          moved.shear += shear;
          packs.start(i, moved);
          packs.evaluate(still.data(), law, unused.data());
          return packs.response(i);
        };
        const ContactResponse at = carried(0.0, 0.0);
        const double stiffness = system.contacts()[i].shear_stiffness;
        const ContactResponse opened = carried(small, 0.0), slipped = carried(0.0, -stiffness * small);
        // Both sides of a kink: nothing to compare.
        if (opened.status() != at.status() || slipped.status() != at.status() || std::abs(opened.normal_by_gap - at.normal_by_gap) > 0.0) continue;
        if (std::abs(opened.shear_by_gap - at.shear_by_gap) > 0.0) continue;
        // The law is linear in pieces: what is left is rounding over the difference.
        const double rounding = 1e-15 * 10.0 / small;
        CHECK(std::abs((opened.normal - at.normal) / small - at.normal_by_gap) < rounding);
        CHECK(std::abs((opened.shear - at.shear) / small - at.shear_by_gap) < rounding * 20.0);
        CHECK(std::abs((slipped.shear - at.shear) / small - at.shear_by_slip) < rounding);
        ++compared;
      }
    }
  }
  CHECK(compared > 300);
}

TEST_CASE("contacts that follow a motion in two steps are where one step brings them", "[statics]") {
  const Scene scene = tower();
  const FrozenSystem system(scene);
  const FrozenStrength strength(system, scene);
  IncrementPacks packs(system);
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * (system.rows() + 1));
  for (int b = 0; b < system.rows(); ++b) motion.segment<3>(3 * b) << 0.0, -0.5 * (b + 1), 0.0;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(motion.size()), whole = force;
  const auto begin = [&] {
    for (std::size_t i = 0; i < system.contacts().size(); ++i) {
      packs.set_strength(i, strength.of(i, {}));
      packs.start(i, {});
    }
  };
  begin();
  packs.evaluate(motion.data(), ShearLaw::coulomb, whole.data());
  motion *= 0.5;
  for (int step = 0; step < 2; ++step) {
    force.setZero();
    packs.follow(motion.data(), ShearLaw::coulomb, force.data());
  }
  // Everything only closes, so that the way does not matter; halves are exact.
  CHECK((force - whole).head(3 * system.rows()).cwiseAbs().maxCoeff() == 0.0);
  CHECK(packs.gap(0) != 0.0);
}
