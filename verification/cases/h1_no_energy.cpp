// H1: no energy from nothing. Polygons thrown into a box, a needle and a wedge among them, and a diamond that is set on a corner: kinetic, gravity
// and stored energy together never rise above the start's, and contacts that are found anew release no energy.
#include <cmath>
#include <random>

#include "harness.h"
#include "openclose/core/tolerance.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double density = 2600.0;  // [kg/m3]

double square(double x) {
  return x * x;
}

/// A number in [0, 1), the same with every compiler.
double draw(std::mt19937& engine) {
  return static_cast<double>(engine()) / 4294967296.0;
}

/// A polygon with corners at random angles, on a circle or, to be concave, within it; every third one is a needle or a wedge.
std::vector<Vec2> random_polygon(std::mt19937& engine, int kind, double size) {
  const double turn = 2.0 * M_PI * draw(engine);
  std::vector<Vec2> corners;
  if (kind % 3 == 0) {
    const double half = 0.5 * size, thin = size * (0.05 + 0.1 * draw(engine));
    corners = kind % 2 == 0 ? std::vector<Vec2>{{-half, -thin}, {half, -thin}, {half, thin}, {-half, thin}}
                            : std::vector<Vec2>{{-half, 0.0}, {half, -2.0 * thin}, {half, 2.0 * thin}};
  } else {
    const int count = 4 + static_cast<int>(4.0 * draw(engine));
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * M_PI * (i + 0.6 * draw(engine)) / count, radius = 0.5 * size * (kind % 3 == 1 ? 1.0 : 0.5 + 0.5 * draw(engine));
      corners.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
    }
  }
  for (Vec2& p : corners) p = Motion::turned_by(turn, p, RotationKind::exact);
  return corners;
}

/// Blocks above each other in a box whose walls belong to its floor; they close by some per cent of their size when they meet. `dem` ends a run in
/// which a corner comes deeper than 0.4 of what lies behind an edge: at 1e10 Pa/m a block of a tonne at 10 m/s closes v sqrt(m/k), 3 mm, a tenth of
/// the thinnest needle.
Scene thrown_into_box(const Scheme& scheme, unsigned seed) {
  std::mt19937 engine(seed);
  Scene scene = empty_scene();
  scene.materials[0].density = density;
  scene.joints[0].normal_stiffness = scheme.contact == "dem" ? 1e10 : 2e7;
  scene.joints[0].shear_stiffness = 0.5 * scene.joints[0].normal_stiffness;
  scene.joints[0].friction_angle = std::atan(0.2 + 0.5 * draw(engine));
  set_scheme(scene, scheme);
  use_joint_springs_as_penalty(scene);
  scene.method.penetration_tolerance = 0.2;  // the springs' closure at the highest speed is below 0.1 m
  scene.blocks.push_back(
      fixed_block("box", {{-2.5, -1.0}, {2.5, -1.0}, {2.5, 20.0}, {2.0, 20.0}, {2.0, 0.0}, {-2.0, 0.0}, {-2.0, 20.0}, {-2.5, 20.0}}));
  for (int i = 0; i < 5; ++i) {
    std::vector<Vec2> corners = random_polygon(engine, i + static_cast<int>(seed), 0.7 + 0.3 * draw(engine));
    for (Vec2& p : corners) p += Vec2(i % 2 == 0 ? -0.7 : 0.7, 1.0 + 0.8 * i);
    scene.blocks.push_back(free_block("block " + std::to_string(i), std::move(corners)));
    scene.blocks.back().velocity = {8.0 * (draw(engine) - 0.5), 8.0 * (draw(engine) - 0.5)};
    scene.blocks.back().angular_velocity = 10.0 * (draw(engine) - 0.5);
  }
  scene.step = {1e-3, 0.1, 1e-6};
  scene.end_time = 2.0;
  return scene;
}

/// What a run has made of its energy, over the scale of its start.
struct Created {
  double rise = 0.0;      ///< [-] of kinetic, gravity and stored energy above the start's
  double released = 0.0;  ///< [-] by contacts that were found anew
};

/// \\param scale  [J]
Created created_energy(Simulation& simulation, const Scene& scene, double scale) {
  Created created;
  const double stored_at_start = simulation.ledger().contact_springs, released_at_start = simulation.ledger().redefinition;
  double released_before = released_at_start;
  for (int i = 0; i < std::lround(scene.end_time / scene.step.dt); ++i) {
    if (!simulation.advance(scene.step.dt)) return {not_measured(), not_measured()};
    const EnergyLedger& l = simulation.ledger();
    created.rise = larger(created.rise, (l.kinetic + l.gravity + l.contact_springs - stored_at_start) / scale);
    created.released += larger(0.0, released_before - l.redefinition) / scale;
    released_before = l.redefinition;
  }
  // Nothing has been shown by blocks that have not met.
  const bool has_fallen = simulation.ledger().gravity < -0.1 * scale;
  return has_fallen ? created : Created{not_measured(), not_measured()};
}

