#include "services/simulator/evaluator_service.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/handler.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/design_analysis.h"
#include "services/simulator/result_cache.h"
#include "services/simulator/simulator_core.h"
#include "services/simulator/template_model.h"

namespace mortise::simulator {
namespace {

constexpr int kMaximumPoints = 1000;
constexpr std::size_t kCachedResults = 20000;

using ResultWriter = std::shared_ptr<rpc::StreamWriter<v1::EvaluationResult>>;

// OK if the point can be evaluated at all.
absl::Status CheckPoint(const v1::DesignPoint& point,
                        const std::vector<parametric::Parameter>& parameters,
                        const std::string& field) {
  if (point.parameters_size() != static_cast<int>(parameters.size())) {
    return InvalidField(field + ".parameters", absl::StrCat("must be ", parameters.size(),
                                                            " values, one for each parameter"));
  }
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const parametric::Parameter& parameter = parameters[k];
    const double slack = 1e-9 * (parameter.maximum - parameter.minimum);
    const double value = point.parameters(static_cast<int>(k));
    if (value >= parameter.minimum - slack && value <= parameter.maximum + slack) continue;
    return InvalidField(absl::StrCat(field, ".parameters[", k, "]"),
                        absl::StrCat(parameter.name, " must be within ", parameter.minimum, " to ",
                                     parameter.maximum));
  }
  return absl::OkStatus();
}

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
        ResultWriter writer, int points)
      : core_(std::move(core)), cache_(std::move(cache)), writer_(writer), remaining_(points) {}

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

  void WaitFor(const std::string& key, int index) {
    const int64_t ticket = core_->waiters().Add(
        key, [self = shared_from_this(), index](const store::Task& task, bool known_before) {
          self->SendTask(index, task, known_before);
        });
    const std::lock_guard lock(mutex_);
    waiting_.emplace_back(key, ticket);
  }

  // Nobody reads any more: what only this stream wanted need not be begun. What is under way is
  // finished and kept: streams break off and are asked for again.
  void Abandon() {
    std::vector<std::pair<std::string, int64_t>> waiting;
    {
      const std::lock_guard lock(mutex_);
      waiting.swap(waiting_);
    }
    for (const auto& [key, ticket] : waiting) {
      if (core_->waiters().Remove(key, ticket)) core_->CancelIfQueued(key);
    }
  }

 private:
  const std::shared_ptr<SimulatorCore> core_;
  const std::shared_ptr<ResultCache> cache_;
  const std::weak_ptr<rpc::StreamWriter<v1::EvaluationResult>> writer_;
  std::mutex mutex_;
  int remaining_;                                         // guarded by mutex_
  std::vector<std::pair<std::string, int64_t>> waiting_;  // guarded by mutex_: key, ticket
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
        [this](const rpc::Call& call, const v1::DescribeDesignSpaceRequest& asked) {
          return Describe(call, asked);
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
  absl::StatusOr<v1::DesignSpace> Describe(const rpc::Call& call,
                                           const v1::DescribeDesignSpaceRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(
        const auto compiled,
        core_->templates().Get(asked.subject(), asked.revision(), rpc::ForwardedFrom(call)));
    v1::DesignSpace space;
    space.set_subject(compiled->name);
    space.set_revision(compiled->revision);
    for (const parametric::Parameter& parameter : compiled->function->parameters()) {
      auto* described = space.add_parameters();
      described->set_name(parameter.name);
      described->set_unit(parameter.unit);
      described->set_minimum(parameter.minimum);
      described->set_maximum(parameter.maximum);
      described->set_default_value(parameter.default_value);
      described->set_step(parameter.step);
    }
    for (const MetricDescription& metric : OfferedMetrics()) {
      auto* described = space.add_metrics();
      described->set_name(metric.name);
      described->set_unit(metric.unit);
      described->set_description(metric.description);
      described->set_offers_gradient(OffersGradient(*compiled->function, metric.name));
    }
    return space;
  }

  absl::Status Evaluate(const rpc::Call& call, const v1::EvaluateBatchRequest& asked,
                        const ResultWriter& writer) {
    if (asked.points_size() < 1 || asked.points_size() > kMaximumPoints) {
      return InvalidField("points", absl::StrCat("must be 1 to ", kMaximumPoints));
    }
    const std::vector<std::string> metrics(asked.metrics().begin(), asked.metrics().end());
    MORTISE_RETURN_IF_ERROR(CheckMetricNames(metrics));
    if (asked.mesh().element_size() < 0) {
      return InvalidField("mesh.element_size", "must be positive, or 0 for the default");
    }
    MORTISE_ASSIGN_OR_RETURN(
        const auto compiled,
        core_->templates().Get(asked.subject(), asked.revision(), rpc::ForwardedFrom(call)));
    auto batch = std::make_shared<Batch>(core_, cache_, writer, asked.points_size());
    writer->OnEnd([batch] { batch->Abandon(); });

    v1::Task task;
    task.set_evaluator(kSimulatorQueue);
    task.set_subject(compiled->name);
    task.set_revision(compiled->revision);
    task.set_digest(compiled->digest);
    *task.mutable_metrics() = asked.metrics();
    task.set_gradients(asked.gradients());
    *task.mutable_mesh() = asked.mesh();
    task.set_trace_id(call.identity().request_id);
    const std::string what =
        absl::StrCat(asked.gradients() ? "gradients of " : "", absl::StrJoin(metrics, ","));
    for (int i = 0; i < asked.points_size(); ++i) {
      const absl::Status usable = CheckPoint(asked.points(i), compiled->function->parameters(),
                                             absl::StrCat("points[", i, "]"));
      if (!usable.ok()) {
        batch->Send(FailedResult(i, usable));
        continue;
      }
      *task.mutable_point() = asked.points(i);
      Submit(task, what, i, batch);
    }
    return absl::OkStatus();
  }

  void Submit(const v1::Task& task, const std::string& what, int index,
              const std::shared_ptr<Batch>& batch) {
    const Eigen::VectorXd parameters = Eigen::Map<const Eigen::VectorXd>(
        task.point().parameters().data(), task.point().parameters_size());
    const std::string key = EvaluationKey(task.digest(), parameters, task.mesh().element_size(),
                                          task.mesh().linear(), what);
    if (const auto known = cache_->Find(key)) {
      v1::EvaluationResult result;
      result.ParseFromString(*known);
      result.set_index(index);
      result.set_cached(true);
      return batch->Send(result);
    }
    // Waits before it asks, so that a result that comes in between is not missed.
    batch->WaitFor(key, index);
    bool was_there = false;
    const auto queued = core_->Enqueue(key, task.SerializeAsString(), 0, was_there);
    if (!queued.ok()) {
      store::Task failed;
      failed.key = key;
      failed.state = store::TaskState::kFailed;
      failed.error = EncodeError(queued.status());
      return core_->waiters().Notify(failed, false);
    }
    if (!IsFinished(*queued)) return;
    core_->waiters().Notify(*queued, was_there);
  }

  const std::shared_ptr<SimulatorCore> core_;
  const std::shared_ptr<ResultCache> cache_ = std::make_shared<ResultCache>(kCachedResults);
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeEvaluatorService(const std::shared_ptr<SimulatorCore>& core) {
  return std::make_shared<EvaluatorAdapter>(core);
}

}  // namespace mortise::simulator
