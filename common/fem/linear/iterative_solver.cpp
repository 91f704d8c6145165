#include "common/fem/linear/iterative_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "absl/strings/str_format.h"
#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "common/fem/linear/tridiagonal.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

// A preconditioned matrix of worse condition than this is singular but for rounding.
constexpr double kSingularCondition = 1e13;

// Where rounding ends the iteration early, the error must have come down to this at least.
constexpr double kRoundingError = 0.01;

// Rounding has ended it where the error does not halve any more in so many iterations.
constexpr int kStalled = 200;

// A rough solution has this error, or what it has after so many iterations where rounding leaves
// more.
constexpr double kRough = 0.01;
constexpr int kRoughIterations = 300;

// Iterations after which their number is foreseen, at least.
constexpr double kFirstLook = 10;

// Coefficients kept for the estimate of the condition.
constexpr std::size_t kLanczosSteps = 300;

absl::Status Singular() {
  return PreconditionFailed("SINGULAR",
                            "the stiffness is not positive definite: something is free to move, "
                            "or stiffnesses differ beyond what numbers can hold",
                            "supports");
}

absl::Status NotPrepared() {
  return PreconditionFailed("NOT_PREPARED", "there is no matrix to solve with");
}

// Lanczos' tridiagonal matrix from the coefficients of conjugate gradients.
class ConditionEstimate {
 public:
  // `beta`: with which the direction of this step continued the last one.
  void Add(double alpha, double beta) {
    if (alphas_.size() < kLanczosSteps) {
      alphas_.push_back(alpha);
      betas_.push_back(beta);
    }
  }

  double Condition() const {
    std::vector<double> diagonal, side;
    for (std::size_t k = 0; k < alphas_.size(); ++k) {
      diagonal.push_back(1 / alphas_[k] + (k > 0 ? betas_[k] / alphas_[k - 1] : 0));
      if (k > 0) side.push_back(std::sqrt(betas_[k]) / alphas_[k - 1]);
    }
    if (diagonal.empty()) return 1;
    const Spectrum spectrum = FindSpectrum(diagonal, side);
    return spectrum.least > 0 ? spectrum.most / spectrum.least : kSingularCondition;
  }

 private:
  std::vector<double> alphas_, betas_;
};

}  // namespace

IterativeSolver::IterativeSolver(const mesh::TetrahedralMesh& mesh,
                                 std::shared_ptr<const BlockPattern> pattern,
                                 const Eigen::Array3Xi& fixed, const NodeFrames& frames,
                                 const SolverOptions& options)
    : pattern_(std::move(pattern)),
      free_((fixed == 0).cast<double>().reshaped()),
      options_(options),
      team_(options.threads),
      multigrid_(mesh, fixed, frames, options.multigrid, team_) {
  summary_.kind = SolverKind::kIterative;
  summary_.unknowns = static_cast<int>((fixed == 0).count());
}

absl::StatusOr<std::unique_ptr<IterativeSolver>> IterativeSolver::Create(
    const mesh::TetrahedralMesh& mesh, std::shared_ptr<const BlockPattern> pattern,
    const Eigen::Array3Xi& fixed, const NodeFrames& frames, const SolverOptions& options) {
  const auto start = Clock::now();
  const double bytes = Multigrid::EstimateBytes(mesh, *pattern) + 8.0 * 3 * 6 * pattern->nodes();
  if (bytes > options.memory_limit) {
    return TooLarge(absl::StrFormat("a preconditioner of %.2f GB", 1e-9 * bytes),
                    absl::StrFormat("%.2f GB", 1e-9 * options.memory_limit));
  }
  std::unique_ptr<IterativeSolver> solver(
      new IterativeSolver(mesh, std::move(pattern), fixed, frames, options));
  solver->summary_.analysis_seconds = SecondsSince(start);
  return solver;
}

