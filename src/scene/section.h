// A joint plane in space and its line in the section that is analysed.
#pragma once

#include <optional>

namespace openclose {

/// How a plane with a dip and a dip direction cuts the section.
struct PlaneInSection {
  double dip = 0.0;      ///< [rad] of the line in the section, counter-clockwise from the horizontal, in (-pi/2, pi/2]
  double spacing = 0.0;  ///< [-] between lines of the section over that between the planes, both measured at right angles; at least 1
  double oblique = 0.0;  ///< [-] part of the plane's unit normal that points out of the section; 0 where the plane strikes across the section
};

/// \param dip            [rad] of the plane below the horizontal, 0 to pi/2
/// \param dip_direction  [rad] azimuth, clockwise from north, into which it falls
/// \param section        [rad] azimuth into which the x axis of the section points
/// Empty for a plane that lies in the section, or within a hundredth of it by its normal: it has no line there.
/// Source: the plane's unit normal (sin dip sin direction, sin dip cos direction, cos dip) in east, north and up, resolved along the section.
std::optional<PlaneInSection> plane_in_section(double dip, double dip_direction, double section);

}  // namespace openclose
