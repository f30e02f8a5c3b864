#include "openclose/draft/written_heading.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("a text is known as written until one character of it is another", "[draft][heading]") {
  const std::string text = "title = \"a\"\nb = 1\n";
  const std::string file = with_heading(text);
  CHECK(file.ends_with("\n" + text));
  CHECK(file.starts_with("# Written by openclose new "));
  CHECK(is_as_written(file));
  for (std::size_t i = 0; i < file.size(); ++i) {
    std::string edited = file;
    edited[i] = edited[i] == 'x' ? 'y' : 'x';
    CHECK_FALSE(is_as_written(edited));
  }
  CHECK_FALSE(is_as_written(file + "\n"));
  CHECK_FALSE(is_as_written(text));
  CHECK_FALSE(is_as_written(""));
  CHECK_FALSE(is_as_written("title"));
}
