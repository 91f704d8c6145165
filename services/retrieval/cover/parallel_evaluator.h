// Many evaluations of a manifold on several threads, counted.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold.h"

namespace mortise::retrieval {

// Calls work(0) … work(count - 1), each once, on up to `threads` threads. `work` must not throw.
void ParallelFor(int count, int threads, const std::function<void(int)>& work);

// Evaluates points of a manifold. Results and counts do not depend on the number of threads.
class ParallelEvaluator {
 public:
  // The manifold must outlive the evaluator; threads >= 1.
  ParallelEvaluator(const Manifold& manifold, int threads);

  // M at each point, in their order. A value of wrong size or with numbers that are not finite is
  // an error as well (INTERNAL).
  std::vector<absl::StatusOr<Eigen::VectorXd>> Evaluate(const std::vector<Eigen::VectorXd>& points);

  // Counts evaluations that were made elsewhere.
  void CountOthers(long evaluations) { evaluations_ += evaluations; }

  const Manifold& manifold() const { return manifold_; }
  int threads() const { return threads_; }
  long evaluations() const { return evaluations_; }
  long failures() const { return failures_; }

  // Returns what the first failures said, without repetition; ten at most.
  const std::vector<std::string>& messages() const { return messages_; }

 private:
  absl::StatusOr<Eigen::VectorXd> EvaluateOne(const Eigen::VectorXd& q) const;
  void Count(const absl::StatusOr<Eigen::VectorXd>& value);

  const Manifold& manifold_;
  int threads_;
  long evaluations_ = 0;
  long failures_ = 0;
  std::vector<std::string> messages_;
};

}  // namespace mortise::retrieval
