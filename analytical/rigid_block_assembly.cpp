#include "openclose/analytical/rigid_block_assembly.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {
namespace {

double cross(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// --- interfaces ---

struct Edge {
  int block;
  int joint;  // that it names, see RigidBlock::edge_joints
  Point from, to;
  Point low, high;  // corners of its box
};

std::vector<Edge> edges_of(const std::vector<RigidBlock>& blocks) {
  std::vector<Edge> edges;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto& v = blocks[b].vertices;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const Point& to = v[(i + 1) % v.size()];
      if ((to - v[i]).norm() <= touching_distance) continue;
      const int joint = blocks[b].edge_joints.empty() ? Interface::by_materials : blocks[b].edge_joints[i];
      edges.push_back({static_cast<int>(b), joint, v[i], to, v[i].cwiseMin(to), v[i].cwiseMax(to)});
    }
  }
  return edges;
}

/// Adds the interface of two edges, if they are one.
void match(const Edge& a, const Edge& b, std::vector<Interface>& interfaces) {
  // The longer edge carries the line: its direction is the better known one.
  const bool along_a = (a.to - a.from).norm() >= (b.to - b.from).norm();
  const Edge& line = along_a ? a : b;
  const Edge& other = along_a ? b : a;
  const double length = (line.to - line.from).norm();
  const Point direction = (line.to - line.from) / length;
  const auto place = [&](const Point& p) { return direction.dot(p - line.from); };
  // Blocks on both sides of a line run along it in opposite directions.
  const double begin = std::max(0.0, place(other.to));
  const double end = std::min(length, place(other.from));
  if (!(end - begin > touching_distance)) return;
  const double span = place(other.from) - place(other.to);
  for (const double s : {begin, end}) {
    const Point on_other = other.to + (s - place(other.to)) / span * (other.from - other.to);
    if (std::abs(cross(direction, on_other - line.from)) > touching_distance) return;
  }
  const Point into_line_block(-direction.y(), direction.x());
  interfaces.push_back({a.block,
                        b.block,
                        {line.from + begin * direction, line.from + end * direction},
                        along_a ? into_line_block : Point(-into_line_block),
                        a.joint == b.joint ? a.joint : Interface::by_materials,
                        {}});
}

// --- reading ---

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw std::invalid_argument(name + ": " + what);
}

/// A table of the file, with the words for where it stands.
class Section {
 public:
  Section(const toml::table& table, std::string where) : table_(table), where_(std::move(where)) {}

  bool has(const char* key) const { return table_.contains(key); }
  const std::string& where() const { return where_; }

  double number(const char* key) const { return number(table_[key].node(), key); }
  double number_or(const char* key, double absent) const { return has(key) ? number(key) : absent; }
  bool flag(const char* key) const {
    if (!has(key)) return false;
    const auto value = table_[key].value_exact<bool>();
    if (!value) refuse(where_, std::string(key) + " must be true or false");
    return *value;
  }
  std::string word(const char* key) const {
    const auto value = table_[key].value<std::string>();
    if (!value) refuse(where_, std::string("needs the text ") + key);
    return *value;
  }
  Point point(const char* key) const { return point(table_[key].node(), key); }
  std::vector<Point> points(const char* key) const {
    std::vector<Point> list;
    for (const toml::node& node : array(key)) list.push_back(point(&node, key));
    return list;
  }
  std::vector<std::string> words(const char* key) const {
    std::vector<std::string> list;
    for (const toml::node& node : array(key)) list.push_back(node.value_or(std::string()));
    return list;
  }

 private:
  const toml::array& array(const char* key) const {
    const toml::array* list = table_[key].as_array();
    if (!list) refuse(where_, std::string("needs the list ") + key);
    return *list;
  }
  double number(const toml::node* node, const char* key) const {
    const auto value = node ? node->value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value)) refuse(where_, std::string("needs the number ") + key);
    return *value;
  }
  Point point(const toml::node* node, const char* key) const {
    const toml::array* pair = node ? node->as_array() : nullptr;
    if (!pair || pair->size() != 2) refuse(where_, std::string(key) + " must be [x, y]");
    return {number(pair->get(0), key), number(pair->get(1), key)};
  }

  const toml::table& table_;
  std::string where_;
};

std::vector<Section> sections(const toml::table& file, const char* key, const std::string& name) {
  std::vector<Section> list;
  const toml::array* tables = file[key].as_array();
  if (!tables) return list;
  for (const toml::node& node : *tables) {
    const std::string where = name + ": " + key + "[" + std::to_string(list.size()) + "]";
    if (!node.as_table()) refuse(where, "is no table");
    list.emplace_back(*node.as_table(), where);
  }
  return list;
}

