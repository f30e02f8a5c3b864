#include "openclose/io/result_rows.h"

#include <cmath>

namespace openclose {
namespace {

JointDrawing status_in(std::string_view word) {
  if (word == "sliding") return JointDrawing::sliding;
  return word == "sticking" ? JointDrawing::sticking : JointDrawing::open;
}

}  // namespace

StateTable contact_table(const std::string& path) {
  return {path, {"block_a", "block_b", "x_m", "y_m", "normal_x", "normal_y", "normal_force_n", "shear_force_n", "status", "length_m"}};
}

std::vector<ContactRow> contact_rows(const StateTable& table, const std::string& state, const BlockIndex& blocks) {
  std::vector<ContactRow> contacts;
  table.rows(state, [&](const Row& row) {
    const Vec2 normal(row.number(4), row.number(5));
    contacts.push_back({blocks.of(row, 0),
                        blocks.of(row, 1),
                        {row.number(2), row.number(3)},
                        row.number(6) * normal + row.number(7) * perpendicular(normal),
                        row.number(9),
                        status_in(row[8])});
  });
  return contacts;
}

StateTable crack_table(const std::string& path) {
  return {path, {"block_a", "block_b", "x1_m", "y1_m", "x2_m", "y2_m", "opening1_m", "opening2_m", "slip1_m", "slip2_m", "joint"}};
}

std::vector<CrackRow> crack_rows(const std::string& path, const std::string& state, const BlockIndex& blocks) {
  const StateTable table = crack_table(path);
  std::vector<CrackRow> cracks;
  table.rows(state, [&](const Row& row) {
    cracks.push_back({blocks.of(row, 0),
                      blocks.of(row, 1),
                      {row.number(2), row.number(3)},
                      {row.number(4), row.number(5)},
                      row.number(6),
                      row.number(7),
                      row.number(8),
                      row.number(9),
                      std::string(row[10])});
  });
  return cracks;
}

Placement::Placement(const Polygon& before, const Polygon& after) {
  for (std::size_t i = 0; i < before.size(); ++i) from += before[i], to += after[i];
  from /= static_cast<double>(before.size());
  to /= static_cast<double>(before.size());
  double along = 0.0, across = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    along += (before[i] - from).dot(after[i] - to);
    across += cross(before[i] - from, after[i] - to);
  }
  const double length = std::hypot(along, across);
  if (length > 0.0) sine = across / length, cosine = along / length;
}

}  // namespace openclose
