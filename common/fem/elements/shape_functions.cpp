#include "common/fem/elements/shape_functions.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "common/mesh/element_faces.h"

namespace mortise::simulator {
namespace {

using mesh::kTetrahedronEdges;

constexpr std::array<std::array<int, 2>, 3> kTriangleEdges{{{0, 1}, {1, 2}, {2, 0}}};

// dN/dL, 4 × nodes, treating the four coordinates as independent.
Eigen::Matrix<double, 4, Eigen::Dynamic, 0, 4, kMaximumNodes> TetrahedronDerivatives(
    const Eigen::Vector4d& l, int nodes) {
  Eigen::Matrix<double, 4, Eigen::Dynamic, 0, 4, kMaximumNodes> derivatives(4, nodes);
  derivatives.setZero();
  if (nodes == 4) {
    derivatives.setIdentity();
    return derivatives;
  }
  for (int i = 0; i < 4; ++i) derivatives(i, i) = 4 * l[i] - 1;
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = kTetrahedronEdges[e];
    derivatives(i, 4 + e) = 4 * l[j];
    derivatives(j, 4 + e) = 4 * l[i];
  }
  return derivatives;
}

}  // namespace

const std::vector<TetrahedronPoint>& TetrahedronRule(int degree) {
  static const std::vector<TetrahedronPoint> one{{Eigen::Vector4d::Constant(0.25), 1.0}};
  static const std::vector<TetrahedronPoint> four = [] {
    const double a = (5 - std::sqrt(5.0)) / 20;
    std::vector<TetrahedronPoint> points;
    for (int i = 0; i < 4; ++i) {
      Eigen::Vector4d l = Eigen::Vector4d::Constant(a);
      l[i] = 1 - 3 * a;
      points.push_back({l, 0.25});
    }
    return points;
  }();
  // Walkington's rule: two orbits of four points and one of six.
  static const std::vector<TetrahedronPoint> fourteen = [] {
    std::vector<TetrahedronPoint> points;
    for (const auto& [a, weight] : {std::pair{0.31088591926330060980, 0.11268792571801585080},
                                    std::pair{0.092735250310891226402, 0.073493043116361949544}}) {
      for (int i = 0; i < 4; ++i) {
        Eigen::Vector4d l = Eigen::Vector4d::Constant(a);
        l[i] = 1 - 3 * a;
        points.push_back({l, weight});
      }
    }
    const double a = 0.045503704125649649492;
    for (const auto& [i, j] : kTetrahedronEdges) {
      Eigen::Vector4d l = Eigen::Vector4d::Constant(a);
      l[i] = l[j] = 0.5 - a;
      points.push_back({l, 0.042546020777081466438});
    }
    return points;
  }();
  return degree <= 1 ? one : degree <= 2 ? four : fourteen;
}

const std::vector<TrianglePoint>& TriangleRule() {
  static const std::vector<TrianglePoint> six = [] {
    std::vector<TrianglePoint> points;
    // Two orbits of three points; see Strang and Fix.
    for (const auto& [a, weight] : {std::pair{0.445948490915965, 0.223381589678011},
                                    std::pair{0.091576213509771, 0.109951743655322}}) {
      for (int i = 0; i < 3; ++i) {
        Eigen::Vector3d l = Eigen::Vector3d::Constant(a);
        l[i] = 1 - 2 * a;
        points.push_back({l, weight});
      }
    }
    double sum = 0;
    for (const TrianglePoint& point : points) sum += point.weight;
    for (TrianglePoint& point : points) point.weight /= sum;
    return points;
  }();
  return six;
}

ShapeVector TetrahedronShape(const Eigen::Vector4d& l, int nodes) {
  ShapeVector shape(nodes);
  if (nodes == 4) {
    shape = l;
    return shape;
  }
  for (int i = 0; i < 4; ++i) shape[i] = l[i] * (2 * l[i] - 1);
  for (int e = 0; e < 6; ++e) {
    shape[4 + e] = 4 * l[kTetrahedronEdges[e][0]] * l[kTetrahedronEdges[e][1]];
  }
  return shape;
}

