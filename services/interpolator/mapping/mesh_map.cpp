#include "services/interpolator/mapping/mesh_map.h"

#include <unordered_map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/element_faces.h"
#include "services/interpolator/mapping/mesh_mapper.h"

namespace mortise::interpolator {
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

std::vector<NodePlace> PlacesInNodes(const OuterSurface& outer,
                                     const std::vector<TrianglePlace>& places) {
  std::vector<NodePlace> in_nodes(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].triangle < 0) continue;
    const Eigen::Vector3i corners = outer.marked.surface.triangles.col(places[i].triangle);
    for (int k = 0; k < 3; ++k) {
      in_nodes[i].nodes[k] = outer.node[static_cast<std::size_t>(corners[k])];
    }
    in_nodes[i].shares = places[i].barycentric;
  }
  return in_nodes;
}

absl::StatusOr<MeshMap> MapMesh(const MarkedMesh& source, const MarkedMesh& target,
                                const LayoutOptions& layout, const VolumeMapOptions& volume) {
  MORTISE_ASSIGN_OR_RETURN(const OuterSurface of_source, OuterSurfaceOf(source, "source"));
  MeshMap map;
  MORTISE_ASSIGN_OR_RETURN(map.outer, OuterSurfaceOf(target, "target"));
  MORTISE_ASSIGN_OR_RETURN(map.surface, MapSurface(of_source.marked, map.outer.marked, layout));
  map.places = PlacesInNodes(of_source, map.surface.places);
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
