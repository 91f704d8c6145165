// Batches over gRPC, with repetition of what got lost.
#include "common/evaluation/evaluator_client.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/base/string_views.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"

namespace mortise::evaluation {

// The designs of one call of Evaluate, and what is known of them.
struct EvaluatorClient::Batch {
  const std::vector<Eigen::VectorXd>& designs;
  std::vector<Answer> answers;
  std::vector<bool> answered;

  explicit Batch(const std::vector<Eigen::VectorXd>& asked)
      : designs(asked), answers(asked.size()), answered(asked.size(), false) {}

  bool Complete() const {
    return std::find(answered.begin(), answered.end(), false) == answered.end();
  }

  std::vector<std::size_t> Unanswered() const {
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < designs.size(); ++i) {
      if (!answered[i]) left.push_back(i);
    }
    return left;
  }
};

namespace {

constexpr absl::Duration kFirstDelay = absl::Milliseconds(100);
constexpr absl::Duration kMaxDelay = absl::Seconds(2);
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Of a call: it got lost, took too long, or there were too many.
bool WorthRepeating(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsAborted(status) ||
         absl::IsResourceExhausted(status) || absl::IsDeadlineExceeded(status);
}

// Of one design: its evaluation got lost. One that takes too much memory or time has failed.
bool GotLost(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsAborted(status) || absl::IsCancelled(status);
}

absl::Status ErrorOf(const v1::EvaluationResult& result) {
  if (!result.has_error()) return absl::OkStatus();
  absl::Status error = rpc::FromProto(result.error());
  return error.ok() ? absl::UnknownError(result.error().message()) : error;
}

Eigen::VectorXd ValuesOf(const v1::EvaluationResult& result,
                         const v1::EvaluateBatchRequest& question) {
  Eigen::VectorXd values = Eigen::VectorXd::Constant(question.metrics_size(), kNone);
  for (int i = 0; i < question.metrics_size(); ++i) {
    for (const v1::Metric& given : result.metrics()) {
      if (given.name() == question.metrics(i)) values[i] = given.value();
    }
  }
  return values;
}

// Names the file of an answer, or fails it.
void ReadFile(const v1::EvaluationResult& result, Answer& answer) {
  if (!result.design_fields().sha256().empty()) {
    answer.file = {result.design_fields().sha256(), result.design_fields().size()};
    return;
  }
  answer.status = WithDetail(
      absl::InternalError("the evaluator gave no shape and fields, which were asked for"),
      {"FILE_MISSING", ""});
}

absl::StatusOr<Eigen::MatrixXd> GradientsOf(const v1::EvaluationResult& result,
                                            const v1::EvaluateBatchRequest& question,
                                            Eigen::Index parameters) {
  Eigen::MatrixXd gradients;
  for (int i = 0; i < question.metrics_size(); ++i) {
    for (const v1::Gradient& gradient : result.gradients()) {
      if (gradient.metric() != question.metrics(i)) continue;
      if (gradient.values_size() != parameters) {
        return absl::InternalError(absl::StrCat("the evaluator's gradient of '", gradient.metric(),
                                                "' has ", gradient.values_size(), " values"));
      }
      if (gradients.size() == 0) {
        gradients = Eigen::MatrixXd::Constant(question.metrics_size(), parameters, kNone);
      }
      gradients.row(i) = Eigen::RowVectorXd::Map(gradient.values().data(), gradient.values_size());
    }
  }
  return gradients;
}

}  // namespace

EvaluatorClient::EvaluatorClient(std::shared_ptr<grpc::Channel> channel,
                                 const v1::EvaluateBatchRequest& question,
                                 std::function<rpc::Origin(absl::Duration)> make_origin,
                                 const Options& options)
    : channel_(std::move(channel)),
      question_(std::make_unique<v1::EvaluateBatchRequest>(question)),
      make_origin_(std::move(make_origin)),
      options_(options) {}

EvaluatorClient::~EvaluatorClient() = default;

void EvaluatorClient::Interrupt() {
  const std::lock_guard lock(mutex_);
  interrupted_ = true;
  for (grpc::ClientContext* context : active_) context->TryCancel();
  interruption_.notify_all();
}

// Waits; false if interrupted meanwhile.
bool EvaluatorClient::PauseBefore(absl::Duration delay) {
  std::unique_lock lock(mutex_);
  return !interruption_.wait_for(lock, absl::ToChronoMilliseconds(delay),
                                 [&] { return interrupted_; });
}

// A failure is of the evaluator, not of the design.
absl::Status EvaluatorClient::Read(const v1::EvaluationResult& result,
                                   const std::vector<std::size_t>& asked, Batch& batch) const {
  if (result.index() < 0 || result.index() >= static_cast<int>(asked.size())) {
    return absl::InternalError("the evaluator answered for a design that was not asked for");
  }
  const std::size_t i = asked[static_cast<std::size_t>(result.index())];
  Answer answer;
  answer.status = ErrorOf(result);
  if (GotLost(answer.status)) return absl::OkStatus();
  if (answer.status.ok()) {
    answer.values = ValuesOf(result, *question_);
    MORTISE_ASSIGN_OR_RETURN(answer.gradients,
                             GradientsOf(result, *question_, batch.designs[i].size()));
    if (question_->has_design_fields()) ReadFile(result, answer);
  }
  batch.answers[i] = std::move(answer);
  batch.answered[i] = true;
  return absl::OkStatus();
}

absl::Status EvaluatorClient::CallOnce(Batch& batch) {
  v1::EvaluateBatchRequest request = *question_;
  const std::vector<std::size_t> asked = batch.Unanswered();
  for (const std::size_t i : asked) {
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
    wrong = Read(result, asked, batch);
    if (!wrong.ok()) context->TryCancel();
  }
  const absl::Status finished = rpc::FromGrpc(reader->Finish());
  const std::lock_guard lock(mutex_);
  active_.erase(context.get());
  if (!wrong.ok()) return wrong;
  if (batch.Complete()) return absl::OkStatus();
  // Nobody here gave it up: whoever served it goes away.
  if (absl::IsCancelled(finished) && !interrupted_) {
    return PeerUnavailable("evaluator", StandardView(finished.message()));
  }
  if (!finished.ok()) return finished;
  return PeerUnavailable("evaluator", "designs were left without an answer");
}

absl::StatusOr<std::vector<Answer>> EvaluatorClient::Evaluate(
    const std::vector<Eigen::VectorXd>& designs) {
  Batch batch(designs);
  absl::Time end = absl::Now() + options_.patience;
  absl::Duration delay = kFirstDelay;
  while (true) {
    const absl::Status status = CallOnce(batch);
    if (status.ok()) return std::move(batch.answers);
    if (!WorthRepeating(status)) return status;
    // A call that took too long was not lost: who computes may be slow, or come later.
    if (absl::IsDeadlineExceeded(status)) end = absl::Now() + options_.patience;
    if (absl::Now() >= end) return status;
    if (!PauseBefore(delay)) return absl::CancelledError("interrupted");
    delay = std::min(2 * delay, kMaxDelay);
  }
}

}  // namespace mortise::evaluation
