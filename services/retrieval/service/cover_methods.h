// The methods by which workers get covers to make, and tell of them.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/handler.h"
#include "common/rpc/stream_reactors.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/retrieval.h"

namespace mortise::retrieval::methods {

// Answers when there is a task, when the caller's patience is over, or when it has gone.
absl::Status LeaseCover(const Retrieval& retrieval, const rpc::Call& call,
                        const v1::LeaseCoverRequest& asked,
                        rpc::Responder<v1::LeaseCoverResponse> respond);

absl::StatusOr<v1::RenewCoverResponse> RenewCover(const Retrieval& retrieval, const rpc::Call& call,
                                                  const v1::RenewCoverRequest& asked);

absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadCoverResponse>>> UploadCover(
    const Retrieval& retrieval, const rpc::Call& call);

absl::StatusOr<v1::ReportCoverResponse> ReportCover(const Retrieval& retrieval,
                                                    const rpc::Call& call,
                                                    const v1::ReportCoverRequest& asked);

}  // namespace mortise::retrieval::methods
