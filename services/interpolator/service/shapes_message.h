// What maps have of shapes, as it is stored and as a message.
#pragma once

#include <cstdint>
#include <vector>

#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/building/mesh_noise.h"
#include "services/interpolator/building/shaped_structure.h"
#include "services/interpolator/records/stored_map.h"

namespace mortise::interpolator {

// Returns what all structures have of shapes together: fields in the order asked for, those of one
// name by their load cases as they come; what structures differ in is united. `noise`: what of the
// floors was estimated. `bytes`: that all of it takes on disk.
v1::MapShapes MakeShapes(const v1::MapSpecification& specification,
                         const std::vector<ShapedStructure>& structures, const MeshNoise& noise,
                         std::int64_t bytes);

// Returns what is stored of a structure; errors of fields in the order of `shapes.fields`, 0 of
// those that it has not.
StoredShapes ToStored(const ShapedStructure& structure, const v1::MapShapes& shapes);

// Returns how many bytes the files of all structures take, each file once.
std::int64_t BytesOf(const std::vector<ShapedStructure>& structures);

}  // namespace mortise::interpolator
