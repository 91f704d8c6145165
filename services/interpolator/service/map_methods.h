// The methods of InterpolatorService about maps that are there.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_reactors.h"
#include "common/store/store.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/service/interpolator.h"

namespace mortise::interpolator::methods {

absl::StatusOr<v1::DesignMap> GetMap(const Interpolator& interpolator, const rpc::Call& call,
                                     const v1::GetMapRequest& asked);

absl::StatusOr<v1::ListMapsResponse> ListMaps(const Interpolator& interpolator,
                                              const rpc::Call& call,
                                              const v1::ListMapsRequest& asked);

absl::StatusOr<v1::EvaluateMapResponse> EvaluateMap(const Interpolator& interpolator,
                                                    const rpc::Call& call,
                                                    const v1::EvaluateMapRequest& asked);

absl::StatusOr<v1::MapShape> EvaluateMapShape(const Interpolator& interpolator,
                                              const rpc::Call& call,
                                              const v1::EvaluateMapShapeRequest& asked);

absl::StatusOr<std::unique_ptr<rpc::StreamReader<v1::FollowMapShapeRequest>>> FollowMapShape(
    const Interpolator& interpolator, const rpc::Call& call,
    std::shared_ptr<rpc::StreamWriter<v1::MapShape>> writer);

absl::StatusOr<v1::OptimizeMapResponse> OptimizeMap(const Interpolator& interpolator,
                                                    const rpc::Call& call,
                                                    const v1::OptimizeMapRequest& asked);

absl::StatusOr<v1::DesignMap> UpdateMap(const rpc::Call& call, const v1::UpdateMapRequest& asked,
                                        store::Transaction& transaction);

// Its files go when nothing has named them for a day (map_upkeep.h), so that what reads it now may
// read on.
absl::StatusOr<v1::DeleteMapResponse> DeleteMap(const rpc::Call& call,
                                                const v1::DeleteMapRequest& asked,
                                                store::Transaction& transaction);

}  // namespace mortise::interpolator::methods
