#include "services/simulator/evaluator_service.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <mutex>
#include <optional>
#include <ranges>
#include <type_traits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/parametric/evaluation_settings.h"
#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/handler.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/evaluation_subject.h"
#include "services/simulator/evaluator_records.h"
#include "services/simulator/result_cache.h"
#include "services/simulator/result_key.h"
#include "services/simulator/serial_executor.h"
#include "services/simulator/simulator_core.h"
#include "services/simulator/subject_metrics.h"

namespace mortise::simulator {
namespace {

constexpr int kMaximumPoints = 1000;
constexpr std::size_t kCachedResults = 20000;
constexpr std::size_t kEnqueuedAtOnce = 32;  // in a transaction

using ResultWriter = std::shared_ptr<rpc::StreamWriter<v1::EvaluationResult>>;

v1::EvaluationResult FailedResult(int index, const absl::Status& status) {
  v1::EvaluationResult result;
  result.set_index(index);
  *result.mutable_error() = rpc::ToProto(status);
  return result;
}

// One stream of results. Its tasks' callbacks hold it; it lets go of the writer when the stream
// ends.
class Batch : public std::enable_shared_from_this<Batch> {
 public:
  Batch(std::shared_ptr<SimulatorCore> core, std::shared_ptr<ResultCache> cache,
        std::shared_ptr<SerialExecutor> queueing, ResultWriter writer, int points)
      : core_(std::move(core)),
        cache_(std::move(cache)),
        queueing_(std::move(queueing)),
        writer_(writer),
        remaining_(points) {}

  // Sends the result of one point; the last one ends the stream.
  void Send(const v1::EvaluationResult& result) {
    const auto writer = writer_.lock();
    if (writer == nullptr) return;
    writer->Write(result);
    bool last = false;
    {
      const std::lock_guard lock(mutex_);
      last = --remaining_ == 0;
    }
    if (last) writer->Finish(absl::OkStatus());
  }

  // Sends what a finished task gave.
  void SendTask(int index, const store::Task& task, bool cached) {
    v1::ReportTaskRequest report;
    if (const absl::Status status = TaskError(task); !status.ok()) {
      return Send(FailedResult(index, status));
    }
    if (!report.ParseFromString(task.result)) {
      return Send(FailedResult(index, absl::InternalError("a stored result cannot be read")));
    }
    cache_->Store(task.key, report.result().SerializeAsString());
    v1::EvaluationResult result = report.result();
    result.set_index(index);
    result.set_cached(cached);
    Send(result);
  }

  // Sends a result of the cache.
  void SendKnown(int index, const std::string& bytes) {
    v1::EvaluationResult result;
    result.ParseFromString(bytes);
    result.set_index(index);
    result.set_cached(true);
    Send(result);
  }

  // Queues tasks and sends their results, each with its index. A few at a time, and of one batch at
  // a time: workers' calls are handled in between.
  void Enqueue(std::vector<std::pair<int, WantedTask>> wanted) {
    if (wanted.empty()) return;
    queueing_->Submit([self = shared_from_this(), wanted = std::move(wanted)]() mutable {
      self->EnqueueSome(std::move(wanted));
    });
  }

  // Nobody reads any more: what only this stream wanted need not be begun. What is under way is
  // finished and kept: streams break off and are asked for again.
  void Abandon() {
    std::vector<Waiting> waiting;
    {
      const std::lock_guard lock(mutex_);
      is_abandoned_ = true;
      waiting.swap(waiting_);
    }
    for (const auto& [key, ticket] : waiting) {
      if (core_->waiters().Remove(key, ticket)) core_->CancelIfQueued(key);
    }
  }

 private:
  struct Waiting {
    std::string key;
    int64_t ticket = 0;
  };

  void EnqueueSome(std::vector<std::pair<int, WantedTask>> wanted) {
    if (is_abandoned()) return;
    const std::size_t count = std::min(wanted.size(), kEnqueuedAtOnce);
    const auto next = wanted.begin() + static_cast<std::ptrdiff_t>(count);
    std::vector<WantedTask> tasks;
    std::vector<Waiting> waiting;
    for (auto& [index, task] : std::ranges::subrange(wanted.begin(), next)) {
      // Waits before it asks, so that a result that comes in between is not missed.
      waiting.push_back(WaitFor(task.key, index));
      tasks.push_back(std::move(task));
    }
    EnqueueNow(tasks);
    Keep(std::move(waiting));
    if (is_abandoned()) return Abandon();  // what was queued since
    wanted.erase(wanted.begin(), next);
    Enqueue(std::move(wanted));
  }

