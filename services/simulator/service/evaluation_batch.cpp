#include "services/simulator/service/evaluation_batch.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <ranges>
#include <utility>

#include "common/rpc/status_mapping.h"
#include "services/simulator/service/difference_gradients.h"
#include "services/simulator/service/evaluation_tasks.h"
#include "services/simulator/service/evaluator_records.h"
#include "services/simulator/service/result_key.h"

namespace mortise::simulator {
namespace {

constexpr std::size_t kEnqueuedAtOnce = 32;  // in a transaction

std::optional<double> ValueOf(const v1::EvaluationResult& result, const std::string& metric) {
  if (result.has_error()) return std::nullopt;
  for (const v1::Metric& told : result.metrics()) {
    if (told.name() == metric) return told.value();
  }
  return std::nullopt;
}

// The metrics of a result that have no gradient yet.
std::vector<std::string> WithoutGradient(const v1::EvaluationResult& result) {
  std::vector<std::string> missing;
  for (const v1::Metric& metric : result.metrics()) {
    const bool is_there = std::ranges::any_of(result.gradients(), [&](const v1::Gradient& told) {
      return told.metric() == metric.name();
    });
    if (!is_there && !std::ranges::count(missing, metric.name())) missing.push_back(metric.name());
  }
  return missing;
}

// A point's result, and those of the designs beside it as they come in. Their callbacks hold it.
class DifferencedPoint : public std::enable_shared_from_this<DifferencedPoint> {
 public:
  DifferencedPoint(v1::EvaluationResult result, std::vector<DifferenceStencil> stencils,
                   EvaluationBatch::Receiver receive)
      : result_(std::move(result)),
        stencils_(std::move(stencils)),
        receive_(std::move(receive)),
        metrics_(WithoutGradient(result_)),
        beside_(stencils_.size()) {}

  // Evaluates all that is missing; `task` is that of the point.
  void Begin(EvaluationBatch& batch, const v1::DesignSpace& space, v1::Task task) {
    const v1::DesignPoint at = task.point();
    task.set_gradients(false);
    task.clear_design_fields();
    *task.mutable_metrics() = {metrics_.begin(), metrics_.end()};
    std::vector<EvaluationBatch::Evaluation> evaluations;
    for (int k = 0; k < space.parameters_size() && !metrics_.empty(); ++k) {
      if (stencils_[k].IsEmpty()) continue;
      for (int side = 0; side < 2; ++side) {
        *task.mutable_point() = PointAtOffset(space, at, k, stencils_[k].offsets[side]);
        evaluations.push_back({task, [self = shared_from_this(), k, side](auto result) {
                                 self->Take(k, side, std::move(result));
                               }});
      }
    }
    if (evaluations.empty()) return Finish();
    remaining_ = evaluations.size();
    batch.Evaluate(std::move(evaluations));
  }

 private:
  void Take(int parameter, int side, v1::EvaluationResult result) {
    {
      const std::lock_guard lock(mutex_);
      if (!result.cached()) result_.set_cached(false);
      beside_[parameter][side] = std::move(result);
      if (--remaining_ > 0) return;
    }
    Finish();
  }

  void Finish() {
    for (const std::string& metric : metrics_) AddGradient(metric);
    receive_(std::move(result_));
  }

  void AddGradient(const std::string& metric) {
    v1::Gradient gradient;
    gradient.set_metric(metric);
    gradient.set_by_differences(true);
    for (std::size_t k = 0; k < stencils_.size(); ++k) {
      const auto slope = SlopeAt(*ValueOf(result_, metric), stencils_[k],
                                 {ValueOf(beside_[k][0], metric), ValueOf(beside_[k][1], metric)});
      if (!slope) return;
      gradient.add_values(*slope);
    }
    *result_.add_gradients() = std::move(gradient);
  }

