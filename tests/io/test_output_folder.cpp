#include <filesystem>
#include <fstream>
#include <optional>

#include "io/files.h"
#include "openclose/core/error.h"
#include "openclose/io/folder_lock.h"
#include "openclose/io/output_folder.h"
#include "openclose/io/part_files.h"
#include "openclose/io/results.h"
#include "openclose/io/text_files.h"
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

TEST_CASE("a new file is none that is there, nor one that a link leads to", "[io][output_folder]") {
  const TemporaryFolder place;
  place.write("mine.txt", "kept");
  std::filesystem::create_symlink(place / "elsewhere.txt", place / "link.txt");
  CHECK_FALSE(make_new(place / "mine.txt"));
  CHECK_FALSE(make_new(place / "link.txt"));
  CHECK_FALSE(std::filesystem::exists(place / "elsewhere.txt"));
  CHECK(make_new(place / "new.txt"));
}

TEST_CASE("an existing output folder keeps its other files", "[io][output_folder]") {
  const TemporaryFolder place;
  place.write("mine.txt", "kept");
  place.write("history.csv", "old and long");
  const OutputFolder folder(place.path());
  std::ofstream file = folder.open("history.csv");
  file << "new";
  finish(file, place / "history.csv");
  CHECK(test::text_of(place / "history.csv") == "new");
  CHECK(test::text_of(place / "mine.txt") == "kept");
}

TEST_CASE("files are written together or not at all", "[io][output_folder]") {
  const TemporaryFolder place;
  place.write("file", "x\n1");
  SECTION("with the folders they need") {
    write_files({{place / "a/b/one", "1"}, {place / "a/two", "2"}, {place / "file", "x\n2"}});
    CHECK(test::text_of(place / "a/b/one") == "1");
    CHECK(test::text_of(place / "a/two") == "2");
    CHECK(test::text_of(place / "file") == "x\n2");
    CHECK_FALSE(std::filesystem::exists(place / "a/two.part"));
  }
  SECTION("none, and no folder, if one cannot be made") {
    CHECK_THROWS_AS(write_files({{place / "a/b/one", "1"}, {place / "file", "x\n2"}, {place / "file/below", "3"}}), InputError);
    CHECK(place.entries() == std::set<std::string>{"file"});
    CHECK(test::text_of(place / "file") == "x\n1");
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
  std::filesystem::remove(place / "energy.csv");
  // What an analysis before has left in the folder of a format is removed, too.
  std::filesystem::create_directories(place / "svg/0000.svg");
  CHECK_THROWS_WITH(OutputFolder(place.path()), ContainsSubstring("svg/0000.svg: is there and cannot be written over"));
}

TEST_CASE("a file that is not written to its end is an error", "[io][output_folder]") {
  for (const auto& close : {finish, finish_growing}) {
    std::ofstream full("/dev/full");
    REQUIRE(full.is_open());
    full << "a row\n";
    CHECK_THROWS_AS(close(full, "out/history.csv"), WriteError);
  }
}

TEST_CASE("a table that is not written is an error at once, before a checkpoint counts on it", "[io][output_folder]") {
  struct Table : RunTable {
    explicit Table(const OutputFolder& folder) : RunTable(folder, "table.csv", "column", nullptr) {}
    using RunTable::file_;
    using RunTable::require_written;
  };
  const TemporaryFolder place;
  Table table(OutputFolder(place.path()));
  table.file_.close();
  table.file_.open("/dev/full");
  table.file_ << "a row\n";
  CHECK_NOTHROW(table.require_written());
  CHECK_THROWS_WITH(table.written(), ContainsSubstring(place / "table.csv"));
  CHECK_THROWS_AS(table.require_written(), WriteError);
}

TEST_CASE("results are removed by their names, nothing else is", "[io][output_folder]") {
  const TemporaryFolder place;
  for (const char* name : {"history.csv", "summary.json", "checkpoint.bin", "mine.txt", "history.csv.old"}) place.write(name, "x");
  const OutputFolder folder(place.path());
  folder.remove_last_results();
  CHECK(place.entries() == std::set<std::string>{"history.csv", "checkpoint.bin", "mine.txt", "history.csv.old"});
  folder.remove_results();
  CHECK(place.entries() == std::set<std::string>{"mine.txt", "history.csv.old"});
}

TEST_CASE("the copy of the scene takes the place of no other file", "[io][output_folder]") {
  const TemporaryFolder place;
  SECTION("its own is written over and removed") {
    const OutputFolder folder(place.path());
    folder.write_scene_copy("title = 'first'\n");
    OutputFolder(place.path()).write_scene_copy("title = 'second'\n");
    CHECK_THAT(test::text_of(place / scene_copy_name), ContainsSubstring("second") && !ContainsSubstring("first"));
    folder.remove_results();
    CHECK(place.entries().empty());
  }
  SECTION("somebody's own scene of that name stays, and the folder is refused") {
    place.write(scene_copy_name, "title = 'mine'\n");
    CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}), ContainsSubstring("scene_as_read.toml: is there and has not been written by openclose"));
    CHECK(test::text_of(place / scene_copy_name) == "title = 'mine'\n");
  }
  SECTION("a copy that is itself the scene to be read is refused") {
    const OutputFolder folder(place.path());
    folder.claim({});
    folder.write_scene_copy("title = 'first'\n");
    CHECK_THROWS_WITH(folder.claim({place / scene_copy_name}), ContainsSubstring("is read, and a result of this name would replace it"));
    CHECK_NOTHROW(folder.claim({place / "other.toml"}));
  }
}

