// What the tests of this folder share: a scene, its system, and lists of contacts to look into.
#pragma once

#include <utility>
#include <vector>

#include "openclose/contact/detection.h"
#include "support/scenes.h"

namespace openclose::test {

/// A scene under detection. Vertices are numbered through all blocks; edge 2 of a rectangle is its top, run through from right to left.
class Detection {
 public:
  /// Unless asked for, all pairs are redone in every update: what is tested is the geometry.
  explicit Detection(const Scene& scene, double reach = 0.05, const DetectionSkips& skips = {true, false, true, 0.0})
      : system(scene), joints(scene), detector(reach, skips) {
    update();
  }
  Detection(const Detection&) = delete;
  Detection& operator=(const Detection&) = delete;

  const std::vector<Contact>& update() {
    detector.update(system, joints, set);
    return contacts;
  }
  void move(int block, double x, double y, double rotation = 0.0) { system.advance(block, {x, y, rotation}); }

  /// Null if there is none.
  Contact* find(int vertex, int edge) {
    for (Contact& c : contacts) {
      if (c.vertex == vertex && c.edge == edge) return &c;
    }
    return nullptr;
  }
  double length(int vertex, int edge) {
    const Contact* c = find(vertex, edge);
    return c == nullptr ? 0.0 : c->length;
  }
  double total_length() const {
    double total = 0.0;
    for (const Contact& c : contacts) total += c.length;
    return total;
  }

  BlockSystem system;
  JointTable joints;
  Detector detector;
  ContactSet set;
  std::vector<Contact>& contacts = set.moving;
};

}  // namespace openclose::test
