#include "services/interpolator/mapping/mesh_map.h"

#include <unordered_map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/element_faces.h"
#include "services/interpolator/mapping/mesh_mapper.h"

namespace mortise::interpolator {
namespace {

// Returns the row of the node in the middle of the edge between two corners of an element.
int MiddleOf(int a, int b) {
  int row = 4;
  for (const auto& [from, to] : mesh::kTetrahedronEdges) {
    if ((from == a && to == b) || (from == b && to == a)) break;
    ++row;
  }
  return row;
}

}  // namespace

absl::StatusOr<OuterSurface> OuterSurfaceOf(const MarkedMesh& marked, const std::string& field) {
  const std::vector<mesh::ElementFace> faces = mesh::ElementFaces(marked.mesh).Outer();
  Eigen::Matrix3Xi triangles(3, static_cast<Eigen::Index>(faces.size())), middles;
  if (marked.mesh.IsQuadratic()) middles.resize(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const mesh::ElementFace& face = faces[static_cast<std::size_t>(t)];
    const auto& corners = mesh::kTetrahedronFaces[static_cast<std::size_t>(face.side)];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      triangles(row, t) = marked.mesh.tetrahedra(corners[k], face.element);
      if (!marked.mesh.IsQuadratic()) continue;
      middles(row, t) =
          marked.mesh.tetrahedra(MiddleOf(corners[k], corners[(k + 1) % 3]), face.element);
    }
  }
  OuterSurface outer = MakeOuterSurface(marked.mesh.nodes, triangles, middles);
  std::unordered_map<int, int> vertex_of;
  for (std::size_t v = 0; v < outer.node.size(); ++v) {
    vertex_of.try_emplace(outer.node[v], static_cast<int>(v));
  }
  for (std::size_t i = 0; i < marked.points.size(); ++i) {
    const auto vertex = vertex_of.find(marked.points[i].vertex);
    if (vertex == vertex_of.end()) {
      return InvalidField(absl::StrCat(field, ".points[", i, "].vertex"),
                          "it is no corner on the surface of the mesh");
    }
    outer.marked.points.push_back({marked.points[i].name, vertex->second});
  }
  for (std::size_t i = 0; i < marked.paths.size(); ++i) {
    ControlPath path{marked.paths[i].name, {}};
    for (const int node : marked.paths[i].vertices) {
      const auto vertex = vertex_of.find(node);
      if (vertex == vertex_of.end()) {
        return InvalidField(absl::StrCat(field, ".paths[", i, "].vertices"),
                            absl::StrCat("node ", node, " is no corner on the surface"));
      }
      path.vertices.push_back(vertex->second);
    }
    outer.marked.paths.push_back(std::move(path));
  }
  return outer;
}

absl::StatusOr<MeshMap> MapMesh(const MarkedMesh& source, const MarkedMesh& target,
                                const LayoutOptions& layout, const VolumeMapOptions& volume) {
  MORTISE_ASSIGN_OR_RETURN(const OuterSurface of_source, OuterSurfaceOf(source, "source"));
  MeshMap map;
  MORTISE_ASSIGN_OR_RETURN(map.outer, OuterSurfaceOf(target, "target"));
  MORTISE_ASSIGN_OR_RETURN(map.surface, MapSurface(of_source.marked, map.outer.marked, layout));
  map.places = PlacesInNodes(of_source, map.surface.places);
  JoinSheets(map.outer, map.surface.positions);
  auto interior = MapVolume(target.mesh, map.outer.node, map.surface.positions, volume);
  if (!interior.ok()) return UnderField("target", interior.status());
  map.volume = *std::move(interior);
  map.nodes = map.volume.nodes;
  return map;
}

absl::StatusOr<MeshMap> MapMesh(const ModelMesh& source, const ModelMesh& target,
                                const LayoutOptions& layout, const VolumeMapOptions& volume) {
  MORTISE_ASSIGN_OR_RETURN(const auto mapper, MeshMapper::Create(target, {layout, volume}));
  return mapper->Map(source);
}

}  // namespace mortise::interpolator
