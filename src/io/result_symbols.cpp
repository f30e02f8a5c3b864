#include "openclose/io/result_symbols.h"

#include <nlohmann/json.hpp>

#include "openclose/io/result_rows.h"
#include "openclose/scene/increased_load.h"

namespace openclose {
namespace {

using nlohmann::json;

Vec2 point_in(const json& list) {
  return {list.at(0).get<double>(), list.at(1).get<double>()};
}

/// Of a multiplier of gravity_x, -gravity_x, gravity_y or -gravity_y; the arrows of other loads stand where they act.
void add_push(const json& summary, Picture& picture) {
  const json& increase = summary.at("options").value("strength_reduction", json::object()).value("increase", json());
  if (!increase.is_string()) return;
  const std::string name = increase.get<std::string>();
  const bool is_back = name.starts_with('-');
  if (!names_gravity(name.substr(is_back ? 1 : 0))) return;
  const Vec2 direction = name.ends_with('x') ? Vec2::UnitX() : Vec2::UnitY();
  picture.push = {is_back ? Vec2(-direction) : direction, name + ", which grows"};
}

}  // namespace

void add_symbols(const ResultFolder& folder, const BlockIndex& blocks, const std::vector<Polygon>& now, Picture& picture) {
  const json& summary = folder.summary();
  const auto placement = [&](const json& entry) {
    const auto b = static_cast<std::size_t>(blocks.of(entry, folder.path_of("summary.json")));
    return Placement(folder.drawing().polygons[b], now[b]);
  };
  const auto carried = [&](const json& entry) { return placement(entry).of(point_in(entry.at("point_m"))); };
  for (const json& entry : summary.value("supports", json::array())) {
    const Vec2 stiffness = point_in(entry.at("stiffness_n_per_m"));
    picture.supports.push_back({carried(entry), stiffness.x() > 0.0, stiffness.y() > 0.0, carried(entry) - placement(entry).to});
  }
  for (const json& entry : summary.value("arrows", json::array())) {
    const bool turns = entry.at("turns_with_block").get<bool>();
    const auto turned = [&](const char* key) { return turns ? placement(entry).turned(point_in(entry.at(key))) : point_in(entry.at(key)); };
    picture.loads.push_back({carried(entry), turned("force_n"), turned("spread_m")});
  }
  add_push(summary, picture);
  for (const json& entry : summary.value("measured_points", json::array()))
    picture.points.push_back({entry.at("name").get<std::string>(), carried(entry)});
}

}  // namespace openclose
