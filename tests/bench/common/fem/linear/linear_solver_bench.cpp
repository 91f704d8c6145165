// Solvers beside each other on cantilevers and thin plates of 60,000 and 200,000 elements.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/linear/linear_solver.h"
#include "common/fem/linear/sparse_cholesky.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

// A bar four times as long as thick, or a plate of three layers whose cells are four times as wide
// as high, of about as many thousand elements.
mesh::TetrahedralMesh Solid(int thousands, bool quadratic, bool plate) {
  const double cells = 1e3 * thousands / 6;
  if (plate) {
    const int side = static_cast<int>(std::lround(std::sqrt(cells / 3)));
    return BoxMesh({1, 1, 0.75 / side}, {side, side, 3}, quadratic);
  }
  const int side = static_cast<int>(std::lround(std::cbrt(cells / 4)));
  return BoxMesh({0.4, 0.1, 0.1}, {4 * side, side, side}, quadratic);
}

absl::Status SolveOnce(const mesh::TetrahedralMesh& mesh, const SolverOptions& options,
                       benchmark::State& state) {
  const Eigen::Array3Xi fixed = ClampedEnd(mesh);
  const Eigen::Matrix3Xd load = EndLoad(mesh);
  ThreadTeam team(options.threads);
  const auto start = Clock::now();
  MORTISE_ASSIGN_OR_RETURN(BlockMatrix stiffness, AssembleStiffness(mesh, {Steel()}, {}, team));
  auto matrix = std::make_shared<BlockMatrix>(std::move(stiffness));
  state.counters["assembly_s"] = SecondsSince(start);
  MORTISE_ASSIGN_OR_RETURN(auto solver,
                           LinearSolver::Create(mesh, matrix->pattern(), fixed, {}, options));
  MORTISE_RETURN_IF_ERROR(solver->Prepare(matrix, mesh.nodes));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd solution, solver->Solve(load));
  const SolverSummary& summary = solver->summary();
  state.counters["elements"] = mesh.tetrahedra.cols();
  state.counters["unknowns"] = summary.unknowns;
  state.counters["analysis_s"] = summary.analysis_seconds;
  state.counters["prepare_s"] = summary.preparation_seconds;
  state.counters["solve_s"] = summary.solution_seconds;
  state.counters["iterations"] = summary.iterations;
  state.counters["levels"] = summary.levels;
  state.counters["error"] = summary.error;
  state.counters["residual"] = summary.residual;
  state.counters["condition"] = summary.condition;
  state.counters["MB"] = 1e-6 * summary.bytes;
  state.counters["deflection_um"] = 1e6 * solution.row(2).minCoeff();
  if (summary.kind == SolverKind::kDirect) {
    MORTISE_RETURN_IF_ERROR(solver->SolveAll(std::vector<Eigen::Matrix3Xd>(8, load)).status());
    state.counters["further_load_s"] = summary.solution_seconds / 8;
  }
  const auto estimate = Clock::now();
  state.counters["estimated_Gflop"] = 1e-9 * EstimateFactorFlops(*matrix->pattern());
  state.counters["estimate_s"] = SecondsSince(estimate);
  state.counters["Gflop"] = 1e-9 * summary.factor_flops;
  state.counters["flop_per_block"] =
      1e9 * state.counters["estimated_Gflop"] /
      static_cast<double>(matrix->rows().size() + matrix->pattern()->row_slots().size());
  return absl::OkStatus();
}

// Arguments: thousands of elements, quadratic, plate, direct, threads.
void BM_Solve(benchmark::State& state) {
  const mesh::TetrahedralMesh mesh =
      Solid(static_cast<int>(state.range(0)), state.range(1) != 0, state.range(2) != 0);
  SolverOptions options;
  options.kind = state.range(3) ? SolverKind::kDirect : SolverKind::kIterative;
  options.threads = static_cast<int>(state.range(4));
  options.memory_limit = 16e9;
  for (auto unused : state) {
    const absl::Status status = SolveOnce(mesh, options, state);
    if (!status.ok()) state.SkipWithError(std::string(status.message()).c_str());
  }
}
BENCHMARK(BM_Solve)
    ->Unit(benchmark::kMillisecond)
    ->ArgNames({"k", "quadratic", "plate", "direct", "threads"})
    ->Iterations(1)
    ->ArgsProduct({{3, 10, 60, 200}, {0, 1}, {0, 1}, {0}, {1, 2}})
    ->ArgsProduct({{3, 10, 60}, {0, 1}, {0, 1}, {1}, {1}})
    ->ArgsProduct({{200}, {0}, {0, 1}, {1}, {1}});

// The choices of the preconditioner. Arguments: thousands of elements, quadratic, plate, steps on
// quadratic elements, steps below, the largest over the least smoothed eigenvalue, strength × 1000,
// whether quadratic elements step down to their corners.
void BM_Multigrid(benchmark::State& state) {
  const mesh::TetrahedralMesh mesh =
      Solid(static_cast<int>(state.range(0)), state.range(1) != 0, state.range(2) != 0);
  SolverOptions options;
  options.kind = SolverKind::kIterative;
  options.threads = 2;
  options.multigrid.quadratic_steps = static_cast<int>(state.range(3));
  options.multigrid.linear_steps = static_cast<int>(state.range(4));
  options.multigrid.smoothed_part = 1.0 / state.range(5);
  options.multigrid.strength = 1e-3 * state.range(6);
  options.multigrid.corners = state.range(7) != 0;
  for (auto unused : state) {
    const absl::Status status = SolveOnce(mesh, options, state);
    if (!status.ok()) state.SkipWithError(std::string(status.message()).c_str());
  }
}
BENCHMARK(BM_Multigrid)
    ->Unit(benchmark::kMillisecond)
    ->ArgNames({"k", "quadratic", "plate", "quadratic_steps", "linear_steps", "part", "strength",
                "corners"})
    ->Iterations(1)
    ->ArgsProduct({{60}, {0, 1}, {0, 1}, {3}, {2}, {12}, {20, 50, 80, 120}, {1}})
    ->ArgsProduct({{60}, {1}, {0}, {2, 4}, {1, 2}, {4, 12, 30}, {20}, {1}})
    ->ArgsProduct({{60}, {1}, {0, 1}, {0}, {3}, {12}, {20, 80}, {0}});

}  // namespace
}  // namespace mortise::simulator

BENCHMARK_MAIN();
