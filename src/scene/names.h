// The words of blocks, joints, base motion and cutting that stand for the values of an enumeration; those of the options stand in options.h.
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

inline constexpr std::array cohesion_behaviour_words{
    Word{"ductile", CohesionBehaviour::ductile},
    Word{"lost_on_opening", CohesionBehaviour::lost_on_opening},
    Word{"lost_on_slip", CohesionBehaviour::lost_on_slip},
};

inline constexpr std::array enclosed_joints_words{
    Word{"refuse", EnclosedJoints::refuse},
    Word{"drop", EnclosedJoints::drop},
};

}  // namespace openclose
