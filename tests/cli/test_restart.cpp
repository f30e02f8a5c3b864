// `run --restart`: the tables of a run that stopped and went on are those of one that never stopped, byte for byte.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "openclose/core/check_sum.h"
#include "support/catch.h"
#include "support/sanitized.h"

using Catch::Matchers::ContainsSubstring;
using openclose::test::CommandResult;
using openclose::test::text_of;
using openclose::test::Workplace;

namespace {

/// What a shell does to send a command this signal after it has had time to begin, which under a sanitizer it takes ten times as much of.
std::string stopped_by(const std::string& signal) {
#ifdef OPENCLOSE_ADDRESS_SANITIZER
  constexpr const char* seconds = "10";
#else
  constexpr const char* seconds = "1";
#endif
  return "timeout --foreground --preserve-status -s " + signal + " " + seconds + " ";
}

constexpr const char* motion =
    " --dt 0.001 --start unloaded --set output.every_s=0.003 --set output.snapshots_s=[0.02,0.1] --set output.snapshots_every_s=0.03";

/// A checkpoint whose check sum is right and whose state begins with a list that is longer than all of it.
/// \param before  [bytes] in front of that list
std::string with_endless_list(std::string checkpoint, std::size_t before) {
  const auto number_at = [&](std::size_t at) {
    std::uint64_t number = 0;
    std::memcpy(&number, checkpoint.data() + at, sizeof number);
    return static_cast<std::size_t>(number);
  };
  constexpr std::size_t number = sizeof(std::uint64_t), order_of_bytes = 4, time = 8;
  std::size_t at = checkpoint.find('\n') + 1 + order_of_bytes;
  at += number + number_at(at) + time;  // the scene
  std::size_t tables = number_at(at);
  for (at += number; tables > 0; --tables) at += number + number_at(at) + 2 * number;
  std::fill_n(checkpoint.begin() + static_cast<long>(at + number + before), number, '\x7f');
  checkpoint.resize(checkpoint.size() - number);
  const std::uint64_t sum = openclose::check_sum(checkpoint);
  return checkpoint.append(reinterpret_cast<const char*>(&sum), sizeof sum);
}

std::string hash_of(const Workplace& place, const std::string& results) {
  return nlohmann::json::parse(text_of(place.folder() / (results + "/summary.json"))).at("state_hash").get<std::string>();
}

void check_same_tables(const Workplace& place, const std::string& a, const std::string& b) {
  for (const char* table : {"history.csv", "energy.csv", "blocks.csv", "contacts.csv", "block_states.csv", "cracks.csv"}) {
    INFO(table);
    const std::string text = text_of(place.folder() / (a + "/" + table));
    CHECK(text.size() > 100);
    CHECK(text == text_of(place.folder() / (b + "/" + table)));
  }
  CHECK(hash_of(place, a) == hash_of(place, b));
}

}  // namespace

TEST_CASE("a run that was stopped goes on as if it had not been", "[cli][restart]") {
  for (const std::string method : {"soft", "hard", "shi", "dem"}) {
    INFO(method);
    const Workplace place(openclose::test::block_on_incline(35.0));
    const std::string common = "run scene.toml --contact " + method + motion;
    REQUIRE(place.run(common + " --end 0.15 -o whole").status == 0);
    REQUIRE(place.run(common + " --end 0.07 -o parts --set output.checkpoint_every_s=0.05").status == 0);
    const std::string history = text_of(place.folder() / "parts/history.csv");

    const CommandResult elsewhere = place.run(common + " --end 0.15 -o elsewhere --restart parts/checkpoint.bin");
    CHECK(elsewhere.status == 0);
    CHECK(elsewhere.errors.empty());
    check_same_tables(place, "whole", "elsewhere");
    CHECK(text_of(place.folder() / "parts/history.csv") == history);

    CHECK(place.run(common + " --end 0.15 -o parts --restart parts/checkpoint.bin").status == 0);
    check_same_tables(place, "whole", "parts");
  }
}