TEST_CASE("a folder knows the checkpoints that lie in it", "[io][output_folder]") {
  const TemporaryFolder place, other;
  for (const TemporaryFolder* folder : {&place, &other}) folder->write("checkpoint.bin", "x");
  place.write("saved.bin", "x");
  std::filesystem::create_symlink(place / "checkpoint.bin", other / "latest.bin");
  const OutputFolder folder(place.path());
  CHECK(folder.has(place / "checkpoint.bin"));
  CHECK(folder.has(place / "saved.bin"));
  CHECK(folder.has(place / "../" + std::filesystem::path(place.path()).filename().string() + "/checkpoint.bin"));
  CHECK(folder.has(other / "latest.bin"));
  CHECK_FALSE(folder.has(other / "checkpoint.bin"));
}

TEST_CASE("a claimed folder keeps what is not ours", "[io][output_folder]") {
  const TemporaryFolder place;
  SECTION("a table of somebody else's is not replaced") {
    place.write("history.csv", "mine");
    CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}), ContainsSubstring("history.csv: is there and has not been written by openclose"));
    CHECK(place.entries() == std::set<std::string>{"history.csv"});
  }
  SECTION("nor are files in the folder of a format") {
    std::filesystem::create_directory(place / "svg");
    place.write("svg/0001.svg", "mine");
    CHECK_THROWS_AS(OutputFolder(place.path()).claim({}), InputError);
    CHECK(test::text_of(place / "svg/0001.svg") == "mine");
  }
  SECTION("a file that is read is named, by whatever path it is read") {
    const OutputFolder folder(place.path());
    folder.claim({});
    folder.open_growing("energy.csv") << "t a\n";
    std::filesystem::create_symlink(place / "energy.csv", place / "record.csv");
    CHECK_THROWS_WITH(folder.claim({place / "record.csv"}), ContainsSubstring("record.csv: is read, and a result of this name would replace it"));
    CHECK(test::text_of(place / "energy.csv") == "t a\n");
  }
  SECTION("what was claimed before may be replaced") {
    const OutputFolder folder(place.path());
    folder.claim({});
    folder.open_growing("history.csv") << "ours";
    CHECK_NOTHROW(OutputFolder(place.path()).claim({}));
    OutputFolder(place.path()).remove_results();
    CHECK(place.entries() == std::set<std::string>{list_name});
  }
  SECTION("what comes into the folder after the analysis is not ours, but for pictures that name us") {
    const OutputFolder folder(place.path());
    folder.claim({});
    folder.open_growing("energy.csv") << "ours";
    folder.list_results();
    CHECK_NOTHROW(OutputFolder(place.path()).claim({}));
    folder.list_results();
    place.write("drawing.svg", "<svg/>\n" + seal_of("<svg/>\n", Seal::xml));
    CHECK_NOTHROW(OutputFolder(place.path()).claim({}));
    folder.list_results();
    for (const char* name : {"report.html", "history.csv", "curve.csv"}) {
      place.write(name, "mine");
      folder.list_results();
      CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}), ContainsSubstring(std::string(name) + ": is there and has not been written by"));
      std::filesystem::remove(place / name);
    }
  }
  SECTION("a folder without a list has nothing of ours: results may have been copied there, and changed") {
    const OutputFolder folder(place.path());
    folder.write_scene_copy("title = 'first'\n");
    CHECK_THROWS_WITH(folder.claim({}), ContainsSubstring("scene_as_read.toml: is there and has not been written by openclose"));
    place.write("history.csv", "mine");
    CHECK_THROWS_WITH(folder.claim({}), ContainsSubstring("history.csv: is there and has not been written by openclose"));
    CHECK(test::text_of(place / "history.csv") == "mine");
  }
}

