#include <cmath>
#include <cstdlib>

#include "common/fem/problems/heat_conduction.h"
#include "common/fem/problems/modal_analysis.h"
#include "tests/unit/common/fem/problems/published_targets.h"
#include "tests/unit/common/fem/problems/structured_mesh.h"

namespace mortise::simulator {

using mesh::MappedBox;
using mesh::Ticks;

TargetAnswer PlateWithConvection(int n, bool quadratic) {
  MappedBox box;
  // Graded towards the corner where the fixed temperature meets the convection.
  std::vector<double> across = Ticks(3 * n, 0.25);
  std::vector<double> up = Ticks(5 * n, 4);
  // The point asked for has a node.
  auto nearest = up.begin() + 1;
  for (auto tick = up.begin() + 1; tick + 1 != up.end(); ++tick) {
    if (std::abs(*tick - 0.2) < std::abs(*nearest - 0.2)) nearest = tick;
  }
  *nearest = 0.2;
  box.ticks = {across, up, {0, 1}};
  box.place = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(0.6 * p.x(), p.y(), 0.05 * p.z());
  };
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, quadratic);
  HeatCase heat;
  heat.materials = {{"steel", 7800, 210e9, 0.3, 0, 0, 52}};
  heat.temperatures = {{{0, "v_min"}, 100}};
  heat.convections = {{{0, "u_max"}, 750, 0}, {{0, "v_max"}, 750, 0}};
  const auto solution = SolveHeat(mesh, heat);
  if (!solution.ok()) std::abort();
  double value = 18.25;
  for (const int v : mesh::NodesWhere(
           box, quadratic, [](const Eigen::Vector3d& p) { return p.x() == 1 && p.y() == 0.2; })) {
    const double here = solution->temperature[v];
    if (std::abs(here - 18.25) >= std::abs(value - 18.25)) value = here;
  }
  return {"T4: temperature at E",
          18.25,
          value,
          static_cast<int>(mesh.tetrahedra.cols()),
          static_cast<int>(mesh.nodes.cols()),
          solution->seconds};
}

TargetAnswer ThickPlateVibration(int n, bool quadratic, PlateSupport support) {
  MappedBox box;
  box.ticks = {Ticks(4 * n), Ticks(4 * n), Ticks(n)};
  box.place = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(10 * p.x(), 10 * p.y(), p.z() - 0.5);
  };
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, quadratic);
  const bool hard = support == PlateSupport::kHard;
  std::vector<Support> supports{{{0, "u_min"}, {false, hard, true}},
                                {{0, "u_max"}, {false, hard, true}},
                                {{0, "v_min"}, {hard, false, true}},
                                {{0, "v_max"}, {hard, false, true}}};
  if (support == PlateSupport::kEdges) {
    Support edges{{}, {false, false, true}};
    edges.nodes = mesh::NodesWhere(box, quadratic, [](const Eigen::Vector3d& p) {
      return p.z() == 0 && (p.x() == 0 || p.x() == 1 || p.y() == 0 || p.y() == 1);
    });
    supports = {edges};
  }
  ModalOptions options;
  options.count = 3;
  const auto solution = FindModes(mesh, {{"steel", 8000, 200e9, 0.3, 0}}, supports, options);
  if (!solution.ok()) std::abort();
  const char* what = support == PlateSupport::kHard   ? "FV52: hard supports"
                     : support == PlateSupport::kSoft ? "FV52: soft supports"
                                                      : "FV52: lower edges";
  return {what,
          45.897,
          solution->modes[solution->rigid_motions].frequency,
          static_cast<int>(mesh.tetrahedra.cols()),
          static_cast<int>(3 * mesh.nodes.cols()),
          solution->seconds};
}

}  // namespace mortise::simulator