TEST_CASE("a killed run goes on from its last checkpoint", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(35.0));
  const std::string common = std::string("run scene.toml") + motion + " --end 0.15 --set output.checkpoint_every_s=0.04";
  REQUIRE(place.run(common + " -o whole").status == 0);
  // The state of the disk some rows after a checkpoint: longer tables, an unfinished line.
  REQUIRE(place.run(std::string("run scene.toml") + motion + " --end 0.04 --set output.checkpoint_every_s=0.04 -o killed").status == 0);
  std::ofstream(place.folder() / "killed/history.csv", std::ios::app) << "0.0429,block,1.2";
  // One that is killed has listed the names of its files alone, without their sums.
  std::string names;
  for (const std::string& line : openclose::test::lines_of(place.folder() / "killed/.openclose"))
    names += (line.starts_with('#') ? line : line.substr(0, line.find(' '))) + '\n';
  place.folder().write("killed/.openclose", names);
  CHECK(place.run(common + " -o killed --restart killed/checkpoint.bin").status == 0);
  check_same_tables(place, "whole", "killed");
}

TEST_CASE("a run that goes on from its end has the files that it had", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(35.0));
  const std::string common = std::string("run scene.toml") + motion + " --set output.checkpoint_every_s=0.04 --set output.milestones_m=[1e-6,9] ";
  // Each ends between two rows.
  for (const std::string end : {"--end 0.1 ", "--end 0.1005 ", "--end 0.1 --set end.displacement_m=1e-5 "}) {
    INFO(end);
    const auto times = [&](const std::string& folder) {
      std::vector<std::string> list;
      for (const std::string& line : openclose::test::lines_of(place.folder() / (folder + "/milestones.csv")))
        list.push_back(openclose::test::fields_of(line)[0] + openclose::test::fields_of(line)[1]);
      return list;
    };
    REQUIRE(place.run(common + end + "-o whole").status == 0);
    std::filesystem::copy(place.folder() / "whole", place.folder() / "again");
    for (const std::string into : {"again", "elsewhere"}) {
      INFO(into);
      CHECK(place.run(common + end + "-o " + into + " --restart again/checkpoint.bin").status == 0);
      check_same_tables(place, "whole", into);
      CHECK(times(into) == times("whole"));
      CHECK(std::filesystem::exists(place.folder() / (into + "/checkpoint.bin")));
    }
    for (const char* folder : {"whole", "again", "elsewhere"}) std::filesystem::remove_all(place.folder() / folder);
  }
}

TEST_CASE("a run that filled the disk goes on from its last checkpoint", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(35.0));
  const std::string common = std::string("run scene.toml") + motion + " --end 0.3 --set output.checkpoint_every_s=0.01 -o ";
  REQUIRE(place.run(common + "whole").status == 0);
  REQUIRE(text_of(place.folder() / "whole/energy.csv").size() > 20 * 512);
  CHECK(place.run(common + "full", "ulimit -f 20; ").status == 3);
  CHECK_FALSE(std::filesystem::exists(place.folder() / "full/summary.json"));
  CHECK(place.run(common + "full --restart full/checkpoint.bin").status == 0);
  check_same_tables(place, "whole", "full");
}

