#include "openclose/io/result_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "openclose/analysis/strength_search.h"
#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/io/force_chain.h"
#include "openclose/io/result_answer.h"
#include "openclose/io/result_folder.h"
#include "openclose/io/result_rows.h"
#include "openclose/io/result_symbols.h"
#include "openclose/io/state_table.h"
#include "openclose/scene/nearest.h"

namespace openclose {
namespace {

using nlohmann::json;

/// [-] Of the size of the median block: a joint that has opened or slipped by more is no line any more, the gap itself is to be seen.
constexpr double widest_drawn_opening = 0.1;
/// [-] Of the widest opening that is drawn as a line: what is open by less is drawn thin.
constexpr double slight_part_of_opening = 0.01;
/// [-] Of the largest displacement of the mechanism: what opens or slips by less has been moved by rounding.
constexpr double noticeable_part_of_mechanism = 0.01;

/// The place of a name in the list, at whose end it is put where a table has one that the summary lacks.
int place_of(std::string_view name, std::vector<std::string>& names) {
  const auto place = std::ranges::find(names, name);
  const auto index = static_cast<int>(place - names.begin());
  if (place == names.end()) names.emplace_back(name);
  return index;
}

class ResultPicture {
 public:
  ResultPicture(const std::string& folder, const DrawingRequest& request)
      : folder_(folder), request_(request), drawn_(folder_.drawing().polygons), block_index_(folder_.path_of("blocks.csv"), folder_.drawing().names) {
    choose_state();
  }

  Picture picture() {
    read_blocks();
    read_contacts();
    read_cracks();
    colour_blocks();
    if (colour_ == BlockColour::material) add_seams();
    add_joints();
    if (request_.forces) add_forces();
    if (request_.cracks) add_cracks();
    if (colour_ == BlockColour::velocity) add_velocities();
    add_symbols(folder_, block_index_, now_, picture_);
    add_titles();
    folder_.require_whole_tables();
    return std::move(picture_);
  }

 private:
  std::string path_of(const std::string& name) const { return folder_.path_of(name); }
  const json& summary() const { return folder_.summary(); }
  bool is_factor() const { return folder_.is_factor(); }

  void choose_state() {
    const std::vector<std::string>& states = folder_.states();
    if (request_.state) {
      if (!folder_.has(*request_.state)) {
        std::vector<std::string> quoted;
        for (const std::string& state : states) quoted.push_back('"' + state + '"');
        throw InputError({path_of("blocks.csv"), 0}, "--state",
                         fmt::format("there is no state \"{}\"{}", *request_.state, did_you_mean('"' + *request_.state + '"', quoted)),
                         suggestions('"' + *request_.state + '"', quoted));
      }
      state_ = *request_.state;
    } else {
      state_ = states.back();
      if (is_factor() && folder_.has(mechanism_state)) state_ = mechanism_state;
    }
    const bool shows_failure = is_factor() && state_ == mechanism_state;
    // At large displacements the failed state is one of a motion, and no mechanism.
    shows_mechanism_ = shows_failure && is_there(path_of("mechanism.csv"));
    const BlockColour usual = shows_failure ? BlockColour::displacement : BlockColour::material;
    colour_ = request_.colour.value_or(shows_mechanism_ ? BlockColour::velocity : usual);
  }

  void read_blocks() {
    now_ = folder_.outlines(state_);
    for (std::size_t b = 0; b < now_.size(); ++b) picture_.blocks.push_back({folder_.drawing().names[b], now_[b], 0, false, 0.0});
    picture_.colour_names = folder_.names_in("materials");
    const StateTable properties(path_of("block_properties.csv"), {"block", "material", "fixed"});
    properties.all_rows([&](const Row& row) {
      Picture::Block& block = picture_.blocks[static_cast<std::size_t>(block_index_.of(row, 0))];
      block.colour = place_of(row[1], picture_.colour_names);
      block.fixed = row[2] == "1";
    });
    std::vector<double> areas;
    for (const Polygon& outline : now_) areas.push_back(std::abs(signed_area(outline)));
    const auto middle = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
    std::ranges::nth_element(areas, middle);
    size_ = std::sqrt(*middle);
  }

