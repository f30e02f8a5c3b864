#include <limits>

#include "openclose/core/archive.h"
#include "support/catch.h"

using openclose::Archive;

namespace {

enum class Colour { red, blue };

struct Part {
  double number = 0.0;
  bool flag = false;
  void exchange(Archive& archive) {
    auto& [a, b] = *this;
    archive(a, b);
  }
  bool operator==(const Part&) const = default;
};

struct Size {
  using Numbers = double;
  double width = 0.0, height = 0.0;
  bool operator==(const Size&) const = default;
};

struct Whole {
  std::vector<Part> parts;
  Size size;
  std::vector<Size> sizes;
  std::vector<double> numbers;
  std::vector<std::pair<int, long>> pairs;
  std::optional<double> some, none;
  std::string text;
  Eigen::Vector3d fixed = Eigen::Vector3d::Zero();
  Eigen::VectorXd dynamic;
  Colour colour = Colour::red;
  void exchange(Archive& archive) { archive(parts, size, sizes, numbers, pairs, some, none, text, fixed, dynamic, colour); }
};

Whole example() {
  Whole w;
  w.parts = {{0.1, true}, {-0.0, false}};
  w.size = {1.0 / 7.0, -2.0};
  w.sizes = {{0.3, 4.0}, {-0.0, 1e300}};
  w.numbers = {std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::infinity(), 1.0 / 3.0};
  w.pairs = {{-1, 5}, {2, 1L << 40}};
  w.some = 7.5;
  w.text = std::string("a\0b\n", 4);
  w.fixed = {1.0, 2.0, 0.1};
  w.dynamic = Eigen::VectorXd::LinSpaced(5, 0.0, 0.3);
  w.colour = Colour::blue;
  return w;
}

}  // namespace

TEST_CASE("what an archive collects comes back bit for bit", "[core][archive]") {
  Whole written = example();
  Archive out;
  CHECK_FALSE(out.reading());
  out(written);
  Archive in(out.bytes());
  CHECK(in.reading());
  Whole read;
  read.none = 3.0;
  read.numbers.resize(17);
  in(read);
  CHECK(in.at_end());
  CHECK(read.parts == written.parts);
  CHECK(std::signbit(read.parts[1].number));
  CHECK(read.size == written.size);
  CHECK(read.sizes == written.sizes);
  CHECK(std::signbit(read.sizes[1].width));
  CHECK(read.numbers == written.numbers);
  CHECK(read.pairs == written.pairs);
  CHECK(read.some == 7.5);
  CHECK_FALSE(read.none);
  CHECK(read.text == written.text);
  CHECK(read.fixed == written.fixed);
  CHECK(read.dynamic == written.dynamic);
  CHECK(read.colour == Colour::blue);
}

TEST_CASE("an archive that is too short says so, wherever it ends", "[core][archive]") {
  Whole written = example();
  Archive out;
  out(written);
  for (std::size_t length = 0; length < out.bytes().size(); ++length) {
    Archive in(out.bytes().substr(0, length));
    Whole read;
    CHECK_THROWS_AS(in(read), std::runtime_error);
  }
}
