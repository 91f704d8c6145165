#include "services/interpolator/service/export_methods.h"

#include <cstddef>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/service/map_queries.h"
#include "services/interpolator/service/map_shape.h"
#include "services/interpolator/service/map_stream.h"

namespace mortise::interpolator::methods {
namespace {

using Writer = rpc::StreamWriter<v1::MapExportPart>;

// What is wanted of the map: as of its shapes elsewhere, but that none are where no geometry is
// named.
absl::StatusOr<ShapeDemand> ReadDemand(const v1::DesignMap& map,
                                       const v1::ExportMapRequest& asked) {
  if (asked.geometry() != v1::GEOMETRY_KIND_UNSPECIFIED) {
    v1::EvaluateMapShapeRequest shape;
    shape.set_geometry(asked.geometry());
    *shape.mutable_fields() = asked.fields();
    *shape.mutable_metrics() = asked.metrics();
    return ReadShapeDemand(map, shape);
  }
  if (!asked.fields().empty())
    return InvalidField("fields", "lie on a geometry; ask for that, too");
  ShapeDemand demand;
  demand.geometry = v1::GEOMETRY_KIND_UNSPECIFIED;
  MORTISE_ASSIGN_OR_RETURN(demand.metrics, MetricColumns(map, asked.metrics()));
  return demand;
}

}  // namespace

absl::Status ExportMap(const Interpolator& interpolator, const rpc::Call&,
                       const v1::ExportMapRequest& asked, const std::shared_ptr<Writer>& writer) {
  MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<const LoadedMap> map,
                           interpolator.loaded->Get(asked.name()));
  const int structures = static_cast<int>(map->structures.size());
  if (asked.structure() < 0 || asked.structure() >= structures) {
    return InvalidField("structure", absl::StrCat("is ", asked.structure(), "; the map has ",
                                                  structures, ", from 0"));
  }
  MORTISE_ASSIGN_OR_RETURN(ShapeDemand demand, ReadDemand(map->record, asked));
  auto stream =
      std::make_shared<MapStream>(std::move(map), interpolator.shapes,
                                  static_cast<std::size_t>(asked.structure()), std::move(demand));
  // The writer keeps what it pulls from; this must not keep the writer.
  std::weak_ptr<Writer> weak = writer;
  writer->Pull([stream, weak]() -> absl::StatusOr<std::optional<v1::MapExportPart>> {
    MORTISE_ASSIGN_OR_RETURN(std::optional<v1::MapExportPart> part, stream->Next());
    if (!part) {
      if (const std::shared_ptr<Writer> alive = weak.lock()) alive->Finish(absl::OkStatus());
    }
    return part;
  });
  return absl::OkStatus();
}

}  // namespace mortise::interpolator::methods