  v1::EvaluationResult result_;
  const std::vector<DifferenceStencil> stencils_;
  const EvaluationBatch::Receiver receive_;
  const std::vector<std::string> metrics_;  // without exact gradients
  std::mutex mutex_;
  std::vector<std::array<v1::EvaluationResult, 2>> beside_;  // guarded until all are there
  std::size_t remaining_ = 0;                                // guarded
};

}  // namespace

EvaluationBatch::EvaluationBatch(std::shared_ptr<SimulatorCore> core,
                                 std::shared_ptr<ResultCache> cache,
                                 std::shared_ptr<SerialExecutor> queueing, const Writer& writer,
                                 int points)
    : core_(std::move(core)),
      cache_(std::move(cache)),
      queueing_(std::move(queueing)),
      writer_(writer),
      remaining_(points) {}

void EvaluationBatch::Evaluate(std::vector<Evaluation> evaluations) {
  std::vector<Queued> queued;
  for (Evaluation& evaluation : evaluations) {
    std::string key = ResultKey(evaluation.task);
    v1::EvaluationResult result;
    // What is kept and damaged, or has lost its file, is evaluated again.
    if (const auto known = cache_->Find(key);
        known && result.ParseFromString(*known) && core_->KeepsFileOf(result)) {
      result.set_cached(true);
      evaluation.receive(std::move(result));
      continue;
    }
    queued.push_back({std::move(key), std::move(evaluation)});
  }
  Enqueue(std::move(queued));
}

void EvaluationBatch::Send(const v1::EvaluationResult& result) {
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

void EvaluationBatch::Abandon() {
  std::vector<Waiting> waiting;
  {
    const std::lock_guard lock(mutex_);
    is_abandoned_ = true;
    waiting.swap(waiting_);
    if (remaining_ == 0) return;  // all were answered
  }
  std::vector<std::string> given_up;
  for (const auto& [key, ticket] : waiting) {
    if (!core_->waiters().Remove(key, ticket)) continue;
    core_->CancelIfQueued(key);
    given_up.push_back(key);
  }
  core_->CancelUnlessWantedAgain(std::move(given_up));
}

void EvaluationBatch::Enqueue(std::vector<Queued> queued) {
  if (queued.empty()) return;
  queueing_->Submit([self = shared_from_this(), queued = std::move(queued)]() mutable {
    self->EnqueueSome(std::move(queued));
  });
}

void EvaluationBatch::EnqueueSome(std::vector<Queued> queued) {
  if (IsAbandoned()) return;
  const std::size_t count = std::min(queued.size(), kEnqueuedAtOnce);
  const auto next = queued.begin() + static_cast<std::ptrdiff_t>(count);
  std::vector<WantedTask> tasks;
  std::vector<Waiting> waiting;
  for (auto& [key, evaluation] : std::ranges::subrange(queued.begin(), next)) {
    tasks.push_back({.key = key, .payload = evaluation.task.SerializeAsString()});
    // Waits before it asks, so that a result that comes in between is not missed.
    const int64_t ticket = core_->waiters().Add(
        key, [self = shared_from_this(), wanted = Queued{key, std::move(evaluation)}](
                 const store::Task& task, bool known) { self->Receive(task, known, wanted); });
    waiting.push_back({std::move(key), ticket});
  }
  EnqueueNow(tasks);
  {
    // For Abandon, which would miss tasks that are not in the queue yet.
    const std::lock_guard lock(mutex_);
    std::ranges::move(waiting, std::back_inserter(waiting_));
  }
  if (IsAbandoned()) return Abandon();  // what was queued since
  queued.erase(queued.begin(), next);
  Enqueue(std::move(queued));
}

// Those that have finished, or cannot be queued, are told to who waits for them.
void EvaluationBatch::EnqueueNow(const std::vector<WantedTask>& tasks) {
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

// Whom a shared task was cancelled for, perhaps on another replica, is not this stream.
void EvaluationBatch::Receive(const store::Task& task, bool known, const Queued& wanted) {
  const bool again =
      task.state == store::TaskState::kCancelled && !IsEvaluatorName(QueueOf(task.key));
  if (again && !IsAbandoned()) return Enqueue({wanted});
  wanted.evaluation.receive(ResultOf(task, known));
}

// What a finished task gave.
v1::EvaluationResult EvaluationBatch::ResultOf(const store::Task& task, bool cached) {
  if (const absl::Status status = TaskError(task); !status.ok()) return FailedResult(status);
  v1::ReportTaskRequest report;
  if (!report.ParseFromString(task.result)) {
    return FailedResult(absl::InternalError("a stored result cannot be read"));
  }
  cache_->Store(task.key, report.result().SerializeAsString());
  v1::EvaluationResult result = std::move(*report.mutable_result());
  result.set_cached(cached);
  return result;
}

bool EvaluationBatch::IsAbandoned() const {
  const std::lock_guard lock(mutex_);
  return is_abandoned_;
}

v1::EvaluationResult FailedResult(const absl::Status& status) {
  v1::EvaluationResult result;
  *result.mutable_error() = rpc::ToProto(status);
  return result;
}

EvaluationBatch::Receiver WithDifferences(const std::shared_ptr<EvaluationBatch>& batch,
                                          const std::shared_ptr<const v1::DesignSpace>& space,
                                          const v1::Task& task, double step,
                                          const EvaluationBatch::Receiver& receive) {
  return [batch, space, task, step, receive](v1::EvaluationResult result) {
    if (result.has_error()) return receive(std::move(result));
    const auto point = std::make_shared<DifferencedPoint>(
        std::move(result), StencilsAround(*space, task.point(), step), receive);
    point->Begin(*batch, *space, task);
  };
}

}  // namespace mortise::simulator
