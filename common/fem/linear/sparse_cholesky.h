// Direct solution of K u = f for free displacements (CHOLMOD, supernodal, with OpenBLAS).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/linear/block_matrix.h"

namespace mortise::simulator {

struct CholeskyOptions {
  double memory_limit = 8e9;  // bytes for the factor; RESOURCE_EXHAUSTED beyond, before it is made
};

// Tells how a factorisation went.
struct CholeskySummary {
  int unknowns = 0;
  double factor_entries = 0;
  double factor_bytes = 0;
  double factor_flops = 0;
  double reciprocal_condition = 0;  // crude estimate from the pivots
  double analysis_seconds = 0;
  double factorization_seconds = 0;
};

// Estimates the flops of a factorisation if nothing were fixed, in a tenth of the time that Analyze
// takes: by minimum degree on the graph of nodes. Infinite if memory is short.
double EstimateFactorFlops(const BlockPattern& pattern);

// The factor L of K restricted to free displacements, K = L Lᵀ. The fill-reducing ordering is found
// on the graph of nodes, a third as large as that of the unknowns. One thread, so that results do
// not depend on the machine's cores; run one process a core.
class SparseCholesky {
 public:
  // Orders the unknowns and finds the pattern of the factor, without values. `fixed` is 3 × nodes,
  // non-zero where a displacement is prescribed and thus not an unknown. RESOURCE_EXHAUSTED if the
  // factor would exceed the limit.
  static absl::StatusOr<SparseCholesky> Analyze(const BlockPattern& pattern,
                                                const Eigen::Array3Xi& fixed,
                                                const CholeskyOptions& options = {});

  // Computes the factor of a matrix on the pattern analysed; again for other values as often as
  // wanted. FAILED_PRECONDITION, reason SINGULAR, if K is not positive definite but for rounding;
  // what is free to move may leave a last pivot that is only rounding, and goes unnoticed here.
  absl::Status Factorize(const BlockMatrix& stiffness);

  // Analyses the pattern, and factorises the values.
  static absl::StatusOr<SparseCholesky> Create(const BlockMatrix& stiffness,
                                               const Eigen::Array3Xi& fixed,
                                               const CholeskyOptions& options = {});

  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  // Returns the displacements (3 × nodes, zero where fixed) under the loads of free directions (3 ×
  // nodes).
  absl::StatusOr<Eigen::Matrix3Xd> Solve(const Eigen::Matrix3Xd& loads);

  // Returns the same for several loads at once, for which the factor is read from memory only once.
  absl::StatusOr<std::vector<Eigen::Matrix3Xd>> SolveAll(
      const std::vector<Eigen::Matrix3Xd>& loads);

  const CholeskySummary& summary() const { return summary_; }

 private:
  struct Factor;
  explicit SparseCholesky(std::unique_ptr<Factor> factor);

  std::unique_ptr<Factor> factor_;
  CholeskySummary summary_;
};

}  // namespace mortise::simulator
