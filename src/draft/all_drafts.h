#pragma once

#include "openclose/draft/drafts.h"

namespace openclose {

Draft arch_draft();
Draft slope_draft();
Draft wall_draft();

}  // namespace openclose