  void read_contacts() {
    const StateTable table = contact_table(path_of("contacts.csv"));
    contacts_ = contact_rows(table, state_, block_index_);
    // A state in which nothing touches has none, either; the drawing and the states of fos without contacts have had none written.
    const bool lacks_contacts = contacts_.empty() && !shows_mechanism_ && (is_factor() || state_ == "initial");
    if (request_.forces && contacts_.empty()) refuse_without_contacts("--forces", table);
    if (colour_ == BlockColour::state && lacks_contacts) refuse_without_contacts("--colour", table);
    for (std::size_t i = 0; i < contacts_.size(); ++i) of_pair_[pair_key(contacts_[i].a, contacts_[i].b)].push_back(i);
  }

  [[noreturn]] void refuse_without_contacts(const char* option, const StateTable& table) const {
    std::string accepted;
    for (const std::string& state : table.states()) accepted += fmt::format("{}\"{}\"", accepted.empty() ? "" : ", ", state);
    throw InputError({path_of("contacts.csv"), 0}, option, fmt::format("there are no contacts in the state \"{}\"", state_),
                     accepted.empty() ? "a result with contacts" : "--state with one of " + accepted);
  }

  void read_cracks() {
    cracks_ = crack_rows(path_of("cracks.csv"), state_, block_index_);
    if (request_.cracks && cracks_.empty()) {
      throw InputError({path_of("cracks.csv"), 0}, "--cracks", fmt::format("no joints are written of the state \"{}\"", state_),
                       "another --state than \"initial\", of a result whose drawing has joints");
    }
  }

  /// The same whichever of the two comes first.
  static std::uint64_t pair_key(int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
  }

  double largest_displacement() const {
    double largest = 0.0;
    for (std::size_t b = 0; b < now_.size(); ++b) {
      for (std::size_t i = 0; i < now_[b].size(); ++i) largest = std::max(largest, (now_[b][i] - drawn_[b][i]).norm());
    }
    return largest;
  }

  JointDrawing state_at(const CrackRow& crack, bool at_from) {
    const double opening = at_from ? crack.opening_from : crack.opening_to, slip = at_from ? crack.slip_from : crack.slip_to;
    if (contacts_.empty()) {
      if (!shows_mechanism_) return JointDrawing::plain;
      const double noticeable = noticeable_part_of_mechanism * largest_displacement_;
      if (opening > noticeable) return JointDrawing::open;
      return std::abs(slip) > noticeable ? JointDrawing::sliding : JointDrawing::sticking;
    }
    const auto found = of_pair_.find(pair_key(crack.a, crack.b));
    if (found == of_pair_.end()) return opening > 0.0 ? JointDrawing::open : JointDrawing::plain;
    const Vec2 place = at_from ? crack.from : crack.to;
    const std::size_t nearest =
        *std::ranges::min_element(found->second, {}, [&](std::size_t i) { return (contacts_[i].point - place).squaredNorm(); });
    for (const std::size_t i : found->second) contacts_[i].used = true;
    return contacts_[nearest].state;
  }

  bool is_line(const CrackRow& crack) const {
    const double widest = std::max({crack.opening_from, crack.opening_to, std::abs(crack.slip_from), std::abs(crack.slip_to)});
    return widest <= widest_drawn_opening * size_ || shows_mechanism_;
  }

