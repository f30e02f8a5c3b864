#include <limits>
#include <vector>

#include "openclose/integrator/parts.h"
#include "support/catch.h"

using namespace openclose;

namespace {

/// Rows 0 to 9 in a chain, two contacts between neighbours and one from each end to a fixed block: contact 0 and 19.
constexpr int rows = 10, contacts = 20, no_limit = rows;

Neighbourhood chain() {
  const auto rows_of = [](std::size_t c) {
    const int left = (static_cast<int>(c) - 1) / 2;
    if (c == 0) return std::pair(rows, 0);
    if (c == contacts - 1) return std::pair(rows - 1, rows);
    return c % 2 == 0 ? std::pair(left, left + 1) : std::pair(left + 1, left);
  };
  Neighbourhood neighbourhood;
  neighbourhood.build(rows, contacts, rows_of);
  return neighbourhood;
}

}  // namespace

TEST_CASE("seeds that are far from each other make parts of their own, the small ones first", "[integrator][parts]") {
  const std::vector<Part> parts = chain().parts({3, 9}, 1, no_limit);
  REQUIRE(parts.size() == 2);
  CHECK(parts[0].rows == std::vector<int>{8, 9});
  CHECK(parts[0].contacts == std::vector<int>{15, 16, 17, 18, 19});
  CHECK(parts[1].rows == std::vector<int>{2, 3, 4});
  CHECK(parts[1].contacts == std::vector<int>{3, 4, 5, 6, 7, 8, 9, 10});
}

TEST_CASE("seeds whose rings meet make one part", "[integrator][parts]") {
  CHECK(chain().parts({6, 3}, 0, no_limit).size() == 2);
  const std::vector<Part> parts = chain().parts({6, 3}, 1, no_limit);
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].rows == std::vector<int>{2, 3, 4, 5, 6, 7});
  CHECK(chain().parts({3, 6}, 1, 5).empty());
  CHECK(chain().parts({}, 2, no_limit).empty());
}

TEST_CASE("the most unbalanced rows are those near the largest residual, and all the others if they are few", "[integrator][parts]") {
  const std::vector<double> residuals{2.0, 500.0, 1000.0, 0.5, 30.0, 0.0, 20.0, 1.5};
  CHECK(most_unbalanced(residuals, 1000.0, 1.0, 0.1, 0) == std::vector<int>{1, 2});
  CHECK(most_unbalanced(residuals, 1000.0, 1.0, 0.1, 3) == std::vector<int>{1, 2});
  CHECK(most_unbalanced(residuals, 1000.0, 1.0, 0.1, 5) == std::vector<int>{1, 2, 4, 6});
  CHECK(most_unbalanced(residuals, 1000.0, 1.0, 0.1, 8) == std::vector<int>{0, 1, 2, 4, 6, 7});
  CHECK(most_unbalanced(residuals, 1000.0, 25.0, 0.1, 8) == std::vector<int>{1, 2, 4});
  CHECK(most_unbalanced(residuals, 1000.0, 600.0, 0.1, 8) == std::vector<int>{2});
  CHECK(most_unbalanced(residuals, std::numeric_limits<double>::infinity(), 1.0, 0.1, 8).empty());
}

TEST_CASE("a neighbourhood without rows is that of no system", "[integrator][parts]") {
  Neighbourhood neighbourhood = chain();
  CHECK(neighbourhood.rows() == rows);
  neighbourhood.clear();
  CHECK(neighbourhood.rows() == -1);
}
