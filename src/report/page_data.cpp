#include "openclose/report/page_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_map>

#include "openclose/analysis/watch.h"
#include "openclose/core/error.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/polygon.h"
#include "openclose/io/drawing_colours.h"
#include "openclose/io/result_answer.h"
#include "openclose/io/result_folder.h"
#include "openclose/io/result_rows.h"
#include "openclose/io/state_table.h"
#include "openclose/report/page_tables.h"

namespace openclose {
namespace {

using nlohmann::json;

/// [-] Openings and slips below this part of the largest one are thinner than a line can be drawn.
constexpr double least_drawn_part = 0.005;

struct ContactRow {
  std::int32_t a = 0, b = 0;
  Vec2 point = Vec2::Zero(), normal = Vec2::Zero();
  double length = 0.0, gap = 0.0, normal_force = 0.0, shear_force = 0.0;
  std::uint8_t status = 0;
  double reach = 0.0;  ///< [m] so far along its face, counter-clockwise along the normal's perpendicular; 0: a point
};

std::uint8_t status_in(std::string_view word) {
  if (word == "sliding") return 2;
  return word == "sticking" ? 1 : 0;
}

class PageData {
 public:
  PageData(const std::string& folder, const ReportRequest& request, Report& report)
      : folder_(folder),
        request_(request),
        report_(report),
        block_index_(path_of("blocks.csv"), folder_.drawing().names),
        motions_(path_of("block_states.csv"), {"block", "displacement_x_m", "displacement_y_m", "rotation_rad", "velocity_x_m_per_s",
                                               "velocity_y_m_per_s", "angular_velocity_rad_per_s", "time_s"}),
        contacts_(path_of("contacts.csv"),
                  {"block_a", "block_b", "x_m", "y_m", "normal_x", "normal_y", "length_m", "gap_m", "normal_force_n", "shear_force_n", "status"}),
        cracks_(crack_table(path_of("cracks.csv"))) {}

  json data() {
    json page;
    page["folder"] = folder_.name();
    page["summary"] = summary();
    if (page["summary"].contains("failing_blocks")) page["summary"]["failing_blocks"].erase("names");
    report_.answer = answer_of(summary());
    page["answer"] = report_.answer;
    page["bounds"] = {{"created_energy", watch_bound::created_energy}, {"penetration", watch_bound::penetration}, {"reach", 1.0}};
    page["colours"] = colours();
    page["rounding_of_openings"] = rounding_of_openings;
    page["blocks"] = blocks();
    page["origin"] = {origin_.x(), origin_.y()};
    page["symbols"] = symbols();
    page["states"] = states();
    add_seams(page);
    page["states_left_out"] = report_.left_out;
    page["states_without_contacts"] = report_.without_contacts;
    add_tables(page);
    page["scene"] = scene_text(path_of("scene_as_read.toml"));
    folder_.require_whole_tables();
    return page;
  }

 private:
  std::string path_of(const std::string& name) const { return folder_.path_of(name); }
  const json& summary() const { return folder_.summary(); }
  bool is_factor() const { return folder_.is_factor(); }

  static json colours() {
    using namespace drawing_colour;
    return {{"fills", fills},        {"fixed", fixed_fill}, {"outline", outline_colour}, {"sliding", sliding_colour}, {"open", open_colour},
            {"force", force_colour}, {"load", load_colour}, {"support", support_colour}, {"gradient", gradient},      {"seams", seams}};
  }

  /// The blocks of the drawing; their index is what everything else names them by.
  json blocks() {
    const auto& [names, polygons] = folder_.drawing();
    Box box = Box::around(polygons.front());
    for (const Polygon& polygon : polygons) {
      const Box other = Box::around(polygon);
      box = {box.low.cwiseMin(other.low), box.high.cwiseMax(other.high)};
    }
    origin_ = 0.5 * (box.low + box.high);
    std::vector<std::int32_t> counts;
    std::vector<double> vertices, centroids;
    for (const Polygon& polygon : polygons) {
      counts.push_back(static_cast<std::int32_t>(polygon.size()));
      for (const Vec2& vertex : polygon) vertices.insert(vertices.end(), {vertex.x() - origin_.x(), vertex.y() - origin_.y()});
      const Vec2 centroid = polygon_properties(polygon).centroid - origin_;
      centroids.insert(centroids.end(), {centroid.x(), centroid.y()});
    }
    json blocks = {{"names", names},
                   {"counts_i4", packed<std::int32_t>(counts)},
                   {"vertices_f8", packed<double>(vertices)},
                   {"centroids_f8", packed<double>(centroids)}};
    add_properties(blocks);
    return blocks;
  }

