#include <cmath>
#include <limits>
#include <random>

#include "openclose/contact/mean_pose.h"
#include "support/catch.h"
#include "support/contact_stiffness.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

using System = BlockSystem;
using End = ContactKinematics;
using Unknowns = End::Unknowns;
using Six = Eigen::Matrix<double, 6, 1>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Two free blocks, the first corner of the second one on the upper edge of the first, both turned anyhow.
class Pair {
 public:
  explicit Pair(unsigned seed) : generator_(seed), system_(scene()) {
    contact.vertex_block = 1;
    contact.vertex = 4;
    contact.edge_block = 0;
    contact.edge = 2;
    for (int b : {0, 1}) system_.advance(b, unknowns(1.0));
  }
  double number(double size) { return std::uniform_real_distribution<double>(-size, size)(generator_); }
  Unknowns unknowns(double size) { return {number(size), number(size), number(size)}; }
  const System& system() const { return system_; }
  Contact contact;

 private:
  static Scene scene() {
    Scene scene = test::empty_scene();
    scene.blocks = {test::free_block("a", test::rectangle(0.0, 0.0, 3.0, 1.0)), test::free_block("b", test::rectangle(1.0, 1.1, 2.0, 1.5))};
    return scene;
  }
  std::mt19937 generator_;
  System system_;
};

struct Poses {
  ContactPose end, mean;
};

Poses poses(const System& system, const Contact& contact, const Unknowns& dv, const Unknowns& de) {
  const ContactStart start(system, contact);
  const ContactPose end(start, BlockMove(dv, RotationKind::exact, 1.0), BlockMove(de, RotationKind::exact, 1.0));
  return {end, mean_pose(start, end)};
}

Six pushed(const End& k, double normal, double shear) {
  Six all;
  all << normal * k.normal_vertex + shear * k.shear_vertex, normal * k.normal_edge + shear * k.shear_edge;
  return all;
}

}  // namespace

TEST_CASE("mean pose: without motion those of the contact", "[contact][mean_pose]") {
  Pair pair(1);
  const End end(pair.system(), pair.contact, Unknowns::Zero(), Unknowns::Zero());
  const End mean(poses(pair.system(), pair.contact, Unknowns::Zero(), Unknowns::Zero()).mean);
  CHECK((mean.normal_vertex - end.normal_vertex).norm() <= 20.0 * epsilon);
  CHECK((mean.normal_edge - end.normal_edge).norm() <= 20.0 * epsilon);
  CHECK((mean.shear_vertex - end.shear_vertex).norm() <= 20.0 * epsilon);
  CHECK((mean.shear_edge - end.shear_edge).norm() <= 20.0 * epsilon);
}

TEST_CASE("mean pose: the impulse of a contact changes no angular momentum", "[contact][mean_pose]") {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Pair pair(seed);
    const Unknowns dv = pair.unknowns(0.5), de = pair.unknowns(0.5);
    const End mean(poses(pair.system(), pair.contact, dv, de).mean);
    const Six push = pushed(mean, pair.number(1.0), pair.number(1.0));
    CHECK((push.segment<2>(0) + push.segment<2>(3)).norm() == 0.0);
    // With v0 + v1 = 2 d/dt the centroids' momentum has its moment about the mean of the places before and after.
    const Vec2 vertex_centre = pair.system().centroid(1) + 0.5 * dv.head<2>(), edge_centre = pair.system().centroid(0) + 0.5 * de.head<2>();
    const double moment = cross(vertex_centre, push.segment<2>(0)) + push[2] + cross(edge_centre, push.segment<2>(3)) + push[5];
    CHECK(std::abs(moment) <= 200.0 * epsilon);
  }
}

TEST_CASE("mean pose: work is force times gap and slip, to third order in the rotations", "[contact][mean_pose]") {
  double worst_ratio = 0.0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Pair pair(seed);
    const Unknowns dv = pair.unknowns(0.1), de = pair.unknowns(0.1);
    const auto rest = [&](double scale) {
      const Poses p = poses(pair.system(), pair.contact, scale * dv, scale * de);
      const End end(pair.system(), pair.contact, scale * dv, scale * de), mean(p.mean);
      return std::abs(mean.normal_vertex.dot(scale * dv) + mean.normal_edge.dot(scale * de) - end.gap_change) +
             std::abs(mean.shear_vertex.dot(scale * dv) + mean.shear_edge.dot(scale * de) - end.slip_change);
    };
    // r theta^3/12 for levers of up to 6 m, in normal and tangent, and the chord of the normal.
    CHECK(rest(1.0) <= 6.0 * 1e-3);
    worst_ratio = std::max(worst_ratio, rest(0.1) / rest(1.0));
  }
  CHECK(worst_ratio < 2e-3);
  Pair pair(7);
  const Unknowns dv(0.3, -0.2, 0.0), de(-0.1, 0.4, 0.0);
  const End end(pair.system(), pair.contact, dv, de);
  const End mean(poses(pair.system(), pair.contact, dv, de).mean);
  CHECK(std::abs(mean.normal_vertex.dot(dv) + mean.normal_edge.dot(de) - end.gap_change) <= 10.0 * epsilon);
}

TEST_CASE("mean pose: derivatives are difference quotients", "[contact][mean_pose]") {
  constexpr double h = 6e-6, quotient_error = 20.0 * (h * h + 4.0 * epsilon / h);
  for (unsigned seed = 0; seed < 200; ++seed) {
    Pair pair(seed);
    const Unknowns dv = pair.unknowns(1.0), de = pair.unknowns(1.0);
    const double normal = pair.number(1.0), shear = pair.number(1.0);
    const auto push_at = [&](int k, double by) {
      Unknowns v = dv, e = de;
      (k < 3 ? v[k] : e[k - 3]) += by;
      return pushed(End(poses(pair.system(), pair.contact, v, e).mean), normal, shear);
    };
    const Poses p = poses(pair.system(), pair.contact, dv, de);
    test::ContactStiffness k{0.0, 0.0, 0.0, 0.0, p.mean.vertex_arm, p.mean.edge_arm, p.end.vertex_arm, p.end.edge_arm};
    k.turning = 0.5 * (normal * p.end.normal + shear * p.end.tangent());
    k.on_arms = 0.5 * (normal * p.mean.normal + shear * p.mean.tangent());
    Eigen::Matrix3d vertex_vertex = Eigen::Matrix3d::Zero(), vertex_edge = vertex_vertex, edge_vertex = vertex_vertex, edge_edge = vertex_vertex;
    k.add_to_vertex(vertex_vertex);
    k.add_to_vertex_edge(vertex_edge);
    k.add_to_edge_vertex(edge_vertex);
    k.add_to_edge(edge_edge);
    Eigen::Matrix<double, 6, 6> all;
    all << vertex_vertex, vertex_edge, edge_vertex, edge_edge;
    for (int u = 0; u < 6; ++u) {
      const Six quotient = (push_at(u, h) - push_at(u, -h)) / (2.0 * h);
      CHECK((all.col(u) + quotient).cwiseAbs().maxCoeff() <= quotient_error);
    }
  }
}
