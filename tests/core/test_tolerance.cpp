// The reasons given for the thresholds, as far as they relate numbers to each other.
#include <cmath>
#include <limits>
#include <numbers>

#include "openclose/core/tolerance.h"
#include "support/catch.h"

using namespace openclose;

namespace {

/// Half the distance of neighbouring numbers at the farthest coordinate that is accepted, which is what a coordinate may be off by.
const double rounding_m = 0.5 * (std::nextafter(tolerance::farthest_coordinate_m, 1e9) - tolerance::farthest_coordinate_m);

}  // namespace

TEST_CASE("the shortest edge stands above the rounding of the farthest coordinate", "[core][tolerance]") {
  CHECK(tolerance::shortest_edge_m > 4.0 * rounding_m);
  CHECK(tolerance::shortest_edge_m > 30.0 * 1e6 * std::numeric_limits<double>::epsilon());
}

TEST_CASE("lengths that must be told apart are ordered", "[core][tolerance]") {
  CHECK(tolerance::shortest_edge_m < tolerance::edge_end_m);
  CHECK(tolerance::shortest_edge_m < tolerance::shortest_overlap_m);
  CHECK(tolerance::edge_end_m < tolerance::deepest_initial_overlap_m);
  CHECK(tolerance::deepest_initial_overlap_m < tolerance::search_skin_m);
}

TEST_CASE("a dropped corner bends 100 m by less than what counts as a width or an overlap", "[core][tolerance]") {
  CHECK(100.0 * tolerance::straight_corner_rad < tolerance::thinnest_block_m);
  CHECK(100.0 * tolerance::straight_corner_rad < tolerance::shortest_overlap_m);
}

TEST_CASE("edges stop facing each other between 5 and 15 degrees", "[core][tolerance]") {
  CHECK(tolerance::parallel_full_rad == Approx(std::numbers::pi / 36.0).epsilon(1e-15));
  CHECK(tolerance::parallel_none_rad == Approx(std::numbers::pi / 12.0).epsilon(1e-15));
}
