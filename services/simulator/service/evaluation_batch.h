// A stream of results: tasks queued or found, waited for, and told as they finish.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/rpc/handler.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/service/serial_executor.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/worker/result_cache.h"

namespace mortise::simulator {

// Its tasks' callbacks hold it; it lets go of the writer when the stream ends. Thread safe.
class EvaluationBatch : public std::enable_shared_from_this<EvaluationBatch> {
 public:
  using Writer = std::shared_ptr<rpc::StreamWriter<v1::EvaluationResult>>;
  // Is called once, on whichever thread learns of the result.
  using Receiver = std::function<void(v1::EvaluationResult result)>;

  struct Evaluation {
    v1::Task task;
    Receiver receive;
  };

  // The stream ends with the result of the last of so many points.
  EvaluationBatch(std::shared_ptr<SimulatorCore> core, std::shared_ptr<ResultCache> cache,
                  std::shared_ptr<SerialExecutor> queueing, const Writer& writer, int points);

  // Gives what is known at once and queues the rest: a few at a time, and of one batch at a time,
  // so that workers' calls are handled in between.
  void Evaluate(std::vector<Evaluation> evaluations);

  // Sends the result of a point.
  void Send(const v1::EvaluationResult& result);

  // Says that nobody reads any more: what only this stream wanted is not begun, and what is under
  // way is stopped, unless it is asked for again within a moment, as after a restart.
  void Abandon();

 private:
  struct Queued {
    std::string key;
    Evaluation evaluation;
  };
  struct Waiting {
    std::string key;
    int64_t ticket = 0;
  };

  void Enqueue(std::vector<Queued> queued);
  void EnqueueSome(std::vector<Queued> queued);
  void EnqueueNow(const std::vector<WantedTask>& tasks);
  void Receive(const store::Task& task, bool known, const Queued& wanted);
  v1::EvaluationResult ResultOf(const store::Task& task, bool cached);
  bool IsAbandoned() const;

  const std::shared_ptr<SimulatorCore> core_;
  const std::shared_ptr<ResultCache> cache_;
  const std::shared_ptr<SerialExecutor> queueing_;
  const std::weak_ptr<rpc::StreamWriter<v1::EvaluationResult>> writer_;
  mutable std::mutex mutex_;
  int remaining_;                 // guarded by mutex_
  bool is_abandoned_ = false;     // guarded by mutex_
  std::vector<Waiting> waiting_;  // guarded by mutex_; their tasks have been queued
};

// Returns what a point gives that could not be evaluated.
v1::EvaluationResult FailedResult(const absl::Status& status);

// Makes the receiver for the evaluation of `task`, which asks for gradients: adds to its result, by
// differences of `step`, those that are missing, and gives it to `receive`. What is beside a point
// is evaluated after the point, so that nothing is wasted on one that cannot be.
EvaluationBatch::Receiver WithDifferences(const std::shared_ptr<EvaluationBatch>& batch,
                                          const std::shared_ptr<const v1::DesignSpace>& space,
                                          const v1::Task& task, double step,
                                          const EvaluationBatch::Receiver& receive);

}  // namespace mortise::simulator
