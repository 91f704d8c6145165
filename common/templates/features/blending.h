// Makes fillets and chamfers so that the process outlives them. Private to this folder: it brings
// Open CASCADE's headers.
//
// Over some configurations the kernel's builder of blends crashes or comes to no end, and nothing
// tells for all of them beforehand which. All that are known of have a blend that runs into another
// edge. So where blend_room.h finds that nothing is near, the blend is made at once; else it is
// made in a copy of the process first, which takes a fork and the blend once more, and here only
// once that has succeeded.
#pragma once

#include <BRepFilletAPI_LocalOperation.hxx>
#include <TopoDS_Shape.hxx>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/templates/features/blend_room.h"
#include "common/templates/features/named_body.h"

namespace mortise::cad {

// Returns the operation that rounds or bevels `edges` of `shape` by a radius or distance in metres,
// done. INVALID_ARGUMENT, "fillet.radius" or "chamfer.distance", if the kernel cannot: with the
// feature, and where another edge is near also with the edge that has the least room and a size
// that can be made. INTERNAL if no copy of the process can be made. Standard_Failure as the kernel
// throws it.
absl::StatusOr<std::unique_ptr<BRepFilletAPI_LocalOperation>> BlendEdges(BlendKind kind,
                                                                         const TopoDS_Shape& shape,
                                                                         const FoundEdges& edges,
                                                                         const std::string& feature,
                                                                         double size);

}  // namespace mortise::cad
