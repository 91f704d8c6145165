// Asks the evaluator of a map.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/evaluation/evaluator_client.h"
#include "common/host/run_service.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/building/map_building.h"

namespace mortise::interpolator {

// The evaluator as operations ask it: as the service itself. Thread safe.
class MapEvaluator {
 public:
  // The environment outlives it. FAILED_PRECONDITION, PEER_UNKNOWN.
  static absl::StatusOr<std::unique_ptr<MapEvaluator>> Create(
      rpc::ServiceEnvironment& environment, const v1::MapSpecification& specification);

  // Describes the subject; an evaluator that is away is waited for, as long as `stop` is not asked.
  absl::StatusOr<std::unique_ptr<v1::DesignSpace>> Describe(const std::stop_token& stop) const;

  // Returns an answer for each design, in the same order. As EvaluatorClient::Evaluate.
  absl::StatusOr<std::vector<DesignAnswer>> Evaluate(const std::vector<Eigen::VectorXd>& designs);

  void Interrupt() { client_.Interrupt(); }

 private:
  MapEvaluator(rpc::ServiceEnvironment& environment, std::shared_ptr<grpc::Channel> channel,
               const v1::MapSpecification& specification);

  const rpc::ServiceEnvironment& environment_;
  const std::string trace_id_;
  const std::shared_ptr<grpc::Channel> channel_;
  const v1::DescribeDesignSpaceRequest description_;
  evaluation::EvaluatorClient client_;
};

}  // namespace mortise::interpolator