struct Names {
  std::map<std::string, int> numbers;

  int of(const std::string& word, const std::string& where) const {
    const auto found = numbers.find(word);
    if (found == numbers.end()) refuse(where, "nothing is called \"" + word + "\"");
    return found->second;
  }
};

class Reader {
 public:
  Reader(const toml::table& file, const std::string& name) : file_(file), name_(name) {}

  RigidBlockAssembly read() {
    if (file_.contains("domain")) refuse(name_, "has a domain; cut it first (openclose cut)");
    if (file_.contains("support")) refuse(name_, "has supports; limit analysis knows rigid bodies only");
    if (file_.contains("gravity_m_per_s2")) gravity_ = Section(file_, name_).point("gravity_m_per_s2");
    read_materials();
    read_joints();
    read_blocks();
    read_loads();
    read_surcharges();
    assembly_.interfaces = find_interfaces(assembly_.blocks);
    set_strengths();
    return std::move(assembly_);
  }

 private:
  void read_materials() {
    for (const Section& s : sections(file_, "material", name_)) {
      double density = 0;
      if (s.has("unit_weight_n_per_m3")) {
        density = s.number("unit_weight_n_per_m3") / gravity_.norm();
      } else {
        density = s.number("density_kg_per_m3");
      }
      if (!(density > 0 && std::isfinite(density))) refuse(s.where(), "the density must be positive");
      materials_.numbers[s.word("name")] = static_cast<int>(densities_.size());
      densities_.push_back(density);
    }
  }

  void read_blocks() {
    for (const Section& s : sections(file_, "block", name_)) {
      RigidBlock block;
      block.name = s.word("name");
      block.vertices = s.points("vertices_m");
      block.edge_joints = edge_joints(s, block.vertices.size());
      block.fixed = s.flag("fixed");
      block.rotation_locked = s.flag("rotation_locked");
      block.material = materials_.of(s.word("material"), s.where());
      block.density = densities_[block.material];
      complete_block(block, gravity_);
      blocks_.numbers[block.name] = static_cast<int>(assembly_.blocks.size());
      assembly_.blocks.push_back(std::move(block));
    }
    if (assembly_.blocks.empty()) refuse(name_, "has no blocks");
  }

  void read_loads() {
    for (const Section& s : sections(file_, "load", name_)) {
      RigidBlock& block = assembly_.blocks[blocks_.of(s.word("block"), s.where())];
      const Point force = s.point("force_n");
      block.load += Eigen::Vector3d(force.x(), force.y(), cross(s.point("point_m") - block.centroid, force));
    }
  }

  /// Pressure pushes to the left of an outline that runs counter-clockwise.
  void read_surcharges() {
    for (const Section& s : sections(file_, "surcharge", name_)) {
      RigidBlock& block = assembly_.blocks[blocks_.of(s.word("block"), s.where())];
      const Point from = s.point("from_m"), to = s.point("to_m"), middle = (from + to) / 2;
      Point along = Point::Zero();
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < block.vertices.size(); ++i) {
        const Point start = block.vertices[i], edge = block.vertices[(i + 1) % block.vertices.size()] - start;
        const double beside = std::abs(cross(edge, middle - start)) / edge.norm(), on_edge = edge.dot(middle - start) / edge.squaredNorm();
        if (on_edge < 0 || on_edge > 1 || beside >= nearest) continue;
        nearest = beside;
        along = (to - from).dot(edge) > 0 ? to - from : from - to;
      }
      const Point force = s.number("pressure_pa") * Point(-along.y(), along.x()) + s.number_or("shear_pa", 0) * along;
      block.load += Eigen::Vector3d(force.x(), force.y(), cross(middle - block.centroid, force));
    }
  }

  void read_joints() {
    for (const Section& s : sections(file_, "joint", name_)) {
      const InterfaceStrength strength{std::tan(s.number("friction_angle_deg") * degree), s.number_or("cohesion_pa", 0),
                                       s.number_or("tensile_strength_pa", 0)};
      if (!(strength.friction >= 0 && strength.cohesion >= 0 && strength.tension >= 0)) refuse(s.where(), "strength must not be negative");
      const auto words = s.has("materials") || !s.has("name") ? s.words("materials") : std::vector<std::string>();
      if (!words.empty() && words.size() != 2) refuse(s.where(), "materials must be two names");
      if (!words.empty()) of_materials_[std::minmax({materials_.of(words[0], s.where()), materials_.of(words[1], s.where())})] = strength;
      if (s.has("name")) joints_.numbers[s.word("name")] = static_cast<int>(strengths_.size());
      strengths_.push_back(strength);
    }
  }

  /// Names of joints for the edges from each vertex to the next, "" for that of the materials.
  std::vector<int> edge_joints(const Section& s, std::size_t edges) const {
    if (!s.has("edge_joints")) return {};
    const auto words = s.words("edge_joints");
    if (words.size() != edges) refuse(s.where(), "edge_joints needs a name for each edge");
    std::vector<int> joints;
    for (const std::string& word : words) joints.push_back(word.empty() ? Interface::by_materials : joints_.of(word, s.where()));
    return joints;
  }

  void set_strengths() {
    for (Interface& i : assembly_.interfaces) {
      if (i.joint != Interface::by_materials) {
        i.strength = strengths_[i.joint];
        continue;
      }
      const RigidBlock &a = assembly_.blocks[i.a], &b = assembly_.blocks[i.b];
      const auto found = of_materials_.find(std::minmax({a.material, b.material}));
      if (found == of_materials_.end()) refuse(name_, "no joint for the materials of blocks " + a.name + " and " + b.name);
      i.strength = found->second;
    }
  }

  const toml::table& file_;
  const std::string& name_;
  Point gravity_{0, -9.81};
  Names materials_, joints_, blocks_;
  std::vector<double> densities_;
  std::vector<InterfaceStrength> strengths_;
  std::map<std::pair<int, int>, InterfaceStrength> of_materials_;
  RigidBlockAssembly assembly_;
};