TEST_CASE("a run goes on into a folder that has results", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(35.0));
  const std::string common = std::string("run scene.toml") + motion;
  REQUIRE(place.run(common + " --end 0.15 -o whole").status == 0);
  REQUIRE(place.run(common + " --end 0.07 -o parts --set output.checkpoint_every_s=0.05 --set output.milestones_m=[9]").status == 0);
  const std::string checkpoint = text_of(place.folder() / "parts/checkpoint.bin");
  const auto goes_on = [&](const std::string& arguments) {
    CHECK(place.run(common + " --end 0.15 --set output.milestones_m=[9] " + arguments).status == 0);
    CHECK(text_of(place.folder() / "parts/checkpoint.bin") == checkpoint);
  };
  SECTION("of another run: they go, the checkpoint and its tables stay") {
    REQUIRE(place.run(common + " --end 0.3 -o other --set output.checkpoint_every_s=0.05").status == 0);
    goes_on("-o other --restart parts/checkpoint.bin");
    CHECK_FALSE(std::filesystem::exists(place.folder() / "other/checkpoint.bin"));
    check_same_tables(place, "whole", "other");
  }
  SECTION("its own, under another path") {
    std::filesystem::create_directory_symlink("parts", place.folder() / "link");
    goes_on("-o link --restart parts/checkpoint.bin");
    check_same_tables(place, "whole", "parts");
  }
  SECTION("its own, from a checkpoint under another name") {
    std::filesystem::rename(place.folder() / "parts/checkpoint.bin", place.folder() / "parts/saved.bin");
    CHECK(place.run(common + " --end 0.15 --set output.milestones_m=[9] -o parts --restart parts/saved.bin").status == 0);
    check_same_tables(place, "whole", "parts");
  }
  SECTION("its own, seen from within") {
    std::filesystem::copy(place.folder() / "parts/checkpoint.bin", place.folder() / "parts/saved.bin");
    const std::string within = "cd parts && ";
    CHECK(
        place.run("run ../scene.toml" + std::string(motion) + " --end 0.15 --set output.milestones_m=[9] -o . --restart saved.bin", within).status ==
        0);
    CHECK(text_of(place.folder() / "parts/checkpoint.bin") == checkpoint);
    check_same_tables(place, "whole", "parts");
  }
}

TEST_CASE("a restart that cannot be writes nothing", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(35.0));
  const std::string common = std::string("run scene.toml") + motion;
  REQUIRE(place.run(common + " --end 0.05 -o out --set output.checkpoint_every_s=1").status == 0);
  const auto refused = [&](const std::string& arguments, const std::string& reason) {
    const CommandResult result = place.run(arguments + " -o other");
    CHECK(result.status == 2);
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], ContainsSubstring(reason));
    CHECK_FALSE(std::filesystem::exists(place.folder() / "other"));
  };
  refused(common + " --end 0.1 --contact hard --restart out/checkpoint.bin", "it belongs to another scene");
  refused(common + " --end 0.02 --restart out/checkpoint.bin", "lies before the checkpoint");
  refused(common + " --end 0.1 --restart out/history.csv", "this is no checkpoint");
  refused(common + " --end 0.1 --restart nothing.bin", "there is no such file");
}

TEST_CASE("a checkpoint whose state is damaged is refused before anything is written", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  const std::string run = std::string("run scene.toml") + motion + " --end 0.05 -o out --set output.checkpoint_every_s=1",
                    fos = "fos scene.toml -o out --set strength_reduction.width=1e-6";
  const std::string command = GENERATE_COPY(values({run, fos}));
  // A search leaves a checkpoint where it is broken off.
  place.run(command, command == fos ? openclose::test::full_under("out/trials.csv") : "");
  const std::string checkpoint = place.folder() / "out/checkpoint.bin";
  REQUIRE(std::filesystem::exists(checkpoint));
  const std::size_t before_list = command == fos ? 0 : 1;  // whether there is a start
  place.folder().write("out/checkpoint.bin", with_endless_list(text_of(checkpoint), before_list));
  const auto before = openclose::test::contents(place.folder() / "out");
  const CommandResult result = place.run(command + " --restart out/checkpoint.bin");
  CHECK(result.status == 2);
  REQUIRE(result.errors.size() == 1);
  CHECK_THAT(result.errors[0], ContainsSubstring("out/checkpoint.bin: the saved state is shorter than what it should hold"));
  CHECK(openclose::test::contents(place.folder() / "out") == before);
}