  // Those that have finished, or cannot be queued, are told to who waits for them.
  void EnqueueNow(const std::vector<WantedTask>& tasks) {
    const auto found = core_->Enqueue(tasks);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      if (!found.ok()) {
        store::Task failed;
        failed.key = tasks[i].key;
        failed.state = store::TaskState::kFailed;
        failed.error = EncodeError(found.status());
        core_->waiters().Notify(failed, false);
      } else if (const auto& [finished, known_before] = (*found)[i]; finished) {
        core_->waiters().Notify(*finished, known_before);
      }
    }
  }

  Waiting WaitFor(const std::string& key, int index) {
    const int64_t ticket = core_->waiters().Add(
        key, [self = shared_from_this(), index](const store::Task& task, bool known_before) {
          self->SendTask(index, task, known_before);
        });
    return {.key = key, .ticket = ticket};
  }

  // For Abandon, which would miss tasks that are not in the queue yet.
  void Keep(std::vector<Waiting> queued) {
    const std::lock_guard lock(mutex_);
    std::move(queued.begin(), queued.end(), std::back_inserter(waiting_));
  }

  bool is_abandoned() const {
    const std::lock_guard lock(mutex_);
    return is_abandoned_;
  }

  const std::shared_ptr<SimulatorCore> core_;
  const std::shared_ptr<ResultCache> cache_;
  const std::shared_ptr<SerialExecutor> queueing_;
  const std::weak_ptr<rpc::StreamWriter<v1::EvaluationResult>> writer_;
  mutable std::mutex mutex_;
  int remaining_;                 // guarded by mutex_
  bool is_abandoned_ = false;     // guarded by mutex_
  std::vector<Waiting> waiting_;  // guarded by mutex_; their tasks have been queued
};

class EvaluatorAdapter final : public v1::EvaluatorService::CallbackService {
 public:
  explicit EvaluatorAdapter(const std::shared_ptr<SimulatorCore>& core)
      : core_(core), endpoint_(core->dispatcher(), "mortise.v1.EvaluatorService") {}

  grpc::ServerUnaryReactor* DescribeDesignSpace(grpc::CallbackServerContext* context,
                                                const v1::DescribeDesignSpaceRequest* request,
                                                v1::DesignSpace* response) override {
    return endpoint_.Query(
        "DescribeDesignSpace", context, request, response,
        [this](const rpc::Call& call,
               const v1::DescribeDesignSpaceRequest& asked) -> absl::StatusOr<v1::DesignSpace> {
          MORTISE_ASSIGN_OR_RETURN(
              EvaluationSubject subject,
              FindSubject(*core_, asked.subject(), asked.revision(), asked.metric_definitions(),
                          rpc::ForwardedFrom(call)));
          return std::move(subject.space);
        });
  }

  grpc::ServerUnaryReactor* CreateEvaluator(grpc::CallbackServerContext* context,
                                            const v1::CreateEvaluatorRequest* request,
                                            v1::Evaluator* response) override {
    return endpoint_.Mutation("CreateEvaluator", context, request, response,
                              [](const rpc::Call& call, const v1::CreateEvaluatorRequest& asked,
                                 store::Transaction& transaction) -> absl::StatusOr<v1::Evaluator> {
                                MORTISE_RETURN_IF_ERROR(CheckEvaluator(asked.evaluator()));
                                return simulator::CreateEvaluator(transaction, asked.evaluator(),
                                                                  call.identity().request_id);
                              });
  }

  grpc::ServerUnaryReactor* GetEvaluator(grpc::CallbackServerContext* context,
                                         const v1::GetEvaluatorRequest* request,
                                         v1::Evaluator* response) override {
    return endpoint_.Query("GetEvaluator", context, request, response,
                           [this](const rpc::Call&, const v1::GetEvaluatorRequest& asked) {
                             return Read([&](store::ReadTransaction& read) {
                               return simulator::GetEvaluator(read, asked.name(), "name");
                             });
                           });
  }

  grpc::ServerUnaryReactor* ListEvaluators(grpc::CallbackServerContext* context,
                                           const v1::ListEvaluatorsRequest* request,
                                           v1::ListEvaluatorsResponse* response) override {
    return endpoint_.Query("ListEvaluators", context, request, response,
                           [this](const rpc::Call&, const v1::ListEvaluatorsRequest& asked) {
                             return Read([&](store::ReadTransaction& read) {
                               return simulator::ListEvaluators(read, asked);
                             });
                           });
  }

