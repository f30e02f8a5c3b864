#include "openclose/law/edge_stress.h"

namespace openclose {

LinearStress::LinearStress(std::span<const PartOfJoint> parts) {
  double length = 0.0, first_moment = 0.0, force = 0.0;
  for (const PartOfJoint& part : parts) {
    length += part.high - part.low;
    first_moment += (part.high - part.low) * 0.5 * (part.low + part.high);
    force += part.normal;
  }
  middle = first_moment / length;
  mean = force / length;
  double moment = 0.0, second_moment = 0.0;
  for (const PartOfJoint& part : parts) {
    const double size = part.high - part.low, off = 0.5 * (part.low + part.high) - middle;
    moment += part.normal * (part.at - middle);
    second_moment += size * (size * size / 12.0 + off * off);
  }
  slope = moment / second_moment;
}

}  // namespace openclose
