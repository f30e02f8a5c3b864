// The explicit loop with its links four at a time against the same contacts one by one: the same to the last bit; and contacts that are gone.
#include <algorithm>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/central_difference.h"
#include "openclose/integrator/crossing_energy.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

/// A row of columns that are shaken, pulled apart and sheared: contacts open, close, stick, slide and lose their strength.
Scene shaken_columns() {
  Scene scene = test::column_of_blocks(7);
  for (int i = 1; i <= 7; ++i) {
    scene.blocks[i].velocity = {0.3 * (i % 3 - 1), i % 2 == 0 ? 0.2 : -0.1};
    scene.blocks[i].angular_velocity = 0.1 * (i % 5 - 2);
  }
  scene.joints[0].cohesion = 5e4;
  scene.joints[0].tensile_strength = 2e4;
  return scene;
}

bool same(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Contact& x, const Contact& y) {
    return x.gap == y.gap && x.status == y.status && x.joint_state == y.joint_state && x.elastic_slip == y.elastic_slip &&
           x.normal_force == y.normal_force && x.shear_force == y.shear_force && x.stored_energy == y.stored_energy;
  });
}

/// With the contacts that the step to come may close.
void load_anew(CentralDifference& loop, Simulation& simulation, const StepProblem& problem) {
  loop.store_blocks(simulation.change_system());
  loop.store_contacts(simulation.change_contacts());
  loop.store_far_gaps(simulation.system(), simulation.change_contacts());
  loop.load(problem);
}

