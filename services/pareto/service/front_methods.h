// The methods of ParetoService about fronts that were found.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_writer.h"
#include "common/store/store.h"
#include "mortise/v1/pareto.pb.h"
#include "mortise/v1/types.pb.h"
#include "services/pareto/service/pareto.h"

namespace mortise::pareto::methods {

absl::StatusOr<v1::Front> GetFront(const Pareto& pareto, const rpc::Call& call,
                                   const v1::GetFrontRequest& asked);

absl::StatusOr<v1::ListFrontsResponse> ListFronts(const Pareto& pareto, const rpc::Call& call,
                                                  const v1::ListFrontsRequest& asked);

// Gives the front without its points, which may be many.
absl::StatusOr<v1::Front> UpdateFront(const rpc::Call& call, const v1::UpdateFrontRequest& asked,
                                      store::Transaction& transaction);

absl::StatusOr<v1::PickPointResponse> PickPoint(const Pareto& pareto, const rpc::Call& call,
                                                const v1::PickPointRequest& asked);

absl::StatusOr<v1::RestrictFrontResponse> RestrictFront(const Pareto& pareto, const rpc::Call& call,
                                                        const v1::RestrictFrontRequest& asked);

absl::Status ExportFront(const Pareto& pareto, const rpc::Call& call,
                         const v1::ExportFrontRequest& asked,
                         const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer);

}  // namespace mortise::pareto::methods
