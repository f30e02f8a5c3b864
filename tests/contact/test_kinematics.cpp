#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "openclose/contact/kinematics.h"
#include "support/catch.h"
#include "support/contact_stiffness.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

using System = BlockSystem;
using Kinematics = ContactKinematics;
using Unknowns = Kinematics::Unknowns;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Lengths here are below 20 m, and so are all derivatives by turns: h^2/6 of the third derivative, epsilon/h of the value.
constexpr double h = 6e-6;
constexpr double quotient_error = 20.0 * (h * h + 4.0 * epsilon / h);

/// Two blocks of random shape and place, of which either, or none, is fixed.
class RandomPose {
 public:
  RandomPose(unsigned seed, RotationKind kind) : generator_(seed), scene_(test::empty_scene()) {
    scene_.method.rotation = kind;
    scene_.blocks = {test::free_block("a", polygon(3)), test::free_block("b", polygon(5))};
    const int fixed = std::uniform_int_distribution<int>(0, 2)(generator_);
    if (fixed < 2) scene_.blocks[fixed].fixed = true;
  }

  double number(double size) { return std::uniform_real_distribution<double>(-size, size)(generator_); }
  Unknowns unknowns(double size) { return {number(size), number(size), number(size)}; }

  System system() {
    System system(scene_);
    for (int b : system.free_blocks()) system.advance(b, unknowns(1.0));
    return system;
  }
  /// Zero for a fixed block.
  Unknowns step_of(const System& system, int b, double size) { return system.block(b).equation < 0 ? Unknowns::Zero().eval() : unknowns(size); }

  Contact contact() {
    Contact contact;
    const bool swapped = std::bernoulli_distribution(0.5)(generator_);
    contact.vertex_block = swapped ? 1 : 0;
    contact.edge_block = swapped ? 0 : 1;
    contact.vertex = swapped ? 3 + below(5) : below(3);
    contact.edge = swapped ? below(3) : 3 + below(5);
    return contact;
  }

 private:
  int below(int end) { return std::uniform_int_distribution<int>(0, end - 1)(generator_); }
  std::vector<Vec2> polygon(int corners) {
    std::vector<Vec2> polygon;
    const Vec2 centre(number(2.0), number(2.0));
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / corners;
      polygon.push_back(centre + (1.0 + number(0.3)) * Vec2(std::cos(angle), std::sin(angle)));
    }
    return polygon;
  }

  std::mt19937 generator_;
  Scene scene_;
};

struct GapAndSlip {
  double gap, slip;
  Vec2 normal, tangent, lever;
};

/// From the positions, without anything of the class under test.
GapAndSlip measured(const System& system, const Contact& contact) {
  const Vec2 p = system.position(contact.vertex_block, contact.vertex), e = system.position(contact.edge_block, contact.edge);
  const Vec2 t = (system.position(contact.edge_block, system.next(contact.edge)) - e).normalized();
  const Vec2 n(t.y(), -t.x());
  return {n.dot(p - e), t.dot(p - e), n, t, p - e};
}

GapAndSlip measured_after(System system, const Contact& contact, const Unknowns& d_vertex, const Unknowns& d_edge) {
  system.advance(contact.vertex_block, d_vertex);
  system.advance(contact.edge_block, d_edge);
  return measured(system, contact);
}

/// Gap and slip when unknown k of the six (vertex's block first) is changed by `by`.
GapAndSlip disturbed(const System& system, const Contact& contact, Unknowns d_vertex, Unknowns d_edge, int k, double by) {
  (k < 3 ? d_vertex[k] : d_edge[k - 3]) += by;
  return measured_after(system, contact, d_vertex, d_edge);
}

}  // namespace

TEST_CASE("gap and slip are those of a vertex above an edge", "[contact][kinematics]") {
  Scene scene = test::block_on_base();
  System system(scene);
  Contact contact;
  contact.vertex_block = 1;
  contact.vertex = 4;
  contact.edge_block = 0;
  contact.edge = 2;
  const Kinematics k(system, contact, {0.3, 0.1, 0.0}, Unknowns::Zero());
  CHECK((k.normal - Vec2(0.0, 1.0)).norm() <= 4.0 * epsilon);
  // The top of the base is run through to the left.
  CHECK((k.tangent - Vec2(-1.0, 0.0)).norm() <= 4.0 * epsilon);
  CHECK(k.gap_change == Approx(0.1).epsilon(4.0 * epsilon));
  CHECK(k.slip_change == Approx(-0.3).epsilon(4.0 * epsilon));
  CHECK((k.normal_vertex - Unknowns(0.0, 1.0, -1.0)).norm() <= 20.0 * epsilon);
  CHECK((k.shear_vertex - Unknowns(-1.0, 0.0, -0.5)).norm() <= 20.0 * epsilon);
}

