#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "io/files.h"
#include "openclose/core/error.h"
#include "openclose/io/output_folder.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::TemporaryFolder;

TEST_CASE("an output folder is made with all above it", "[io][output_folder]") {
  const TemporaryFolder place;
  const OutputFolder folder(place / "a/b/c");
  CHECK(std::filesystem::is_directory(place / "a/b/c"));
  CHECK(folder.path() == place / "a/b/c");
}

TEST_CASE("an existing output folder keeps its other files", "[io][output_folder]") {
  const TemporaryFolder place;
  place.write("mine.txt", "kept");
  place.write("history.csv", "old and long");
  const OutputFolder folder(place.path());
  std::ofstream file = folder.open("history.csv");
  file << "new";
  finish(file, "history.csv");
  CHECK(test::text_of(place / "history.csv") == "new");
  CHECK(test::text_of(place / "mine.txt") == "kept");
}

TEST_CASE("files are written together or not at all", "[io][output_folder]") {
  const TemporaryFolder place;
  place.write("file", "x");
  SECTION("with the folders they need") {
    write_files({{place / "a/b/one", "1"}, {place / "a/two", "2"}, {place / "file", "3"}});
    CHECK(test::text_of(place / "a/b/one") == "1");
    CHECK(test::text_of(place / "a/two") == "2");
    CHECK(test::text_of(place / "file") == "3");
    CHECK_FALSE(std::filesystem::exists(place / "a/two.part"));
  }
  SECTION("none, and no folder, if one cannot be made") {
    CHECK_THROWS_AS(write_files({{place / "a/b/one", "1"}, {place / "file", "2"}, {place / "file/below", "3"}}), InputError);
    CHECK(place.entries() == std::set<std::string>{"file"});
    CHECK(test::text_of(place / "file") == "x");
  }
  SECTION("a folder is not written over") {
    std::filesystem::create_directory(place / "folder");
    CHECK_THROWS_WITH(write_files({{place / "one", "1"}, {place / "folder", "2"}}), ContainsSubstring("folder: is there and cannot be written over"));
    CHECK(place.entries() == std::set<std::string>{"file", "folder"});
  }
}

TEST_CASE("output folders that cannot be are refused", "[io][output_folder]") {
  const TemporaryFolder place;
  place.write("file", "x");
  SECTION("below a regular file") {
    CHECK_THROWS_AS(OutputFolder(place / "file/out"), InputError);
    CHECK_THROWS_WITH(OutputFolder(place / "file/out"), ContainsSubstring(place / "file/out: cannot write to this output folder"));
  }
  SECTION("a regular file itself") {
    CHECK_THROWS_AS(OutputFolder(place / "file"), InputError);
  }
  SECTION("where the system makes no folders") {
    CHECK_THROWS_AS(OutputFolder("/proc/openclose"), InputError);
  }
  CHECK(test::text_of(place / "file") == "x");
  CHECK(place.entries() == std::set<std::string>{"file"});
}

TEST_CASE("a folder in which a result could not be written is refused before anything is", "[io][output_folder]") {
  const TemporaryFolder place;
  std::filesystem::create_directory(place / "energy.csv");
  CHECK_THROWS_AS(OutputFolder(place.path()), InputError);
  CHECK_THROWS_WITH(OutputFolder(place.path()), ContainsSubstring("energy.csv: is there and cannot be written over"));
  CHECK(place.entries() == std::set<std::string>{"energy.csv"});
}

TEST_CASE("a file that is not written to its end is an error", "[io][output_folder]") {
  std::ofstream full("/dev/full");
  REQUIRE(full.is_open());
  full << "a row\n";
  CHECK_THROWS_AS(finish(full, "history.csv"), std::runtime_error);
}
