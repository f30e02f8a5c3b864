#include "openclose/io/vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <optional>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "openclose/io/state_table.h"

namespace openclose {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say so");

/// Of VTK's cells.
constexpr std::uint8_t vtk_vertex = 1, vtk_polygon = 7;

template <typename T>
constexpr const char* vtk_type() {
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  return "UInt8";
}

/// One unstructured grid, written as it is put together.
class Grid {
 public:
  Grid(std::size_t points, std::size_t cells) {
    text_ = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
        points, cells);
  }
  void open(const char* section) { text_ += fmt::format("<{}>\n", section); }
  void close(const char* section) { text_ += fmt::format("</{}>\n", section); }
  template <typename T>
  void array(const std::string& name, const std::vector<T>& values, int components = 1) {
    const std::size_t size = values.size() * sizeof(T);
    const std::uint64_t header = size;
    std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
    bytes.append(reinterpret_cast<const char*>(values.data()), size);
    text_ += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">{}</DataArray>\n", vtk_type<T>(), name,
                         components, base64(bytes.data(), bytes.size()));
  }
  std::string take() { return std::move(text_) + "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"; }

 private:
  std::string text_;
};

/// Numbers of the blocks in the order of the scene, materials in that of their first block, who is fixed.
struct BlockNumbers {
  std::unordered_map<std::string, std::int64_t> of;
  std::vector<std::int64_t> material, fixed;

  explicit BlockNumbers(const std::string& properties) {
    std::ifstream file(properties);
    std::string line;
    std::unordered_map<std::string, std::int64_t> materials;
    for (std::getline(file, line); std::getline(file, line);) {
      const std::size_t first = line.find(','), second = line.find(',', first + 1);
      of.emplace(line.substr(0, first), static_cast<std::int64_t>(material.size()));
      material.push_back(
          materials.try_emplace(line.substr(first + 1, second - first - 1), static_cast<std::int64_t>(materials.size())).first->second);
      fixed.push_back(line.at(second + 1) == '1' ? 1 : 0);
    }
  }
  std::int64_t number(std::string_view name) const {
    const auto place = of.find(std::string(name));
    return place == of.end() ? -1 : place->second;
  }
};

/// The two columns from this one on.
void add_vector(std::vector<double>& list, const Row& row, std::size_t column) {
  list.insert(list.end(), {row.number_or_zero(column), row.number_or_zero(column + 1), 0.0});
}

std::string grid_of_blocks(const StateTable& outlines, const StateTable& motions, const std::string& state, const BlockNumbers& numbers) {
  std::vector<double> points, displacement, velocity, rotation, angular_velocity;
  std::vector<std::int64_t> connectivity, offsets, block, material, fixed;
  std::string_view last;
  outlines.rows(state, [&](const Row& row) {
    if (row[0] != last || offsets.empty()) {
      offsets.push_back(0);
      const std::int64_t b = numbers.number(row[0]);
      block.push_back(b);
      material.push_back(b < 0 ? -1 : numbers.material[static_cast<std::size_t>(b)]);
      fixed.push_back(b < 0 ? 0 : numbers.fixed[static_cast<std::size_t>(b)]);
      last = row[0];
    }
    connectivity.push_back(static_cast<std::int64_t>(connectivity.size()));
    add_vector(points, row, 1);
    offsets.back() = static_cast<std::int64_t>(connectivity.size());
  });
  motions.rows(state, [&](const Row& row) {
    add_vector(displacement, row, 1);
    rotation.push_back(row.number(3));
    add_vector(velocity, row, 4);
    angular_velocity.push_back(row.number_or_zero(6));
  });
  Grid grid(points.size() / 3, offsets.size());
  grid.open("Points");
  grid.array("points_m", points, 3);
  grid.close("Points");
  grid.open("Cells");
  grid.array("connectivity", connectivity);
  grid.array("offsets", offsets);
  grid.array("types", std::vector<std::uint8_t>(offsets.size(), vtk_polygon));
  grid.close("Cells");
  grid.open("CellData");
  grid.array("block", block);
  grid.array("material", material);
  grid.array("fixed", fixed);
  if (rotation.size() == offsets.size()) {
    grid.array("displacement_m", displacement, 3);
    grid.array("rotation_rad", rotation);
    grid.array("velocity_m_per_s", velocity, 3);
    grid.array("angular_velocity_rad_per_s", angular_velocity);
  }
  grid.close("CellData");
  return grid.take();
}

