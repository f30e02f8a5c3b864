// Drawings of blocks as SVG: a scene, or a state of a result. What is to be drawn is data; how it looks is decided in one place.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "openclose/geometry/polygon.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// What a joint does, or a piece of it.
enum class JointDrawing { plain, sticking, sliding, open };

/// Everything in metres, newtons and seconds, x to the right and y upwards.
struct Picture {
  struct Block {
    std::string name;
    Polygon outline;
    int colour = 0;  ///< index into colour_names, where blocks have no value
    bool fixed = false;
    double value = 0.0;  ///< in the unit of the scale
  };
  /// Colours for a number, from 0 to the largest one.
  struct Scale {
    std::string quantity;  ///< with its unit
    double largest = 0.0;
  };
  /// An edge of a block for which the scene names a joint.
  struct Seam {
    Vec2 from = Vec2::Zero(), to = Vec2::Zero();
    int name = 0;  ///< index into seam_names
  };
  struct Joint {
    Vec2 from = Vec2::Zero(), to = Vec2::Zero();
    JointDrawing state = JointDrawing::plain;
    bool is_slight = false;  ///< open by so little beside others that a line as wide as theirs would mislead
  };
  /// The resultant between two blocks, drawn along its direction so far into either of them.
  struct Force {
    Vec2 from = Vec2::Zero(), to = Vec2::Zero();
    double size = 0.0;  ///< [N]
  };
  struct Crack {
    Vec2 from = Vec2::Zero(), to = Vec2::Zero();
    double opening = 0.0;  ///< [m]
  };
  /// A velocity of a point, or a load on it.
  struct Arrow {
    Vec2 point = Vec2::Zero(), vector = Vec2::Zero();
    Vec2 spread = Vec2::Zero();  ///< along which a load is spread evenly, with its middle at the point
  };
  struct Spring {
    Vec2 point = Vec2::Zero();
    bool in_x = false, in_y = false;
    Vec2 outwards = Vec2::Zero();  ///< from the middle of its block: a spring is drawn on this side, by default on the left and below
  };
  /// A part of gravity that grows until the blocks fail.
  struct Push {
    Vec2 direction = Vec2::Zero();
    std::string name;
  };
  struct Point {
    std::string name;
    Vec2 place = Vec2::Zero();
  };

  std::string title;
  std::vector<std::string> notes;  ///< lines below the title
  std::vector<Block> blocks;
  std::vector<std::string> colour_names;  ///< a colour each, for the legend
  std::optional<Scale> scale;
  std::vector<Seam> seams;
  std::vector<std::string> seam_names;  ///< a colour each, for the legend
  std::vector<Joint> joints;
  std::vector<Force> forces;
  std::vector<Crack> cracks;
  std::string crack_name;  ///< for the legend, before the width of the largest
  std::vector<Arrow> velocities;
  std::string velocity_name;  ///< for the legend
  std::vector<Arrow> loads;
  std::optional<Push> push;
  std::vector<Spring> supports;
  std::vector<Point> points;
};

/// An SVG document: one polygon a block with its name as its tooltip, or, of many blocks, one path a colour; fixed blocks dotted; what is drawn is
/// explained below, with a scale bar of a round length in metres and scales for what has a size. Widths of lines follow the size of the blocks.
std::string svg_drawing(const Picture& picture);

/// The blocks of a scene, a colour for each material and each joint that edges name, with supports, loads and measured points.
Picture picture_of(const Scene& scene);

/// "gravity is turned by 10 degrees to the right" or "there is no gravity"; empty where it points straight down. \param gravity  [m/s2]
std::string gravity_in_words(const Vec2& gravity);

/// Indices of the joints that edges of blocks name, in the order of the scene, in which drawings give them their colours.
std::vector<int> joints_of_edges(const Scene& scene);

}  // namespace openclose