  void add_properties(json& blocks) const {
    const std::size_t count = block_index_.size();
    std::vector<std::int32_t> material(count, 0);
    std::vector<std::uint8_t> fixed(count, 0);
    std::vector<double> area(count, 0.0), mass(count, 0.0);
    std::vector<std::string> materials = folder_.names_in("materials");
    const StateTable table(path_of("block_properties.csv"), {"block", "material", "fixed", "area_m2", "mass_kg"});
    table.all_rows([&](const Row& row) {
      const int b = block_index_.of(row, 0);
      const auto place = std::ranges::find(materials, row[1]);
      material[b] = static_cast<std::int32_t>(place - materials.begin());
      if (place == materials.end()) materials.emplace_back(row[1]);
      fixed[b] = row[2] == "1";
      area[b] = row.number(3);
      mass[b] = row.number(4);
    });
    blocks["materials"] = materials;
    blocks["material_i4"] = packed<std::int32_t>(material);
    blocks["fixed_u1"] = packed<std::uint8_t>(fixed);
    blocks["area_f8"] = packed<double>(area);
    blocks["mass_f8"] = packed<double>(mass);
  }

  /// What holds, pushes and measures blocks, at points of the drawing.
  json symbols() const {
    json list = json::array();
    const auto add = [&](const char* kind, const json& entry, json more) {
      more["kind"] = kind;
      more["block"] = block_index_.of(entry, path_of("summary.json"));
      const json& point = entry.at("point_m");
      more["point"] = {point.at(0).get<double>() - origin_.x(), point.at(1).get<double>() - origin_.y()};
      list.push_back(std::move(more));
    };
    for (const json& entry : summary().value("supports", json::array())) {
      const json& stiffness = entry.at("stiffness_n_per_m");
      const auto block = static_cast<std::size_t>(block_index_.of(entry, path_of("summary.json")));
      const Vec2 middle = polygon_properties(folder_.drawing().polygons[block]).centroid;
      const json& point = entry.at("point_m");
      add("support", entry,
          {{"in_x", stiffness.at(0).get<double>() > 0.0},
           {"in_y", stiffness.at(1).get<double>() > 0.0},
           {"on_the_right", point.at(0).get<double>() > middle.x()},
           {"on_top", point.at(1).get<double>() > middle.y()}});
    }
    for (const json& entry : summary().value("arrows", json::array()))
      add("load", entry, {{"force", entry.at("force_n")}, {"turns", entry.at("turns_with_block")}, {"spread", entry.at("spread_m")}});
    for (const json& entry : summary().value("measured_points", json::array())) add("point", entry, {{"name", entry.at("name")}});
    return list;
  }

  /// Names of the states in their order, without those at the time of the one before.
  std::vector<std::string> different_states() const {
    std::vector<std::string> names;
    std::optional<double> last;
    for (const std::string& state : folder_.states()) {
      const std::optional<double> time = time_of(state);
      if (time && time == last) continue;
      last = time;
      names.push_back(state);
    }
    return names;
  }

  std::optional<double> time_of(const std::string& state) const {
    std::optional<double> time;
    motions_.first_row(state, [&](const Row& row) {
      if (!row[7].empty()) time = row.number(7);
    });
    return time;
  }

  /// Where all would take too much, motions may have half of the page, so that a film stays one, and contacts with joints what they leave.
  json states() {
    const std::vector<std::string> names = different_states();
    const std::size_t last = names.size() - 1;
    const std::size_t motion = size_of(motion_of(names[last])), contacts = size_of(contacts_of(names[last]));
    const std::size_t every = stride(motion * names.size(), request_.most_bytes / 2);
    const std::size_t shown = names.size() / every;
    const std::size_t left = request_.most_bytes - std::min(request_.most_bytes, motion * shown);
    const std::size_t every_contacts = stride(contacts * shown, left);
    json list = json::array();
    std::size_t with_contacts = 0;
    // The drawing, the start and the end are always there.
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (i > 0 && i < last && (i - 1) % every != 0) continue;
      json& state = list.emplace_back(motion_of(names[i]));
      if (i > 0 && i < last && ((i - 1) / every) % every_contacts != 0) continue;
      state.update(contacts_of(names[i]));
      ++with_contacts;
    }
    report_.states = list.size();
    report_.left_out = names.size() - list.size();
    report_.without_contacts = list.size() - with_contacts;
    return list;
  }

  /// One in how many is kept so that all of this size become at most that.
  static std::size_t stride(std::size_t all, std::size_t most) {
    const std::size_t least = std::max<std::size_t>(1, most);
    return std::max<std::size_t>(1, (all + least - 1) / least);
  }

