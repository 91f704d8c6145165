// The methods of EvaluatorService that describe and evaluate subjects: templates and registered
// evaluators.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "mortise/v1/evaluator.pb.h"
#include "services/simulator/service/evaluation_batch.h"
#include "services/simulator/service/serial_executor.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/worker/result_cache.h"

namespace mortise::simulator::methods {

inline constexpr int kMaximumPoints = 1000;  // of a batch

// What evaluations stand on; batches keep it for as long as they run.
struct Evaluations {
  std::shared_ptr<SimulatorCore> core;
  std::shared_ptr<ResultCache> results;      // of this process, before those of the store
  std::shared_ptr<SerialExecutor> queueing;  // puts the tasks of one batch after another in line
};

absl::StatusOr<v1::DesignSpace> DescribeDesignSpace(const Evaluations& evaluations,
                                                    const rpc::Call& call,
                                                    const v1::DescribeDesignSpaceRequest& asked);

absl::Status EvaluateBatch(const Evaluations& evaluations, const rpc::Call& call,
                           const v1::EvaluateBatchRequest& asked,
                           const EvaluationBatch::Writer& writer);

}  // namespace mortise::simulator::methods
