// Tells things of one name apart by what they lie beside: the faces of a fillet along several
// edges, of a chamfer, the pieces that a face was cut into.
#pragma once

#include <string>
#include <vector>

namespace mortise::mesh {

// Returns the names, those that several have with what these lie beside added, "border beside
// (plate.end, plate.outline.left)", where that tells them apart: neighbours whose own name only
// they have, with names added in turns before. What lies beside the same stays as it is. So names
// agree at two parameters where what they lie beside does. `beside`: the neighbours of each. Long
// lists are cut to a digest.
std::vector<std::string> DistinctNames(std::vector<std::string> names,
                                       const std::vector<std::vector<int>>& beside);

}  // namespace mortise::mesh
