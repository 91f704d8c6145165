// Evaluates the designs of a discovery through another process.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/evaluation/evaluator_client.h"
#include "common/rpc/channel.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/service/discovery_problem.h"

namespace mortise::v1 {
class DescribeDesignSpaceRequest;
}

namespace mortise::pareto {

// Thread safe. A design that cannot be evaluated is an Evaluation that failed; what got lost is
// asked for again, as evaluation::EvaluatorClient says.
class RemoteEvaluator : public Evaluator {
 public:
  // `make_origin` gives the identity and deadline of one call that may take so long. `problem`
  // outlives the evaluator.
  RemoteEvaluator(std::shared_ptr<grpc::Channel> channel,
                  const v1::DiscoverySpecification& specification, const DiscoveryProblem& problem,
                  std::function<rpc::Origin(absl::Duration)> make_origin,
                  const evaluation::EvaluatorClient::Options& options);

  absl::StatusOr<std::vector<Evaluation>> Evaluate(
      const std::vector<Eigen::VectorXd>& designs) override;
  void Interrupt() override { client_.Interrupt(); }

 private:
  const DiscoveryProblem& problem_;
  evaluation::EvaluatorClient client_;
};

// What to ask an evaluator of the subject for.
v1::DescribeDesignSpaceRequest DescriptionRequest(const v1::DiscoverySpecification& specification);

}  // namespace mortise::pareto
