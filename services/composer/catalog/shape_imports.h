// Stores the shapes that a model has and the catalog does not: of what was stretched in pieces
// between bores that keep their size, or turned, and of what the catalog has forgotten meanwhile.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/shapes/drawn_shape.h"
#include "common/rpc/channel.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::composer {

// Returns a file of the shape for ImportShape: STEP of its exact solid, or else STL of its
// triangles. FAILED_PRECONDITION, SHAPE_NOT_SOLID, of what is only a surface; otherwise fails as
// cad::SolidOfShape and cad::WriteStep.
absl::StatusOr<v1::ImportShapeRequest> FileOfShape(const mesh::DrawnShape& shape);

// Imports those shapes of the parts of an assembly that the catalog has not, as the caller, and
// names in each part what the catalog calls its shape then. What is asked again with the same
// `request_id` is done once. The bundle must have all shapes of its parts. Fails as FileOfShape,
// and as the catalog.
absl::Status ImportShapes(const std::shared_ptr<grpc::Channel>& catalog, const rpc::Origin& caller,
                          const std::string& request_id, v1::AssemblyBundle* bundle);

}  // namespace mortise::composer