/// What the loop does, contact by contact.
class OneByOne {
 public:
  /// \param approach  [m] up to which contacts are listed
  void load(const StepProblem& problem, double approach) {
    joints_ = &problem.joints;
    share_ = problem.method.step_fraction * problem.method.step_fraction;
    deepest = 0.0;
    links_.clear();
    blocks_.load(problem);
    blocks_.begin_forces();
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) add(problem, i, approach);
  }
  void step(double h, const Vec2& base) {
    const ExplicitMotion motion{h, h, base, 0.0, 0.0};
    blocks_.try_motion(motion);
    energies = EnergyLedger();
    blocks_.advance(motion, energies);
    blocks_.begin_forces();
    lost_strength = false;
    friction_ = damping_ = scheme_ = 0.0;
    for (Link& link : links_) follow(link);
    energies.friction += friction_;
    energies.contact_damping += damping_;
    energies.scheme += scheme_;
  }
  void store(std::vector<Contact>& contacts) const {
    for (const Link& link : links_) {
      Contact& c = contacts[link.place] = link.contact;
      const double closure = c.status == ContactStatus::open ? 0.0 : link.gap;
      c.gap = link.gap + c.rest_gap;
      c.stored_energy = 0.5 * (link.springs.normal * closure * closure + link.springs.shear * c.elastic_slip * c.elastic_slip) - c.crossing_energy;
    }
  }
  double unbalanced_force() const { return blocks_.unbalanced_force(0.0); }

  EnergyLedger energies;  ///< of the last step
  bool lost_strength = false;
  double deepest = 0.0;  ///< [m] since the load

 private:
  struct Link {
    double arm_x, arm_y, across_x, across_y, normal_x, normal_y, loaded_gap;  // as those of the loop
    std::size_t place;                                                        ///< in the list
    int vertex_slot, edge_slot;
    JointSprings springs;
    ContactDashpots dashpots;
    ContactStrength strength;
    bool damped, breakable;
    double gap, slip, viscous_shear;
    Contact contact;
  };

  void add(const StepProblem& problem, std::size_t place, double approach) {
    const BlockSystem& system = problem.system;
    const Contact& c = problem.contacts[place];
    const TabulatedJoint& joint = joints_->joint(c.joint);
    const ContactStrength strength(joint, c);
    const JointSprings springs(joint, c.length);
    const bool rests = c.status == ContactStatus::open && c.elastic_slip == 0.0 && c.normal_force == 0.0 && c.shear_force == 0.0;
    if (rests && !may_close(strength, springs.normal, c.gap, approach)) return;
    const Vec2 arm = system.arm(c.vertex), across = system.position(c.vertex_block, c.vertex) - system.centroid(c.edge_block);
    const Vec2 normal = -perpendicular((system.arm(system.next(c.edge)) - system.arm(c.edge)).normalized());
    const bool damped = joint.damping_ratio > 0.0;
    const ContactDashpots dashpots(joint, c.length, system.reduced_mass(c.vertex_block, c.edge_block));
    Link link{arm.x(),
              arm.y(),
              across.x(),
              across.y(),
              normal.x(),
              normal.y(),
              0.0,
              place,
              blocks_.slot(system, c.vertex_block),
              blocks_.slot(system, c.edge_block),
              springs,
              dashpots,
              strength,
              damped,
              can_lose_strength(joint, c.joint_state),
              c.stretch(),
              0.0,
              0.0,
              c};
    LinkPlace<double> at = place_of(link);
    link.loaded_gap = link.gap - at.gap;
    at.gap = link.gap;
    link.slip = at.slip;
    const CarriedForces f = carried(link, at, 0.0);
    Contact& now = link.contact;
    if (link.gap > strength.tension / springs.normal) now.status = ContactStatus::open;
    if (now.status == ContactStatus::open && f.elastic_normal != 0.0) now.status = ContactStatus::sticking;
    carry_on_with(link, f);
    if (now.status == ContactStatus::open && c.status == ContactStatus::open) {
      now.normal_force = c.normal_force;
      now.shear_force = c.shear_force;
    }
    push(link, at);
    links_.push_back(link);
  }

  void follow(Link& link) {
    const LinkPlace<double> at = place_of(link);
    Contact& c = link.contact;
    const double gap_change = at.gap - link.gap, slip = at.slip - link.slip, kn = link.springs.normal, ks = link.springs.shear;
    CarriedForces f = carried(link, at, slip);
    const bool was_open = c.status == ContactStatus::open, opens = f.status == ContactStatus::open;
    const double normal = was_open ? 0.0 : c.normal_force, shear = was_open ? 0.0 : c.shear_force, stretch = -f.elastic_shear * (1.0 / ks);
    const LinkEnergies<double> taken({kn, ks, was_open ? 0.0 : link.gap, was_open ? link.gap : 0.0, c.elastic_slip, normal, shear, link.viscous_shear,
                                      gap_change, slip, opens ? at.gap : 0.0, stretch, f.shear});
    const double owed = c.crossing_energy, kept_shear = f.shear - f.elastic_shear;
    if (was_open != opens || (was_open && (c.normal_force != 0.0 || c.shear_force != 0.0))) {
      c.crossing_energy = 0.0;
      if (link.strength.tension == 0.0 && was_open && !opens) c.crossing_energy = closing_energy(kn, link.gap, at.gap);
      if (link.strength.tension == 0.0 && !was_open && opens) {
        const double energy = owed + 0.5 * std::min(normal, -kn * link.gap) * at.gap;
        const Opening opening = settled(energy, kn, gap_change, ks, slip, c.elastic_slip, shear, share_);
        f.normal = opening.normal;
        f.shear = opening.shear;
        c.crossing_energy = opening.energy;
      }
    }
    friction_ += taken.rubbed;
    scheme_ += c.crossing_energy - owed;
    scheme_ += taken.scheme;
    scheme_ -= taken.not_yet;
    if (link.damped) damping_ += taken.damping;
    if (!opens) deepest = std::max(deepest, -at.gap - static_cast<float>(c.rest_gap));
    link.gap = at.gap;
    link.slip = at.slip;
    const double rubbed_over = slip + c.elastic_slip - stretch;
    c.elastic_slip = stretch;
    c.status = f.status;
    carry_on_with(link, f);
    link.viscous_shear = kept_shear;
    if (link.breakable) lose_strength(link, rubbed_over, at);
    push(link, at);
  }

  void lose_strength(Link& link, double slip, const LinkPlace<double>& at) {
    Contact& c = link.contact;
    const TabulatedJoint& joint = joints_->joint(c.joint);
    const JointState state = state_after(joint, c.joint_state, c.status, std::abs(slip));
    if (state == c.joint_state) return;
    lost_strength |= !state.bonded;
    c.joint_state = state;
    link.breakable = can_lose_strength(joint, state);
    link.strength = ContactStrength(joint, c);
    if (c.status == ContactStatus::open) return;
    carry_on_with(link, carried(link, at, 0.0));
    if (link.breakable || at.gap <= 0.0) return;
    c.status = ContactStatus::open;
    energies.redefinition += 0.5 * link.springs.normal * (at.gap * at.gap);
  }

  LinkPlace<double> place_of(const Link& link) const {
    return link_place<double>(blocks_.pose(link.vertex_slot), blocks_.pose(link.edge_slot), link);
  }
  CarriedForces carried(const Link& link, const LinkPlace<double>& at, double slip) const {
    const LinkRate<double> rate = link_rate<double>(blocks_.rate(link.vertex_slot), blocks_.rate(link.edge_slot), at.at);
    const double cn = link.damped ? link.dashpots.normal : 0.0, cs = link.damped ? link.dashpots.shear : 0.0;
    return carry(link.strength,
                 {-link.springs.normal * at.gap, -cn * rate.normal, -link.springs.shear * (link.contact.elastic_slip + slip), -cs * rate.shear});
  }
  static void carry_on_with(Link& link, const CarriedForces& f) {
    link.contact.normal_force = f.normal;
    link.contact.shear_force = f.shear;
    link.viscous_shear = f.shear - f.elastic_shear;
  }
  void push(const Link& link, const LinkPlace<double>& at) {
    const ContactPush<double> push(link.contact.normal_force, link.contact.shear_force, at.at);
    ExplicitRate &v = blocks_.forces()[link.vertex_slot], &e = blocks_.forces()[link.edge_slot];
    v = {v.x + push.x, v.y + push.y, v.turn + push.on_vertex, 0.0};
    e = {e.x - push.x, e.y - push.y, e.turn - push.on_edge, 0.0};
  }

  const JointTable* joints_ = nullptr;
  ExplicitBlocks blocks_;
  std::vector<Link> links_;
  double share_ = 0.0;
  double friction_ = 0.0, damping_ = 0.0, scheme_ = 0.0;  ///< [J] of the contacts in a step
};

}  // namespace

