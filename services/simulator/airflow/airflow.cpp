#include "services/simulator/airflow/airflow.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <locale>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/temporary_folder.h"
#include "services/simulator/airflow/airflow_case.h"
#include "services/simulator/airflow/openfoam.h"
#include "services/simulator/airflow/wall_pressure.h"

namespace mortise::simulator {
namespace {

constexpr double kBytesPerCell = 4000;  // of what makes the cells; the flow takes less
constexpr double kOutlying = 0.001;     // of the surface: single cells may be far off
constexpr int kMinIterations = 200, kMaxIterations = 1500;

// Turns the world into the wind's frame: the wind along x, what is up as far up as can be.
Eigen::Matrix3d WindFrame(const Eigen::Vector3d& wind) {
  const Eigen::Vector3d x = wind.normalized();
  const bool blows_upright = std::abs(x.z()) > 0.999;
  const Eigen::Vector3d up =
      blows_upright ? Eigen::Vector3d::UnitX().eval() : Eigen::Vector3d::UnitZ().eval();
  const Eigen::Vector3d y = up.cross(x).normalized();
  Eigen::Matrix3d frame;
  frame << x.transpose(), y.transpose(), x.cross(y).transpose();
  return frame;
}

// Enough for drag to stay within a thousandth or two; information crosses one cell in each.
int IterationsFor(int cells) {
  const double share = std::cbrt(cells / 30'000.0);
  return std::clamp(static_cast<int>(kMinIterations * share), kMinIterations, kMaxIterations);
}

struct Forces {
  std::vector<Eigen::Vector3d> total, friction;  // N, after each iteration
};

// "time (total) (pressure) (friction)", three numbers each.
absl::StatusOr<Forces> ReadForces(const std::filesystem::path& file) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file));
  Forces forces;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream numbers(absl::StrReplaceAll(line, {{"(", " "}, {")", " "}}));
    numbers.imbue(std::locale::classic());
    double time = 0;
    Eigen::Vector3d total, pressure, friction;
    numbers >> time;
    for (Eigen::Vector3d* const force : {&total, &pressure, &friction}) {
      for (double& component : *force) numbers >> component;
    }
    if (!numbers) break;  // also what is not finite
    forces.total.push_back(total);
    forces.friction.push_back(friction);
  }
  return forces;
}

absl::Status NotConverged(std::string_view how = "") {
  return PreconditionFailed("NOT_CONVERGED",
                            absl::StrCat("the flow of air does not settle", std::string(how),
                                         ": try more cells, or less wind"),
                            "airflow");
}

absl::Status AverageForces(const Forces& forces, int iterations, const Eigen::Matrix3d& to_world,
                           AirflowSolution& solution) {
  if (static_cast<int>(forces.total.size()) < iterations) return NotConverged();
  const std::size_t first = forces.total.size() - forces.total.size() / 4;
  const double weight = 1.0 / static_cast<double>(forces.total.size() - first);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), friction = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < forces.total.size(); ++i) {
    mean += weight * forces.total[i];
    friction += weight * forces.friction[i];
  }
  for (std::size_t i = first; i < forces.total.size(); ++i) {
    solution.force_swing = std::max(solution.force_swing, (forces.total[i] - mean).norm());
  }
  if (!mean.allFinite() || !std::isfinite(solution.force_swing)) return NotConverged();
  solution.force = to_world * mean;
  solution.friction = to_world * friction;
  return absl::OkStatus();
}

// The number behind the last "cells:" that snappyHexMesh prints.
int CellsIn(const std::string& log) {
  const std::size_t at = log.rfind("cells:");
  return at == std::string::npos ? 0 : std::atoi(log.c_str() + at + 6);
}

// Faces of cells along the body, as the boundary of the cells tells them: "body { ... nFaces N; }".
int BodyFacesIn(const std::string& boundary) {
  constexpr std::string_view kCount = "nFaces";
  std::size_t at = boundary.find("body");
  if (at != std::string::npos) at = boundary.find(kCount, at);
  return at == std::string::npos ? 0 : std::atoi(boundary.c_str() + at + kCount.size());
}

// The lowest and the highest pressure but for kOutlying of the surface at either end.
std::pair<double, double> PressureRange(const mesh::SurfaceMesh& surface,
                                        const Eigen::VectorXd& pressure) {
  std::vector<std::pair<double, double>> pressures;  // with the area that has it
  double area = 0;
  for (const auto& triangle : surface.triangles.colwise()) {
    const Eigen::Vector3d a = surface.vertices.col(triangle[0]);
    const Eigen::Vector3d b = surface.vertices.col(triangle[1]) - a;
    const Eigen::Vector3d c = surface.vertices.col(triangle[2]) - a;
    const double third = b.cross(c).norm() / 6;
    for (const int v : triangle) pressures.emplace_back(pressure[v], third);
    area += 3 * third;
  }
  std::sort(pressures.begin(), pressures.end());
  const auto outlying = [&](auto begin, auto end) {
    double left = kOutlying * area;
    return std::find_if(begin, end, [&](const auto& of) { return (left -= of.second) <= 0; })
        ->first;
  };
  return {outlying(pressures.begin(), pressures.end()),
          outlying(pressures.rbegin(), pressures.rend())};
}

