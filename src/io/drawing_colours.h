// The colours of drawings and of the page of results, so that one means the same in both.
#pragma once

#include <array>

namespace openclose::drawing_colour {

/// Materials, or other classes of blocks, in their order; from the first one again where they are more.
inline constexpr std::array fills = {"#e8dcc3", "#c9d8c5", "#c7d3e3", "#e3c9c5", "#d9cde3", "#e0e0d0"};
/// Joints that edges of blocks name: none near the red, orange, blue and violet of what joints and loads do.
inline constexpr std::array seams = {"#00a0b0", "#66a61e", "#b59a00", "#8da0cb", "#8c564b"};
inline constexpr const char* fixed_fill = "#a5a096";
inline constexpr const char* outline_colour = "#333";
inline constexpr const char* sliding_colour = "#f16913";
inline constexpr const char* open_colour = "#cb181d";
inline constexpr const char* force_colour = "#6a0a78";
inline constexpr const char* load_colour = "#08519c";
inline constexpr const char* support_colour = "#006d2c";

/// From 0 to 1: light to dark, told apart in grey, too (YlGnBu of ColorBrewer, without its darkest end, on which no outline can be seen).
inline constexpr std::array<std::array<int, 3>, 7> gradient = {
    {{255, 255, 229}, {237, 248, 177}, {199, 233, 180}, {127, 205, 187}, {65, 182, 196}, {29, 145, 192}, {44, 110, 180}}};

}  // namespace openclose::drawing_colour