  void add_joints() {
    if (shows_mechanism_) largest_displacement_ = largest_displacement();
    double widest = 0.0;
    std::unordered_map<std::uint64_t, int> joints_of_pair;
    for (const CrackRow& crack : cracks_) {
      if (is_line(crack)) widest = std::max({widest, crack.opening_from, crack.opening_to});
      ++joints_of_pair[pair_key(crack.a, crack.b)];
    }
    for (const CrackRow& crack : cracks_) {
      if (!is_line(crack)) continue;
      const std::uint64_t key = pair_key(crack.a, crack.b);
      const JointDrawing from = state_at(crack, true), to = state_at(crack, false);
      // Where the blocks touch now is told by their contacts.
      if (from != JointDrawing::open && to != JointDrawing::open && joints_of_pair[key] == 1 && of_pair_.contains(key) && add_face(of_pair_[key]))
        continue;
      const std::optional<std::pair<Vec2, Vec2>> common = common_stretch(crack);
      if (!common) continue;
      const auto add = [&](const Vec2& begin, const Vec2& end, JointDrawing state, double opening) {
        // What touches without a force is closed.
        if (state == JointDrawing::open && opening <= rounding_of_openings * size_) state = JointDrawing::sticking;
        picture_.joints.push_back({begin, end, state, state == JointDrawing::open && opening < slight_part_of_opening * widest});
      };
      const Vec2 middle = 0.5 * (common->first + common->second);
      if (from == to) {
        add(common->first, common->second, from, std::max(crack.opening_from, crack.opening_to));
      } else {
        add(common->first, middle, from, crack.opening_from);
        add(middle, common->second, to, crack.opening_to);
      }
    }
    // What touches now and did not in the drawing.
    for (const auto& [key, list] : of_pair_) {
      if (contacts_[list.front()].used) continue;
      if (!add_face(list)) {
        for (const std::size_t i : list) {
          const ContactRow& contact = contacts_[i];
          if (contact.state == JointDrawing::sliding) picture_.joints.push_back({contact.point, contact.point, contact.state});
        }
      }
    }
  }

  /// Joints with a name, where they still face each other, if there are others to be told from them.
  void add_seams() {
    std::set<std::string> names;
    for (const CrackRow& crack : cracks_) names.insert(crack.joint);
    if (names.size() < 2) return;
    picture_.seam_names = folder_.names_in("joints");
    for (const CrackRow& crack : cracks_) {
      const std::optional<std::pair<Vec2, Vec2>> common = common_stretch(crack);
      if (crack.joint.empty() || !common || !is_line(crack)) continue;
      picture_.seams.push_back({common->first, common->second, place_of(crack.joint, picture_.seam_names)});
    }
  }

  /// Where both blocks still have their side of the joint: its line lies in the middle of theirs, which have moved along it by half of the slip, to
  /// and fro. Nothing where they have passed each other.
  static std::optional<std::pair<Vec2, Vec2>> common_stretch(const CrackRow& crack) {
    const Vec2 along = (crack.to - crack.from).normalized();
    const Vec2 from = crack.from + 0.5 * std::abs(crack.slip_from) * along, to = crack.to - 0.5 * std::abs(crack.slip_to) * along;
    if ((to - from).dot(along) <= 0.0) return std::nullopt;
    return std::pair(from, to);
  }

  /// Two contacts at the ends of the stretch along which two edges face each other, of which each has a part. Draws those that are closed: open ones
  /// may have their corners far apart. False if it is something else.
  bool add_face(const std::vector<std::size_t>& list) {
    if (list.size() != 2) return false;
    const ContactRow &a = contacts_[list[0]], &b = contacts_[list[1]];
    const double apart = (a.point - b.point).norm(), length = a.length + b.length;
    if (std::abs(apart - length) > accuracy_of_lengths * length) return false;
    const Vec2 between = a.point + a.length / length * (b.point - a.point);
    if (a.state != JointDrawing::open) picture_.joints.push_back({a.point, between, a.state});
    if (b.state != JointDrawing::open) picture_.joints.push_back({between, b.point, b.state});
    return true;
  }

  void colour_blocks() {
    switch (colour_) {
      case BlockColour::material:
        break;
      case BlockColour::displacement:
        colour_by_displacement();
        break;
      case BlockColour::velocity:
        colour_by_velocity();
        break;
      case BlockColour::state:
        colour_by_state();
        break;
    }
  }