  /// [bytes] As JSON, without the little that is not packed.
  static std::size_t size_of(const json& value) {
    if (value.is_string()) return value.get_ref<const std::string&>().size();
    std::size_t size = 0;
    if (value.is_structured()) {
      for (const json& part : value) size += size_of(part);
    }
    return size;
  }

  json motion_of(const std::string& name) const {
    json state = {{"name", name}};
    const std::optional<double> time = time_of(name);
    if (time) state["time_s"] = *time;
    add_motion(name, state);
    if (is_factor() && name == mechanism_state) add_mechanism(state);
    return state;
  }

  json contacts_of(const std::string& name) const {
    json state = json::object();
    add_contacts(name, state);
    add_cracks(name, state);
    return state;
  }

  void add_motion(const std::string& name, json& state) const {
    std::vector<float> motion(3 * block_index_.size(), 0.0f), velocity(3 * block_index_.size(), 0.0f);
    bool moves = false;
    std::size_t rows = 0;
    motions_.rows(name, [&](const Row& row) {
      const int b = block_index_.of(row, 0);
      for (std::size_t k = 0; k < 3; ++k) {
        motion[3 * b + k] = static_cast<float>(row.number(1 + k));
        velocity[3 * b + k] = static_cast<float>(row.number_or_zero(4 + k));
      }
      moves = moves || !row[4].empty();
      ++rows;
    });
    if (motions_.has(name)) {
      if (rows != block_index_.size())
        throw InputError({motions_.path(), 0}, "", fmt::format("the state \"{}\" has {} blocks", name, rows),
                         fmt::format("the {} blocks of blocks.csv", block_index_.size()));
      state["motion_f4"] = packed<float>(motion);
      state["largest_displacement"] = largest_vector(motion);
    }
    if (moves) {
      state["velocity_f4"] = packed<float>(velocity);
      state["largest_velocity"] = largest_vector(velocity);
    }
  }

  static double largest_vector(const std::vector<float>& triples) {
    double largest = 0.0;
    for (std::size_t i = 0; i + 2 < triples.size(); i += 3)
      largest = std::max(largest, std::hypot(static_cast<double>(triples[i]), static_cast<double>(triples[i + 1])));
    return largest;
  }

  void add_contacts(const std::string& name, json& state) const {
    std::vector<ContactRow> rows;
    contacts_.rows(name, [&](const Row& row) {
      rows.push_back({block_index_.of(row, 0),
                      block_index_.of(row, 1),
                      {row.number(2), row.number(3)},
                      {row.number(4), row.number(5)},
                      row.number(6),
                      row.number(7),
                      row.number(8),
                      row.number(9),
                      status_in(row[10])});
    });
    if (rows.empty()) return;
    find_faces(rows);
    std::vector<std::int32_t> blocks;
    std::vector<float> numbers;
    std::vector<std::uint8_t> status;
    double largest = 0.0;
    for (const ContactRow& c : rows) {
      blocks.insert(blocks.end(), {c.a, c.b});
      const Vec2 point = c.point - origin_;
      for (const double number : {point.x(), point.y(), c.normal.x(), c.normal.y(), c.length, c.gap, c.normal_force, c.shear_force, c.reach})
        numbers.push_back(static_cast<float>(number));
      status.push_back(c.status);
      largest = std::max(largest, std::hypot(c.normal_force, c.shear_force));
    }
    state["contacts"] = {{"blocks_i4", packed<std::int32_t>(blocks)},
                         {"numbers_f4", packed<float>(numbers)},
                         {"status_u1", packed<std::uint8_t>(status)},
                         {"largest_force", largest}};
  }

  /// Two contacts at the ends of the stretch along which two edges face each other have a part of it each.
  static void find_faces(std::vector<ContactRow>& rows) {
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> of_pair;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto [low, high] = std::minmax(rows[i].a, rows[i].b);
      of_pair[(static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high)].push_back(i);
    }
    for (const auto& [pair, list] : of_pair) {
      for (const std::size_t i : list) {
        for (const std::size_t k : list) {
          const Vec2 way = rows[k].point - rows[i].point;
          const double length = rows[i].length + rows[k].length;
          if (i == k || std::abs(way.norm() - length) > accuracy_of_lengths * length) continue;
          rows[i].reach = std::copysign(rows[i].length, way.dot(perpendicular(rows[i].normal)));
        }
      }
    }
  }

