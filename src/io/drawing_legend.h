// The rows of keys below a drawing.
#pragma once

#include <string>

#include "openclose/io/drawing.h"
#include "openclose/io/svg_page.h"

namespace openclose {

/// The colour of a number between 0 and 1.
std::string colour_at(double part);

/// Writes one entry after the other on the page, from the left to the right, and begins a new row where the present one is full.
class Legend {
 public:
  /// \param place  [px] left end and base line of the first row
  /// \param right  [px] where rows end
  Legend(SvgPage& page, const Vec2& place, double right) : page_(page), left_(place.x()), right_(right), x_(place.x()), y_(place.y()) {}

  void add_swatch(const std::string& fill, const std::string& text, const char* over = nullptr);
  void add_line(const char* name, const std::string& colour, double width, const std::string& text, double opacity = 1.0,
                const std::string& dashes = "");
  void add_colour_bar(const Picture::Scale& scale);
  void add_scale_bar(double length, const std::string& text);
  /// Room for a symbol this wide, and its text. Returns the left end of the symbol, at half of its height.
  Vec2 add_symbol(double width, const std::string& text);
  double bottom() const { return y_ + extra_; }  ///< [px]

 private:
  double next_entry(double width);

  SvgPage& page_;
  double left_, right_, x_, y_;
  double extra_ = 0.0;  ///< [px] what the present row has below its line
};

}  // namespace openclose
