// Batches over gRPC, with repetition of what got lost.
#include "services/pareto/service/remote_evaluator.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/pareto.pb.h"

namespace mortise::pareto {
namespace {

constexpr absl::Duration kFirstDelay = absl::Milliseconds(100);
constexpr absl::Duration kMaxDelay = absl::Seconds(2);

// Of a call: it got lost, took too long, or there were too many.
bool WorthRepeating(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsAborted(status) ||
         absl::IsResourceExhausted(status) || absl::IsDeadlineExceeded(status);
}

// Of one design: its evaluation got lost. One that takes too much memory or time has failed.
bool GotLost(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsAborted(status) || absl::IsCancelled(status);
}

}  // namespace

// The designs of one call of Evaluate, and what is known of them.
struct RemoteEvaluator::Batch {
  const std::vector<Eigen::VectorXd>& designs;
  std::vector<Evaluation> results;
  std::vector<bool> answered;

  explicit Batch(const std::vector<Eigen::VectorXd>& asked)
      : designs(asked), results(asked.size()), answered(asked.size(), false) {}

  bool Complete() const {
    return std::find(answered.begin(), answered.end(), false) == answered.end();
  }
};

namespace {

// NaN if it was left out.
double ValueOf(const v1::EvaluationResult& result, const std::string& metric) {
  double value = std::numeric_limits<double>::quiet_NaN();
  for (const v1::Metric& given : result.metrics()) {
    if (given.name() == metric) value = given.value();
  }
  return value;
}

absl::StatusOr<std::optional<Eigen::RowVectorXd>> GradientOf(const v1::EvaluationResult& result,
                                                             const std::string& metric,
                                                             Eigen::Index size) {
  std::optional<Eigen::RowVectorXd> found;
  for (const v1::Gradient& gradient : result.gradients()) {
    if (gradient.metric() != metric) continue;
    if (gradient.values_size() != size) {
      return absl::InternalError(absl::StrCat("the evaluator's gradient of '", metric, "' has ",
                                              gradient.values_size(), " values"));
    }
    found = Eigen::RowVectorXd::Map(gradient.values().data(), gradient.values_size());
  }
  return found;
}

// Rows that are never set stay NaN.
void SetRow(const Eigen::RowVectorXd& gradient, Eigen::Index row, Eigen::Index rows,
            Eigen::MatrixXd& jacobian) {
  if (jacobian.size() == 0) {
    jacobian =
        Eigen::MatrixXd::Constant(rows, gradient.size(), std::numeric_limits<double>::quiet_NaN());
  }
  jacobian.row(row) = gradient;
}

// Which of the metrics that the problem asks for are not there as finite numbers; empty if all are.
std::string WhatIsMissing(const v1::EvaluationResult& result, const DiscoveryProblem& problem) {
  std::set<std::string> missing;
  for (const Objective& objective : problem.objectives) missing.insert(objective.metric);
  for (const Constraint& constraint : problem.constraints) missing.insert(constraint.metric);
  std::erase_if(missing,
                [&](const std::string& metric) { return std::isfinite(ValueOf(result, metric)); });
  if (missing.empty()) return "";
  return absl::StrCat("the evaluator left out a metric, or gave one that is not finite: ",
                      absl::StrJoin(missing, ", "));
}

absl::Status ReadResult(const v1::EvaluationResult& result, const DiscoveryProblem& problem,
                        Evaluation& evaluation) {
  if (result.has_error()) {
    evaluation.status = EvaluationStatus::kFailed;
    const absl::Status error = rpc::FromProto(result.error());
    evaluation.message = result.error().message();
    evaluation.reason = DetailOf(error).reason;
    evaluation.code = error.code();
    return absl::OkStatus();
  }
  const auto d = static_cast<Eigen::Index>(problem.objectives.size());
  evaluation.status = EvaluationStatus::kEvaluated;
  evaluation.metrics.resize(d);
  const Eigen::VectorXd signs = problem.Signs();
  for (Eigen::Index i = 0; i < d; ++i) {
    const std::string& name = problem.objectives[static_cast<std::size_t>(i)].metric;
    evaluation.metrics[i] = signs[i] * ValueOf(result, name);
    MORTISE_ASSIGN_OR_RETURN(const std::optional<Eigen::RowVectorXd> gradient,
                             GradientOf(result, name, problem.space.size()));
    if (gradient) SetRow(signs[i] * *gradient, i, d, evaluation.jacobian);
  }
  std::vector<double> rows;
  for (const Constraint& constraint : problem.constraints) {
    const auto first = static_cast<Eigen::Index>(rows.size());
    constraint.AppendTo(ValueOf(result, constraint.metric), rows);
    MORTISE_ASSIGN_OR_RETURN(const std::optional<Eigen::RowVectorXd> gradient,
                             GradientOf(result, constraint.metric, problem.space.size()));
    if (!gradient) continue;
    const Eigen::Index m = problem.options.constraints;
    if (constraint.maximum) SetRow(*gradient, first, m, evaluation.constraint_jacobian);
    if (constraint.minimum) {
      SetRow(-*gradient, first + constraint.rows() - 1, m, evaluation.constraint_jacobian);
    }
  }
  evaluation.constraints =
      Eigen::VectorXd::Map(rows.data(), static_cast<Eigen::Index>(rows.size()));
  evaluation.message = WhatIsMissing(result, problem);
  return absl::OkStatus();
}

}  // namespace

RemoteEvaluator::RemoteEvaluator(std::shared_ptr<grpc::Channel> channel,
                                 const v1::DiscoverySpecification& specification,
                                 const DiscoveryProblem& problem,
                                 std::function<rpc::Origin(absl::Duration)> make_origin,
                                 const Options& options)
    : channel_(std::move(channel)),
      specification_(std::make_unique<v1::DiscoverySpecification>(specification)),
      problem_(problem),
      make_origin_(std::move(make_origin)),
      options_(options) {}

RemoteEvaluator::~RemoteEvaluator() = default;

void RemoteEvaluator::Interrupt() {
  const std::lock_guard lock(mutex_);
  interrupted_ = true;
  for (grpc::ClientContext* context : active_) context->TryCancel();
  interruption_.notify_all();
}

// Waits; false if interrupted meanwhile.
bool RemoteEvaluator::PauseBefore(absl::Duration delay) {
  std::unique_lock lock(mutex_);
  return !interruption_.wait_for(lock, absl::ToChronoMilliseconds(delay),
                                 [&] { return interrupted_; });
}

absl::Status RemoteEvaluator::CallOnce(Batch& batch) {
  v1::EvaluateBatchRequest request;
  request.set_subject(specification_->subject());
  request.set_revision(specification_->revision());
  std::set<std::string> metrics;
  for (const Objective& objective : problem_.objectives) {
    if (metrics.insert(objective.metric).second) request.add_metrics(objective.metric);
  }
  for (const Constraint& constraint : problem_.constraints) {
    if (metrics.insert(constraint.metric).second) request.add_metrics(constraint.metric);
  }
  request.set_gradients(problem_.AnyGradient());
  if (specification_->has_mesh()) *request.mutable_mesh() = specification_->mesh();
  if (specification_->has_airflow()) *request.mutable_airflow() = specification_->airflow();
  *request.mutable_metric_definitions() = specification_->metric_definitions();
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < batch.designs.size(); ++i) {
    if (batch.answered[i]) continue;
    asked.push_back(i);
    request.add_points()->mutable_parameters()->Add(batch.designs[i].begin(),
                                                    batch.designs[i].end());
  }
  const std::unique_ptr<grpc::ClientContext> context =
      rpc::MakeClientContext(make_origin_(options_.longest_call));
  {
    const std::lock_guard lock(mutex_);
    if (interrupted_) return absl::CancelledError("interrupted");
    active_.insert(context.get());
  }
  const std::unique_ptr<v1::EvaluatorService::Stub> stub = v1::EvaluatorService::NewStub(channel_);
  const auto reader = stub->EvaluateBatch(context.get(), request);
  absl::Status wrong;
  v1::EvaluationResult result;
  while (wrong.ok() && reader->Read(&result)) {
    if (result.index() < 0 || result.index() >= static_cast<int>(asked.size())) {
      wrong = absl::InternalError("the evaluator answered for a design that was not asked for");
      context->TryCancel();
      break;
    }
    const std::size_t i = asked[static_cast<std::size_t>(result.index())];
    if (result.has_error() && GotLost(rpc::FromProto(result.error()))) continue;
    batch.results[i].x = batch.designs[i];
    wrong = ReadResult(result, problem_, batch.results[i]);
    batch.answered[i] = true;
  }
  const absl::Status finished = rpc::FromGrpc(reader->Finish());
  const std::lock_guard lock(mutex_);
  active_.erase(context.get());
  if (!wrong.ok()) return wrong;
  if (batch.Complete()) return absl::OkStatus();
  if (!finished.ok()) return finished;
  return PeerUnavailable("evaluator", "designs were left without an answer");
}

