#include "common/fem/elements/loads.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

using Traction = std::function<Eigen::Vector3d(const Eigen::Vector3d& position,
                                               const Eigen::Vector3d& area_vector)>;

// Adds ∫ Nᵀ t dA over the triangles; `force` is the traction times the area at a point.
void AddSurfaceLoad(const mesh::TetrahedralMesh& mesh, const std::vector<int>& triangles,
                    const Traction& force, Eigen::Matrix3Xd& sum) {
  for (const int t : triangles) {
    const GradientMatrix positions = TrianglePositions(mesh, t);
    const int nodes = static_cast<int>(positions.cols());
    for (const TrianglePoint& point : TriangleRule()) {
      const ShapeVector shape = TriangleShape(point.barycentric, nodes);
      const Eigen::Vector3d load =
          point.weight * force(positions * shape, TriangleAreaVector(positions, point.barycentric));
      for (int k = 0; k < nodes; ++k) sum.col(mesh.face_triangles(k, t)) += shape[k] * load;
    }
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

void AddFaceLoads(const mesh::TetrahedralMesh& mesh, const LoadCase& loads, Eigen::Matrix3Xd& sum) {
  for (const FaceForce& force : loads.forces) {
    const std::vector<int> triangles = TrianglesOn(mesh, force.face, true);
    const Eigen::Vector3d traction = force.force / Area(mesh, triangles);
    AddSurfaceLoad(
        mesh, triangles,
        [&](const auto&, const Eigen::Vector3d& area) -> Eigen::Vector3d {
          return area.norm() * traction;
        },
        sum);
  }
  for (const FacePressure& pressure : loads.pressures) {
    AddSurfaceLoad(
        mesh, TrianglesOn(mesh, pressure.face, true),
        [&](const auto&, const Eigen::Vector3d& area) -> Eigen::Vector3d {
          return -pressure.pressure * area;
        },
        sum);
  }
  for (const FaceTraction& given : loads.tractions) {
    AddSurfaceLoad(
        mesh, TrianglesOn(mesh, given.face, true),
        [&](const Eigen::Vector3d& position, const Eigen::Vector3d& area) -> Eigen::Vector3d {
          return area.norm() * given.traction(position, area.normalized());
        },
        sum);
  }
}

// Adds ∫ Nᵀ b dV; a rule of degree 5 where b varies.
void AddBodyLoads(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                  const LoadCase& loads, Eigen::Matrix3Xd& sum) {
  const bool varies = loads.rotation.has_value() || loads.body_force;
  if (!varies && loads.gravity.isZero(0)) return;
  const auto force = [&](const Eigen::Vector3d& position, double density) -> Eigen::Vector3d {
    Eigen::Vector3d body = density * loads.gravity;
    if (loads.rotation) {
      const Eigen::Vector3d& omega = loads.rotation->angular_velocity;
      body -= density * omega.cross(omega.cross(position - loads.rotation->point));
    }
    if (loads.body_force) body += loads.body_force(position);
    return body;
  };
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    const double density = materials[mesh.part[e]].density;
    for (const TetrahedronPoint& point : TetrahedronRule(varies ? 5 : 2)) {
      const double volume =
          point.weight * EvaluateElement(positions, point.barycentric).determinant / 6;
      const ShapeVector shape = TetrahedronShape(point.barycentric, nodes);
      const Eigen::Vector3d load = volume * force(positions * shape, density);
      for (int k = 0; k < nodes; ++k) sum.col(mesh.tetrahedra(k, e)) += shape[k] * load;
    }
  }
}

// Adds ∫ Bᵀ D ε_T dV: what would hold the warm body in its cold shape, turned round.
void AddThermalLoad(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                    const Eigen::VectorXd& temperature, Eigen::Matrix3Xd& sum) {
  if (temperature.size() == 0) return;
  std::vector<Vector6d> stress;
  for (const Material& material : materials) {
    stress.push_back(StiffnessMatrix(material) * ThermalStrain(material));
  }
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    for (const TetrahedronPoint& point : TetrahedronRule(mesh.IsQuadratic() ? 2 : 1)) {
      const ElementPoint geometry = EvaluateElement(positions, point.barycentric);
      const ShapeVector shape = TetrahedronShape(point.barycentric, nodes);
      double warming = 0;
      for (int k = 0; k < nodes; ++k) warming += shape[k] * temperature[mesh.tetrahedra(k, e)];
      const Vector6d s = point.weight * geometry.determinant / 6 * warming * stress[mesh.part[e]];
      Eigen::Matrix3d tensor;
      tensor << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
      for (int k = 0; k < nodes; ++k) {
        sum.col(mesh.tetrahedra(k, e)) += tensor * geometry.gradients.col(k);
      }
    }
  }
}

// The barycentric coordinates of a point in the tetrahedron of an element's corners.
Eigen::Vector4d Barycentric(const GradientMatrix& positions, const Eigen::Vector3d& point) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = positions.col(k + 1) - positions.col(0);
  Eigen::Vector4d l;
  l.tail<3>() = edges.inverse() * (point - positions.col(0));
  l[0] = 1 - l.tail<3>().sum();
  return l;
}

// Adds a point force; false if the point is in no element, nor near one by a twentieth of its size.
bool AddPointForce(const mesh::TetrahedralMesh& mesh, const PointForce& load,
                   Eigen::Matrix3Xd& sum) {
  constexpr double kOutside = -0.05;
  Eigen::Index best = -1;
  Eigen::Vector4d where;
  double depth = kOutside;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const Eigen::Vector4d l = Barycentric(ElementPositions(mesh, e), load.position);
    if (!(l.minCoeff() > depth)) continue;
    depth = l.minCoeff();
    best = e;
    where = l;
  }
  if (best < 0) return false;
  const ShapeVector shape = TetrahedronShape(where, static_cast<int>(mesh.tetrahedra.rows()));
  for (Eigen::Index k = 0; k < shape.size(); ++k) {
    sum.col(mesh.tetrahedra(k, best)) += shape[k] * load.force;
  }
  return true;
}

}  // namespace

absl::StatusOr<Eigen::Matrix3Xd> AssembleLoads(const mesh::TetrahedralMesh& mesh,
                                               const std::vector<Material>& materials,
                                               const LoadCase& loads) {
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  AddFaceLoads(mesh, loads, sum);
  if (!sum.allFinite()) {
    return InvalidField("tractions", "a traction is not finite somewhere on its face");
  }
  AddBodyLoads(mesh, materials, loads, sum);
  if (!sum.allFinite()) return InvalidField("body_force", "is not finite somewhere in the body");
  AddThermalLoad(mesh, materials, loads.temperature, sum);
  for (const NodalForce& load : loads.nodal_forces) sum.col(load.node) += load.force;
  for (std::size_t i = 0; i < loads.point_forces.size(); ++i) {
    if (!AddPointForce(mesh, loads.point_forces[i], sum)) {
      return InvalidField(absl::StrCat("point_forces[", i, "].position"), "lies outside the body");
    }
  }
  return sum;
}

}  // namespace mortise::simulator
