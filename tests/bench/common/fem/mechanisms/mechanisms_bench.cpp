// Hinges of all kinds and sizes, which must all be told, and thin bodies, which must all be solved.
#include <cstdio>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "tests/unit/common/fem/mechanisms/thin_bodies.h"
#include "tests/unit/common/fem/problems/hinged_bodies.h"

namespace mortise::simulator {
namespace {

constexpr SolverKind kKinds[] = {SolverKind::kDirect, SolverKind::kIterative};

const char* NameOf(SolverKind kind) { return kind == SolverKind::kDirect ? "factor" : "iteration"; }

std::vector<LoadCase> FiveLoads(const mesh::TetrahedralMesh& mesh, const Hinge& hinge) {
  std::vector<LoadCase> loads(5);  // the last one is none
  loads[0].gravity = {1, -9.81, 3};
  loads[1].nodal_forces = {{NodesAt(mesh, hinge.held)[0], {0, 0, 1e4}}};
  loads[2].nodal_forces = {{NodesAt(mesh, hinge.outer).back(), {1e4, -2e4, 3e4}}};
  loads[3].rotation = Rotation{{0.3, 0.1, 0}, {0, 0, 5}};
  return loads;
}

// How many of five loads and two solvers are refused as they must be.
int CountTold(const mesh::TetrahedralMesh& mesh, const Hinge& hinge) {
  int told = 0;
  AnalysisCase analysis;
  analysis.materials = {Steel()};
  analysis.supports.emplace_back().nodes = NodesAt(mesh, hinge.held);
  for (const LoadCase& loads : FiveLoads(mesh, hinge)) {
    static_cast<LoadCase&>(analysis) = loads;
    for (const SolverKind kind : kKinds) {
      ElasticityOptions options;
      options.solver.kind = kind;
      const absl::Status status = SolveElasticity(mesh, analysis, options).status();
      told += DetailOf(status).reason == "RIGID_MOTION" &&
              status.message().find("is free to " + hinge.motion) != std::string::npos;
    }
  }
  return told;
}

void PrintHinges() {
  std::printf("%-24s %-9s %8s   told of 10\n", "hinge", "elements", "number");
  for (const Hinge& hinge : Hinges()) {
    for (const bool quadratic : {false, true}) {
      const auto smallest = static_cast<double>(hinge.mesh(1, false).tetrahedra.cols());
      for (const int wanted : {400, 4000, 40000}) {
        int cells = 1;
        while (smallest * cells * cells * cells < wanted) ++cells;
        const mesh::TetrahedralMesh mesh = hinge.mesh(cells, quadratic);
        std::printf("%-24s %-9s %8ld   %d\n", hinge.name.c_str(),
                    quadratic ? "quadratic" : "linear", static_cast<long>(mesh.tetrahedra.cols()),
                    CountTold(mesh, hinge));
        std::fflush(stdout);
      }
    }
  }
}

void PrintThinBodies() {
  std::printf("\n%-12s %-10s %-9s %8s  %-10s %9s %9s %7s\n", "body", "solver", "elements", "number",
              "error", "residual", "imbalance", "seconds");
  for (const ThinBody& body : kThinBodies) {
    for (const int finer : {1, 2}) {
      for (const bool quadratic : {false, true}) {
        const mesh::TetrahedralMesh mesh = MeshOf(body, quadratic, finer);
        for (const SolverKind kind : kKinds) {
          ElasticityOptions options;
          options.solver.kind = kind;
          const auto solution = SolveElasticity(mesh, EndMoment(body), options);
          std::printf("%-12s %-10s %-9s %8ld  ", body.name, NameOf(kind),
                      quadratic ? "quadratic" : "linear",
                      static_cast<long>(mesh.tetrahedra.cols()));
          if (!solution.ok()) {
            std::printf("%s\n", std::string(solution.status().message()).c_str());
            continue;
          }
          std::printf(quadratic ? "%-10.1e" : "%-10.2f",
                      ErrorOfBending(body, mesh, solution->displacement));
          std::printf(" %9.1e %9.1e %7.2f\n", solution->summary.residual,
                      solution->summary.imbalance, solution->summary.seconds);
          std::fflush(stdout);
        }
      }
    }
  }
}

}  // namespace
}  // namespace mortise::simulator

int main() {
  mortise::simulator::PrintHinges();
  mortise::simulator::PrintThinBodies();
  return 0;
}