absl::StatusOr<std::vector<Evaluation>> RemoteEvaluator::Evaluate(
    const std::vector<Eigen::VectorXd>& designs) {
  Batch batch(designs);
  absl::Time end = absl::Now() + options_.patience;
  absl::Duration delay = kFirstDelay;
  while (true) {
    const absl::Status status = CallOnce(batch);
    if (status.ok()) return std::move(batch.results);
    if (!WorthRepeating(status)) return status;
    // A call that took too long was not lost: who computes may be slow, or come later.
    if (absl::IsDeadlineExceeded(status)) end = absl::Now() + options_.patience;
    if (absl::Now() >= end) return status;
    if (!PauseBefore(delay)) return absl::CancelledError("interrupted");
    delay = std::min(2 * delay, kMaxDelay);
  }
}

absl::StatusOr<std::unique_ptr<v1::DesignSpace>> DescribeDesignSpace(
    const std::shared_ptr<grpc::Channel>& channel, const v1::DiscoverySpecification& specification,
    const rpc::Origin& origin, const rpc::RetryOptions& retry) {
  v1::DescribeDesignSpaceRequest request;
  request.set_subject(specification.subject());
  request.set_revision(specification.revision());
  *request.mutable_metric_definitions() = specification.metric_definitions();
  const std::unique_ptr<v1::EvaluatorService::Stub> stub = v1::EvaluatorService::NewStub(channel);
  auto described = std::make_unique<v1::DesignSpace>();
  MORTISE_RETURN_IF_ERROR(rpc::CallWithRetry(origin, retry, [&](grpc::ClientContext* context) {
    described->Clear();
    return stub->DescribeDesignSpace(context, request, described.get());
  }));
  return described;
}

}  // namespace mortise::pareto