std::string grid_of_contacts(const StateTable& contacts, const std::string& state, const BlockNumbers& numbers) {
  std::vector<double> points, normal, force, length, gap, normal_force, shear_force;
  std::vector<std::int64_t> cells, offsets, a, b, status;
  contacts.rows(state, [&](const Row& row) {
    add_vector(points, row, 2);
    add_vector(normal, row, 4);
    const double nx = row.number(4), ny = row.number(5), n = row.number(8), t = row.number(9);
    force.insert(force.end(), {n * nx - t * ny, n * ny + t * nx, 0.0});
    length.push_back(row.number(6));
    gap.push_back(row.number(7));
    normal_force.push_back(n);
    shear_force.push_back(t);
    status.push_back(row[10] == "open" ? 0 : row[10] == "sticking" ? 1 : 2);
    a.push_back(numbers.number(row[0]));
    b.push_back(numbers.number(row[1]));
    cells.push_back(static_cast<std::int64_t>(cells.size()));
    offsets.push_back(static_cast<std::int64_t>(cells.size()));
  });
  Grid grid(cells.size(), cells.size());
  grid.open("Points");
  grid.array("points_m", points, 3);
  grid.close("Points");
  grid.open("Cells");
  grid.array("connectivity", cells);
  grid.array("offsets", offsets);
  grid.array("types", std::vector<std::uint8_t>(cells.size(), vtk_vertex));
  grid.close("Cells");
  grid.open("PointData");
  grid.array("block_a", a);
  grid.array("block_b", b);
  grid.array("status", status);
  grid.array("length_m", length);
  grid.array("gap_m", gap);
  grid.array("normal_force_n", normal_force);
  grid.array("shear_force_n", shear_force);
  grid.array("normal", normal, 3);
  grid.array("force_on_a_n", force, 3);
  grid.close("PointData");
  return grid.take();
}

/// "moved 10 m" without its blanks, which have to be quoted in every shell.
std::string name_in_file(std::string state) {
  std::ranges::replace(state, ' ', '_');
  return state;
}

std::string collection(const std::vector<std::pair<double, std::string>>& files) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const auto& [time, file] : files) text += fmt::format("<DataSet timestep=\"{:.17g}\" part=\"0\" file=\"{}\"/>\n", time, file);
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace

std::string base64(const char* bytes, std::size_t size) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = (three << 8) | (i + k < size ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= size ? digits[(three >> (18 - 6 * k)) & 63u] : '=';
  }
  return text;
}

void write_vtk(const OutputFolder& folder) {
  const StateTable outlines(folder.path_of("blocks.csv"), {"block", "x_m", "y_m"});
  const StateTable motions(folder.path_of("block_states.csv"), {"block", "displacement_x_m", "displacement_y_m", "rotation_rad", "velocity_x_m_per_s",
                                                                "velocity_y_m_per_s", "angular_velocity_rad_per_s", "time_s"});
  const StateTable contacts(folder.path_of("contacts.csv"), {"block_a", "block_b", "x_m", "y_m", "normal_x", "normal_y", "length_m", "gap_m",
                                                             "normal_force_n", "shear_force_n", "status"});
  const BlockNumbers numbers(folder.path_of("block_properties.csv"));
  std::vector<std::pair<double, std::string>> block_files, contact_files;
  for (const std::string& state : outlines.states()) {
    if (!motions.has(state)) continue;  // the drawing
    std::optional<double> time;
    motions.rows(state, [&](const Row& row) {
      if (!time) time = row[7].empty() ? static_cast<double>(block_files.size()) : row.number(7);
    });
    if (!block_files.empty() && block_files.back().first == time) continue;
    const std::string name = fmt::format("{:04}_{}.vtu", block_files.size(), name_in_file(state));
    block_files.emplace_back(time.value_or(0.0), "blocks_" + name);
    contact_files.emplace_back(time.value_or(0.0), "contacts_" + name);
    folder.write_format_file("vtk", block_files.back().second, grid_of_blocks(outlines, motions, state, numbers));
    folder.write_format_file("vtk", contact_files.back().second, grid_of_contacts(contacts, state, numbers));
  }
  folder.write_format_file("vtk", "blocks.pvd", collection(block_files));
  folder.write_format_file("vtk", "contacts.pvd", collection(contact_files));
}

}  // namespace openclose
