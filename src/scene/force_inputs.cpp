#include "openclose/scene/force_inputs.h"

#include "openclose/scene/point_of_block.h"

namespace openclose {

void Load::complete(const Table& table, const std::vector<BlockInput>& blocks) {
  block = block_of_point(table.at("point_m"), block, point, blocks);
}

void Support::complete(const Table& table, const std::vector<BlockInput>& blocks) {
  if (stiffness.isZero(0.0)) table.at("stiffness_n_per_m").fail("both stiffnesses are 0", "[kx, ky] of which one may be 0");
  block = block_of_point(table.at("point_m"), block, point, blocks);
}

}  // namespace openclose