TEST_CASE("links four at a time do what each does", "[integrator][explicit]") {
  Scene scene = GENERATE(shaken_columns(), test::tumbling_blocks());
  scene.method.contact = "dem";
  scene.joints[0].damping_ratio = GENERATE(0.0, 0.2);
  scene.joints[0].cohesion_behaviour = GENERATE(CohesionBehaviour::ductile, CohesionBehaviour::lost_on_slip);
  if (scene.joints[0].weakens_by_slip()) scene.joints[0].slip_weakening_distance = GENERATE(0.0, 1e-4);
  Simulation simulation(scene);
  constexpr double h = 1e-4;  // [s]
  std::vector<Contact> by_fours = simulation.change_contacts();
  const StepProblem problem = simulation.problem(h, false);
  CentralDifference fours(tolerance::contact_skin_m);
  OneByOne ones;
  fours.load(problem);
  ones.load(problem, fours.approach());
  std::vector<Contact> one_by_one = by_fours;
  int changes = 0, lost = 0, wrong = 0, reloads = 0;
  const Vec2 base(0.3, 0.0);
  for (int step = 0; step < 2000; ++step) {
    const std::vector<Contact> before = one_by_one;
    const auto move = [&] { return fours.move(h, h, base, 1.0, 1.0, MassDamping::none, 0.0); };
    Move moved = move();
    if (moved == Move::past_list) {
      load_anew(fours, simulation, problem);
      ones.load(problem, fours.approach());
      ++reloads;
      moved = move();
    }
    REQUIRE(moved == Move::taken);
    fours.follow_contacts();
    ones.step(h, base);
    fours.store_contacts(by_fours);
    ones.store(one_by_one);
    wrong += !same(by_fours, one_by_one) || fours.unbalanced_force(0.0) != ones.unbalanced_force() || fours.lost_strength() != ones.lost_strength;
    const EnergyLedger a = fours.take_energies(), &b = ones.energies;
    wrong += a.friction != b.friction || a.contact_damping != b.contact_damping || a.scheme != b.scheme || a.redefinition != b.redefinition;
    for (std::size_t c = 0; c < before.size(); ++c) changes += before[c].status != one_by_one[c].status;
    lost += ones.lost_strength;
  }
  CHECK(wrong == 0);
  CHECK(reloads > 0);
  CHECK(fours.max_penetration() == ones.deepest);
  if (scene.blocks.size() < 5) return;
  CHECK(changes > 20);
  CHECK(lost > 0);
}

TEST_CASE("contacts that are gone push no more", "[integrator][explicit]") {
  Scene scene = test::column_of_blocks(1);
  scene.method.contact = "dem";
  Simulation simulation(scene);
  constexpr double h = 1e-4;  // [s]
  std::vector<Contact>& contacts = simulation.change_contacts();
  const StepProblem problem = simulation.problem(h, false);
  CentralDifference loop(tolerance::contact_skin_m);
  loop.load(problem);
  const double weight = loop.unbalanced_force(0.0);
  const auto move = [&] { return loop.move(h, h, Vec2::Zero(), 1.0, 1.0, MassDamping::none, 0.0); };
  for (int i = 0; i < 20; ++i) {
    Move moved = move();
    if (moved == Move::past_list) {
      load_anew(loop, simulation, problem);
      moved = move();
    }
    REQUIRE(moved == Move::taken);
    loop.follow_contacts();
  }
  REQUIRE(loop.unbalanced_force(0.0) < 0.99 * weight);

  const int listed = static_cast<int>(contacts.size());
  contacts.clear();
  loop.renew(problem, {{.pair = 0, .before = {0, listed}, .after = {0, 0}}});
  CHECK(loop.unbalanced_force(0.0) == Approx(weight));
  REQUIRE(move() == Move::taken);
  loop.follow_contacts();
  CHECK(loop.unbalanced_force(0.0) == Approx(weight));
}
