#include "services/simulator/sparse_cholesky.h"

#include <cholmod.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <mutex>
#include <vector>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"

extern "C" void openblas_set_num_threads(int threads);

namespace mortise::simulator {
namespace {

// Below this a pivot is rounding noise: the structure is a mechanism.
constexpr double kSingular = 1e-14;

constexpr int kNestedDissectionNodes = 30000;

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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
SparsePointer NodeGraph(const BlockMatrix& matrix, cholmod_common* common) {
  const int nodes = matrix.nodes();
  cholmod_sparse* graph = cholmod_allocate_sparse(nodes, nodes, matrix.rows().size(), true, true, 1,
                                                  CHOLMOD_PATTERN, common);
  if (graph != nullptr) {
    std::copy(matrix.starts().begin(), matrix.starts().end(), static_cast<int*>(graph->p));
    std::copy(matrix.rows().begin(), matrix.rows().end(), static_cast<int*>(graph->i));
  }
  return SparsePointer(graph, {common});
}

// The matrix of the unknowns, upper triangle by columns.
SparsePointer FreeMatrix(const BlockMatrix& matrix, const Eigen::Array3Xi& number, int unknowns,
                         cholmod_common* common) {
  const std::size_t bound = 9 * matrix.rows().size();
  SparsePointer sparse(
      cholmod_allocate_sparse(unknowns, unknowns, bound, true, true, 1, CHOLMOD_REAL, common),
      {common});
  if (sparse == nullptr) return sparse;
  int* starts = static_cast<int*>(sparse->p);
  int* rows = static_cast<int*>(sparse->i);
  double* values = static_cast<double*>(sparse->x);
  int entry = 0, column = 0;
  for (int j = 0; j < matrix.nodes(); ++j) {
    for (int b = 0; b < 3; ++b) {
      if (number(b, j) < 0) continue;
      starts[column++] = entry;
      for (int k = matrix.starts()[j]; k < matrix.starts()[j + 1]; ++k) {
        const int i = matrix.rows()[k];
        for (int a = 0; a < (i == j ? b + 1 : 3); ++a) {
          if (number(a, i) < 0) continue;
          rows[entry] = number(a, i);
          values[entry++] = matrix.blocks()[k](a, b);
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

absl::StatusOr<SparseCholesky> SparseCholesky::Create(const BlockMatrix& stiffness,
                                                      const Eigen::Array3Xi& fixed,
                                                      const CholeskyOptions& options) {
  auto state = std::make_unique<Factor>();
  cholmod_common* common = &state->workspace.common;
  state->number = NumberUnknowns(fixed, state->unknowns);
  CholeskySummary summary;
  summary.unknowns = state->unknowns;
  if (state->unknowns == 0) {
    SparseCholesky nothing(std::move(state));
    nothing.summary_ = summary;
    return nothing;
  }
  if (9 * stiffness.rows().size() > static_cast<std::size_t>(INT_MAX)) return OutOfMemory();

  auto start = std::chrono::steady_clock::now();
  const SparsePointer graph = NodeGraph(stiffness, common);
  if (graph == nullptr) return OutOfMemory();
  // Minimum degree is quicker to find; nested dissection fills large factors less.
  common->nmethods = 1;
  common->method[0].ordering =
      stiffness.nodes() > kNestedDissectionNodes ? CHOLMOD_METIS : CHOLMOD_AMD;
  const FactorPointer node_factor(cholmod_analyze(graph.get(), common), {common});
  if (node_factor == nullptr) return OutOfMemory();
  std::vector<int> order = ExpandOrder(static_cast<const int*>(node_factor->Perm), state->number);
  const SparsePointer matrix = FreeMatrix(stiffness, state->number, state->unknowns, common);
  if (matrix == nullptr) return OutOfMemory();
  common->method[0].ordering = CHOLMOD_GIVEN;
  state->factor =
      FactorPointer(cholmod_analyze_p(matrix.get(), order.data(), nullptr, 0, common), {common});
  if (state->factor == nullptr) return OutOfMemory();
  summary.analysis_seconds = SecondsSince(start);
  summary.factor_entries = common->lnz;
  summary.factor_flops = common->fl;
  if (8 * static_cast<double>(state->factor->xsize) > options.memory_limit) {
    return TooLarge(absl::StrFormat("a factor of %.1f GB", 8e-9 * state->factor->xsize),
                    absl::StrFormat("%.1f GB", 1e-9 * options.memory_limit));
  }

  start = std::chrono::steady_clock::now();
  cholmod_factorize(matrix.get(), state->factor.get(), common);
  summary.factorization_seconds = SecondsSince(start);
  if (common->status == CHOLMOD_OUT_OF_MEMORY || common->status == CHOLMOD_TOO_LARGE) {
    return OutOfMemory();
  }
  summary.reciprocal_condition = cholmod_rcond(state->factor.get(), common);
  if (common->status != CHOLMOD_OK || !(summary.reciprocal_condition > kSingular)) {
    return PreconditionFailed(
        "SINGULAR",
        "the structure is a mechanism: some parts hang together by an edge or "
        "a point only, or stiffnesses differ beyond what numbers can hold",
        "supports");
  }
  SparseCholesky result(std::move(state));
  result.summary_ = summary;
  return result;
}

absl::StatusOr<Eigen::Matrix3Xd> SparseCholesky::Solve(const Eigen::Matrix3Xd& loads) {
  Eigen::Matrix3Xd displacement = Eigen::Matrix3Xd::Zero(3, loads.cols());
  if (factor_->unknowns == 0) return displacement;
  cholmod_common* common = &factor_->workspace.common;
  const DensePointer right(
      cholmod_allocate_dense(factor_->unknowns, 1, factor_->unknowns, CHOLMOD_REAL, common),
      {common});
  if (right == nullptr) return OutOfMemory();
  const auto number = factor_->number.data();
  for (Eigen::Index k = 0; k < loads.size(); ++k) {
    if (number[k] >= 0) static_cast<double*>(right->x)[number[k]] = loads.data()[k];
  }
  const DensePointer solution(cholmod_solve(CHOLMOD_A, factor_->factor.get(), right.get(), common),
                              {common});
  if (solution == nullptr) return OutOfMemory();
  for (Eigen::Index k = 0; k < loads.size(); ++k) {
    if (number[k] >= 0) displacement.data()[k] = static_cast<const double*>(solution->x)[number[k]];
  }
  return displacement;
}

}  // namespace mortise::simulator