  void set_values(const std::vector<double>& values, const std::string& quantity, const std::string& unit) {
    double largest = 0.0;
    for (const double value : values) largest = std::max(largest, value);
    // Lengths of closures are easier to read in millimetres.
    const bool small = unit.rfind("m", 0) == 0 && largest < 0.1;
    picture_.scale = {fmt::format("{} [{}{}]", quantity, small ? "m" : "", unit), small ? 1e3 * largest : largest};
    for (std::size_t b = 0; b < values.size(); ++b) picture_.blocks[b].value = small ? 1e3 * values[b] : values[b];
  }

  void colour_by_displacement() {
    std::vector<double> values;
    for (std::size_t b = 0; b < now_.size(); ++b) {
      const Placement placement(drawn_[b], now_[b]);
      values.push_back((placement.to - placement.from).norm());
    }
    set_values(values, "displacement", "m");
  }

  void colour_by_velocity() {
    velocities_.assign(now_.size(), Vec2::Zero());
    if (shows_mechanism_) {
      // It has a row a block that moves.
      const StateTable mechanism(path_of("mechanism.csv"), {"block", "velocity_x", "velocity_y"});
      mechanism.all_rows([&](const Row& row) { note_velocity(row); });
    } else {
      const StateTable table(path_of("block_states.csv"), {"block", "velocity_x_m_per_s", "velocity_y_m_per_s"});
      table.rows(state_, [&](const Row& row) {
        if (!row[1].empty()) note_velocity(row);
      });
    }
    if (!has_velocities_) {
      throw InputError({path_of("block_states.csv"), 0}, "--colour", fmt::format("there are no velocities in the state \"{}\"", state_),
                       is_factor() ? "--state failed, the mechanism" : "a state of a run after its start");
    }
    std::vector<double> values;
    for (const Vec2& v : velocities_) values.push_back(v.norm());
    const double fastest = *std::ranges::max_element(values);
    if (shows_mechanism_ && fastest > 0.0) {
      for (double& value : values) value /= fastest;
      set_values(values, "velocity / largest velocity", "-");
    } else {
      set_values(values, "velocity", "m/s");
    }
  }

  /// Of a row with the name of a block and its velocity.
  void note_velocity(const Row& row) {
    velocities_[static_cast<std::size_t>(block_index_.of(row, 0))] = {row.number(1), row.number(2)};
    has_velocities_ = true;
  }

  void colour_by_state() {
    // Reported by joints of the drawing, too, where no contacts are written.
    enum Class { untouched, held, slid_upon };
    std::vector<int> classes(now_.size(), untouched);
    const auto raise = [&](int b, int to) { classes[static_cast<std::size_t>(b)] = std::max(classes[static_cast<std::size_t>(b)], to); };
    const auto note = [&](int a, int b, JointDrawing state) {
      if (state == JointDrawing::open || state == JointDrawing::plain) return;
      for (const int block : {a, b}) raise(block, state == JointDrawing::sliding ? slid_upon : held);
    };
    if (contacts_.empty() && shows_mechanism_) largest_displacement_ = largest_displacement();
    for (const ContactRow& contact : contacts_) note(contact.a, contact.b, contact.state);
    for (const CrackRow& crack : cracks_) {
      if (contacts_.empty()) note(crack.a, crack.b, std::min(state_at(crack, true), state_at(crack, false)));
    }
    picture_.colour_names = {"touched by nothing", "held by friction or cohesion", "something slides along it"};
    for (std::size_t b = 0; b < classes.size(); ++b) picture_.blocks[b].colour = classes[b];
  }

  void add_velocities() {
    for (std::size_t b = 0; b < now_.size(); ++b) {
      const Placement placement(drawn_[b], now_[b]);
      picture_.velocities.push_back({placement.to, velocities_[b]});
    }
    double fastest = 0.0;
    for (const Vec2& v : velocities_) fastest = std::max(fastest, v.norm());
    picture_.velocity_name = shows_mechanism_                               ? "velocity of the mechanism"
                             : picture_.scale->quantity.ends_with("[mm/s]") ? fmt::format("{:.3g} mm/s", 1e3 * fastest)
                                                                            : fmt::format("{:.3g} m/s", fastest);
  }