TEST_CASE("a file gets its name when it is complete", "[io][output_folder]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  place.write("curve.csv", "old");
  {
    std::ofstream file = folder.open("curve.csv");
    file << "new";
    CHECK(test::text_of(place / "curve.csv") == "old");
    finish(file, place / "curve.csv");
  }
  CHECK(test::text_of(place / "curve.csv") == "new");
  CHECK(place.entries() == std::set<std::string>{"curve.csv"});
}

TEST_CASE("a file that is removed while it is written is an error", "[io][output_folder]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  std::ofstream file = folder.open_growing("history.csv");
  std::filesystem::remove(place / "history.csv");
  CHECK_THROWS_WITH(finish(file, place / "history.csv"), ContainsSubstring("has been removed while it was written"));
  CHECK_THROWS_AS(finish(file, place / "history.csv"), WriteError);
}

TEST_CASE("a whole file does not take the place of one that is not as openclose has written it", "[io][output_folder]") {
  const TemporaryFolder place;
  const std::string mine = "<svg>\n<!-- drawn by openclose, and by me -->";
  place.write("notes.svg", mine);
  const auto write = [&](const std::string& name, const std::string& text) { write_files({{place / name, text, false, Seal::xml}}); };
  CHECK_THROWS_WITH(write("notes.svg", "<svg>\n<!-- drawn by openclose -->"),
                    ContainsSubstring("has not been written by openclose, or edited since"));
  CHECK(test::text_of(place / "notes.svg") == mine);
  CHECK_NOTHROW(write("new.svg", "<svg>1"));
  CHECK_NOTHROW(write("new.svg", "<svg>2"));
  CHECK(test::text_of(place / "new.svg").starts_with("<svg>2"));
  std::ofstream(place / "new.svg", std::ios::app) << "edited";
  CHECK_THROWS_AS(write("new.svg", "<svg>3"), InputError);
}

TEST_CASE("what has the name that a file has until it is complete stays, and nothing is written", "[io][output_folder]") {
  const TemporaryFolder place;
  place.write("mine", "kept");
  SECTION("a file") {
    place.write("new.svg.part", "mine");
  }
  SECTION("a link, also one that leads to what could be written over") {
    std::filesystem::create_symlink("mine", place / "new.svg.part");
  }
  SECTION("a link that leads nowhere yet") {
    std::filesystem::create_symlink("nowhere", place / "new.svg.part");
  }
  const auto before = place.entries();
  CHECK_THROWS_WITH(write_files({{place / "new.svg", "text"}}), ContainsSubstring("new.svg.part: is there"));
  CHECK(place.entries() == before);
  CHECK(test::text_of(place / "mine") == "kept");
}

TEST_CASE("a claimed folder lists what is made in it, when it is made", "[io][output_folder]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  folder.claim({});
  // As a run that is killed leaves it.
  const auto refused_after = [&](const std::string& name) {
    place.write(name, "mine");
    CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}), ContainsSubstring(name + ": is there and has not been written by openclose"));
    CHECK(test::text_of(place / name) == "mine");
    std::filesystem::remove(place / name);
  };
  SECTION("not what is not") {
    for (const char* name : {"history.csv", "curve.csv", "history.csv.part", "summary.json.part", "checkpoint.bin"}) refused_after(name);
  }
  SECTION("a table at once, and nothing with its name and an ending") {
    folder.open_growing("history.csv") << "ours";
    refused_after("history.csv.part");
    OutputFolder(place.path()).claim({});
  }
  SECTION("a whole file when it is complete, until then only what it is called by then") {
    std::ofstream file = folder.open("summary.json");
    refused_after("summary.json");
    finish(file, place / "summary.json");
    OutputFolder(place.path()).claim({});
    CHECK(place.entries() == std::set<std::string>{list_name, "summary.json"});
  }
  SECTION("a whole file that replaces its own, in between too") {
    for (int i = 0; i < 2; ++i) {
      std::ofstream file = folder.open("summary.json");
      OutputFolder(place.path()).require_ours({});
      finish(file, place / "summary.json");
    }
  }
  SECTION("a file that has come in between stays") {
    for (const char* name : {"summary.json", "summary.json.part", "history.csv"}) {
      place.write(name, "mine");
      CHECK_THROWS_AS(name == std::string("history.csv") ? folder.open_growing("history.csv") : folder.open("summary.json"), WriteError);
      CHECK(test::text_of(place / name) == "mine");
      std::filesystem::remove(place / name);
    }
  }
}

