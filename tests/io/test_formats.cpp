#include <filesystem>
#include <set>

#include "files.h"
#include "openclose/io/formats.h"
#include "openclose/io/results.h"
#include "openclose/io/summary.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::TemporaryFolder;
using openclose::test::text_of;

TEST_CASE("an unknown form of results is refused by the names that there are", "[io][formats]") {
  CHECK_NOTHROW(require_formats({}, {"scene.toml", 7}));
  CHECK_NOTHROW(require_formats({"svg", "vtk"}, {"scene.toml", 7}));
  CHECK_THROWS_WITH(require_formats({"vtk", "dxf"}, {"scene.toml", 7}),
                    "scene.toml:7: output.formats: \"dxf\" is no known form of results; accepted: \"vtk\", \"svg\"");
}

TEST_CASE("a drawing of every state", "[io][formats]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  Simulation simulation(test::block_on_base());
  {
    StateTables tables(folder, simulation.scene());
    tables.add_drawing(simulation.scene(), simulation.system());
    simulation.change_contacts();  // finds them
    tables.add("final", simulation);
    tables.close();
  }
  write_block_properties(folder, simulation.scene(), simulation.system());
  Summary summary;
  summary.command = "run";
  write_summary(folder, summary, simulation);
  write_formats({"svg"}, folder);
  for (const char* drawing : {"svg/0000.svg", "svg/0001.svg"})
    CHECK_THAT(text_of(place / drawing), ContainsSubstring("<svg") && ContainsSubstring("</svg>"));
  CHECK_FALSE(std::filesystem::exists(place / "svg/0002.svg"));
  CHECK_FALSE(std::filesystem::exists(place / "vtk"));
  CHECK(text_of(place / "svg/0000.svg") != text_of(place / "svg/0001.svg"));

  place.write("svg/mine.svg", "mine");
  folder.remove_results();
  CHECK(place.entries() == std::set<std::string>{"svg"});
  CHECK(std::filesystem::exists(place / "svg/mine.svg"));
  CHECK_FALSE(std::filesystem::exists(place / "svg/0000.svg"));
}