  void add_forces() {
    for (const auto& [key, list] : of_pair_) {
      PairForce pair{contacts_[list.front()].a, contacts_[list.front()].b};
      double weights = 0.0;
      for (const std::size_t i : list) {
        const double weight = contacts_[i].force.norm();
        pair.on_a += contacts_[i].a == pair.a ? contacts_[i].force : Vec2(-contacts_[i].force);
        pair.point += weight * contacts_[i].point;
        weights += weight;
      }
      if (weights == 0.0 || pair.on_a.isZero(0.0)) continue;
      pair.point /= weights;
      picture_.forces.push_back(force_through(pair, picture_.blocks, size_));
    }
  }

  void add_cracks() {
    // A gap as wide as a part of a block is seen itself; a bar in its middle would stand in the air.
    const bool all = std::ranges::all_of(cracks_, [&](const CrackRow& crack) { return is_line(crack); });
    picture_.crack_name = shows_mechanism_ ? "largest opening, as drawn,"
                          : all            ? "largest opening"
                                           : "largest opening of joints that still face each other";
    const auto add = [&](const Vec2& from, const Vec2& to, double opening) {
      if (opening > rounding_of_openings * size_) picture_.cracks.push_back({from, to, opening});
    };
    for (const CrackRow& crack : cracks_) {
      const std::optional<std::pair<Vec2, Vec2>> common = common_stretch(crack);
      if (!common || !is_line(crack)) continue;
      // Half of the joint stands for each end.
      const Vec2 middle = 0.5 * (common->first + common->second);
      add(common->first, middle, crack.opening_from);
      add(middle, common->second, crack.opening_to);
    }
    if (picture_.cracks.empty()) picture_.crack_name = all ? "no joint is open" : "no opening of joints that still face each other";
  }

  void add_titles() {
    const std::string title = summary().value("title", "");
    picture_.title = title.empty() ? folder_.name() : title;
    picture_.notes.push_back(answer_of(summary()));
    const std::string gravity = summary().value("gravity_in_words", "");
    picture_.notes.push_back(fmt::format("{} blocks; state \"{}\"{}{}{}", now_.size(), state_, explanation(), gravity.empty() ? "" : "; ", gravity));
  }

  std::string explanation() const {
    if (shows_mechanism_) {
      const json failing = summary().value("failing_blocks", json::object());
      const bool by_limit = summary().at("bracket").value("failed_by", json()) == by_limit_analysis;
      return fmt::format(": the mechanism{} of {} of them, velocities drawn as displacements", by_limit ? " of the limit analysis" : "",
                         failing.value("number", 0));
    }
    if (is_factor() && state_ == mechanism_state) return ": after failure";
    if (is_factor() && state_ == "stable") return ": the last one that stands";
    if (state_ == "initial") return ": the drawing";
    if (state_ == "start") return ": the start of the motion";
    return "";
  }

  ResultFolder folder_;
  DrawingRequest request_;
  std::string state_;
  bool shows_mechanism_ = false, has_velocities_ = false;
  BlockColour colour_ = BlockColour::material;
  std::vector<Polygon> drawn_, now_;
  BlockIndex block_index_;
  double size_ = 1.0;                  ///< [m] of the median block
  double largest_displacement_ = 0.0;  ///< [m] of a vertex in the mechanism
  std::vector<ContactRow> contacts_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> of_pair_;
  std::vector<CrackRow> cracks_;
  std::vector<Vec2> velocities_;
  Picture picture_;
};

}  // namespace

const std::vector<std::string>& block_colour_names() {
  static const std::vector<std::string> names = {"material", "displacement", "velocity", "state"};
  return names;
}

Picture picture_of_results(const std::string& folder, const DrawingRequest& request) {
  try {
    return ResultPicture(folder, request).picture();
  } catch (const json::exception&) {
    throw InputError({folder + "/summary.json", 0}, "", "this is not what openclose writes of a run or fos",
                     "the results of this version of openclose");
  }
}

}  // namespace openclose