TEST_CASE("files of formats are listed one by one", "[io][output_folder]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  folder.claim({});
  folder.write_format_file("svg", "0001.svg", "ours");
  SECTION("also where a run was killed, which only knows the names") {
    place.write("svg/0001.svg", "edited");
    CHECK_NOTHROW(OutputFolder(place.path()).claim({}));
  }
  SECTION("at its end with what is in them") {
    folder.list_results();
    CHECK_NOTHROW(OutputFolder(place.path()).require_ours({}));
    place.write("svg/0001.svg", "edited");
    CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}), ContainsSubstring("svg/0001.svg: has been changed since openclose has written it"));
    return;
  }
  SECTION("others stay, and are not written over") {
    place.write("svg/0002.svg", "mine");
    CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}), ContainsSubstring("svg/0002.svg: is there and has not been written by openclose"));
    CHECK_THROWS_AS(folder.write_format_file("svg", "0002.svg", "ours"), WriteError);
    CHECK(test::text_of(place / "svg/0002.svg") == "mine");
  }
  folder.remove_results();
  CHECK_FALSE(std::filesystem::exists(place / "svg/0001.svg"));
}

TEST_CASE("a table goes on as a new file, not in what has another name, too", "[io][output_folder]") {
  const TemporaryFolder place;
  place.write("history.csv", "kept\ngone\n");
  std::filesystem::create_hard_link(place / "history.csv", place / "copy");
  const OutputFolder folder(place.path());
  std::ofstream file = folder.open_growing("history.csv", place / "history.csv", 5);
  file << "new\n";
  finish_growing(file, place / "history.csv");
  CHECK(test::text_of(place / "history.csv") == "kept\nnew\n");
  CHECK(test::text_of(place / "copy") == "kept\ngone\n");
  CHECK(place.entries() == std::set<std::string>{"history.csv", "copy"});
}

TEST_CASE("a damaged list makes nothing ours", "[io][output_folder]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  folder.claim({});
  std::ofstream(place / list_name, std::ios::app) << "\ncurve.csv not-a-sum\n";
  place.write("curve.csv", "mine");
  CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}), ContainsSubstring("curve.csv: is there and has not been written by openclose"));
  std::filesystem::remove(place / "curve.csv");
  // As a full disk cuts it.
  const std::string list = test::text_of(place / list_name);
  place.write(".openclose.part", list.substr(0, 20));
  CHECK_NOTHROW(OutputFolder(place.path()).claim({}));
  CHECK_FALSE(std::filesystem::exists(place / ".openclose.part"));
}

TEST_CASE("what an analysis that is killed after its claim leaves is known by its sum", "[io][output_folder]") {
  const TemporaryFolder place;
  const OutputFolder folder(place.path());
  folder.claim({});
  folder.open_growing("history.csv") << "ours";
  folder.list_results();
  folder.claim({});
  place.write("history.csv", "edited");
  CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}), ContainsSubstring("history.csv: has been changed since"));
  // Begun anew it is its own again, however it ends.
  folder.open_growing("history.csv") << "of the next";
  CHECK_NOTHROW(OutputFolder(place.path()).claim({}));
}

TEST_CASE("a folder is held by one, as long as that one lives", "[io][folder_lock]") {
  const TemporaryFolder place;
  std::filesystem::create_directory(place / "out");
  std::optional<FolderLock> first(place / "out");
  CHECK_THROWS_WITH(FolderLock(place / "out"), ContainsSubstring("out: another openclose is writing to this folder"));
  CHECK_NOTHROW(FolderLock(place.path()));
  CHECK_NOTHROW(first->require_same_folder());
  first.reset();
  const FolderLock second(place / "out");
  std::filesystem::rename(place / "out", place / "old");
  CHECK_THROWS_AS(second.require_same_folder(), WriteError);
  std::filesystem::create_directory(place / "out");
  CHECK_THROWS_WITH(second.require_same_folder(), ContainsSubstring("another folder has this name by now, or none"));
}

TEST_CASE("a list that is none of ours is not replaced", "[io][output_folder]") {
  const TemporaryFolder place;
  for (const char* name : {".openclose", ".openclose.part"}) {
    place.write(name, "title = 'mine'\n");
    CHECK_THROWS_WITH(OutputFolder(place.path()).claim({}),
                      ContainsSubstring(std::string(name) + ": is there and has not been written by openclose"));
    CHECK(test::text_of(place / name) == "title = 'mine'\n");
    std::filesystem::remove(place / name);
  }
}

TEST_CASE("a seal holds as long as nobody edits what stands above it", "[io][seal]") {
  for (const Seal seal : {Seal::hash, Seal::xml}) {
    for (const std::string text : {"", "a", "a\n# b\n<!-- c -->\n"}) {
      const std::string file = text + seal_of(text, seal);
      CHECK(is_sealed(file, seal));
      CHECK_FALSE(is_sealed("b" + file, seal));
      CHECK_FALSE(is_sealed(file + " ", seal));
      CHECK_FALSE(is_sealed(text, seal));
      CHECK_FALSE(is_sealed(file, Seal::none));
    }
  }
  CHECK(seal_of("text", Seal::none).empty());
}
