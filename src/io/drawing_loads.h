// The arrows of loads in a drawing: one at a point, a row of them for what is spread along an edge.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "openclose/io/drawing.h"

namespace openclose {

/// In pixels, x to the right and y downwards.
struct DrawnLoad {
  std::vector<std::pair<Vec2, Vec2>> arrows;                      ///< from and to; several of a load that is spread
  Vec2 outer_end = Vec2::Zero(), other_outer_end = Vec2::Zero();  ///< of the first and the last arrow, away from the block
  double head = 0.0, width = 0.0;                                 ///< of each arrow
  std::string label;                                              ///< empty where another load has it
};

class LoadArrows {
 public:
  explicit LoadArrows(const std::vector<Picture::Arrow>& loads);

  /// [px] From where the load acts to the other end of its arrow, y upwards. Forces and tractions have scales of their own.
  Vec2 outwards(const Picture::Arrow& load) const;
  /// \param at            the place on the page of a point
  /// \param label_forces  whether forces at points have their sizes beside them. A traction stands once, at the longest stretch that has it
  std::vector<DrawnLoad> drawn(const std::function<Vec2(const Vec2&)>& at, bool label_forces) const;

 private:
  const std::vector<Picture::Arrow>& loads_;
  double largest_force_ = 0.0;     ///< [N]
  double largest_traction_ = 0.0;  ///< [Pa]
};

}  // namespace openclose
