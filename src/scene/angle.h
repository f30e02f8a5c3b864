// Degrees in the file, radians inside.
#pragma once

namespace openclose {

double radians(double degrees);

/// The degrees that radians() turns into exactly this angle, the shortest to write if there are several. Every angle that came from a file has
/// such degrees; of angles that were computed about one in ten has none, because the doubles in degrees lie less dense, and gets the nearest.
double degrees(double radians);

}  // namespace openclose
