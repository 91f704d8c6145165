#include "services/interpolator/service/map_evaluator.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/evaluation/described_design_space.h"
#include "common/rpc/channel.h"
#include "services/interpolator/service/interpolator.h"
#include "services/interpolator/service/plan_request.h"

namespace mortise::interpolator {
namespace {

constexpr absl::Duration kPatience = absl::Minutes(10);  // with an evaluator that is away
constexpr absl::Duration kLongestFetch = absl::Minutes(30);
constexpr int kTries = 3;  // of a file that is gone whenever it is asked for

rpc::Origin OriginOf(const rpc::ServiceEnvironment& environment, const std::string& trace_id,
                     absl::Duration timeout) {
  return rpc::OwnOrigin(environment.signer, rpc::Role::kDesigner, trace_id, timeout);
}

rpc::RetryOptions Patiently(const std::stop_token& stop) {
  rpc::RetryOptions retry;
  retry.patience = kPatience;
  retry.stop = stop;
  return retry;
}

}  // namespace

absl::StatusOr<std::unique_ptr<MapEvaluator>> MapEvaluator::Create(
    rpc::ServiceEnvironment& environment, const v1::MapSpecification& specification,
    const std::stop_token& stop) {
  MORTISE_ASSIGN_OR_RETURN(auto channel, environment.peers->Channel(kEvaluatorPeer));
  MORTISE_ASSIGN_OR_RETURN(
      auto described, evaluation::DescribeDesignSpace(
                          channel, DescriptionOf(specification),
                          OriginOf(environment, CurrentTraceId(), kPatience), Patiently(stop)));
  return std::unique_ptr<MapEvaluator>(
      new MapEvaluator(environment, std::move(channel), specification, std::move(described)));
}

MapEvaluator::MapEvaluator(rpc::ServiceEnvironment& environment,
                           std::shared_ptr<grpc::Channel> channel,
                           const v1::MapSpecification& specification,
                           std::unique_ptr<v1::DesignSpace> described)
    : environment_(environment),
      trace_id_(CurrentTraceId()),
      channel_(std::move(channel)),
      described_(std::move(described)),
      metrics_(specification.metrics_size()),
      client_(channel_, QuestionOf(specification, *described_),
              [this](absl::Duration timeout) { return OriginOf(environment_, trace_id_, timeout); },
              {}) {}

void MapEvaluator::Interrupt() {
  interruption_.request_stop();
  client_.Interrupt();
}

absl::StatusOr<std::vector<DesignAnswer>> MapEvaluator::Evaluate(
    const std::vector<Eigen::VectorXd>& designs) {
  MORTISE_ASSIGN_OR_RETURN(std::vector<evaluation::Answer> answers, client_.Evaluate(designs));
  std::vector<DesignAnswer> result;
  for (evaluation::Answer& answer : answers) {
    DesignAnswer& each = result.emplace_back();
    each.status = std::move(answer.status);
    if (!each.status.ok()) continue;
    each.values = answer.values.head(metrics_);
    if (!answer.file) continue;
    each.file = answer.file->sha256;
    Remember(each.file, designs[result.size() - 1]);
  }
  return result;
}

std::optional<Eigen::VectorXd> MapEvaluator::DesignOf(const std::string& file) const {
  const std::lock_guard lock(mutex_);
  const auto found = designs_.find(file);
  if (found == designs_.end()) return std::nullopt;
  return found->second;
}

void MapEvaluator::Remember(const std::string& file, const Eigen::VectorXd& design) {
  const std::lock_guard lock(mutex_);
  designs_[file] = design;
}

// What stands in the place of a file, itself if it is not gone as far as is known.
std::string MapEvaluator::PresentOf(const std::string& file) const {
  const std::lock_guard lock(mutex_);
  const auto renewed = renewed_.find(file);
  return renewed == renewed_.end() ? file : renewed->second;
}

absl::StatusOr<std::string> MapEvaluator::Fetch(const std::string& file) {
  const std::optional<Eigen::VectorXd> design = DesignOf(file);
  if (!design) return ResourceNotFound(absl::StrCat("blobs/", file));
  for (int i = 1;; ++i) {
    absl::StatusOr<std::string> bytes = evaluation::FetchDesignFile(
        channel_, PresentOf(file), OriginOf(environment_, trace_id_, kLongestFetch),
        Patiently(interruption_.get_token()));
    if (!absl::IsNotFound(bytes.status()) || i == kTries) return bytes;
    MORTISE_ASSIGN_OR_RETURN(const std::vector<DesignAnswer> answers, Evaluate({*design}));
    MORTISE_RETURN_IF_ERROR(answers.front().status);
    const std::lock_guard lock(mutex_);
    renewed_[file] = answers.front().file;
  }
}

}  // namespace mortise::interpolator
