// Rows of the tables of results, as drawings need them.
#pragma once

#include <string>
#include <vector>

#include "openclose/geometry/polygon.h"
#include "openclose/io/drawing.h"
#include "openclose/io/result_folder.h"
#include "openclose/io/state_table.h"

namespace openclose {

/// Of contacts.csv.
struct ContactRow {
  int a = 0, b = 0;
  Vec2 point = Vec2::Zero(), force = Vec2::Zero();  ///< force on a [N]
  double length = 0.0;                              ///< [m]
  JointDrawing state = JointDrawing::plain;
  bool used = false;  ///< by a joint that is drawn
};

/// Of cracks.csv.
struct CrackRow {
  int a = 0, b = 0;
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  double opening_from = 0.0, opening_to = 0.0, slip_from = 0.0, slip_to = 0.0;
  std::string joint;  ///< empty if it has no name
};

StateTable contact_table(const std::string& path);
std::vector<ContactRow> contact_rows(const StateTable& table, const std::string& state, const BlockIndex& blocks);
StateTable crack_table(const std::string& path);
std::vector<CrackRow> crack_rows(const std::string& path, const std::string& state, const BlockIndex& blocks);

/// [-] Of the size of the median block: an opening below is the rounding of places, six orders above that of a double.
inline constexpr double rounding_of_openings = 1e-9;

/// The mechanism of a factor of safety as blocks.csv has it.
inline constexpr const char* mechanism_state = "failed";
/// [-] Two contacts whose lengths add up to their distance to this accuracy are the ends of one face.
inline constexpr double accuracy_of_lengths = 0.1;

/// How a block has moved from one polygon to another, as a rigid body.
struct Placement {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();  ///< the mean of the vertices
  double sine = 0.0, cosine = 1.0;

  Placement(const Polygon& before, const Polygon& after);
  Vec2 turned(const Vec2& vector) const { return cosine * vector + sine * perpendicular(vector); }
  Vec2 of(const Vec2& point) const { return to + turned(point - from); }
};

}  // namespace openclose