  void add_cracks(const std::string& name, json& state) const {
    std::vector<std::vector<double>> rows;
    std::vector<std::int32_t> blocks;
    double largest = 0.0, largest_opening = 0.0;
    cracks_.rows(name, [&](const Row& row) {
      std::vector<double> numbers;
      for (std::size_t k = 2; k < 10; ++k) numbers.push_back(row.number(k));
      largest_opening = std::max({largest_opening, numbers[4], numbers[5]});
      largest = std::max({largest, largest_opening, std::abs(numbers[6]), std::abs(numbers[7])});
      rows.push_back(std::move(numbers));
      blocks.insert(blocks.end(), {block_index_.of(row, 0), block_index_.of(row, 1)});
    });
    std::vector<std::int32_t> kept_blocks;
    std::vector<float> kept;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::vector<double>& r = rows[i];
      const double size = std::max({r[4], r[5], std::abs(r[6]), std::abs(r[7])});
      if (size <= least_drawn_part * largest) continue;
      kept_blocks.insert(kept_blocks.end(), {blocks[2 * i], blocks[2 * i + 1]});
      for (std::size_t k = 0; k < r.size(); ++k) kept.push_back(static_cast<float>(k < 4 ? r[k] - origin_[k % 2] : r[k]));
    }
    if (!kept.empty())
      state["cracks"] = {{"blocks_i4", packed<std::int32_t>(kept_blocks)}, {"numbers_f4", packed<float>(kept)}, {"largest_opening", largest_opening}};
  }

  /// The joints with a name, where there are others: lines of the drawing that move with the first of their blocks, from the first state that has
  /// any.
  void add_seams(json& page) const {
    if (cracks_.states().empty()) return;
    const std::string& state = cracks_.states().front();
    const std::vector<Polygon>& drawn = folder_.drawing().polygons;
    const std::vector<Polygon> now = folder_.outlines(state);
    const std::vector<std::string> names = folder_.names_in("joints");
    std::vector<std::int32_t> blocks, joints;
    std::vector<float> ends;
    bool has_others = false;
    cracks_.rows(state, [&](const Row& row) {
      const auto name = std::ranges::find(names, row[10]);
      has_others = has_others || name == names.end();
      if (name == names.end()) return;
      const int b = block_index_.of(row, 0);
      const Placement back(now[b], drawn[b]);
      blocks.push_back(b);
      joints.push_back(static_cast<std::int32_t>(name - names.begin()));
      for (const std::size_t k : {2, 4}) {
        const Vec2 end = back.of({row.number(k), row.number(k + 1)}) - origin_;
        ends.insert(ends.end(), {static_cast<float>(end.x()), static_cast<float>(end.y())});
      }
    });
    const bool can_be_told_apart = has_others || std::ranges::adjacent_find(joints, std::not_equal_to()) != joints.end();
    if (!joints.empty() && can_be_told_apart)
      page["seams"] = {{"names", names},
                       {"blocks_i4", packed<std::int32_t>(blocks)},
                       {"joints_i4", packed<std::int32_t>(joints)},
                       {"ends_f4", packed<float>(ends)}};
  }

  /// At large displacements the failed state is one of a motion, and no mechanism.
  void add_mechanism(json& state) const {
    const StateTable table(path_of("mechanism.csv"), {"block", "velocity_x", "velocity_y", "rotation_per_m"});
    if (table.states().empty()) return;
    std::vector<float> velocity(3 * block_index_.size(), 0.0f);
    table.all_rows([&](const Row& row) {
      const int b = block_index_.of(row, 0);
      for (std::size_t k = 0; k < 3; ++k) velocity[3 * b + k] = static_cast<float>(row.number(1 + k));
    });
    state["is_mechanism"] = true;
    state["velocity_f4"] = packed<float>(velocity);
    state["largest_velocity"] = largest_vector(velocity);
  }

  void add_tables(json& page) const {
    std::vector<std::string> measured;
    for (const json& point : summary().value("measured_points", json::array())) measured.push_back(point.at("name").get<std::string>());
    page["history"] = curves_in(path_of("history.csv"), "point", measured, {"displacement_x_m", "displacement_y_m"});
    page["energy"] = curves_in(path_of("energy.csv"), "", {});
    page["contact_history"] = curves_in(path_of("contact_history.csv"), "contact", {}, {"normal_force_n"});
    page["curve"] = curves_in(path_of("curve.csv"), "point", {}, {"displacement_m"});
    page["trials"] = json(rows_in(path_of("trials.csv"), {"stage", "stable", "criterion"}));
    page["milestones"] = json(rows_in(path_of("milestones.csv"), {"reason"}));
  }

  ResultFolder folder_;
  ReportRequest request_;
  Report& report_;
  BlockIndex block_index_;
  StateTable motions_, contacts_, cracks_;
  Vec2 origin_ = Vec2::Zero();  ///< the middle of the drawing
};

}  // namespace

json page_data(const std::string& folder, const ReportRequest& request, Report& report) {
  return PageData(folder, request, report).data();
}

}  // namespace openclose
