// The method of InterpolatorService that gives away what it takes to interpolate elsewhere.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_writer.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/service/interpolator.h"

namespace mortise::interpolator::methods {

// Streams the map of one structure, as the proto says. INVALID_ARGUMENT naming "structure",
// "geometry", "fields" or "metrics[0]"; FAILED_PRECONDITION, MAP_WITHOUT_SHAPES.
absl::Status ExportMap(const Interpolator& interpolator, const rpc::Call& call,
                       const v1::ExportMapRequest& asked,
                       const std::shared_ptr<rpc::StreamWriter<v1::MapExportPart>>& writer);

}  // namespace mortise::interpolator::methods
