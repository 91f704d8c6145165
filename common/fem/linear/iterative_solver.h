// Solves by conjugate gradients with a multigrid preconditioner.
#pragma once

#include <memory>
#include <vector>

#include "common/fem/linear/linear_solver.h"
#include "common/fem/linear/multigrid.h"
#include "common/fem/linear/thread_team.h"

namespace mortise::simulator {

class IterativeSolver : public LinearSolver {
 public:
  static absl::StatusOr<std::unique_ptr<IterativeSolver>> Create(
      const mesh::TetrahedralMesh& mesh, std::shared_ptr<const BlockPattern> pattern,
      const Eigen::Array3Xi& fixed, const NodeFrames& frames, const SolverOptions& options);

  absl::Status Prepare(std::shared_ptr<const BlockMatrix> matrix,
                       const Eigen::Matrix3Xd& positions) override;
  absl::StatusOr<std::vector<Eigen::Matrix3Xd>> SolveAll(
      const std::vector<Eigen::Matrix3Xd>& loads) override;
  absl::StatusOr<Eigen::Matrix3Xd> SolveRoughly(const Eigen::Matrix3Xd& load) override;
  const SolverSummary& summary() const override { return summary_; }

  // Whether the last load ended for want of patience, not of iterations.
  bool gave_up_early() const { return summary_.iterations < options_.maximum_iterations; }

  // Waits for the iteration from now on, whatever a factor would be worth.
  void WaitForever();

 private:
  struct Iteration;
  IterativeSolver(const mesh::TetrahedralMesh& mesh, std::shared_ptr<const BlockPattern> pattern,
                  const Eigen::Array3Xi& fixed, const NodeFrames& frames,
                  const SolverOptions& options);

  bool IsTooSlow(double tolerance) const;
  absl::StatusOr<Eigen::Matrix3Xd> SolveOne(const Eigen::Matrix3Xd& load, double tolerance,
                                            bool is_rough);
  // Iterates until the error is at most `tolerance`, or as small as it gets.
  absl::Status Iterate(Iteration& now, double tolerance, bool is_rough);
  absl::Status Correct(Iteration& now);
  void Restart(Iteration& now);
  absl::Status Step(Iteration& now);
  void MultiplyFree(const Eigen::VectorXd& x, Eigen::VectorXd& y);
  double Dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

  std::shared_ptr<const BlockPattern> pattern_;
  Eigen::ArrayXd free_;  // 3 · nodes: 1 for unknowns, 0 where prescribed
  SolverOptions options_;
  ThreadTeam team_;
  Multigrid multigrid_;
  std::shared_ptr<const BlockMatrix> matrix_;
  SolverSummary summary_;
  int iterations_before_ = 0;  // for other loads of this matrix
};

}  // namespace mortise::simulator
