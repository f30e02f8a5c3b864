#include <string>
#include <vector>

#include "openclose/io/search_checkpoint.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("checkpoints of a search take a twentieth of its time, and the last state can be written at any time", "[io][checkpoint]") {
  double now = 100.0;
  constexpr double cost = 0.5;
  std::vector<std::string> written;
  const auto write = [&](std::string state) {
    written.push_back(std::move(state));
    now += cost;
  };
  SearchCheckpoint checkpoint(write, [&] { return now; });
  checkpoint.keep("first");
  REQUIRE(written == std::vector<std::string>{"first"});
  now += 0.99 * cost / share_of_checkpoints;
  checkpoint.keep("second");
  CHECK(written.size() == 1);
  now += 0.02 * cost / share_of_checkpoints;
  checkpoint.keep("third");
  CHECK(written == std::vector<std::string>{"first", "third"});
  checkpoint.keep("fourth");
  CHECK(written.size() == 2);
  checkpoint.flush();
  CHECK(written == std::vector<std::string>{"first", "third", "fourth"});
  // Nothing is written twice.
  checkpoint.flush();
  CHECK(written.size() == 3);
}

TEST_CASE("a search of many short trials writes no more than its share allows", "[io][checkpoint]") {
  double now = 0.0, in_writing = 0.0;
  constexpr double cost = 0.02, trial = 0.01;
  SearchCheckpoint checkpoint(
      [&](const std::string&) {
        now += cost;
        in_writing += cost;
      },
      [&] { return now; });
  for (int i = 0; i < 1000; ++i) {
    now += trial;
    checkpoint.keep("state");
  }
  CHECK(in_writing <= share_of_checkpoints * now + cost);
  CHECK(in_writing >= 0.5 * share_of_checkpoints * now);
}
