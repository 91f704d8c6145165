#include "services/simulator/loads.h"

#include "services/simulator/shape_functions.h"

namespace mortise::simulator {
namespace {

// Adds the traction `traction(area vector per unit weight)` integrated over triangle `t`.
template <typename Traction>
void AddSurfaceLoad(const mesh::TetrahedralMesh& mesh, int t, const Traction& traction,
                    Eigen::Matrix3Xd& loads) {
  const GradientMatrix positions = TrianglePositions(mesh, t);
  const int nodes = static_cast<int>(positions.cols());
  for (const TrianglePoint& point : TriangleRule()) {
    const ShapeVector shape = TriangleShape(point.barycentric, nodes);
    const Eigen::Vector3d load =
        point.weight * traction(TriangleAreaVector(positions, point.barycentric));
    for (int k = 0; k < nodes; ++k) loads.col(mesh.face_triangles(k, t)) += shape[k] * load;
  }
}

double Area(const mesh::TetrahedralMesh& mesh, const std::vector<int>& triangles) {
  double area = 0;
  for (const int t : triangles) {
    const GradientMatrix positions = TrianglePositions(mesh, t);
    for (const TrianglePoint& point : TriangleRule()) {
      area += point.weight * TriangleAreaVector(positions, point.barycentric).norm();
    }
  }
  return area;
}

void AddGravity(const mesh::TetrahedralMesh& mesh, const AnalysisCase& analysis,
                Eigen::Matrix3Xd& loads) {
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    const Eigen::Vector3d weight = analysis.materials[mesh.part[e]].density * analysis.gravity;
    for (const TetrahedronPoint& point : TetrahedronRule(2)) {
      const double volume =
          point.weight * EvaluateElement(positions, point.barycentric).determinant / 6;
      const ShapeVector shape = TetrahedronShape(point.barycentric, nodes);
      for (int k = 0; k < nodes; ++k) {
        loads.col(mesh.tetrahedra(k, e)) += shape[k] * volume * weight;
      }
    }
  }
}

}  // namespace

Eigen::Matrix3Xd AssembleLoads(const mesh::TetrahedralMesh& mesh, const AnalysisCase& analysis) {
  Eigen::Matrix3Xd loads = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  for (const FaceForce& force : analysis.forces) {
    const std::vector<int> triangles = TrianglesOn(mesh, force.face, true);
    const Eigen::Vector3d traction = force.force / Area(mesh, triangles);
    for (const int t : triangles) {
      AddSurfaceLoad(
          mesh, t,
          [&](const Eigen::Vector3d& area) -> Eigen::Vector3d { return area.norm() * traction; },
          loads);
    }
  }
  for (const FacePressure& pressure : analysis.pressures) {
    for (const int t : TrianglesOn(mesh, pressure.face, true)) {
      AddSurfaceLoad(
          mesh, t,
          [&](const Eigen::Vector3d& area) -> Eigen::Vector3d { return -pressure.pressure * area; },
          loads);
    }
  }
  if (!analysis.gravity.isZero()) AddGravity(mesh, analysis, loads);
  return loads;
}

}  // namespace mortise::simulator
