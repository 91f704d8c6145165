#include "common/fem/linear/sparse_cholesky.h"

#include <cholmod.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <limits>
#include <mutex>
#include <vector>

#include "absl/strings/str_format.h"
#include "common/base/elapsed_time.h"
#include "common/base/errors.h"

extern "C" void openblas_set_num_threads(int threads);
extern "C" int omp_get_max_active_levels();
extern "C" void omp_set_max_active_levels(int levels);

namespace mortise::simulator {
namespace {

constexpr int kNestedDissectionNodes = 30000;

// While it lives, parallel regions of OpenMP that this thread comes to run on it alone. CHOLMOD
// wakes four threads for each of many thousand supernodes, whatever the number of cores: it was two
// to three times as slow, and two workers got into each other's way.
class OnThisThread {
 public:
  OnThisThread() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~OnThisThread() { omp_set_max_active_levels(levels_); }
  OnThisThread(const OnThisThread&) = delete;
  OnThisThread& operator=(const OnThisThread&) = delete;

 private:
  const int levels_;
};

// CHOLMOD's workspace and settings, freed with the object.
struct Workspace {
  cholmod_common common;
  Workspace() {
    static std::once_flag once;
    std::call_once(once, [] { openblas_set_num_threads(1); });
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.print = 0;
    common.error_handler = nullptr;
  }
  ~Workspace() { cholmod_finish(&common); }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
};

struct FreeSparse {
  cholmod_common* common;
  void operator()(cholmod_sparse* matrix) const { cholmod_free_sparse(&matrix, common); }
};
struct FreeDense {
  cholmod_common* common;
  void operator()(cholmod_dense* matrix) const { cholmod_free_dense(&matrix, common); }
};
struct FreeFactor {
  cholmod_common* common;
  void operator()(cholmod_factor* factor) const { cholmod_free_factor(&factor, common); }
};
using SparsePointer = std::unique_ptr<cholmod_sparse, FreeSparse>;
using DensePointer = std::unique_ptr<cholmod_dense, FreeDense>;
using FactorPointer = std::unique_ptr<cholmod_factor, FreeFactor>;

// The index of each free displacement among the unknowns, -1 where fixed; 3 × nodes.
Eigen::Array3Xi NumberUnknowns(const Eigen::Array3Xi& fixed, int& count) {
  Eigen::Array3Xi number(3, fixed.cols());
  count = 0;
  for (Eigen::Index k = 0; k < fixed.size(); ++k) {
    number.data()[k] = fixed.data()[k] ? -1 : count++;
  }
  return number;
}

// The graph of nodes, upper triangle, without values.
SparsePointer NodeGraph(const BlockPattern& matrix, cholmod_common* common) {
  const int nodes = matrix.nodes();
  cholmod_sparse* graph = cholmod_allocate_sparse(nodes, nodes, matrix.rows().size(), true, true, 1,
                                                  CHOLMOD_PATTERN, common);
  if (graph != nullptr) {
    std::copy(matrix.starts().begin(), matrix.starts().end(), static_cast<int*>(graph->p));
    std::copy(matrix.rows().begin(), matrix.rows().end(), static_cast<int*>(graph->i));
  }
  return SparsePointer(graph, {common});
}

// The matrix of the unknowns, upper triangle by columns. Its pattern depends on `pattern` only;
// without `values` they are zero.
SparsePointer FreeMatrix(const BlockPattern& pattern, const std::vector<Eigen::Matrix3d>* values,
                         const Eigen::Array3Xi& number, int unknowns, cholmod_common* common) {
  const std::size_t bound = 9 * pattern.rows().size();
  SparsePointer sparse(cholmod_allocate_sparse(unknowns, unknowns, bound, true, true, 1,
                                               values ? CHOLMOD_REAL : CHOLMOD_PATTERN, common),
                       {common});
  if (sparse == nullptr) return sparse;
  int* starts = static_cast<int*>(sparse->p);
  int* rows = static_cast<int*>(sparse->i);
  double* entries = static_cast<double*>(sparse->x);
  int entry = 0, column = 0;
  for (int j = 0; j < pattern.nodes(); ++j) {
    for (int b = 0; b < 3; ++b) {
      if (number(b, j) < 0) continue;
      starts[column++] = entry;
      for (int k = pattern.starts()[j]; k < pattern.starts()[j + 1]; ++k) {
        const int i = pattern.rows()[k];
        for (int a = 0; a < (i == j ? b + 1 : 3); ++a) {
          if (number(a, i) < 0) continue;
          rows[entry] = number(a, i);
          if (values) entries[entry] = (*values)[k](a, b);
          ++entry;
        }
      }
    }
  }
  starts[column] = entry;
  return sparse;
}

// An elimination order of the unknowns from one of the nodes.
std::vector<int> ExpandOrder(const int* node_order, const Eigen::Array3Xi& number) {
  std::vector<int> order;
  for (Eigen::Index v = 0; v < number.cols(); ++v) {
    for (int k = 0; k < 3; ++k) {
      if (number(k, node_order[v]) >= 0) order.push_back(number(k, node_order[v]));
    }
  }
  return order;
}

absl::Status OutOfMemory() { return TooLarge("the factor of the stiffness", "the memory at hand"); }

}  // namespace

double EstimateFactorFlops(const BlockPattern& pattern) {
  const OnThisThread alone;
  Workspace workspace;
  const SparsePointer graph = NodeGraph(pattern, &workspace.common);
  workspace.common.nmethods = 1;
  workspace.common.method[0].ordering = CHOLMOD_AMD;
  workspace.common.supernodal = CHOLMOD_SIMPLICIAL;
  const FactorPointer factor(
      graph == nullptr ? nullptr : cholmod_analyze(graph.get(), &workspace.common),
      {&workspace.common});
  // Each node is three unknowns.
  return factor == nullptr ? std::numeric_limits<double>::infinity() : 27 * workspace.common.fl;
}

struct SparseCholesky::Factor {
  Workspace workspace;  // outlives the factor
  Eigen::Array3Xi number;
  int unknowns = 0;
  FactorPointer factor{nullptr, {nullptr}};
};

SparseCholesky::SparseCholesky(std::unique_ptr<Factor> factor) : factor_(std::move(factor)) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

absl::StatusOr<SparseCholesky> SparseCholesky::Analyze(const BlockPattern& pattern,
                                                       const Eigen::Array3Xi& fixed,
                                                       const CholeskyOptions& options) {
  const OnThisThread alone;
  SparseCholesky result(std::make_unique<Factor>());
  Factor& state = *result.factor_;
  cholmod_common* common = &state.workspace.common;
  state.number = NumberUnknowns(fixed, state.unknowns);
  CholeskySummary& summary = result.summary_;
  summary.unknowns = state.unknowns;
  if (state.unknowns == 0) return result;
  if (9 * pattern.rows().size() > static_cast<std::size_t>(INT_MAX)) return OutOfMemory();

  const auto start = std::chrono::steady_clock::now();
  const SparsePointer graph = NodeGraph(pattern, common);
  if (graph == nullptr) return OutOfMemory();
  // Minimum degree is quicker to find; nested dissection fills large factors less.
  common->nmethods = 1;
  common->method[0].ordering =
      pattern.nodes() > kNestedDissectionNodes ? CHOLMOD_METIS : CHOLMOD_AMD;
  const FactorPointer node_factor(cholmod_analyze(graph.get(), common), {common});
  if (node_factor == nullptr) return OutOfMemory();
  std::vector<int> order = ExpandOrder(static_cast<const int*>(node_factor->Perm), state.number);
  const SparsePointer matrix = FreeMatrix(pattern, nullptr, state.number, state.unknowns, common);
  if (matrix == nullptr) return OutOfMemory();
  common->method[0].ordering = CHOLMOD_GIVEN;
  state.factor =
      FactorPointer(cholmod_analyze_p(matrix.get(), order.data(), nullptr, 0, common), {common});
  if (state.factor == nullptr) return OutOfMemory();
  summary.analysis_seconds = SecondsSince(start);
  summary.factor_entries = common->lnz;
  summary.factor_flops = common->fl;
  summary.factor_bytes = 8 * static_cast<double>(state.factor->xsize);
  if (summary.factor_bytes > options.memory_limit) {
    return TooLarge(absl::StrFormat("a factor of %.3g GB", 1e-9 * summary.factor_bytes),
                    absl::StrFormat("%.3g GB", 1e-9 * options.memory_limit));
  }
  return result;
}

absl::Status SparseCholesky::Factorize(const BlockMatrix& stiffness) {
  if (factor_->unknowns == 0) return absl::OkStatus();
  const OnThisThread alone;
  const auto start = std::chrono::steady_clock::now();
  cholmod_common* common = &factor_->workspace.common;
  const SparsePointer matrix = FreeMatrix(*stiffness.pattern(), &stiffness.blocks(),
                                          factor_->number, factor_->unknowns, common);
  if (matrix == nullptr) return OutOfMemory();
  cholmod_factorize(matrix.get(), factor_->factor.get(), common);
  summary_.factorization_seconds = SecondsSince(start);
  if (common->status == CHOLMOD_OUT_OF_MEMORY || common->status == CHOLMOD_TOO_LARGE) {
    return OutOfMemory();
  }
  summary_.reciprocal_condition = cholmod_rcond(factor_->factor.get(), common);
  if (common->status != CHOLMOD_OK || !(summary_.reciprocal_condition > 0)) {
    return PreconditionFailed("SINGULAR",
                              "the stiffness is not positive definite: something is free to move, "
                              "or stiffnesses differ beyond what numbers can hold",
                              "supports");
  }
  return absl::OkStatus();
}

absl::StatusOr<SparseCholesky> SparseCholesky::Create(const BlockMatrix& stiffness,
                                                      const Eigen::Array3Xi& fixed,
                                                      const CholeskyOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(SparseCholesky result, Analyze(*stiffness.pattern(), fixed, options));
  MORTISE_RETURN_IF_ERROR(result.Factorize(stiffness));
  return result;
}

absl::StatusOr<std::vector<Eigen::Matrix3Xd>> SparseCholesky::SolveAll(
    const std::vector<Eigen::Matrix3Xd>& loads) {
  std::vector<Eigen::Matrix3Xd> solutions;
  for (const Eigen::Matrix3Xd& load : loads) {
    solutions.push_back(Eigen::Matrix3Xd::Zero(3, load.cols()));
  }
  if (factor_->unknowns == 0 || loads.empty()) return solutions;
  const OnThisThread alone;
  cholmod_common* common = &factor_->workspace.common;
  const DensePointer right(cholmod_allocate_dense(factor_->unknowns, loads.size(),
                                                  factor_->unknowns, CHOLMOD_REAL, common),
                           {common});
  if (right == nullptr) return OutOfMemory();
  const auto number = factor_->number.data();
  for (std::size_t i = 0; i < loads.size(); ++i) {
    double* column = static_cast<double*>(right->x) + i * factor_->unknowns;
    for (Eigen::Index k = 0; k < loads[i].size(); ++k) {
      if (number[k] >= 0) column[number[k]] = loads[i].data()[k];
    }
  }
  const DensePointer solution(cholmod_solve(CHOLMOD_A, factor_->factor.get(), right.get(), common),
                              {common});
  if (solution == nullptr) return OutOfMemory();
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const double* column = static_cast<const double*>(solution->x) + i * factor_->unknowns;
    for (Eigen::Index k = 0; k < loads[i].size(); ++k) {
      if (number[k] >= 0) solutions[i].data()[k] = column[number[k]];
    }
  }
  return solutions;
}

absl::StatusOr<Eigen::Matrix3Xd> SparseCholesky::Solve(const Eigen::Matrix3Xd& loads) {
  MORTISE_ASSIGN_OR_RETURN(std::vector<Eigen::Matrix3Xd> solutions, SolveAll({loads}));
  return std::move(solutions.front());
}

}  // namespace mortise::simulator
