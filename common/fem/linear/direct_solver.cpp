#include "common/fem/linear/direct_solver.h"

#include <chrono>
#include <utility>

#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "common/fem/linear/sparse_cholesky.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

// Rounds of refinement that a residual above the tolerance is given, unless it is but the rounding
// of K u: then refinement changes nothing.
constexpr int kRefinements = 1;
constexpr double kRounding = 4e-15;

// A solution whose energy is less than this share of what its displacements would have if each node
// moved by itself is a motion without stiffness but for rounding. Sheets a 2000th as thick as long
// come to 1e-15.
constexpr double kWithoutEnergy = 1e-16;

// Of the diagonal, where rounding leaves no factor: some units of rounding.
constexpr double kStiffening = 4e-15;

absl::Status Singular() {
  return PreconditionFailed("SINGULAR",
                            "something is free to move, or stiffnesses differ beyond what numbers "
                            "can hold",
                            "supports");
}

absl::Status NotPrepared() {
  return PreconditionFailed("NOT_PREPARED", "there is no matrix to solve with");
}

class DirectSolver : public LinearSolver {
 public:
  DirectSolver(std::shared_ptr<const BlockPattern> pattern, const Eigen::Array3Xi& fixed,
               const SolverOptions& options, SparseCholesky factor)
      : pattern_(std::move(pattern)),
        fixed_(fixed),
        options_(options),
        team_(options.threads),
        factor_(std::move(factor)) {
    summary_.kind = SolverKind::kDirect;
    summary_.unknowns = factor_.summary().unknowns;
    summary_.bytes = factor_.summary().factor_bytes;
    summary_.factor_entries = factor_.summary().factor_entries;
    summary_.factor_flops = factor_.summary().factor_flops;
    summary_.analysis_seconds = factor_.summary().analysis_seconds;
  }

  absl::Status Prepare(std::shared_ptr<const BlockMatrix> matrix,
                       const Eigen::Matrix3Xd&) override {
    const auto start = Clock::now();
    matrix_ = nullptr;
    if (options_.progress) MORTISE_RETURN_IF_ERROR(options_.progress(0, -1));
    MORTISE_RETURN_IF_ERROR(Factorize(*matrix));
    matrix_ = std::move(matrix);
    stiffness_.resize(pattern_->nodes());
    for (int v = 0; v < pattern_->nodes(); ++v) {
      stiffness_[v] = matrix_->blocks()[pattern_->starts()[v + 1] - 1].trace();
    }
    const double reciprocal = factor_.summary().reciprocal_condition;
    summary_.condition = reciprocal > 0 ? 1 / reciprocal : 0;
    summary_.preparation_seconds = SecondsSince(start);
    return absl::OkStatus();
  }

  absl::StatusOr<std::vector<Eigen::Matrix3Xd>> SolveAll(
      const std::vector<Eigen::Matrix3Xd>& loads) override {
    if (matrix_ == nullptr) return NotPrepared();
    MORTISE_RETURN_IF_ERROR(CheckLoads(loads, pattern_->nodes()));
    const auto start = Clock::now();
    MORTISE_ASSIGN_OR_RETURN(std::vector<Eigen::Matrix3Xd> solutions, factor_.SolveAll(loads));
    for (int round = 0;; ++round) {
      std::vector<Eigen::Matrix3Xd> rest;
      bool has_energy = true;
      const bool close = FindResiduals(loads, solutions, rest, has_energy);
      if (!has_energy && !options_.is_corrected) return Singular();
      if (close || round == kRefinements) break;
      MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::Matrix3Xd> corrections,
                               factor_.SolveAll(rest));
      for (std::size_t i = 0; i < loads.size(); ++i) solutions[i] += corrections[i];
    }
    summary_.solution_seconds = SecondsSince(start);
    return solutions;
  }

  absl::StatusOr<Eigen::Matrix3Xd> SolveRoughly(const Eigen::Matrix3Xd& load) override {
    if (matrix_ == nullptr) return NotPrepared();
    MORTISE_RETURN_IF_ERROR(CheckLoads({load}, pattern_->nodes()));
    return factor_.Solve(load);
  }

  const SolverSummary& summary() const override { return summary_; }

 private:
  // Rounding may take the last pivots of a very slender structure below zero. With a little more on
  // the diagonal there is a factor that is near enough for its solutions to be corrected.
  absl::Status Factorize(const BlockMatrix& matrix) {
    absl::Status status = factor_.Factorize(matrix);
    if (DetailOf(status).reason != "SINGULAR") return status;
    BlockMatrix stiffer = matrix;
    for (int v = 0; v < pattern_->nodes(); ++v) {
      stiffer.blocks()[pattern_->starts()[v + 1] - 1].diagonal() *= 1 + kStiffening;
    }
    return factor_.Factorize(stiffer);
  }

  // What the solutions leave of the loads; true if little enough for all. `has_energy`: whether all
  // of them deform something.
  bool FindResiduals(const std::vector<Eigen::Matrix3Xd>& loads,
                     const std::vector<Eigen::Matrix3Xd>& solutions,
                     std::vector<Eigen::Matrix3Xd>& rest, bool& has_energy) {
    bool close = true;
    for (std::size_t i = 0; i < loads.size(); ++i) {
      Eigen::Matrix3Xd internal;
      matrix_->Multiply(solutions[i], internal, team_);
      rest.push_back((fixed_ == 0).select(loads[i] - internal, 0.0));
      const double load = (fixed_ == 0).select(loads[i], 0.0).norm();
      summary_.residual = load > 0 ? rest.back().norm() / load : 0;
      const double energy = (solutions[i].array() * internal.array()).sum();
      const double alone = solutions[i].colwise().squaredNorm() * stiffness_;
      has_energy = has_energy && (load == 0 || energy > kWithoutEnergy * alone);
      close =
          close && (summary_.residual <= options_.tolerance ||
                    rest.back().norm() <= kRounding * stiffness_.maxCoeff() * solutions[i].norm());
    }
    return close;
  }

  std::shared_ptr<const BlockPattern> pattern_;
  Eigen::Array3Xi fixed_;
  SolverOptions options_;
  ThreadTeam team_;
  SparseCholesky factor_;
  std::shared_ptr<const BlockMatrix> matrix_;
  Eigen::VectorXd stiffness_;  // traces of the diagonal blocks
  SolverSummary summary_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<LinearSolver>> CreateDirectSolver(
    std::shared_ptr<const BlockPattern> pattern, const Eigen::Array3Xi& fixed,
    const SolverOptions& options) {
  CholeskyOptions cholesky;
  cholesky.memory_limit = options.memory_limit;
  MORTISE_ASSIGN_OR_RETURN(SparseCholesky factor,
                           SparseCholesky::Analyze(*pattern, fixed, cholesky));
  return std::make_unique<DirectSolver>(std::move(pattern), fixed, options, std::move(factor));
}

}  // namespace mortise::simulator
