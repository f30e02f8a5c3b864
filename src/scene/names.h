// The words of base motion and cutting that stand for the values of an enumeration; others stand beside their enumerations.
#pragma once

#include <array>
#include <string_view>

#include "openclose/scene/domain.h"
#include "openclose/scene/limits.h"
#include "openclose/scene/scene.h"

namespace openclose {

inline constexpr std::array base_motion_words{
    Word{"pulses", BaseMotionKind::pulses},
    Word{"harmonic", BaseMotionKind::harmonic},
    Word{"record", BaseMotionKind::record},
};

inline constexpr std::array enclosed_joints_words{
    Word{"refuse", EnclosedJoints::refuse},
    Word{"drop", EnclosedJoints::drop},
};

}  // namespace openclose