TEST_CASE("who stops a run while it settles is told how to go on, or keeps the results of the one before and is told how to run again",
          "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  REQUIRE(place.run("new wall -o wall.toml -q").status == 0);
  REQUIRE(place.run("run scene.toml" + std::string(motion) + " --end 0.05 -o out").status == 0);
  const auto before = openclose::test::contents(place.folder() / "out");
  // Rounding leaves more than this, so that it settles for ever.
  const std::string settled =
      " --start settled --dt 0.001 --end 1 --set settle.unbalanced_fraction=1e-300 --set settle.max_steps=1000000000 "
      "--set settle.max_explicit_steps=1000000000 -o out";
  const std::string stop = stopped_by("INT");
  SECTION("with an explicit method") {
    const CommandResult stopped = place.run("run wall.toml --contact dem" + settled, stop);
    CHECK(stopped.status == 130);
    REQUIRE_FALSE(stopped.errors.empty());
    CHECK_THAT(stopped.errors.back(),
               ContainsSubstring("stopped while the start was settling") && ContainsSubstring("to run again: openclose run 'wall.toml' "));
    CHECK(openclose::test::contents(place.folder() / "out") == before);
  }
  SECTION("or, with another one, gets a state to go on from") {
    std::string arguments = "run wall.toml --contact soft" + settled;
    for (int i = 0; i < 2; ++i) {
      const CommandResult stopped = place.run(arguments, stop);
      CHECK(stopped.status == 130);
      REQUIRE_FALSE(stopped.errors.empty());
      CHECK_THAT(stopped.errors.back(), ContainsSubstring("stopped while the start was settling") && ContainsSubstring(" of the weight unbalanced") &&
                                            ContainsSubstring("to go on: openclose run 'wall.toml' ") && ContainsSubstring("--restart"));
      CHECK(std::filesystem::exists(place.folder() / "out/checkpoint.bin"));
      CHECK_FALSE(std::filesystem::exists(place.folder() / "out/history.csv"));
      arguments = "run wall.toml --contact soft" + settled + " --restart out/checkpoint.bin";
    }
  }
}

TEST_CASE("the command that goes on is one for a shell, whatever the names are", "[cli][restart]") {
  const Workplace place("");
  place.folder().write("it's a slope.toml", openclose::test::block_on_incline(35.0));
  const CommandResult stopped = place.run("run \"it's a slope.toml\"" + std::string(motion) + " --end 1000 -o \"what's left\"", stopped_by("INT"));
  CHECK(stopped.status == 130);
  REQUIRE(stopped.errors.size() == 1);
  const std::string& told = stopped.errors[0];
  const std::size_t arguments = told.find("openclose run ");
  REQUIRE(arguments != std::string::npos);
  const CommandResult again = place.run(told.substr(arguments + std::string("openclose ").size()), stopped_by("INT"));
  CHECK(again.status == 130);
  CHECK_THAT(again.errors.at(0), ContainsSubstring("stopped at t = "));
}

// `timeout` in the foreground sends one signal; else it sends it to its group as well, and the second one ends a command at once.
TEST_CASE("a run that is stopped by a signal saves its state and says how to go on from it", "[cli][restart]") {
  struct Stop {
    const char* signal;
    int status;
  };
  const Stop stop = GENERATE(values<Stop>({{"INT", 130}, {"TERM", 143}}));
  INFO(stop.signal);
  const Workplace place(openclose::test::block_on_incline(35.0));
  const std::string common = std::string("run scene.toml") + motion;
  const CommandResult stopped = place.run(common + " --end 1000 -o parts", stopped_by(stop.signal));
  CHECK(stopped.status == stop.status);
  REQUIRE(stopped.errors.size() == 1);
  CHECK_THAT(stopped.errors[0], ContainsSubstring("stopped at t = ") && ContainsSubstring("--restart 'parts/checkpoint.bin'"));
  const double time = nlohmann::json::parse(text_of(place.folder() / "parts/summary.json")).at("time_s").get<double>();
  const std::string end = " --end " + std::to_string(time + 0.05);
  CHECK(place.run(common + end + " -o parts --restart parts/checkpoint.bin").status == 0);
  CHECK(place.run(common + end + " -o whole").status == 0);
  check_same_tables(place, "whole", "parts");
}