absl::Status IterativeSolver::Prepare(std::shared_ptr<const BlockMatrix> matrix,
                                      const Eigen::Matrix3Xd& positions) {
  const auto start = Clock::now();
  matrix_ = nullptr;
  iterations_before_ = 0;
  if (options_.progress) MORTISE_RETURN_IF_ERROR(options_.progress(0, -1));
  if (summary_.unknowns > 0) MORTISE_RETURN_IF_ERROR(multigrid_.Prepare(*matrix, positions));
  matrix_ = std::move(matrix);
  if (summary_.unknowns > 0) {
    summary_.bytes = multigrid_.Bytes();
    summary_.levels = multigrid_.Levels();
  }
  summary_.preparation_seconds = SecondsSince(start);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Eigen::Matrix3Xd>> IterativeSolver::SolveAll(
    const std::vector<Eigen::Matrix3Xd>& loads) {
  if (matrix_ == nullptr) return NotPrepared();
  MORTISE_RETURN_IF_ERROR(CheckLoads(loads, pattern_->nodes()));
  const auto start = Clock::now();
  std::vector<Eigen::Matrix3Xd> solutions;
  for (const Eigen::Matrix3Xd& load : loads) {
    MORTISE_ASSIGN_OR_RETURN(Eigen::Matrix3Xd solution, SolveOne(load, options_.tolerance, false));
    solutions.push_back(std::move(solution));
    iterations_before_ += summary_.iterations;
  }
  summary_.solution_seconds = SecondsSince(start);
  return solutions;
}

absl::StatusOr<Eigen::Matrix3Xd> IterativeSolver::SolveRoughly(const Eigen::Matrix3Xd& load) {
  if (matrix_ == nullptr) return NotPrepared();
  MORTISE_RETURN_IF_ERROR(CheckLoads({load}, pattern_->nodes()));
  // What is told is how the load itself was solved.
  const SolverSummary told = summary_;
  auto solution = SolveOne(load, kRough, true);
  iterations_before_ += summary_.iterations;
  const int iterations = told.iterations + summary_.iterations;
  if (solution.ok()) summary_ = told;
  summary_.iterations = iterations;
  return solution;
}

void IterativeSolver::WaitForever() { options_.patience = std::numeric_limits<double>::infinity(); }

// Looks after a tenth of the patience, and whenever the iterations have doubled: before, the error
// says little.
bool IterativeSolver::IsTooSlow(double tolerance) const {
  const int done = summary_.iterations;
  if (!std::isfinite(options_.patience)) return false;
  if (iterations_before_ > options_.patience) return true;
  double look = std::max(kFirstLook, options_.patience / 10);
  while (2 * look <= done) look *= 2;
  if (done < look || done - 1 >= look) return false;
  const double foreseen = summary_.error < 1 ? done * std::log(tolerance) / std::log(summary_.error)
                                             : std::numeric_limits<double>::infinity();
  return iterations_before_ + foreseen > options_.patience;
}

void IterativeSolver::MultiplyFree(const Eigen::VectorXd& x, Eigen::VectorXd& y) {
  matrix_->Multiply(x.data(), y.data(), team_);
  y.array() *= free_;
}

double IterativeSolver::Dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return team_.Sum(static_cast<int>(a.size()), [&](int begin, int end) {
    return a.segment(begin, end - begin).dot(b.segment(begin, end - begin));
  });
}

// What one load's iteration carries along.
struct IterativeSolver::Iteration {
  enum class Next { kStep, kRestart, kEnd };

  Eigen::VectorXd load, solution, residual, corrected, direction, image;
  double rho = 0;           // residual · corrected
  double previous_rho = 0;  // of the step before
  double first_rho = 0;     // at the start
  double true_error = 1;    // at the last restart
  double least_error = 1;   // when it last halved
  int halved = 0;           // the iteration after which it did
  bool is_fresh = true;     // the next direction continues none
  bool has_restarted = false;
  bool is_exact = true;  // the residual is the true one
  ConditionEstimate estimate;

  Next Judge(double error, int iterations, double tolerance, bool is_rough);
};

// What is to be done at an error.
IterativeSolver::Iteration::Next IterativeSolver::Iteration::Judge(double error, int iterations,
                                                                   double tolerance,
                                                                   bool is_rough) {
  if (is_exact && has_restarted) {
    const bool rounding = error < kRoundingError && error > 0.5 * true_error;
    if (error <= tolerance || rounding) return Next::kEnd;
    true_error = error;
  }
  if (error < 0.5 * least_error) {
    least_error = error;
    halved = iterations;
  }
  const bool stalled = iterations > halved + kStalled && least_error < kRoundingError;
  if (stalled && is_exact) return Next::kEnd;
  if (is_rough && iterations >= kRoughIterations) return Next::kEnd;
  return error <= tolerance || stalled ? Next::kRestart : Next::kStep;
}

