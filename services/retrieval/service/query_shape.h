// The shape that a search is for.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/rpc/channel.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/template_source.h"

namespace mortise::retrieval {

struct QueryShape {
  mesh::SurfaceMesh surface;       // metres where the unit is known, z upwards
  std::vector<std::string> notes;  // what became of it, for people
  std::string title;               // of the file or template
  bool unit_is_known = true;       // rather than guessed, or not even that
};

// The shape that a request describes. INVALID_ARGUMENT naming "mesh.file", "mesh.length_unit",
// "design.template", "design.parameters[0]" and so on, or "query" where there is none; NOT_FOUND;
// as the reader of meshes and the catalog.
absl::StatusOr<QueryShape> ReadQuery(const v1::SearchShapesRequest& request,
                                     TemplateSource& templates, const rpc::Origin& origin);

}  // namespace mortise::retrieval
