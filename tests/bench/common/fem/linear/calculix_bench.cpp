// The solvers beside CalculiX (Debian's calculix-ccx) on the very same mesh, supports and loads, in
// one run: wall time, memory and displacements of both.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/linear/linear_solver.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kProgram[] = "/usr/bin/ccx";
constexpr int kThreads = 2;

void WriteInput(const mesh::TetrahedralMesh& mesh, const Eigen::Array3Xi& fixed,
                const Eigen::Matrix3Xd& load, const std::string& solver,
                const std::filesystem::path& path) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  std::fprintf(file, "*NODE, NSET=ALL\n");
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    std::fprintf(file, "%ld, %.15g, %.15g, %.15g\n", v + 1, mesh.nodes(0, v), mesh.nodes(1, v),
                 mesh.nodes(2, v));
  }
  std::fprintf(file, "*ELEMENT, TYPE=%s, ELSET=BODY\n", mesh.IsQuadratic() ? "C3D10" : "C3D4");
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    std::fprintf(file, "%ld", e + 1);
    for (Eigen::Index a = 0; a < mesh.tetrahedra.rows(); ++a) {
      std::fprintf(file, ", %d", mesh.tetrahedra(a, e) + 1);
    }
    std::fprintf(file, "\n");
  }
  std::fprintf(file,
               "*MATERIAL, NAME=STEEL\n*ELASTIC\n210e9, 0.3\n"
               "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL\n*BOUNDARY\n");
  for (Eigen::Index v = 0; v < fixed.cols(); ++v) {
    if (fixed(0, v)) std::fprintf(file, "%ld, 1, 3\n", v + 1);
  }
  std::fprintf(file, "*STEP\n*STATIC, SOLVER=%s\n*CLOAD\n", solver.c_str());
  for (Eigen::Index v = 0; v < load.cols(); ++v) {
    if (load(2, v) != 0) std::fprintf(file, "%ld, 3, %.15g\n", v + 1, load(2, v));
  }
  std::fprintf(file, "*NODE PRINT, NSET=ALL\nU\n*END STEP\n");
  std::fclose(file);
}

// Displacements as CalculiX printed them; empty if it did not.
Eigen::Matrix3Xd ReadDisplacements(const std::filesystem::path& path, Eigen::Index nodes) {
  Eigen::Matrix3Xd displacement = Eigen::Matrix3Xd::Zero(3, nodes);
  std::ifstream file(path);
  std::string line;
  Eigen::Index count = 0;
  while (std::getline(file, line)) {
    long node = 0;
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), " %ld %lf %lf %lf", &node, &x, &y, &z) != 4) continue;
    if (node < 1 || node > nodes) continue;
    displacement.col(node - 1) << x, y, z;
    ++count;
  }
  return count == nodes ? displacement : Eigen::Matrix3Xd(3, 0);
}

struct Run {
  double seconds = 0, megabytes = 0;
  Eigen::Matrix3Xd displacement;
};

// CalculiX from reading its input to writing its output.
Run RunCalculix(const std::filesystem::path& folder, Eigen::Index nodes) {
  const auto start = Clock::now();
  const pid_t child = fork();
  if (child == 0) {
    const std::string threads = std::to_string(kThreads);
    setenv("OMP_NUM_THREADS", threads.c_str(), 1);
    const int log = open((folder / "log").c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    dup2(log, 1);
    dup2(log, 2);
    if (chdir(folder.c_str()) == 0) execl(kProgram, "ccx", "-i", "case", nullptr);
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  Run run;
  run.seconds = SecondsSince(start);
  run.megabytes = 1e-3 * usage.ru_maxrss;
  run.displacement = ReadDisplacements(folder / "case.dat", nodes);
  return run;
}

// Ours from the mesh in memory to the displacements.
absl::StatusOr<Run> RunOurs(const mesh::TetrahedralMesh& mesh, const Eigen::Array3Xi& fixed,
                            const Eigen::Matrix3Xd& load) {
  const auto start = Clock::now();
  SolverOptions options;
  options.threads = kThreads;
  ThreadTeam team(kThreads);
  MORTISE_ASSIGN_OR_RETURN(BlockMatrix stiffness, AssembleStiffness(mesh, {Steel()}, {}, team));
  auto matrix = std::make_shared<BlockMatrix>(std::move(stiffness));
  MORTISE_ASSIGN_OR_RETURN(auto solver,
                           LinearSolver::Create(mesh, matrix->pattern(), fixed, {}, options));
  MORTISE_RETURN_IF_ERROR(solver->Prepare(matrix, mesh.nodes));
  Run run;
  MORTISE_ASSIGN_OR_RETURN(run.displacement, solver->Solve(load));
  run.seconds = SecondsSince(start);
  const BlockPattern& pattern = *matrix->pattern();
  run.megabytes = 1e-6 * (solver->summary().bytes + 80.0 * pattern.rows().size() +
                          4.0 * pattern.pairs() * pattern.elements());
  return run;
}

// Arguments: cells across the bar, quadratic, CalculiX' iterative solver.
void BM_BesideCalculix(benchmark::State& state) {
  if (access(kProgram, X_OK) != 0) {
    state.SkipWithError("CalculiX is absent: apt-get install calculix-ccx");
    return;
  }
  const int side = static_cast<int>(state.range(0));
  const mesh::TetrahedralMesh mesh =
      BoxMesh({0.4, 0.1, 0.1}, {4 * side, side, side}, state.range(1) != 0);
  const Eigen::Array3Xi fixed = ClampedEnd(mesh);
  const Eigen::Matrix3Xd load = EndLoad(mesh);
  std::string folder = std::filesystem::temp_directory_path() / "calculixXXXXXX";
  if (mkdtemp(folder.data()) == nullptr) {
    state.SkipWithError("cannot make a temporary folder");
    return;
  }
  WriteInput(mesh, fixed, load, state.range(2) ? "ITERATIVE CHOLESKY" : "SPOOLES",
             std::filesystem::path(folder) / "case.inp");
  for (auto unused : state) {
    const auto ours = RunOurs(mesh, fixed, load);
    const Run theirs = RunCalculix(folder, mesh.nodes.cols());
    if (!ours.ok() || theirs.displacement.cols() == 0) {
      state.SkipWithError(ours.ok() ? "CalculiX did not solve the case"
                                    : std::string(ours.status().message()).c_str());
      break;
    }
    state.counters["elements"] = mesh.tetrahedra.cols();
    state.counters["ours_s"] = ours->seconds;
    state.counters["calculix_s"] = theirs.seconds;
    state.counters["times_faster"] = theirs.seconds / ours->seconds;
    state.counters["ours_MB"] = ours->megabytes;
    state.counters["calculix_MB"] = theirs.megabytes;
    state.counters["difference"] =
        (ours->displacement - theirs.displacement).norm() / ours->displacement.norm();
  }
  std::filesystem::remove_all(folder);
}
BENCHMARK(BM_BesideCalculix)
    ->Unit(benchmark::kMillisecond)
    ->ArgNames({"side", "quadratic", "iterative"})
    ->Iterations(1)
    ->ArgsProduct({{14, 20}, {0}, {1, 0}})
    ->ArgsProduct({{14}, {1}, {1, 0}});

}  // namespace
}  // namespace mortise::simulator
