// What a list of checks would ask for and the program does not have.
#include "harness.h"

namespace openclose::verification {
namespace {

void water_and_crack(Report& report) {
  report.leave_out("planar wedge with water, tension crack, earthquake and bolt", "all", "not built: there is no water pressure in joints");
}

void deformable_blocks(Report& report) {
  report.leave_out("patch test, bar waves, cantilever", "all", "not built: blocks are rigid");
}

const Registered<Case> water_registered{{"E2", "planar wedge with water and a tension crack", &water_and_crack}};
const Registered<Case> deformable_registered{{"G1", "deformable blocks", &deformable_blocks}};

}  // namespace
}  // namespace openclose::verification
