// The files for ParaView: well-formed, their arrays of the lengths that they say, and the numbers those of the tables. `make verify-vtk` reads them
// with VTK itself.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "io/files.h"
#include "openclose/io/results.h"
#include "openclose/io/vtk.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::TemporaryFolder;
using openclose::test::text_of;

namespace {

std::string decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int known = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = (bits << 6) | static_cast<std::uint32_t>(digits.find(c));
    if ((known += 6) >= 8) bytes += static_cast<char>((bits >> (known -= 8)) & 255u);
  }
  return bytes;
}

/// The array of this name; its header has to tell its length.
template <typename T>
std::vector<T> array(const std::string& xml, const std::string& name) {
  const std::size_t at = xml.find("Name=\"" + name + "\"");
  REQUIRE(at != std::string::npos);
  const std::size_t begin = xml.find('>', at) + 1;
  const std::string bytes = decoded(xml.substr(begin, xml.find('<', begin) - begin));
  std::uint64_t size = 0;
  REQUIRE(bytes.size() >= sizeof size);
  std::memcpy(&size, bytes.data(), sizeof size);
  REQUIRE(bytes.size() == sizeof size + size);
  std::vector<T> values(size / sizeof(T));
  std::memcpy(values.data(), bytes.data() + sizeof size, size);
  return values;
}

/// Every tag is closed, in the right order.
bool is_well_formed(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.front() == '?' || tag.back() == '/') continue;
    if (tag.front() != '/') {
      open.push_back(tag.substr(0, tag.find(' ')));
    } else if (open.empty() || open.back() != tag.substr(1)) {
      return false;
    } else {
      open.pop_back();
    }
  }
  return open.empty();
}

}  // namespace

TEST_CASE("base64 is that of RFC 4648", "[io][vtk]") {
  const std::pair<const char*, const char*> vectors[] = {
      {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : vectors) CHECK(base64(plain, std::strlen(plain)) == coded);
}

TEST_CASE("states of a run as grids of blocks and contacts", "[io][vtk]") {
  const TemporaryFolder place;
  Scene scene = test::column_of_blocks(2);
  scene.method.start = Start::settled;
  scene.end_time = 0.2;
  scene.snapshots_every = 0.1;
  Simulation simulation(scene);
  const OutputFolder folder(place.path());
  {
    StateTables states(folder, scene);
    states.add_drawing(simulation.scene(), simulation.system());
    write_block_properties(folder, scene, simulation.system());
    RunObserver observer;
    observer.started = [&](const Simulation& s) { states.add("start", s); };
    observer.snapshot = [&](const std::string& state, const Simulation& s) { states.add(state, s); };
    REQUIRE(run(simulation, observer).converged);
    states.add("final", simulation);
    states.close();
  }
  write_vtk(folder);
  // "final" is the state of t = 0.2 once more.
  const std::string series = text_of(place / "vtk/blocks.pvd");
  CHECK(is_well_formed(series));
  CHECK_THAT(series, ContainsSubstring("timestep=\"0\" part=\"0\" file=\"blocks_0000_start.vtu\"") &&
                         ContainsSubstring("file=\"blocks_0002_t=0.2.vtu\"") && !ContainsSubstring("blocks_0003"));
  CHECK_THAT(series, ContainsSubstring("timestep=\"0.1"));
  const std::string blocks = text_of(place / "vtk/blocks_0001_t=0.1.vtu"), contacts = text_of(place / "vtk/contacts_0001_t=0.1.vtu");
  CHECK(is_well_formed(blocks));
  CHECK(is_well_formed(contacts));
  CHECK_THAT(blocks, ContainsSubstring("<Piece NumberOfPoints=\"12\" NumberOfCells=\"3\">"));
  CHECK(array<std::int64_t>(blocks, "offsets") == std::vector<std::int64_t>{4, 8, 12});
  CHECK(array<std::uint8_t>(blocks, "types") == std::vector<std::uint8_t>{7, 7, 7});
  CHECK(array<std::int64_t>(blocks, "fixed") == std::vector<std::int64_t>{1, 0, 0});
  const std::vector<double> points = array<double>(blocks, "points_m");
  REQUIRE(points.size() == 36);
  CHECK(points[0] == -10.0);
  CHECK(points[1] == -1.0);
  // The lower block stands on its first two corners, which have sunk by the closure, on the average.
  CHECK(0.5 * (points[3 * 4 + 1] + points[3 * 5 + 1]) == Approx(-2.0 * test::block_weight / 2e9).epsilon(1e-3));
  const std::vector<double> moved = array<double>(blocks, "displacement_m");
  REQUIRE(moved.size() == 9);
  CHECK(moved[3 * 1 + 1] == Approx(-2.0 * test::block_weight / 2e9).epsilon(1e-3));
  const std::vector<double> force = array<double>(contacts, "force_on_a_n");
  const std::vector<std::int64_t> a = array<std::int64_t>(contacts, "block_a"), b = array<std::int64_t>(contacts, "block_b");
  REQUIRE(force.size() == 3 * a.size());
  double on_base = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) on_base += a[i] == 0 ? force[3 * i + 1] : b[i] == 0 ? -force[3 * i + 1] : 0.0;
  CHECK(on_base == Approx(-2.0 * test::block_weight).epsilon(1e-5));

  // What somebody else has put there stays.
  place.write("vtk/view.pvsm", "mine");
  folder.remove_results();
  CHECK(place.entries() == std::set<std::string>{"vtk"});
  CHECK(std::filesystem::exists(place / "vtk/view.pvsm"));
  CHECK_FALSE(std::filesystem::exists(place / "vtk/blocks_0000_start.vtu"));
  CHECK_FALSE(std::filesystem::exists(place / "vtk/contacts.pvd"));
}