std::string described(const toml::parse_error& error) {
  return std::string(error.description()) + " (line " + std::to_string(error.source().begin.line) + ")";
}

}  // namespace

void complete_block(RigidBlock& block, const Point& gravity) {
  if (block.vertices.size() < 3) throw std::invalid_argument("block " + block.name + " has fewer than three vertices");
  // Relative to a vertex, so that far from the origin no digits are lost.
  const Point origin = block.vertices.front();
  double twice_area = 0;
  Point moment = Point::Zero();
  for (std::size_t i = 0; i < block.vertices.size(); ++i) {
    const Point p = block.vertices[i] - origin, q = block.vertices[(i + 1) % block.vertices.size()] - origin;
    twice_area += cross(p, q);
    moment += cross(p, q) * (p + q);
  }
  if (twice_area == 0) throw std::invalid_argument("block " + block.name + " has no area");
  block.centroid = origin + moment / (3 * twice_area);
  block.area = std::abs(twice_area) / 2;
  if (twice_area < 0) {
    std::reverse(block.vertices.begin(), block.vertices.end());
    // The edge from the last vertex to the first stays the last one.
    if (!block.edge_joints.empty()) std::reverse(block.edge_joints.begin(), block.edge_joints.end() - 1);
  }
  block.load.head<2>() += block.density * block.area * gravity;
}

std::vector<Interface> find_interfaces(const std::vector<RigidBlock>& blocks) {
  std::vector<Edge> edges = edges_of(blocks);
  std::sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) { return p.low.x() < q.low.x(); });
  std::vector<Interface> interfaces;
  // A vertical line sweeps over the edges; those it cuts are open.
  std::vector<const Edge*> open;
  for (const Edge& edge : edges) {
    std::erase_if(open, [&](const Edge* other) { return other->high.x() < edge.low.x() - touching_distance; });
    for (const Edge* other : open) {
      if (other->block == edge.block || (blocks[other->block].fixed && blocks[edge.block].fixed)) continue;
      if (other->high.y() < edge.low.y() - touching_distance || edge.high.y() < other->low.y() - touching_distance) continue;
      const bool in_order = edge.block < other->block;
      match(in_order ? edge : *other, in_order ? *other : edge, interfaces);
    }
    open.push_back(&edge);
  }
  const auto key = [](const Interface& i) { return std::tuple(i.a, i.b, i.ends[0].x(), i.ends[0].y()); };
  std::sort(interfaces.begin(), interfaces.end(), [&](const Interface& p, const Interface& q) { return key(p) < key(q); });
  return interfaces;
}

RigidBlockAssembly parse_rigid_blocks(const std::string& text, const std::string& name) {
  try {
    return Reader(toml::parse(text, name), name).read();
  } catch (const toml::parse_error& error) {
    refuse(name, described(error));
  }
}

RigidBlockAssembly read_rigid_blocks(const std::string& path) {
  try {
    return Reader(toml::parse_file(path), path).read();
  } catch (const toml::parse_error& error) {
    refuse(path, described(error));
  }
}

}  // namespace openclose::analytical
