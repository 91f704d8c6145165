// The methods of SimulatorService by which files come and go: meshes, and what belongs to the
// results of tasks.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_reactors.h"
#include "common/rpc/stream_writer.h"
#include "mortise/v1/simulator.pb.h"
#include "mortise/v1/types.pb.h"
#include "services/simulator/service/simulator.h"

namespace mortise::simulator::methods {

absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadBlobResponse>>> UploadBlob(
    const Simulator& simulator, const rpc::Call& call);

absl::Status DownloadBlob(const Simulator& simulator, const rpc::Call& call,
                          const v1::DownloadBlobRequest& asked,
                          const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer);

}  // namespace mortise::simulator::methods
