// A drag of a control over a stream: values come as fast as a hand gives them, the latest is
// answered with what it changes, and nothing is stored until the end.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_reactors.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/service/composer.h"
#include "services/composer/service/drag_cache.h"

namespace mortise::composer {

// Returns a drag of a model at a revision, which is opened if it is not at hand. ABORTED,
// STALE_REVISION; else fails as ReadModel and DragCache::DragOf.
absl::StatusOr<std::shared_ptr<OpenDrag>> FindDrag(const Composer& composer, const rpc::Call& call,
                                                   const std::string& name, std::int64_t revision,
                                                   const DraggedControl& control);

// Takes the messages of DragNode (composer.proto). Of values that wait only the latest is kept, and
// the next is begun when the one before is answered: whatever a client sends, one value and one
// answer wait at most.
std::unique_ptr<rpc::StreamReader<v1::DragNodeRequest>> OpenDragStream(
    const Composer& composer, const rpc::Call& call,
    std::shared_ptr<rpc::StreamWriter<v1::DragNodeResponse>> writer);

}  // namespace mortise::composer
