#include "services/interpolator/service/map_methods.h"

#include <memory>
#include <string>
#include <utility>

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "services/interpolator/records/map_files.h"
#include "services/interpolator/service/follow_shape.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/service/map_optimum.h"
#include "services/interpolator/service/map_queries.h"
#include "services/interpolator/service/map_records.h"
#include "services/interpolator/service/map_shape.h"
#include "services/interpolator/service/map_specification.h"

namespace mortise::interpolator::methods {

absl::StatusOr<v1::DesignMap> GetMap(const Interpolator& interpolator, const rpc::Call&,
                                     const v1::GetMapRequest& asked) {
  return kMaps.Get(*interpolator.store, asked.name());
}

absl::StatusOr<v1::ListMapsResponse> ListMaps(const Interpolator& interpolator, const rpc::Call&,
                                              const v1::ListMapsRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      resources::CheckListRequest(asked),
      asked.subject().empty() ? absl::OkStatus() : CheckSubject(asked.subject())));
  MORTISE_ASSIGN_OR_RETURN(
      auto page, kMaps.List(*interpolator.store, asked, [&asked](const v1::DesignMap& map) {
        return asked.subject().empty() || map.specification().subject() == asked.subject();
      }));
  return resources::ToResponse(std::move(page), &v1::ListMapsResponse::mutable_maps);
}

absl::StatusOr<v1::EvaluateMapResponse> EvaluateMap(const Interpolator& interpolator,
                                                    const rpc::Call& call,
                                                    const v1::EvaluateMapRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const LoadedMap> map,
                           interpolator.loaded->Get(asked.name()));
  return Evaluate(*map, asked, [&call] { return call.cancelled(); });
}

absl::StatusOr<v1::MapShape> EvaluateMapShape(const Interpolator& interpolator, const rpc::Call&,
                                              const v1::EvaluateMapShapeRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const LoadedMap> map,
                           interpolator.loaded->Get(asked.name()));
  return EvaluateShape(*map, *interpolator.shapes, asked);
}

absl::StatusOr<std::unique_ptr<rpc::StreamReader<v1::FollowMapShapeRequest>>> FollowMapShape(
    const Interpolator& interpolator, const rpc::Call&,
    std::shared_ptr<rpc::StreamWriter<v1::MapShape>> writer) {
  return OpenShapeStream(interpolator, std::move(writer));
}

absl::StatusOr<v1::OptimizeMapResponse> OptimizeMap(const Interpolator& interpolator,
                                                    const rpc::Call& call,
                                                    const v1::OptimizeMapRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const LoadedMap> map,
                           interpolator.loaded->Get(asked.name()));
  return FindOptimum(*map, asked, [&call] { return call.cancelled(); });
}

absl::StatusOr<v1::DesignMap> UpdateMap(const rpc::Call& call, const v1::UpdateMapRequest& asked,
                                        store::Transaction& transaction) {
  return kMaps.UpdateTags(transaction, asked.map(), asked.update_mask(), "map",
                          rpc::AuthorOf(call));
}

absl::StatusOr<v1::DeleteMapResponse> DeleteMap(const rpc::Call& call,
                                                const v1::DeleteMapRequest& asked,
                                                store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap map, kMaps.Get(transaction, asked.name()));
  MORTISE_ASSIGN_OR_RETURN(const std::string id,
                           ParseResourceName(map.name(), kMaps.names, "name"));
  MORTISE_RETURN_IF_ERROR(transaction.Delete(kMaps.kind, id));
  MORTISE_RETURN_IF_ERROR(DropMapFiles(transaction, id));
  MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = "map.deleted",
                                                   .subject = map.name(),
                                                   .payload = "{}",
                                                   .trace_id = rpc::AuthorOf(call).trace_id}));
  return v1::DeleteMapResponse();
}

}  // namespace mortise::interpolator::methods
