// The words of base motion and cutting that stand for the values of an enumeration; others stand beside their enumerations.
#pragma once

#include <array>
#include <string_view>

#include "openclose/scene/domain.h"
#include "openclose/scene/limits.h"
#include "openclose/scene/scene.h"

namespace openclose {

inline constexpr std::array base_motion_words{
    Word{"pulses", BaseMotionKind::pulses, "rectangular ones, which add up where they overlap"},
    Word{"harmonic", BaseMotionKind::harmonic, "amplitude sin(2 pi frequency t + phase) from time 0 on"},
    Word{"record", BaseMotionKind::record, "accelerations at times, linear between them, one series for each direction"},
};

inline constexpr std::array enclosed_joints_words{
    Word{"refuse", EnclosedJoints::refuse, "an error"},
    Word{"drop", EnclosedJoints::drop, "as if they were not there: the block is rigid, and what it encloses moves with it"},
};

}  // namespace openclose