absl::Status IterativeSolver::Correct(Iteration& now) {
  multigrid_.Correct(now.residual, now.corrected);
  now.rho = Dot(now.residual, now.corrected);
  if (now.first_rho == 0) now.first_rho = now.rho;
  if (!(now.rho >= 0 && now.first_rho > 0)) return Singular();
  summary_.error = std::sqrt(now.rho / now.first_rho);
  return absl::OkStatus();
}

// The residual carried along may have drifted from the true one, which has the last word.
void IterativeSolver::Restart(Iteration& now) {
  MultiplyFree(now.solution, now.image);
  now.residual = now.load - now.image;
  now.is_fresh = now.has_restarted = now.is_exact = true;
}

absl::Status IterativeSolver::Step(Iteration& now) {
  const int size = static_cast<int>(now.load.size());
  const double beta = now.is_fresh ? 0 : now.rho / now.previous_rho;
  now.previous_rho = now.rho;
  now.is_fresh = now.is_exact = false;
  team_.ForRanges(size, [&](int begin, int end) {
    now.direction.segment(begin, end - begin) = now.corrected.segment(begin, end - begin) +
                                                beta * now.direction.segment(begin, end - begin);
  });
  MultiplyFree(now.direction, now.image);
  const double curvature = Dot(now.direction, now.image);
  if (!(curvature > 0)) return Singular();
  const double alpha = now.rho / curvature;
  if (!now.has_restarted) now.estimate.Add(alpha, beta);
  team_.ForRanges(size, [&](int begin, int end) {
    const int count = end - begin;
    now.solution.segment(begin, count) += alpha * now.direction.segment(begin, count);
    now.residual.segment(begin, count) -= alpha * now.image.segment(begin, count);
  });
  ++summary_.iterations;
  return absl::OkStatus();
}

absl::Status IterativeSolver::Iterate(Iteration& now, double tolerance, bool is_rough) {
  while (true) {
    if (options_.progress) {
      MORTISE_RETURN_IF_ERROR(options_.progress(summary_.iterations, summary_.error));
    }
    MORTISE_RETURN_IF_ERROR(Correct(now));
    const Iteration::Next next =
        now.Judge(summary_.error, summary_.iterations, tolerance, is_rough);
    if (next == Iteration::Next::kEnd) return absl::OkStatus();
    if (next == Iteration::Next::kRestart) {
      Restart(now);
      continue;
    }
    if (summary_.iterations >= options_.maximum_iterations || IsTooSlow(tolerance)) {
      return PreconditionFailed(
          "NOT_CONVERGED",
          absl::StrFormat("after %d iterations the relative error is %.2g, not %.2g",
                          summary_.iterations, summary_.error, tolerance));
    }
    MORTISE_RETURN_IF_ERROR(Step(now));
  }
}

absl::StatusOr<Eigen::Matrix3Xd> IterativeSolver::SolveOne(const Eigen::Matrix3Xd& load,
                                                           double tolerance, bool is_rough) {
  Iteration now;
  now.load = load.reshaped().array() * free_;
  now.solution = now.direction = now.image = Eigen::VectorXd::Zero(now.load.size());
  const double scale = std::sqrt(Dot(now.load, now.load));
  summary_.iterations = 0;
  summary_.residual = summary_.error = 0;
  if (scale == 0) return Eigen::Matrix3Xd::Zero(3, load.cols());
  now.residual = now.load;
  summary_.error = 1;
  MORTISE_RETURN_IF_ERROR(Iterate(now, tolerance, is_rough));
  summary_.residual = std::sqrt(Dot(now.residual, now.residual)) / scale;
  summary_.condition = now.estimate.Condition();
  if (!(summary_.condition < kSingularCondition) || !now.solution.allFinite()) return Singular();
  return Eigen::Matrix3Xd(Eigen::Map<const Eigen::Matrix3Xd>(now.solution.data(), 3, load.cols()));
}

}  // namespace mortise::simulator
