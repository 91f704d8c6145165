// Asks another process about designs: any EvaluatorService (protos/mortise/v1/evaluator.proto).
#pragma once

#include <Eigen/Core>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/evaluation/design_file.h"
#include "common/rpc/channel.h"

namespace mortise::v1 {
class EvaluateBatchRequest;
class EvaluationResult;
}  // namespace mortise::v1

namespace mortise::evaluation {

// What an evaluator says of one design of K parameters that it was asked M metrics of.
struct Answer {
  absl::Status status;     // why the design cannot be evaluated, with its detail; OK if it was
  Eigen::VectorXd values;  // M, SI units, in the order asked; NaN where the evaluator left one out
  // M x K, SI units; a row of NaN where there is none of that metric, empty where there is no row.
  Eigen::MatrixXd gradients;
  // Where its shape and fields are, if the question asks for them. A design whose evaluator names
  // no file then has failed: INTERNAL, FILE_MISSING.
  std::optional<DesignFile> file;
};

// Thread safe. A call that fails because the evaluator is away (it restarts, say) is repeated for
// the designs that have no answer yet, for as long as `patience` from the beginning.
class EvaluatorClient {
 public:
  struct Options {
    absl::Duration patience = absl::Minutes(10);
    // A call that takes longer is made again, with patience anew: who computes may be slow.
    absl::Duration longest_call = absl::Hours(1);
  };

  // `question` is what to ask about every design: subject, metrics and settings, without points.
  // `make_origin` gives the identity and deadline of one call that may take so long.
  EvaluatorClient(std::shared_ptr<grpc::Channel> channel, const v1::EvaluateBatchRequest& question,
                  std::function<rpc::Origin(absl::Duration)> make_origin, const Options& options);
  ~EvaluatorClient();

  // Returns one answer for each design (K values in SI units), in the same order; at most 1000
  // designs. A failure says nothing about designs, but that the evaluator is out of reach
  // (UNAVAILABLE and what else it fails with), answers nonsense (INTERNAL), or that it was
  // interrupted (CANCELLED).
  absl::StatusOr<std::vector<Answer>> Evaluate(const std::vector<Eigen::VectorXd>& designs);

  // Asks calls of Evaluate that are under way to return soon, as will all later ones. Any thread
  // may call this.
  void Interrupt();

 private:
  struct Batch;

  absl::Status CallOnce(Batch& batch);
  absl::Status Read(const v1::EvaluationResult& result, const std::vector<std::size_t>& asked,
                    Batch& batch) const;
  bool PauseBefore(absl::Duration delay);

  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::EvaluateBatchRequest> question_;
  std::function<rpc::Origin(absl::Duration)> make_origin_;
  Options options_;
  std::mutex mutex_;
  std::condition_variable interruption_;
  bool interrupted_ = false;               // guarded by mutex_
  std::set<grpc::ClientContext*> active_;  // guarded by mutex_
};

}  // namespace mortise::evaluation
