#include "common/fem/elements/shape_derivative.h"

#include <Eigen/Geometry>
#include <utility>

#include "absl/functional/function_ref.h"
#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

Eigen::Matrix3d StressOf(const Matrix6d& stiffness, const Eigen::Matrix3d& gradient) {
  return StressTensor(stiffness * StrainOf(gradient));
}

GradientMatrix Gathered(const mesh::TetrahedralMesh& mesh, Eigen::Index element,
                        const Eigen::Matrix3Xd& field) {
  GradientMatrix values(3, mesh.tetrahedra.rows());
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    values.col(k) = field.col(mesh.tetrahedra(k, element));
  }
  return values;
}

// The rule that integrates the stiffness (and the volume) of elements exactly if they are
// straight-sided.
const std::vector<TetrahedronPoint>& RuleOf(const mesh::TetrahedralMesh& mesh) {
  return TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
}

// Tangents of a triangle at a point: derivatives of the position by the second and third
// barycentric coordinate, and those of the shape functions. Their cross product, halved, is
// TriangleAreaVector.
struct TrianglePlace {
  Eigen::Vector3d first, second;
  ShapeVector by_first, by_second;
  ShapeVector shape;
};

TrianglePlace PlaceAt(const GradientMatrix& positions, const Eigen::Vector3d& l) {
  const Eigen::Index nodes = positions.cols();
  const auto by_l = TriangleDerivatives(l, static_cast<int>(nodes));
  TrianglePlace place;
  place.by_first = by_l.col(1) - by_l.col(0);
  place.by_second = by_l.col(2) - by_l.col(0);
  place.first = positions * place.by_first;
  place.second = positions * place.by_second;
  place.shape = TriangleShape(l, static_cast<int>(nodes));
  return place;
}

// Adds d(w · a)/dX for the area vector a = (first × second) / 2.
void AddAreaDerivative(const mesh::TetrahedralMesh& mesh, int triangle, const TrianglePlace& place,
                       const Eigen::Vector3d& w, Eigen::Matrix3Xd& sum) {
  const Eigen::Vector3d by_first = place.second.cross(w) / 2;
  const Eigen::Vector3d by_second = w.cross(place.first) / 2;
  for (Eigen::Index k = 0; k < place.shape.size(); ++k) {
    sum.col(mesh.face_triangles(k, triangle)) +=
        place.by_first[k] * by_first + place.by_second[k] * by_second;
  }
}

// The mean over triangles of what `value_of` makes of u at a point: a number, and its derivative by
// u.
using ValueOfField = absl::FunctionRef<std::pair<double, Eigen::Vector3d>(const Eigen::Vector3d&)>;
FaceMean MeanOf(const mesh::TetrahedralMesh& mesh, const std::vector<int>& triangles,
                const Eigen::Matrix3Xd& field, ValueOfField value_of) {
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  FaceMean mean{0, none, none};
  for (const int t : triangles) {
    const GradientMatrix positions = TrianglePositions(mesh, t);
    for (const TrianglePoint& point : TriangleRule()) {
      const TrianglePlace place = PlaceAt(positions, point.barycentric);
      const Eigen::Vector3d vector = place.first.cross(place.second) / 2;
      const double piece = point.weight * vector.norm();
      Eigen::Vector3d u = Eigen::Vector3d::Zero();
      for (Eigen::Index k = 0; k < place.shape.size(); ++k) {
        u += place.shape[k] * field.col(mesh.face_triangles(k, t));
      }
      const auto [value, by_u] = value_of(u);
      for (Eigen::Index k = 0; k < place.shape.size(); ++k) {
        mean.by_field.col(mesh.face_triangles(k, t)) += piece * place.shape[k] * by_u;
      }
      mean.value += piece * value;
      AddAreaDerivative(mesh, t, place, value * point.weight * vector.normalized(),
                        mean.by_position);
    }
  }
  const FaceArea area = AreaOfTriangles(mesh, triangles);
  mean.value /= area.value;
  mean.by_field /= area.value;
  mean.by_position = (mean.by_position - mean.value * area.by_position) / area.value;
  return mean;
}

}  // namespace

