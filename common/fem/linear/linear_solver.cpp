#include "common/fem/linear/linear_solver.h"

#include <functional>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fem/linear/direct_solver.h"
#include "common/fem/linear/iterative_solver.h"
#include "common/fem/linear/sparse_cholesky.h"

namespace mortise::simulator {
namespace {

// Up to as many nodes a factor takes a fraction of a second; from so many on, seconds to estimate.
constexpr int kSmall = 1500;
constexpr int kLarge = 200000;

// Flops of a factor, as they are estimated, in the time of one iteration on one block of the
// matrix: on one thread 2,200, on two 1,200. Orders other than the estimate's make factors up to
// twice as slow or quick.
constexpr double kFlopsOfIteration = 1500;
// Iterations for a load and their preparation that compact bodies take.
constexpr double kUsualIterations = 27;

// Iterates, and factorises where that does not converge.
class FallbackSolver : public LinearSolver {
 public:
  FallbackSolver(std::unique_ptr<IterativeSolver> first,
                 std::function<absl::StatusOr<std::unique_ptr<LinearSolver>>(double)> make_second)
      : first_(std::move(first)), make_second_(std::move(make_second)), used_(first_.get()) {}

  absl::Status Prepare(std::shared_ptr<const BlockMatrix> matrix,
                       const Eigen::Matrix3Xd& positions) override {
    matrix_ = std::move(matrix);
    positions_ = positions;
    used_ = first_.get();
    return first_->Prepare(matrix_, positions_);
  }

  absl::StatusOr<std::vector<Eigen::Matrix3Xd>> SolveAll(
      const std::vector<Eigen::Matrix3Xd>& loads) override {
    return WithEither<std::vector<Eigen::Matrix3Xd>>(
        [&](LinearSolver& solver) { return solver.SolveAll(loads); });
  }

  absl::StatusOr<Eigen::Matrix3Xd> SolveRoughly(const Eigen::Matrix3Xd& load) override {
    return WithEither<Eigen::Matrix3Xd>(
        [&](LinearSolver& solver) { return solver.SolveRoughly(load); });
  }

  const SolverSummary& summary() const override { return used_->summary(); }

 private:
  template <class Result, class Solve>
  absl::StatusOr<Result> WithEither(const Solve& solve) {
    if (used_ != first_.get()) return solve(*used_);
    absl::StatusOr<Result> result = solve(*first_);
    if (result.ok() || DetailOf(result.status()).reason != "NOT_CONVERGED") return result;
    const absl::Status prepared = PrepareSecond();
    if (absl::IsResourceExhausted(prepared)) {
      if (!first_->gave_up_early()) return result;
      first_->WaitForever();
      return solve(*first_);
    }
    MORTISE_RETURN_IF_ERROR(prepared);
    used_ = second_.get();
    return solve(*used_);
  }

  absl::Status PrepareSecond() {
    if (second_ == nullptr) {
      MORTISE_ASSIGN_OR_RETURN(second_, make_second_(first_->summary().bytes));
    }
    return second_->Prepare(matrix_, positions_);
  }

  std::unique_ptr<IterativeSolver> first_;
  std::unique_ptr<LinearSolver> second_;
  // With the bytes that the first one holds.
  std::function<absl::StatusOr<std::unique_ptr<LinearSolver>>(double)> make_second_;
  LinearSolver* used_;  // one of the two
  std::shared_ptr<const BlockMatrix> matrix_;
  Eigen::Matrix3Xd positions_;
};

}  // namespace

SolverChoice ChooseSolver(const BlockPattern& pattern, int loads) {
  if (pattern.nodes() <= kSmall) return {SolverKind::kDirect};
  if (pattern.nodes() > kLarge) {
    return {SolverKind::kIterative, std::numeric_limits<double>::infinity()};
  }
  const double blocks = static_cast<double>(pattern.rows().size() + pattern.row_slots().size());
  const double worth = EstimateFactorFlops(pattern) / (kFlopsOfIteration * blocks);
  if (worth <= kUsualIterations * loads) return {SolverKind::kDirect};
  return {SolverKind::kIterative, worth};
}

absl::StatusOr<std::unique_ptr<LinearSolver>> LinearSolver::Create(
    const mesh::TetrahedralMesh& mesh, std::shared_ptr<const BlockPattern> pattern,
    const Eigen::Array3Xi& fixed, const NodeFrames& frames, const SolverOptions& options) {
  if (pattern->nodes() != mesh.nodes.cols() || fixed.cols() != mesh.nodes.cols()) {
    return InvalidField("fixed", "there must be a column for each node of the mesh");
  }
  if (!(options.tolerance > 0 && options.tolerance < 1)) {
    return InvalidField("tolerance", "must lie within 0 and 1");
  }
  if (options.kind == SolverKind::kIterative) {
    return IterativeSolver::Create(mesh, std::move(pattern), fixed, frames, options);
  }
  const auto direct = [pattern, fixed, options](double bytes_held) {
    SolverOptions rest = options;
    rest.memory_limit -= bytes_held;
    return CreateDirectSolver(pattern, fixed, rest);
  };
  if (options.kind == SolverKind::kDirect) return direct(0);
  const SolverChoice choice = ChooseSolver(*pattern, options.loads);
  if (choice.kind == SolverKind::kDirect) {
    auto solver = direct(0);
    if (!absl::IsResourceExhausted(solver.status())) return solver;
  }
  SolverOptions patient = options;
  patient.patience = choice.kind == SolverKind::kIterative
                         ? choice.patience
                         : std::numeric_limits<double>::infinity();
  MORTISE_ASSIGN_OR_RETURN(
      auto iterative, IterativeSolver::Create(mesh, std::move(pattern), fixed, frames, patient));
  return std::make_unique<FallbackSolver>(std::move(iterative), direct);
}

absl::StatusOr<Eigen::Matrix3Xd> LinearSolver::Solve(const Eigen::Matrix3Xd& load) {
  MORTISE_ASSIGN_OR_RETURN(std::vector<Eigen::Matrix3Xd> solutions, SolveAll({load}));
  return std::move(solutions.front());
}

absl::Status CheckLoads(const std::vector<Eigen::Matrix3Xd>& loads, int nodes) {
  for (std::size_t i = 0; i < loads.size(); ++i) {
    if (loads[i].cols() != nodes) {
      return InvalidField(absl::StrCat("loads[", i, "]"), "must have a column for each node");
    }
    if (!loads[i].allFinite()) {
      return InvalidField(absl::StrCat("loads[", i, "]"), "a force is not finite");
    }
  }
  return absl::OkStatus();
}

}  // namespace mortise::simulator
