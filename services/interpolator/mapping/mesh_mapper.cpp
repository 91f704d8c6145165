#include "services/interpolator/mapping/mesh_mapper.h"

#include <utility>

#include "common/base/errors.h"
#include "services/interpolator/mapping/control_points.h"

namespace mortise::interpolator {
MeshMapper::MeshMapper(ModelMesh target, LayoutOptions layout)
    : target_(std::move(target)), layout_(layout) {}

absl::StatusOr<std::unique_ptr<const MeshMapper>> MeshMapper::Create(
    ModelMesh target, const MeshMapOptions& options) {
  auto mapper = std::unique_ptr<MeshMapper>(new MeshMapper(std::move(target), options.layout));
  MORTISE_ASSIGN_OR_RETURN(mapper->outer_,
                           OuterSurfaceOf({mapper->target_.mesh, {}, {}}, "target"));
  auto marked = PlaceControlVariables(mapper->outer_.marked.surface, mapper->target_.variables);
  if (!marked.ok()) return UnderField("target", marked.status());
  mapper->marked_ = *std::move(marked);
  auto volume = VolumeMapper::Create(mapper->target_.mesh, mapper->outer_.node, options.volume);
  if (!volume.ok()) return UnderField("target", volume.status());
  mapper->volume_ = *std::move(volume);
  return mapper;
}

absl::StatusOr<MeshMap> MeshMapper::Map(const ModelMesh& source) const {
  MORTISE_ASSIGN_OR_RETURN(const OuterSurface of_source,
                           OuterSurfaceOf({source.mesh, {}, {}}, "source"));
  const auto marked = PlaceControlVariables(of_source.marked.surface, source.variables);
  if (!marked.ok()) return UnderField("source", marked.status());
  MeshMap map;
  map.outer = outer_;
  MORTISE_ASSIGN_OR_RETURN(map.surface, MapSurface(*marked, marked_, layout_));
  // The vertices of the target come first, then those of control points between them.
  const std::size_t count = outer_.node.size();
  map.surface.places = PlacesBeforeMarking(of_source.marked.surface, *marked, map.surface, count);
  map.surface.positions.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(count));
  map.places = PlacesInNodes(of_source, map.surface.places);
  FollowCurvedSides(source.mesh.nodes, of_source, map.surface);
  JoinSheets(outer_, map.surface.positions);
  MORTISE_ASSIGN_OR_RETURN(map.volume, volume_->Map(map.surface.positions));
  map.nodes = map.volume.nodes;
  return map;
}

}  // namespace mortise::interpolator
