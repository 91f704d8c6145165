#include "services/interpolator/mapping/mesh_mapper.h"

#include <optional>
#include <utility>

#include "common/base/errors.h"
#include "services/interpolator/mapping/control_points.h"
#include "services/interpolator/mapping/nearest_place.h"

namespace mortise::interpolator {
namespace {

// Finds out where vertices are that have slid on faces of the source.
absl::Status FollowSlides(const mesh::SurfaceMesh& source, const Eigen::Array3Xi& slides,
                          MeshMap& map) {
  std::optional<NearestPlaces> nearest;
  for (std::size_t v = 0; v < map.outer.node.size(); ++v) {
    const auto column = static_cast<Eigen::Index>(v);
    if ((slides.col(column) == 0).all()) continue;
    if (!nearest) {
      MORTISE_ASSIGN_OR_RETURN(nearest, NearestPlaces::Create(source));
    }
    map.surface.positions.col(column) = map.nodes.col(map.outer.node[v]);
    MORTISE_ASSIGN_OR_RETURN(map.surface.places[v],
                             nearest->Find(map.surface.positions.col(column)));
  }
  return absl::OkStatus();
}

}  // namespace

MeshMapper::MeshMapper(ModelMesh target, LayoutOptions layout)
    : target_(std::move(target)), layout_(layout) {}

absl::StatusOr<std::unique_ptr<const MeshMapper>> MeshMapper::Create(
    ModelMesh target, const MeshMapOptions& options) {
  auto mapper = std::unique_ptr<MeshMapper>(new MeshMapper(std::move(target), options.layout));
  mapper->outer_ = OuterSurfaceOf(mapper->target_.mesh);
  auto marked = PlaceControlVariables(mapper->outer_.marked.surface, mapper->target_.variables);
  if (!marked.ok()) return UnderField("target", marked.status());
  mapper->marked_ = *std::move(marked);
  auto volume = VolumeMapper::Create(mapper->target_.mesh, mapper->outer_.node, options.volume);
  if (!volume.ok()) return UnderField("target", volume.status());
  mapper->volume_ = *std::move(volume);
  return mapper;
}

absl::StatusOr<MeshMap> MeshMapper::Map(const ModelMesh& source) const {
  const OuterSurface of_source = OuterSurfaceOf(source.mesh);
  const auto marked = PlaceControlVariables(of_source.marked.surface, source.variables);
  if (!marked.ok()) return UnderField("source", marked.status());
  MeshMap map;
  map.outer = outer_;
  MORTISE_ASSIGN_OR_RETURN(map.surface, MapSurface(*marked, marked_, layout_));
  // The vertices of the target come first, then those of control points between them.
  const std::size_t count = outer_.node.size();
  map.surface.places = PlacesBeforeMarking(of_source.marked.surface, *marked, map.surface, count);
  map.surface.positions.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(count));
  FollowCurvedSides(source.mesh.nodes, of_source, map.surface);
  JoinSheets(outer_, map.surface.positions);
  const Eigen::Array3Xi slides = SlidesOnFlatFaces(of_source, outer_, marked_, map.surface.places);
  MORTISE_ASSIGN_OR_RETURN(map.volume, volume_->Map(map.surface.positions, slides));
  map.nodes = map.volume.nodes;
  MORTISE_RETURN_IF_ERROR(FollowSlides(of_source.marked.surface, slides, map));
  map.places = PlacesInNodes(of_source, map.surface.places);
  return map;
}

}  // namespace mortise::interpolator
