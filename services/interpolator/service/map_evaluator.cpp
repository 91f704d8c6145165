#include "services/interpolator/service/map_evaluator.h"

#include <utility>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/evaluation/described_design_space.h"
#include "common/rpc/channel.h"
#include "services/interpolator/service/interpolator.h"
#include "services/interpolator/service/plan_request.h"

namespace mortise::interpolator {
namespace {

constexpr absl::Duration kDescribePatience = absl::Minutes(10);

}  // namespace

absl::StatusOr<std::unique_ptr<MapEvaluator>> MapEvaluator::Create(
    rpc::ServiceEnvironment& environment, const v1::MapSpecification& specification) {
  MORTISE_ASSIGN_OR_RETURN(auto channel, environment.peers->Channel(kEvaluatorPeer));
  return std::unique_ptr<MapEvaluator>(
      new MapEvaluator(environment, std::move(channel), specification));
}

MapEvaluator::MapEvaluator(rpc::ServiceEnvironment& environment,
                           std::shared_ptr<grpc::Channel> channel,
                           const v1::MapSpecification& specification)
    : environment_(environment),
      trace_id_(CurrentTraceId()),
      channel_(std::move(channel)),
      description_(DescriptionOf(specification)),
      client_(channel_, QuestionOf(specification),
              [this](absl::Duration timeout) {
                return rpc::OwnOrigin(environment_.signer, rpc::Role::kDesigner, trace_id_,
                                      timeout);
              },
              {}) {}

absl::StatusOr<std::unique_ptr<v1::DesignSpace>> MapEvaluator::Describe(
    const std::stop_token& stop) const {
  rpc::RetryOptions retry;
  retry.patience = kDescribePatience;
  retry.stop = stop;
  return evaluation::DescribeDesignSpace(
      channel_, description_,
      rpc::OwnOrigin(environment_.signer, rpc::Role::kDesigner, trace_id_, kDescribePatience),
      retry);
}

absl::StatusOr<std::vector<DesignAnswer>> MapEvaluator::Evaluate(
    const std::vector<Eigen::VectorXd>& designs) {
  MORTISE_ASSIGN_OR_RETURN(std::vector<evaluation::Answer> answers, client_.Evaluate(designs));
  std::vector<DesignAnswer> result;
  for (evaluation::Answer& answer : answers) {
    result.push_back({std::move(answer.status), std::move(answer.values)});
  }
  return result;
}

}  // namespace mortise::interpolator
