#include "openclose/model/force_elements.h"

namespace openclose {
namespace {

/// A constant force at a point: its lever turns with the block, its direction does not.
class PointLoad : public ForceElement {
 public:
  PointLoad(const Load& load, BlockSystem& system)
      : ForceElement(load.block, {system.follow_point(load.block, load.point)}, ForceAccount::loads), force_(load.force) {}

  Unknowns force(const ElementPath& path) const override { return Motion::gradient(path.points[0].end_arm, force_); }
  Matrix stiffness(const ElementPath& path) const override { return -Motion::hessian(path.points[0].end_arm, force_); }
  Unknowns mean_force(const ElementPath& path) const override {
    const PointPath& p = path.points[0];
    return Motion::gradient(p.arm + 0.5 * (p.moved - Motion::translation(path.d)), force_);
  }
  Matrix mean_stiffness(const ElementPath& path) const override {
    const PointPath& p = path.points[0];
    return -0.5 * Motion::hessian(p.arm + (p.moved - Motion::translation(path.d)), force_);
  }
  double magnitude(const ElementPath&) const override { return force_.norm(); }
  double energy_change(const ElementPath& path) const override { return -force_.dot(path.points[0].moved); }

 private:
  Vec2 force_;  ///< [N]
};

/// Springs between a point and where it was drawn.
class PointSupport : public ForceElement {
 public:
  PointSupport(const Support& support, BlockSystem& system)
      : ForceElement(support.block, {system.follow_point(support.block, support.point)}, ForceAccount::support_springs),
        stiffness_(support.stiffness),
        anchor_(system.point_position(points().front())) {}

  Unknowns force(const ElementPath& path) const override {
    const PointPath& p = path.points[0];
    return Motion::gradient(p.end_arm, -stiffness_.cwiseProduct((p.position - anchor_) + p.moved));
  }
  Matrix stiffness(const ElementPath& path) const override {
    const PointPath& p = path.points[0];
    const Vec2 stretch = (p.position - anchor_) + p.moved;
    const Unknowns gx = Motion::gradient(p.end_arm, {1.0, 0.0}), gy = Motion::gradient(p.end_arm, {0.0, 1.0});
    return stiffness_.x() * gx * gx.transpose() + stiffness_.y() * gy * gy.transpose() -
           Motion::hessian(p.end_arm, -stiffness_.cwiseProduct(stretch));
  }
  Unknowns mean_force(const ElementPath& path) const override {
    const PointPath& p = path.points[0];
    const Vec2 stretch = (p.position - anchor_) + 0.5 * p.moved, arm = p.arm + 0.5 * (p.moved - Motion::translation(path.d));
    return Motion::gradient(arm, -stiffness_.cwiseProduct(stretch));
  }
  Matrix mean_stiffness(const ElementPath& path) const override {
    const PointPath& p = path.points[0];
    const Vec2 stretch = (p.position - anchor_) + 0.5 * p.moved, turned = p.moved - Motion::translation(path.d);
    const Vec2 end_arm = p.arm + turned, arm = p.arm + 0.5 * turned;
    const Unknowns gx = Motion::gradient(end_arm, {1.0, 0.0}), gy = Motion::gradient(end_arm, {0.0, 1.0});
    Matrix total = 0.5 * stiffness_.x() * Motion::gradient(arm, {1.0, 0.0}) * gx.transpose();
    total += 0.5 * stiffness_.y() * Motion::gradient(arm, {0.0, 1.0}) * gy.transpose();
    total -= 0.5 * Motion::hessian(end_arm, -stiffness_.cwiseProduct(stretch));
    return total;
  }
  double magnitude(const ElementPath& path) const override {
    const PointPath& p = path.points[0];
    return stiffness_.cwiseProduct((p.position - anchor_) + p.moved).norm();
  }
  double spring_scale(const ElementPath& path) const override { return stiffness_.maxCoeff() * (anchor_.norm() + path.points[0].position.norm()); }
  double energy_change(const ElementPath& path) const override {
    const Vec2 before = path.points[0].position - anchor_, after = before + path.points[0].moved;
    return 0.5 * stiffness_.dot(after.cwiseAbs2() - before.cwiseAbs2());
  }
  double stored_energy(const ElementPath& path) const override { return 0.5 * stiffness_.dot((path.points[0].position - anchor_).cwiseAbs2()); }
  std::vector<Spring> springs(const ElementPath& path) const override {
    std::vector<Spring> list;
    for (int k = 0; k < 2; ++k) {
      if (stiffness_[k] > 0.0) list.push_back({Motion::gradient(path.points[0].arm, Vec2::Unit(k)), stiffness_[k]});
    }
    return list;
  }

 private:
  Vec2 stiffness_;  ///< [N/m] in x and y
  Vec2 anchor_;     ///< [m] where the springs are slack, relative to the system's origin
};

/// A traction along a part of an edge: its resultant acts in the middle and turns with the block, so that its moment stays as it is.
class EdgeTraction : public ForceElement {
 public:
  EdgeTraction(const Surcharge& surcharge, BlockSystem& system)
      : ForceElement(surcharge.block, {system.follow_point(surcharge.block, surcharge.from), system.follow_point(surcharge.block, surcharge.to)},
                     ForceAccount::loads),
        surcharge_(surcharge) {}

  Unknowns force(const ElementPath& path) const override { return at(path.points[0].end_arm, path.points[1].end_arm); }
  Matrix stiffness(const ElementPath& path) const override {
    Matrix k = Matrix::Zero();
    k.col(Motion::rotation_index).head<2>() = -perpendicular(Motion::translation(force(path)));
    return k;
  }
  Unknowns mean_force(const ElementPath& path) const override {
    return 0.5 * (at(path.points[0].arm, path.points[1].arm) + at(path.points[0].end_arm, path.points[1].end_arm));
  }
  Matrix mean_stiffness(const ElementPath& path) const override { return 0.5 * stiffness(path); }
  double magnitude(const ElementPath& path) const override { return Motion::translation(force(path)).norm(); }
  /// No potential: minus the work over the way.
  double energy_change(const ElementPath& path) const override { return -mean_force(path).dot(path.d); }

 private:
  Unknowns at(const Vec2& from, const Vec2& to) const { return Motion::gradient(0.5 * (from + to), surcharge_.resultant(to - from)); }

  Surcharge surcharge_;
};

std::unique_ptr<const ForceElement> element(const Load& load, BlockSystem& system) {
  return std::make_unique<PointLoad>(load, system);
}
std::unique_ptr<const ForceElement> element(const Support& support, BlockSystem& system) {
  return std::make_unique<PointSupport>(support, system);
}
std::unique_ptr<const ForceElement> element(const Surcharge& surcharge, BlockSystem& system) {
  return std::make_unique<EdgeTraction>(surcharge, system);
}

}  // namespace

ElementPath ForceElement::path(const BlockSystem& system, const Unknowns& d) const {
  ElementPath path;
  path.d = d;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    PointPath& p = path.points[i];
    p.position = system.point_position(points_[i]);
    p.arm = system.point_arm(points_[i]);
    p.moved = Motion::displacement(d, p.arm, system.rotation_kind());
    p.end_arm = p.arm + p.moved - Motion::translation(d);
  }
  return path;
}

std::vector<std::unique_ptr<const ForceElement>> force_elements(const ForceInputs& inputs, BlockSystem& system) {
  std::vector<std::unique_ptr<const ForceElement>> list;
  for_each_force(inputs, [&](const auto& input) { list.push_back(element(input, system)); });
  return list;
}

}  // namespace openclose