TEST_CASE("a search for the factor of safety that is stopped tells what it knows", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  // The search ends by itself, or tells what it knows: it has found a stable factor by the time of its first look at the signal.
  const CommandResult stopped = place.run(
      "fos scene.toml --contact dem --set strength_reduction.definition=large_displacements --set settle.first_dt_s=1e-7 -o out", stopped_by("INT"));
  CHECK(stopped.status == 130);
  REQUIRE(stopped.errors.size() == 1);
  CHECK_THAT(stopped.errors[0], ContainsSubstring("stopped ") && ContainsSubstring("state saved in out"));
  const nlohmann::json summary = nlohmann::json::parse(text_of(place.folder() / "out/summary.json"));
  CHECK_THAT(summary.at("reason").get<std::string>(), ContainsSubstring("stopped"));
  CHECK(summary.at("verdict").get<std::string>() != "certified");
}

TEST_CASE("who stops a search in its first trial keeps the results of the one before, and is told how to run again", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  REQUIRE(place.run("fos scene.toml -o out").status == 0);
  const auto before = openclose::test::contents(place.folder() / "out");
  // The waves of dem take seconds to come to rest in so high a wall.
  REQUIRE(place.run("new wall --courses 160 --bricks 30 -o wall.toml -q").status == 0);
  const CommandResult stopped = place.run("fos wall.toml --contact dem -o out", stopped_by("INT"));
  CHECK(stopped.status == 130);
  REQUIRE_FALSE(stopped.errors.empty());
  CHECK_THAT(stopped.errors.back(), ContainsSubstring("stopped in the first trial") && ContainsSubstring("to run again: openclose fos 'wall.toml' "));
  CHECK(openclose::test::contents(place.folder() / "out") == before);
}

TEST_CASE("a search whose tables cannot be written goes on from its checkpoint to the same answer", "[cli][restart]") {
  const Workplace place(openclose::test::block_on_incline(20.0));
  REQUIRE(place.run("fos scene.toml -o whole").status == 0);
  CHECK_FALSE(std::filesystem::exists(place.folder() / "whole/checkpoint.bin"));
  CHECK(place.run("fos scene.toml -o parts", openclose::test::full_under("parts/trials.csv")).status == 3);
  REQUIRE(std::filesystem::exists(place.folder() / "parts/checkpoint.bin"));

  SECTION("in its folder") {
    CHECK(place.run("fos scene.toml -o parts --restart parts/checkpoint.bin").status == 0);
    for (const char* table : {"trials.csv", "blocks.csv", "contacts.csv", "block_states.csv", "cracks.csv", "mechanism.csv"}) {
      INFO(table);
      CHECK(text_of(place.folder() / ("whole/" + std::string(table))) == text_of(place.folder() / ("parts/" + std::string(table))));
    }
    CHECK(hash_of(place, "whole") == hash_of(place, "parts"));
    CHECK_FALSE(std::filesystem::exists(place.folder() / "parts/checkpoint.bin"));
  }
  SECTION("not with another scene, and not as a run") {
    const auto refused = [&](const std::string& arguments, const std::string& reason) {
      const CommandResult result = place.run(arguments + " -o other --restart parts/checkpoint.bin");
      CHECK(result.status == 2);
      REQUIRE(result.errors.size() == 1);
      CHECK_THAT(result.errors[0], ContainsSubstring(reason));
      CHECK_FALSE(std::filesystem::exists(place.folder() / "other"));
    };
    refused("fos scene.toml --set joint[0].friction_angle_deg=21", "it belongs to another scene");
    refused("fos scene.toml --set strength_reduction.width=1e-5", "it belongs to another scene");
    // With the step that fos takes where a scene has none, so that the scenes are the same.
    refused("run scene.toml --end 1 --dt 1", "it was written by openclose fos; accepted: a checkpoint of openclose run");
  }
}
