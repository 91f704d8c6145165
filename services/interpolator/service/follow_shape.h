// Shapes while designs are dragged, over a stream.
#pragma once

#include <memory>

#include "common/rpc/call.h"
#include "common/rpc/stream_reactors.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/service/interpolator.h"

namespace mortise::interpolator {

// Takes the messages of FollowMapShape (interpolator.proto). Of points that wait only the latest is
// kept, and the next answer is begun when the one before is sent: whatever a client sends, one
// point and one answer wait at most. The mesh goes ahead of the first shape in it, in messages of
// its own of the same sequence where one cannot hold it: their `new_mesh` says `more`, and they
// have no positions; the last part comes with the shape.
std::unique_ptr<rpc::StreamReader<v1::FollowMapShapeRequest>> OpenShapeStream(
    const Interpolator& interpolator, std::shared_ptr<rpc::StreamWriter<v1::MapShape>> writer);

}  // namespace mortise::interpolator