  grpc::ServerUnaryReactor* DeleteEvaluator(grpc::CallbackServerContext* context,
                                            const v1::DeleteEvaluatorRequest* request,
                                            v1::DeleteEvaluatorResponse* response) override {
    return endpoint_.Mutation(
        "DeleteEvaluator", context, request, response,
        [](const rpc::Call& call, const v1::DeleteEvaluatorRequest& asked,
           store::Transaction& transaction) -> absl::StatusOr<v1::DeleteEvaluatorResponse> {
          MORTISE_RETURN_IF_ERROR(
              simulator::DeleteEvaluator(transaction, asked.name(), call.identity().request_id));
          return v1::DeleteEvaluatorResponse();
        });
  }

  grpc::ServerWriteReactor<v1::EvaluationResult>* EvaluateBatch(
      grpc::CallbackServerContext* context, const v1::EvaluateBatchRequest* request) override {
    return endpoint_.ServerStream<v1::EvaluationResult>(
        "EvaluateBatch", context, request,
        [this](const rpc::Call& call, const v1::EvaluateBatchRequest& asked,
               const ResultWriter& writer) { return Evaluate(call, asked, writer); },
        {.capacity = kMaximumPoints + 8});
  }

 private:
  // What `find` gives, of one state of the store.
  template <typename Find>
  std::invoke_result_t<Find, store::ReadTransaction&> Read(const Find& find) {
    std::optional<std::invoke_result_t<Find, store::ReadTransaction&>> found;
    MORTISE_RETURN_IF_ERROR(core_->store()->Read([&](store::ReadTransaction& read) {
      found = find(read);
      return found->status();
    }));
    return *std::move(found);
  }

  absl::Status Evaluate(const rpc::Call& call, const v1::EvaluateBatchRequest& asked,
                        const ResultWriter& writer) {
    if (asked.points_size() < 1 || asked.points_size() > kMaximumPoints) {
      return InvalidField("points", absl::StrCat("must be 1 to ", kMaximumPoints));
    }
    const std::vector<std::string> metrics(asked.metrics().begin(), asked.metrics().end());
    MORTISE_RETURN_IF_ERROR(parametric::CheckMeshSettings(asked.mesh()));
    MORTISE_RETURN_IF_ERROR(parametric::ReadAirflow(asked.airflow()).status());
    MORTISE_ASSIGN_OR_RETURN(const EvaluationSubject subject,
                             FindSubject(*core_, asked.subject(), asked.revision(),
                                         asked.metric_definitions(), rpc::ForwardedFrom(call)));
    MORTISE_RETURN_IF_ERROR(CheckMetrics(subject.space, metrics));
    auto batch = std::make_shared<Batch>(core_, cache_, queueing_, writer, asked.points_size());
    writer->OnEnd([batch] { batch->Abandon(); });

    v1::Task task;
    task.set_evaluator(subject.queue);
    task.set_subject(subject.space.subject());
    task.set_revision(subject.space.revision());
    task.set_digest(subject.digest);
    *task.mutable_metrics() = asked.metrics();
    task.set_gradients(asked.gradients());
    *task.mutable_mesh() = asked.mesh();
    *task.mutable_metric_definitions() = asked.metric_definitions();
    if (asked.has_airflow()) *task.mutable_airflow() = asked.airflow();
    task.set_trace_id(call.identity().request_id);
    std::vector<std::pair<int, WantedTask>> wanted;
    for (int i = 0; i < asked.points_size(); ++i) {
      const absl::Status usable =
          CheckPoint(subject.space, asked.points(i), absl::StrCat("points[", i, "]"));
      if (!usable.ok()) {
        batch->Send(FailedResult(i, usable));
        continue;
      }
      *task.mutable_point() = asked.points(i);
      const std::string key = ResultKey(task);
      if (const auto known = cache_->Find(key)) {
        batch->SendKnown(i, *known);
        continue;
      }
      wanted.emplace_back(i, WantedTask{.key = key, .payload = task.SerializeAsString()});
    }
    batch->Enqueue(std::move(wanted));
    return absl::OkStatus();
  }

  const std::shared_ptr<SimulatorCore> core_;
  const std::shared_ptr<ResultCache> cache_ = std::make_shared<ResultCache>(kCachedResults);
  const std::shared_ptr<SerialExecutor> queueing_ =
      std::make_shared<SerialExecutor>(core_->dispatcher());
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeEvaluatorService(const std::shared_ptr<SimulatorCore>& core) {
  return std::make_shared<EvaluatorAdapter>(core);
}

}  // namespace mortise::simulator
