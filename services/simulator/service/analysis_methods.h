// The methods of SimulatorService about analyses.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_writer.h"
#include "common/store/store.h"
#include "mortise/v1/operations.pb.h"
#include "mortise/v1/simulator.pb.h"
#include "mortise/v1/types.pb.h"
#include "services/simulator/service/simulator.h"

namespace mortise::simulator::methods {

// Makes the task of a request for the analysis of a design, as a worker will get it: with the
// template's revision and all parameters. Fails at once, with the field, where the geometry is
// impossible or nothing holds it. Slow: it runs before the transaction.
absl::StatusOr<v1::Task> PrepareDesign(const Simulator& simulator, const rpc::Call& call,
                                       const v1::AnalyzeDesignRequest& asked);

absl::StatusOr<v1::Operation> AnalyzeDesign(const Simulator& simulator, const rpc::Call& call,
                                            const v1::AnalyzeDesignRequest& asked, v1::Task& task,
                                            store::Transaction& transaction);

// Makes the task of a request for the analysis of a mesh: the catalog's numbers take the place of
// its materials' names. INVALID_ARGUMENT as CheckMeshCase, NOT_FOUND for unknown materials,
// UNAVAILABLE. Slow: it runs before the transaction.
absl::StatusOr<v1::Task> PrepareMesh(const Simulator& simulator, const rpc::Call& call,
                                     const v1::AnalyzeMeshRequest& asked);

absl::StatusOr<v1::Operation> AnalyzeMesh(const Simulator& simulator, const rpc::Call& call,
                                          const v1::AnalyzeMeshRequest& asked, v1::Task& task,
                                          store::Transaction& transaction);

absl::StatusOr<v1::Analysis> GetAnalysis(const Simulator& simulator, const rpc::Call& call,
                                         const v1::GetAnalysisRequest& asked);

absl::StatusOr<v1::ListAnalysesResponse> ListAnalyses(const Simulator& simulator,
                                                      const rpc::Call& call,
                                                      const v1::ListAnalysesRequest& asked);

absl::StatusOr<v1::Analysis> UpdateAnalysis(const rpc::Call& call,
                                            const v1::UpdateAnalysisRequest& asked,
                                            store::Transaction& transaction);

absl::Status DownloadArtifact(const Simulator& simulator, const rpc::Call& call,
                              const v1::DownloadArtifactRequest& asked,
                              const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer);

}  // namespace mortise::simulator::methods
