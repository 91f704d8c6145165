#include "services/interpolator/mapping/mesh_map.h"

#include <unordered_map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/element_faces.h"
#include "services/interpolator/mapping/control_points.h"

namespace mortise::interpolator {
namespace {

// Maps the mesh whose outer surface is `outer`; `target` is this surface, or a finer one of which
// its vertices are the first.
absl::StatusOr<MeshMap> MapBetween(const MarkedSurface& source, const MarkedSurface& target,
                                   OuterSurface outer, const mesh::TetrahedralMesh& mesh,
                                   const LayoutOptions& layout, const VolumeMapOptions& volume) {
  MeshMap map;
  map.outer = std::move(outer);
  MORTISE_ASSIGN_OR_RETURN(map.surface, MapSurface(source, target, layout));
  const auto count = static_cast<Eigen::Index>(map.outer.node.size());
  map.surface.positions.conservativeResize(Eigen::NoChange, count);
  map.surface.places.resize(map.outer.node.size());
  auto interior = MapVolume(mesh, map.outer.node, map.surface.positions, volume);
  if (!interior.ok()) return UnderField("target", interior.status());
  map.volume = *std::move(interior);
  map.nodes = map.volume.nodes;
  return map;
}

}  // namespace

absl::StatusOr<OuterSurface> OuterSurfaceOf(const MarkedMesh& marked, const std::string& field) {
  OuterSurface outer;
  std::unordered_map<int, int> vertex_of;
  const std::vector<mesh::ElementFace> faces = mesh::ElementFaces(marked.mesh).Outer();
  mesh::SurfaceMesh& surface = outer.marked.surface;
  surface.triangles.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t t = 0; t < faces.size(); ++t) {
    const auto& corners = mesh::kTetrahedronFaces[static_cast<std::size_t>(faces[t].side)];
    for (int k = 0; k < 3; ++k) {
      const int node =
          marked.mesh.tetrahedra(corners[static_cast<std::size_t>(k)], faces[t].element);
      const auto [entry, is_new] = vertex_of.try_emplace(node, static_cast<int>(outer.node.size()));
      if (is_new) outer.node.push_back(node);
      surface.triangles(k, static_cast<Eigen::Index>(t)) = entry->second;
    }
  }
  surface.vertices.resize(3, static_cast<Eigen::Index>(outer.node.size()));
  for (std::size_t v = 0; v < outer.node.size(); ++v) {
    surface.vertices.col(static_cast<Eigen::Index>(v)) = marked.mesh.nodes.col(outer.node[v]);
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
  MORTISE_ASSIGN_OR_RETURN(OuterSurface of_target, OuterSurfaceOf(target, "target"));
  const MarkedSurface marked = of_target.marked;
  return MapBetween(of_source.marked, marked, std::move(of_target), target.mesh, layout, volume);
}

absl::StatusOr<MeshMap> MapMesh(const ModelMesh& source, const ModelMesh& target,
                                const LayoutOptions& layout, const VolumeMapOptions& volume) {
  MORTISE_ASSIGN_OR_RETURN(const OuterSurface of_source,
                           OuterSurfaceOf({source.mesh, {}, {}}, "source"));
  MORTISE_ASSIGN_OR_RETURN(OuterSurface of_target, OuterSurfaceOf({target.mesh, {}, {}}, "target"));
  const auto ours = PlaceControlVariables(of_source.marked.surface, source.variables);
  if (!ours.ok()) return UnderField("source", ours.status());
  const auto theirs = PlaceControlVariables(of_target.marked.surface, target.variables);
  if (!theirs.ok()) return UnderField("target", theirs.status());
  return MapBetween(*ours, *theirs, std::move(of_target), target.mesh, layout, volume);
}

}  // namespace mortise::interpolator
