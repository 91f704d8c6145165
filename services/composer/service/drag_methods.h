// The methods that drag: composer.proto says what each takes and gives; the wrappers of common/rpc
// what all have.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_reactors.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/service/model_change.h"

namespace mortise::composer::methods {

absl::StatusOr<v1::NodeControls> GetNodeControls(const Composer& composer, const rpc::Call& call,
                                                 const v1::GetNodeControlsRequest& asked);

absl::StatusOr<ModelChange> DragControl(const Composer& composer, const rpc::Call& call,
                                        const v1::DragControlRequest& asked);

absl::StatusOr<v1::DragPreview> PreviewDrag(const Composer& composer, const rpc::Call& call,
                                            const v1::PreviewDragRequest& asked);

absl::StatusOr<std::unique_ptr<rpc::StreamReader<v1::DragNodeRequest>>> DragNode(
    const Composer& composer, const rpc::Call& call,
    std::shared_ptr<rpc::StreamWriter<v1::DragNodeResponse>> writer);

}  // namespace mortise::composer::methods