Eigen::Matrix3Xd StiffnessDerivative(const mesh::TetrahedralMesh& mesh,
                                     const std::vector<Material>& materials,
                                     const Eigen::Matrix3Xd& displacement,
                                     const Eigen::Matrix3Xd& adjoint) {
  std::vector<Matrix6d> stiffness;
  for (const Material& material : materials) stiffness.push_back(StiffnessMatrix(material));
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    const GradientMatrix u = Gathered(mesh, e, displacement);
    const GradientMatrix l = Gathered(mesh, e, adjoint);
    const Matrix6d& of_part = stiffness[static_cast<std::size_t>(mesh.part[e])];
    for (const TetrahedronPoint& point : RuleOf(mesh)) {
      const ElementPoint at = EvaluateElement(positions, point.barycentric);
      const double volume = point.weight * at.determinant / 6;
      const Eigen::Matrix3d by_u = u * at.gradients.transpose();
      const Eigen::Matrix3d by_l = l * at.gradients.transpose();
      const Eigen::Matrix3d stress = StressOf(of_part, by_u);
      const Eigen::Matrix3d adjoint_stress = StressOf(of_part, by_l);
      const double energy = (stress.array() * by_l.array()).sum();
      const Eigen::Matrix3d factor =
          volume * (energy * Eigen::Matrix3d::Identity() - by_l.transpose() * stress -
                    by_u.transpose() * adjoint_stress);
      const GradientMatrix change = factor * at.gradients;
      for (Eigen::Index k = 0; k < change.cols(); ++k) {
        sum.col(mesh.tetrahedra(k, e)) += change.col(k);
      }
    }
  }
  return sum;
}

FaceArea AreaOfTriangles(const mesh::TetrahedralMesh& mesh, const std::vector<int>& triangles) {
  FaceArea area{0, Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols())};
  for (const int t : triangles) {
    const GradientMatrix positions = TrianglePositions(mesh, t);
    for (const TrianglePoint& point : TriangleRule()) {
      const TrianglePlace place = PlaceAt(positions, point.barycentric);
      const Eigen::Vector3d vector = place.first.cross(place.second) / 2;
      area.value += point.weight * vector.norm();
      AddAreaDerivative(mesh, t, place, point.weight * vector.normalized(), area.by_position);
    }
  }
  return area;
}

FaceMean MeanOverTriangles(const mesh::TetrahedralMesh& mesh, const std::vector<int>& triangles,
                           const Eigen::Matrix3Xd& field, const Eigen::Vector3d& direction) {
  return MeanOf(mesh, triangles, field, [&direction](const Eigen::Vector3d& u) {
    return std::pair(direction.dot(u), direction);
  });
}

FaceMean MeanLengthOverTriangles(const mesh::TetrahedralMesh& mesh,
                                 const std::vector<int>& triangles, const Eigen::Matrix3Xd& field) {
  return MeanOf(mesh, triangles, field, [](const Eigen::Vector3d& u) {
    return std::pair<double, Eigen::Vector3d>(u.norm(), u.normalized());
  });
}

Eigen::Matrix3Xd LoadDerivative(const mesh::TetrahedralMesh& mesh,
                                const std::vector<Material>& materials, const LoadCase& loads,
                                const Eigen::Matrix3Xd& adjoint) {
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  for (const FaceForce& force : loads.forces) {
    sum += MeanOverTriangles(mesh, TrianglesOn(mesh, force.face, true), adjoint, force.force)
               .by_position;
  }
  for (const FacePressure& pressure : loads.pressures) {
    for (const int t : TrianglesOn(mesh, pressure.face, true)) {
      const GradientMatrix positions = TrianglePositions(mesh, t);
      for (const TrianglePoint& point : TriangleRule()) {
        const TrianglePlace place = PlaceAt(positions, point.barycentric);
        Eigen::Vector3d at = Eigen::Vector3d::Zero();
        for (Eigen::Index k = 0; k < place.shape.size(); ++k) {
          at += place.shape[k] * adjoint.col(mesh.face_triangles(k, t));
        }
        AddAreaDerivative(mesh, t, place, -pressure.pressure * point.weight * at, sum);
      }
    }
  }
  if (loads.gravity.isZero(0)) return sum;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    const GradientMatrix l = Gathered(mesh, e, adjoint);
    const Eigen::Vector3d weight =
        materials[static_cast<std::size_t>(mesh.part[e])].density * loads.gravity;
    for (const TetrahedronPoint& point : RuleOf(mesh)) {
      const ElementPoint at = EvaluateElement(positions, point.barycentric);
      const ShapeVector shape =
          TetrahedronShape(point.barycentric, static_cast<int>(positions.cols()));
      const double power = point.weight * at.determinant / 6 * weight.dot(l * shape);
      for (Eigen::Index k = 0; k < positions.cols(); ++k) {
        sum.col(mesh.tetrahedra(k, e)) += power * at.gradients.col(k);
      }
    }
  }
  return sum;
}

Eigen::Matrix3Xd MassDerivative(const mesh::TetrahedralMesh& mesh,
                                const std::vector<double>& densities) {
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    for (const TetrahedronPoint& point : RuleOf(mesh)) {
      const ElementPoint at = EvaluateElement(positions, point.barycentric);
      const double mass =
          point.weight * at.determinant / 6 * densities[static_cast<std::size_t>(mesh.part[e])];
      for (Eigen::Index k = 0; k < positions.cols(); ++k) {
        sum.col(mesh.tetrahedra(k, e)) += mass * at.gradients.col(k);
      }
    }
  }
  return sum;
}

}  // namespace mortise::simulator