void Begin(const AirflowSolverOptions& options, const char* stage) {
  if (options.progress != nullptr) options.progress->Begin(stage);
}

absl::Status Run(const std::filesystem::path& folder, int cells,
                 const AirflowSolverOptions& options) {
  OpenFoamRun run{.case_folder = folder, .stop = options.stop};
  Begin(options, "air: cells");
  MORTISE_RETURN_IF_ERROR(RunOpenFoam("blockMesh", {}, run));
  MORTISE_RETURN_IF_ERROR(RunOpenFoam("snappyHexMesh", {"-overwrite"}, run));
  MORTISE_ASSIGN_OR_RETURN(const std::string boundary,
                           ReadFile(folder / "constant" / "polyMesh" / "boundary"));
  if (BodyFacesIn(boundary) == 0) {
    return PreconditionFailed(
        "TOO_FEW_CELLS",
        absl::StrCat("none of the cells of air meets the design: ask for more than ", cells,
                     " (airflow.cells)"),
        "airflow");
  }
  Begin(options, "air: flow");
  run.progress = options.progress;
  const absl::Status flow = RunOpenFoam("rhoSimpleFoam", {}, run);
  if (DetailOf(flow).reason != kOpenFoamFailed) return flow;
  return NotConverged(absl::StrCat(" (", std::string(flow.message()), ")"));
}

}  // namespace

absl::StatusOr<AirflowSolution> SolveAirflow(const mesh::SurfaceMesh& body,
                                             const parametric::Airflow& airflow,
                                             const AirflowSolverOptions& options) {
  MORTISE_RETURN_IF_ERROR(parametric::CheckAirflow(airflow));
  for (const char* const program : {"blockMesh", "snappyHexMesh", "rhoSimpleFoam"}) {
    MORTISE_RETURN_IF_ERROR(CheckOpenFoam(program));
  }
  if (kBytesPerCell * airflow.cells > options.memory_limit) {
    return TooLarge(absl::StrCat("the flow of air with ", airflow.cells, " cells"),
                    absl::StrCat("the limit of ", options.memory_limit / 1e9, " GB"));
  }
  const Eigen::Matrix3d to_wind = WindFrame(airflow.wind);
  const mesh::SurfaceMesh turned{to_wind * body.vertices, body.triangles};
  const AirflowDomain domain = MakeAirflowDomain(turned, airflow.cells);
  const double speed = airflow.wind.norm();
  AirflowSolution solution;
  solution.iterations = IterationsFor(airflow.cells);

  const TemporaryFolder folder("airflow");
  for (const auto& [name, text] :
       WriteAirflowCase(turned, domain, airflow.air, speed, solution.iterations)) {
    MORTISE_RETURN_IF_ERROR(WriteFile(folder.path() / name, text));
  }
  MORTISE_RETURN_IF_ERROR(Run(folder.path(), airflow.cells, options));
  MORTISE_ASSIGN_OR_RETURN(const std::string log, ReadFile(folder.path() / "log.snappyHexMesh"));
  solution.cells = CellsIn(log);
  const std::filesystem::path results = folder.path() / "postProcessing";
  MORTISE_ASSIGN_OR_RETURN(const Forces forces, ReadForces(results / "forces" / "0" / "force.dat"));
  MORTISE_RETURN_IF_ERROR(
      AverageForces(forces, solution.iterations, to_wind.transpose(), solution));
  MORTISE_ASSIGN_OR_RETURN(
      const std::string vtk,
      ReadFile(results / "body" / absl::StrCat(solution.iterations) / "body.vtk"));
  MORTISE_ASSIGN_OR_RETURN(WallFaces faces, ReadWallFaces(vtk));
  if (faces.values.size() == 0) return NotConverged();
  faces.values *= 0.5 * airflow.air.Density() * speed * speed;
  solution.surface = DividedTriangles(turned, 1.5 * domain.surface_cell);
  solution.pressure = ValuesAtVertices(faces, solution.surface);
  std::tie(solution.minimum_pressure, solution.maximum_pressure) =
      PressureRange(solution.surface, solution.pressure);
  solution.surface.vertices = to_wind.transpose() * solution.surface.vertices;
  solution.wall = {to_wind.transpose() * faces.centers, to_wind.transpose() * faces.areas,
                   std::move(faces.values)};
  return solution;
}

}  // namespace mortise::simulator