ShapeVector TriangleShape(const Eigen::Vector3d& l, int nodes) {
  ShapeVector shape(nodes);
  if (nodes == 3) {
    shape = l;
    return shape;
  }
  for (int i = 0; i < 3; ++i) shape[i] = l[i] * (2 * l[i] - 1);
  for (int e = 0; e < 3; ++e) shape[3 + e] = 4 * l[kTriangleEdges[e][0]] * l[kTriangleEdges[e][1]];
  return shape;
}

ElementPoint EvaluateElement(const GradientMatrix& positions, const Eigen::Vector4d& barycentric) {
  const int nodes = static_cast<int>(positions.cols());
  const auto by_l = TetrahedronDerivatives(barycentric, nodes);
  // Natural coordinates are L₁, L₂, L₃; L₀ = 1 − L₁ − L₂ − L₃.
  GradientMatrix natural(3, nodes);
  for (int k = 0; k < 3; ++k) natural.row(k) = by_l.row(k + 1) - by_l.row(0);
  const Eigen::Matrix3d jacobian = natural * positions.transpose();
  ElementPoint point;
  point.determinant = jacobian.determinant();
  point.gradients = jacobian.inverse() * natural;
  return point;
}

Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 6, 3> TriangleDerivatives(const Eigen::Vector3d& l,
                                                                      int nodes) {
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 6, 3> by_l(nodes, 3);
  by_l.setZero();
  if (nodes == 3) {
    by_l.setIdentity();
    return by_l;
  }
  for (int i = 0; i < 3; ++i) by_l(i, i) = 4 * l[i] - 1;
  for (int e = 0; e < 3; ++e) {
    by_l(3 + e, kTriangleEdges[e][0]) = 4 * l[kTriangleEdges[e][1]];
    by_l(3 + e, kTriangleEdges[e][1]) = 4 * l[kTriangleEdges[e][0]];
  }
  return by_l;
}

Eigen::Vector3d TriangleAreaVector(const GradientMatrix& positions, const Eigen::Vector3d& l) {
  if (positions.cols() == 3) {
    return 0.5 * (positions.col(1) - positions.col(0)).cross(positions.col(2) - positions.col(0));
  }
  const auto by_l = TriangleDerivatives(l, 6);
  const Eigen::Vector3d u = positions * (by_l.col(1) - by_l.col(0));
  const Eigen::Vector3d v = positions * (by_l.col(2) - by_l.col(0));
  return 0.5 * u.cross(v);
}

TriangleGeometry EvaluateTriangle(const GradientMatrix& positions, const Eigen::Vector3d& l) {
  const auto by_l = TriangleDerivatives(l, static_cast<int>(positions.cols()));
  Eigen::Matrix<double, Eigen::Dynamic, 2, 0, 6, 2> natural(positions.cols(), 2);
  natural << by_l.col(1) - by_l.col(0), by_l.col(2) - by_l.col(0);
  const Eigen::Matrix<double, 3, 2> tangents = positions * natural;
  const Eigen::Matrix2d metric = tangents.transpose() * tangents;
  TriangleGeometry geometry;
  geometry.gradients = tangents * metric.inverse() * natural.transpose();
  geometry.normal = tangents.col(0).cross(tangents.col(1)).normalized();
  return geometry;
}

GradientMatrix ElementPositions(const mesh::TetrahedralMesh& mesh, Eigen::Index e) {
  GradientMatrix positions(3, mesh.tetrahedra.rows());
  for (Eigen::Index k = 0; k < positions.cols(); ++k) {
    positions.col(k) = mesh.nodes.col(mesh.tetrahedra(k, e));
  }
  return positions;
}

GradientMatrix TrianglePositions(const mesh::TetrahedralMesh& mesh, Eigen::Index t) {
  GradientMatrix positions(3, mesh.face_triangles.rows());
  for (Eigen::Index k = 0; k < positions.cols(); ++k) {
    positions.col(k) = mesh.nodes.col(mesh.face_triangles(k, t));
  }
  return positions;
}

}  // namespace mortise::simulator
