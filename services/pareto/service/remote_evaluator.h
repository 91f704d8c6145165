// Evaluates designs through another process: any EvaluatorService.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/rpc/channel.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/service/discovery_problem.h"

namespace mortise::pareto {

// Thread safe. A call that fails because the evaluator is away (it restarts, say) is repeated for
// the designs that have no answer yet, for as long as `patience`; a design that cannot be evaluated
// is an Evaluation that failed.
class RemoteEvaluator : public Evaluator {
 public:
  struct Options {
    absl::Duration patience = absl::Minutes(10);
    absl::Duration longest_call = absl::Hours(1);
  };

  // `make_origin` gives the identity and deadline of one call that may take so long.
  RemoteEvaluator(std::shared_ptr<grpc::Channel> channel,
                  const v1::DiscoverySpecification& specification, const DiscoveryProblem& problem,
                  std::function<rpc::Origin(absl::Duration)> make_origin, const Options& options);
  ~RemoteEvaluator() override;

  absl::StatusOr<std::vector<Evaluation>> Evaluate(
      const std::vector<Eigen::VectorXd>& designs) override;
  void Interrupt() override;

 private:
  struct Batch;

  absl::Status CallOnce(Batch& batch);
  bool PauseBefore(absl::Duration delay);

  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::DiscoverySpecification> specification_;
  const DiscoveryProblem& problem_;
  std::function<rpc::Origin(absl::Duration)> make_origin_;
  Options options_;
  std::mutex mutex_;
  std::condition_variable interruption_;
  bool interrupted_ = false;               // guarded by mutex_
  std::set<grpc::ClientContext*> active_;  // guarded by mutex_
};

// Returns the design space and metrics of a subject.
absl::StatusOr<std::unique_ptr<v1::DesignSpace>> DescribeDesignSpace(
    const std::shared_ptr<grpc::Channel>& channel, const v1::DiscoverySpecification& specification,
    const rpc::Origin& origin, const rpc::RetryOptions& retry);

}  // namespace mortise::pareto