TEST_CASE("changes of gap and slip are the differences of the measured ones", "[contact][kinematics]") {
  const RotationKind kind = GENERATE(RotationKind::exact, RotationKind::linear);
  const double size = GENERATE(0.7, 1e-3, 1e-8);
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomPose pose(seed, kind);
    const System system = pose.system();
    const Contact contact = pose.contact();
    const Unknowns d_vertex = pose.step_of(system, contact.vertex_block, size), d_edge = pose.step_of(system, contact.edge_block, size);
    const Kinematics k(system, contact, d_vertex, d_edge);
    const GapAndSlip before = measured(system, contact), after = measured_after(system, contact, d_vertex, d_edge);
    // The measured ones are differences of lengths of some 10 m.
    CHECK(std::abs(k.gap_change - (after.gap - before.gap)) <= 200.0 * epsilon);
    CHECK(std::abs(k.slip_change - (after.slip - before.slip)) <= 200.0 * epsilon);
    CHECK((k.normal - after.normal).norm() <= 20.0 * epsilon);
    CHECK((k.tangent - after.tangent).norm() <= 20.0 * epsilon);
  }
}

TEST_CASE("changes of gap and slip are free of cancellation", "[contact][kinematics]") {
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomPose pose(seed, RotationKind::exact);
    const System system = pose.system();
    const Contact contact = pose.contact();
    const Unknowns d_vertex = pose.step_of(system, contact.vertex_block, 1e-12), d_edge = pose.step_of(system, contact.edge_block, 1e-12);
    const Kinematics k(system, contact, d_vertex, d_edge), at_rest(system, contact, Unknowns::Zero(), Unknowns::Zero());
    CHECK(at_rest.gap_change == 0.0);
    CHECK(at_rest.slip_change == 0.0);
    // Steps of 1e-12: second-order terms are 1e-23, rounding of the first-order ones 1e-27; measured gaps would be off by 1e-15.
    CHECK(std::abs(k.gap_change - (at_rest.normal_vertex.dot(d_vertex) + at_rest.normal_edge.dot(d_edge))) <= 1e-22);
    CHECK(std::abs(k.slip_change - (at_rest.shear_vertex.dot(d_vertex) + at_rest.shear_edge.dot(d_edge))) <= 1e-22);
  }
}

TEST_CASE("gradients of gap and slip are difference quotients", "[contact][kinematics]") {
  const RotationKind kind = GENERATE(RotationKind::exact, RotationKind::linear);
  // Linear rotation is measured from the start of the step, where alone its derivative is that of a rotation.
  const double size = kind == RotationKind::exact ? 1.0 : 0.0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomPose pose(seed, kind);
    const System system = pose.system();
    const Contact contact = pose.contact();
    const Unknowns d_vertex = pose.step_of(system, contact.vertex_block, size), d_edge = pose.step_of(system, contact.edge_block, size);
    const Kinematics at(system, contact, d_vertex, d_edge);
    for (int k = 0; k < 6; ++k) {
      const GapAndSlip up = disturbed(system, contact, d_vertex, d_edge, k, h), down = disturbed(system, contact, d_vertex, d_edge, k, -h);
      CHECK(std::abs((k < 3 ? at.normal_vertex[k] : at.normal_edge[k - 3]) - (up.gap - down.gap) / (2.0 * h)) <= quotient_error);
      CHECK(std::abs((k < 3 ? at.shear_vertex[k] : at.shear_edge[k - 3]) - (up.slip - down.slip) / (2.0 * h)) <= quotient_error);
    }
  }
}

TEST_CASE("the hessian is the difference quotient of the gradients", "[contact][kinematics]") {
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomPose pose(seed, RotationKind::exact);
    const System system = pose.system();
    const Contact contact = pose.contact();
    const Unknowns d_vertex = pose.step_of(system, contact.vertex_block, 1.0), d_edge = pose.step_of(system, contact.edge_block, 1.0);
    const double normal = pose.number(1.0), shear = pose.number(1.0);
    const Kinematics at(system, contact, d_vertex, d_edge);
    const test::ContactHessian hessian(at, normal * at.normal + shear * at.tangent);
    Eigen::Matrix<double, 6, 6> full;
    full << hessian.vertex_vertex, hessian.vertex_edge, hessian.vertex_edge.transpose(), hessian.edge_edge;
    const auto gradient = [&](int k, double by) {
      Unknowns v = d_vertex, e = d_edge;
      (k < 3 ? v[k] : e[k - 3]) += by;
      const Kinematics moved(system, contact, v, e);
      Eigen::Matrix<double, 6, 1> g;
      g << normal * moved.normal_vertex + shear * moved.shear_vertex, normal * moved.normal_edge + shear * moved.shear_edge;
      return g;
    };
    for (int k = 0; k < 6; ++k) {
      const Eigen::Matrix<double, 6, 1> quotient = (gradient(k, h) - gradient(k, -h)) / (2.0 * h);
      CHECK((full.col(k) - quotient).cwiseAbs().maxCoeff() <= quotient_error);
    }
    CHECK(full.isApprox(full.transpose(), 1e-14));
  }
}

