// The shape that a search is for.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/rpc/call.h"
#include "common/rpc/channel.h"
#include "common/rpc/stream_reactors.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/retrieval.h"

namespace mortise::retrieval {

struct QueryShape {
  mesh::SurfaceMesh surface;       // metres where the unit is known, z upwards
  std::vector<std::string> notes;  // what became of it, for people
  std::string title;               // of the file or template
  bool unit_is_known = true;       // rather than guessed, or not even that
};

// Returns the shape that a request describes. INVALID_ARGUMENT naming "mesh.file", "mesh.upload",
// "mesh.length_unit", "design.template", "design.parameters[0]" and so on, or "query" where there
// is none; NOT_FOUND; as the reader of meshes and the catalog.
absl::StatusOr<QueryShape> ReadQuery(const v1::SearchShapesRequest& request,
                                     const Retrieval& retrieval, const rpc::Origin& origin);

namespace methods {

// Keeps a mesh for a query.
absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadMeshResponse>>> UploadMesh(
    const Retrieval& retrieval, const rpc::Call& call);

}  // namespace methods

}  // namespace mortise::retrieval
