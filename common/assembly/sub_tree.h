// Makes a sub-tree of an assembly an assembly by itself: a drawer without its cabinet.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"

namespace mortise::parametric {

// Returns the sub-tree below `node` of a valid assembly. `node` names a group; where no group is
// called so, a part; or else the parts of a row, "node 1", "node 2" … or of a grid, "node 1.1" ….
// The root, "", is the whole assembly. Everything stays where it is drawn and keeps its name; the
// node becomes the root.
//
// Connecting parts that touch each other belong together, as in connection.h. They stay where all
// principal parts that they touch are in the sub-tree, wherever they are drawn; where one is not
// they are left out, even those drawn in the sub-tree: what they hold is no longer there. Those
// that touch no principal part stay with their group. The joints that stay are those that move
// groups below the node with parts in them.
//
// INVALID_ARGUMENT, "group", where nothing is called so, or it has no principal parts. Fails also
// as FindTouchingParts does.
absl::StatusOr<Assembly> SubTreeOf(const Assembly& assembly, const std::string& node);

// Returns the names of the parts that are drawn below a node, which names as in SubTreeOf; all for
// "". INVALID_ARGUMENT, "group", where nothing is called so.
absl::StatusOr<std::vector<std::string>> PartsOfNode(const Assembly& assembly,
                                                     const std::string& node);

// Returns what is left of a valid assembly when the sub-tree below `node` is taken out, which names
// as in SubTreeOf. Connecting parts that belong together go as soon as one of the principal parts
// that they touch goes, wherever they are drawn; those that touch none go with their group. Those
// stay that reach into several principal parts that stay, and only lie against what goes, as a
// screw does whose tip comes to the face of a board. Groups and joints stay as far as there are
// parts left in them.
//
// INVALID_ARGUMENT, "group", where nothing is called so, or it has no principal parts;
// FAILED_PRECONDITION, NOTHING_LEFT, if no principal part is left. Fails also as FindTouchingParts
// does.
absl::StatusOr<Assembly> WithoutSubTree(const Assembly& assembly, const std::string& node);

// Returns the names of the groups of a valid assembly whose sub-trees are things by themselves, in
// the order of the groups: those with at least two parts, and fewer than the whole. Of several that
// look the same, as the drawers of a cabinet do, the first stands for all: their parts have the
// same shapes, items and sizes in the same places, but for where the sub-tree stands. Groups that
// SubTreeOf refuses are left out.
std::vector<std::string> DistinctSubTrees(const Assembly& assembly);

}  // namespace mortise::parametric
