// A domain that joints cut into blocks, as it stands in the scene file.
#pragma once

#include <vector>

#include "openclose/geometry/block_cutting.h"
#include "openclose/geometry/joint_set.h"
#include "openclose/scene/scene.h"
#include "openclose/scene/table.h"

namespace openclose {

/// Joints that lie within one block, not connected to its boundary or in one point only, cannot bound a block of their own: it would leave the
/// other with a hole.
enum class EnclosedJoints { refuse, drop };

/// The tables that concern cutting. All but [domain] may be empty.
struct CuttingTables {
  Table domain;
  std::vector<Table> joint_sets;
  std::vector<Table> joint_lines;
  std::vector<Table> regions;
};

/// Appends the blocks of the domain to those of the scene and fills in scene.cutting; does nothing if the file has no [domain] (and then refuses
/// joints and regions). Blocks are named b0001, b0002 ... by height of the centroid, then from left to right, so that their names do not depend on
/// the order of the joints; the material is that of the last [[region]] that contains the centroid, or else the domain's.
/// Throws InputError, for what is written and for what comes of it: a joint that misses the domain, a set that bounds no block, sets that run along
/// each other, no blocks or too many of them, blocks that would have holes, a region without
/// blocks.
void cut_domain(const CuttingTables& tables, const NameList& material_names, const NameList& joint_names, NameList& block_names, Scene& scene);

/// Fixes every block, cut or written, that touches one of these lines over more than a point (tolerance::touching_m,
/// tolerance::shortest_overlap_m). Throws InputError for a line that no block touches.
void fix_blocks(const std::vector<Table>& fixed_lines, Scene& scene);

}  // namespace openclose
