// Points stand where their values are, on both kinds of axes.
#include <cmath>
#include <regex>

#include "openclose/study/plot.h"
#include "support/catch.h"

using namespace openclose;

namespace {

std::vector<std::pair<double, double>> points_in(const std::string& svg) {
  std::vector<std::pair<double, double>> points;
  const std::regex circle("class=\"point\" cx=\"([0-9.-]+)\" cy=\"([0-9.-]+)\"");
  for (std::sregex_iterator i(svg.begin(), svg.end(), circle), end; i != end; ++i) points.emplace_back(std::stod((*i)[1]), std::stod((*i)[2]));
  return points;
}

}  // namespace

TEST_CASE("a power law is a straight line on logarithmic axes, a straight line one on linear axes", "[study]") {
  for (const bool logarithmic : {false, true}) {
    Plot plot{"", "x", "y", logarithmic, logarithmic, {{"a", {}}}};
    for (const double x : {1.0, 2.0, 8.0}) plot.series[0].points.push_back({x, logarithmic ? 3.0 * x * x : 3.0 + 2.0 * x, {}, false});
    const auto points = points_in(svg_plots("title", {}, {plot}));
    REQUIRE(points.size() == 3);
    const double slope = (points[2].second - points[0].second) / (points[2].first - points[0].first);
    CHECK(points[1].second == Approx(points[0].second + slope * (points[1].first - points[0].first)).margin(0.02));
    CHECK(slope < 0.0);
    CHECK((points[1].first - points[0].first) / (points[2].first - points[0].first) == Approx(logarithmic ? 1.0 / 3.0 : 1.0 / 7.0).margin(1e-3));
  }
}

TEST_CASE("a hollow point is a ring in the colour of its series", "[study]") {
  const Plot plot{"", "x", "y", false, false, {{"a", {{1.0, 1.0, {}, false, true}, {2.0, 2.0, {}, false, false}}}}};
  const std::string svg = svg_plots("title", {}, {plot});
  std::vector<std::pair<std::string, std::string>> looks;
  const std::regex circle("class=\"point\"[^>]* fill=\"([^\"]+)\" stroke=\"([^\"]+)\"");
  for (std::sregex_iterator i(svg.begin(), svg.end(), circle), end; i != end; ++i) looks.emplace_back((*i)[1], (*i)[2]);
  REQUIRE(looks.size() == 2);
  CHECK(looks[0].first == "white");
  CHECK(looks[0].second == looks[1].second);
  CHECK(looks[1].first == looks[1].second);
}

TEST_CASE("what an axis cannot have is left out, and names cannot break the picture", "[study]") {
  const Plot plot{"",   "x",
                  "y",  true,
                  true, {{"<b>&", {{1.0, 0.0, {}, false}, {-1.0, 1.0, {}, false}, {1.0, NAN, {}, false}, {2.0, 3.0, {}, false}}}, {"none", {}}}};
  const std::string svg = svg_plots("a < b", {"note"}, {plot, Plot{}});
  CHECK(points_in(svg).size() == 1);
  CHECK(svg.find("<b>") == std::string::npos);
  CHECK(svg.find("a &lt; b") != std::string::npos);
}
