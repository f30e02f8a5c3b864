#include <cmath>

#include "openclose/analysis/settle.h"
#include "openclose/core/parallel.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

Scene wall(int courses, int bricks, double shift = 0.5) {
  return test::scene_with(test::wall_with_moving_top(courses, bricks, shift));
}

/// Displacements after settling and 40 steps in which the top course slides to rest.
std::vector<double> displacements(Scene scene, LinearSolverKind kind, LinearCounters& counters) {
  scene.method.linear_solver = kind;
  Simulation simulation(scene);
  REQUIRE(settle(simulation).settled);
  simulation.restore_velocities();
  simulation.restart_clock();
  for (int i = 0; i < 40; ++i) REQUIRE(simulation.advance(2e-3));
  counters = simulation.enforcement().linear_counters();
  std::vector<double> list;
  for (int b : simulation.system().free_blocks()) {
    for (int k = 0; k < 3; ++k) list.push_back(simulation.system().displacement(b)[k]);
  }
  return list;
}

}  // namespace

TEST_CASE("the linear solver does not show in the answer", "[analysis][linear]") {
  for (const std::string contact : {"soft", "hard", "shi"}) {
    INFO(contact);
    Scene scene = wall(5, 6);
    scene.method.contact = contact;
    LinearCounters plain_counters, counters;
    const auto expected = displacements(scene, LinearSolverKind::plain, plain_counters);
    CHECK(plain_counters.incomplete == 0);
    double farthest = 0.0;
    for (double u : expected) farthest = std::max(farthest, std::abs(u));
    CHECK(farthest > 0.05);
    for (const LinearSolverKind kind : {LinearSolverKind::automatic, LinearSolverKind::direct, LinearSolverKind::iterative}) {
      INFO(static_cast<int>(kind));
      const auto u = displacements(scene, kind, counters);
      // Unbalanced forces of 1e-12 of the largest one, on springs of 1e9 N/m, and what friction makes of them in 80 ms.
      for (std::size_t i = 0; i < u.size(); ++i) REQUIRE(std::abs(u[i] - expected[i]) < 1e-9);
      CHECK((counters.incomplete > 0) == (kind == LinearSolverKind::iterative));
    }
  }
}

TEST_CASE("rows that a factor keeps and couplings that it leaves out do not show in the answer", "[analysis][linear]") {
  for (const std::string contact : {"soft", "hard", "shi"}) {
    for (const double shift : {0.5, 0.0}) {  // without, four bricks meet in a corner, and soft ones touch there
      INFO(contact << ", shift " << shift);
      Scene scene = wall(5, 6, shift);
      scene.method.contact = contact;
      LinearCounters whole, needed;
      scene.method.skip_factorisation = false;
      const auto expected = displacements(scene, LinearSolverKind::direct, whole);
      scene.method.skip_factorisation = true;
      const auto u = displacements(scene, LinearSolverKind::direct, needed);
      // As for other solvers.
      for (std::size_t i = 0; i < u.size(); ++i) REQUIRE(std::abs(u[i] - expected[i]) < 1e-9);
      CHECK(whole.rows_kept == 0);
      CHECK(whole.refinements == 0);
      CHECK(whole.rows > 0);
      CHECK(needed.rows_kept > 0);
      if (contact == "soft") CHECK((needed.refinements > 0) == (shift == 0.0));
    }
  }
}

TEST_CASE("several threads do what one does, bit for bit, also after a restart", "[analysis][linear][parallel]") {
  const auto state_of = [](Simulation& simulation) {
    Archive archive;
    archive(simulation);
    return archive.bytes();
  };
  const auto motion_of = [](const Simulation& simulation) {
    std::vector<double> list;
    for (int b : simulation.system().free_blocks()) {
      for (int k = 0; k < 3; ++k) list.push_back(simulation.system().displacement(b)[k]);
      for (int k = 0; k < 3; ++k) list.push_back(simulation.system().velocity(b)[k]);
    }
    return list;
  };
  for (const std::string contact : {"soft", "hard", "shi"}) {
    INFO(contact);
    Scene scene = wall(25, 42);
    scene.method.contact = contact;
    scene.method.linear_solver = LinearSolverKind::iterative;
    scene.step.dt = 2e-3;
    std::string first_state, last_state;
    std::vector<double> motion;
    for (int threads = 1; threads <= 3; ++threads) {
      INFO(threads << " threads");
      scene.method.threads = threads;
      const long multiplied = times_shared(SharedWork::product);
      Simulation simulation(scene);
      REQUIRE(simulation.advance(scene.step.dt));
      const std::string now = state_of(simulation);
      REQUIRE(simulation.advance(scene.step.dt));
      CHECK((times_shared(SharedWork::product) > multiplied) == (threads > 1));
      if (threads == 1) {
        first_state = now;
        last_state = state_of(simulation);
        motion = motion_of(simulation);
        CHECK(motion[motion.size() - 6] > 1e-3);
        continue;
      }
      const bool same = now == first_state && state_of(simulation) == last_state;
      CHECK(same);
    }
    // What one thread has begun three end.
    Simulation later(scene);
    Archive archive(first_state);
    archive(later);
    const auto shared = [] { return times_shared(SharedWork::product) + times_shared(SharedWork::factorisation); };
    const long before = shared();
    REQUIRE(later.advance(scene.step.dt));
    const bool same = motion_of(later) == motion;
    CHECK(same);
    CHECK(shared() > before);
  }
}