/// [J] Kinetic energy at the start, and that of falling to the floor.
double energy_at_start(const Simulation& simulation) {
  const BlockSystem& system = simulation.system();
  double sum = system.kinetic_energy();
  for (int b : system.free_blocks()) sum += system.block(b).mass[0] * 9.81 * system.centroid(b).y();
  return sum;
}

void box(Report& report, const Scheme& scheme) {
  Created worst;
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    const Scene scene = thrown_into_box(scheme, seed);
    Simulation simulation = report.simulate(scene);
    const Created created = created_energy(simulation, scene, energy_at_start(simulation));
    worst.rise = larger(worst.rise, created.rise);
    worst.released = larger(worst.released, created.released);
  }
  report.near(with_variant("polygons in a box: rise of energy over the start's", scheme), scheme.contact, 0.0, worst.rise, 0.01, "-",
              "there is no source; 1 % is what the program allows itself in any run");
  // `shi` adds up changes of gaps that are linear in the motion of a step; what it has left out is put right when the gap is measured anew.
  const bool linear = scheme.contact == "shi";
  report.near(with_variant("polygons in a box: released by contacts found anew", scheme), scheme.contact, 0.0, worst.released, linear ? 0.01 : 1e-9,
              "-",
              linear ? "gaps of a linear motion are measured anew, of second order in a step's rotation; 1 % as above"
                     : "springs keep their energy or lose it; rounding of the energies of 2000 steps, over the start's");
}

/// A diamond set on the tip of a wedge, corner on corner.
Scene corner_on_corner(const Scheme& scheme) {
  Scene scene = empty_scene();
  scene.materials[0].density = density;
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = 1e10;
  set_scheme(scene, scheme);
  scene.blocks = {fixed_block("base", {{-3.0, -1.0}, {5.0, -1.0}, {5.0, 0.0}, {-3.0, 0.0}}),
                  free_block("diamond", {{0.0, 2.0}, {0.5, 2.5}, {0.0, 3.0}, {-0.5, 2.5}}),
                  free_block("wedge", {{-0.5, 0.0}, {0.5, 0.0}, {0.0, 2.0}})};
  // A ninth of the period of the two on each other: of order 2, integrators that do not resolve a closing gain energy by it.
  scene.step = {2e-4, 0.1, 1e-6};
  scene.end_time = 2.0;
  return scene;
}

void diamond(Report& report, const Scheme& scheme) {
  const std::string quantity = with_variant("diamond on a tip: how far it rises", scheme);
  if (scheme.variant == "trapezoid") {
    report.leave_out(quantity, scheme.contact, "the trapezoid gains energy at every closing by itself: see the bounces of D2");
    return;
  }
  const Scene scene = corner_on_corner(scheme);
  Simulation simulation = report.simulate(scene);
  double highest = 0.0, lowest = 0.0;
  for (int i = 0; i < std::lround(scene.end_time / scene.step.dt); ++i) {
    const bool done = simulation.advance(scene.step.dt);
    const double height = done ? simulation.system().displacement(1)[1] : not_measured();
    highest = larger(highest, height);
    lowest = smaller(lowest, height);
    if (!done) break;
  }
  if (!(lowest < 0.0)) highest = not_measured();  // not even the closure of its own weight
  // Two contacts at right angles push out what they find penetrating.
  const bool pushes = scheme.contact == "hard";
  const double pushed = square(tolerance::hard_recovery_m_per_s) / 9.81;
  report.near(quantity, scheme.contact, 0.0, highest, pushes ? pushed : 1e-6, "m",
              pushes ? "pushed out by two contacts, each at tolerance::hard_recovery: v^2/g"
                     : "it starts at rest, and nothing lifts it; the order of its closure under its own weight");
}

void no_energy_from_nothing(Report& report) {
  for (const Scheme& scheme : schemes()) {
    box(report, scheme);
    diamond(report, scheme);
  }
}

const Registered<Case> registered{{"H1", "no energy from nothing", &no_energy_from_nothing, Reference::conservation}};

}  // namespace
}  // namespace openclose::verification
