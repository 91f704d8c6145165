// AnalyzeDesign and AnalyzeMesh: one task with fields and pictures, as a long-running operation.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/channel.h"
#include "common/rpc/identity.h"
#include "mortise/v1/operations.pb.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::jobs {
class Operations;
}
namespace mortise::store {
class Store;
class Transaction;
}  // namespace mortise::store

namespace mortise::simulator {

class SimulatorCore;

// The kind of records that hold analyses, by id.
inline constexpr char kAnalysisKind[] = "analyses";

// What the keys of their tasks begin with.
inline constexpr char kAnalysisTaskPrefix[] = "analysis-";

// Looks the template up and checks the parameters: the task a worker will be given.
absl::StatusOr<v1::Task> PrepareAnalysis(SimulatorCore& core, const v1::AnalyzeDesignRequest& asked,
                                         const rpc::Origin& origin);

// The task of a case that has passed CheckMeshCase: the catalog's numbers take the place of its
// materials' names. Fails as CheckMeshCase does, NOT_FOUND for unknown materials, UNAVAILABLE.
absl::StatusOr<v1::Task> PrepareMeshAnalysis(SimulatorCore& core,
                                             const v1::AnalyzeMeshRequest& asked,
                                             const rpc::Origin& origin);

// Starts the operation in the caller's transaction.
absl::StatusOr<v1::Operation> StartAnalysis(jobs::Operations& operations, const v1::Task& task,
                                            const rpc::Call& call, store::Transaction& transaction);

// Names the handler: it queues the task, waits for a worker, and keeps the Analysis.
void RegisterAnalysis(jobs::Operations& operations, const std::shared_ptr<SimulatorCore>& core);

// NOT_FOUND naming the analysis.
absl::StatusOr<v1::Analysis> ReadAnalysis(store::Store& store, const std::string& id);

}  // namespace mortise::simulator
