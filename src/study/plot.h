// Curves over linear or logarithmic axes as SVG, several pictures beside each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace openclose {

struct PlotPoint {
  double x = 0.0, y = 0.0;
  std::optional<double> high;  ///< upper end of an interval that begins at y
  bool failed = false;         ///< drawn as a cross
  bool hollow = false;         ///< drawn as a ring: a value that is trusted less
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
};

struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<PlotSeries> series;
};

/// Points that a logarithmic axis cannot have are left out. Plots without any point stay empty frames.
std::string svg_plots(const std::string& title, const std::vector<std::string>& notes, const std::vector<Plot>& plots);

}  // namespace openclose