TEST_CASE("the two blocks get equal and opposite forces on one line", "[contact][kinematics]") {
  const RotationKind kind = GENERATE(RotationKind::exact, RotationKind::linear);
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomPose pose(seed, kind);
    const System system = pose.system();
    const Contact contact = pose.contact();
    const Unknowns d_vertex = pose.step_of(system, contact.vertex_block, 1.0), d_edge = pose.step_of(system, contact.edge_block, 1.0);
    const Kinematics k(system, contact, d_vertex, d_edge);
    const Vec2 centre_vertex = system.centroid(contact.vertex_block) + d_vertex.head<2>();
    const Vec2 centre_edge = system.centroid(contact.edge_block) + d_edge.head<2>();
    const auto check_balance = [&](const Unknowns& on_vertex, const Unknowns& on_edge) {
      CHECK((on_vertex + on_edge).head<2>().isZero(0.0));
      const double moment = on_vertex[2] + cross(centre_vertex, on_vertex.head<2>()) + on_edge[2] + cross(centre_edge, on_edge.head<2>());
      CHECK(std::abs(moment) <= 100.0 * epsilon);
    };
    check_balance(k.normal_vertex, k.normal_edge);
    check_balance(k.shear_vertex, k.shear_edge);
    CHECK(k.normal_vertex.head<2>() == k.normal);
    CHECK(k.shear_vertex.head<2>() == k.tangent);
    CHECK((centre_vertex + k.vertex_arm - (centre_edge + k.edge_arm)).norm() <= 50.0 * epsilon);
  }
}

TEST_CASE("the four blocks of a contact's stiffness are those of its gradients and its hessian", "[contact][kinematics]") {
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomPose pose(seed, RotationKind::exact);
    const System system = pose.system();
    const Contact contact = pose.contact();
    const Unknowns d_vertex = pose.step_of(system, contact.vertex_block, 1.0), d_edge = pose.step_of(system, contact.edge_block, 1.0);
    const Kinematics at(system, contact, d_vertex, d_edge);
    const double nn = pose.number(1.0), tn = pose.number(1.0), tt = pose.number(1.0);
    const Eigen::Matrix2d shift = (nn * at.normal + tn * at.tangent) * at.normal.transpose() + tt * at.tangent * at.tangent.transpose();
    const Vec2 turning(pose.number(1.0), pose.number(1.0));
    const test::ContactStiffness k{shift(0, 0), shift(0, 1),   shift(1, 0), shift(1, 1), at.vertex_arm,
                                   at.edge_arm, at.vertex_arm, at.edge_arm, turning,     turning};
    const auto block = [&](const Unknowns& n1, const Unknowns& t1, const Unknowns& n2, const Unknowns& t2) -> Eigen::Matrix3d {
      return (nn * n1 + tn * t1) * n2.transpose() + tt * t1 * t2.transpose();
    };
    const test::ContactHessian hessian(at, turning);
    const auto check = [&](auto add, const Eigen::Matrix3d& expected) {
      Eigen::Matrix3d sum = Eigen::Matrix3d::Ones();
      add(sum);
      // Sums of a dozen products of arms of up to 20 m.
      CHECK((sum - Eigen::Matrix3d::Ones() - expected).norm() <= 20.0 * 400.0 * epsilon);
    };
    const Unknowns &nv = at.normal_vertex, &ne = at.normal_edge, &tv = at.shear_vertex, &te = at.shear_edge;
    check([&](Eigen::Matrix3d& m) { k.add_to_vertex(m); }, block(nv, tv, nv, tv) - hessian.vertex_vertex);
    check([&](Eigen::Matrix3d& m) { k.add_to_edge(m); }, block(ne, te, ne, te) - hessian.edge_edge);
    check([&](Eigen::Matrix3d& m) { k.add_to_vertex_edge(m); }, block(nv, tv, ne, te) - hessian.vertex_edge);
    check([&](Eigen::Matrix3d& m) { k.add_to_edge_vertex(m); }, block(ne, te, nv, tv) - hessian.vertex_edge.transpose());
  }
}
