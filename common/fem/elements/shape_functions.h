// Shape functions and quadrature of isoparametric tetrahedra and triangles, 4/10 and 3/6 nodes.
//
// Notation: L₀ … L₃ are the barycentric coordinates of the corners; a linear shape function is
// Nᵢ = Lᵢ; quadratic ones are Nᵢ = Lᵢ(2Lᵢ − 1) at corners and 4 Lᵢ Lⱼ at the middle of edge ij.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

inline constexpr int kMaximumNodes = 10;  // of an element

using ShapeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaximumNodes, 1>;
using GradientMatrix = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaximumNodes>;

// A point of an element and its share of the integral; weights of a rule add up to 1.
struct TetrahedronPoint {
  Eigen::Vector4d barycentric;
  double weight;
};
struct TrianglePoint {
  Eigen::Vector3d barycentric;
  double weight;
};

// Returns the smallest rule that is exact for polynomials of `degree`: there are rules for degree 1
// (one point), 2 (four points) and 5 (fourteen points).
const std::vector<TetrahedronPoint>& TetrahedronRule(int degree);

// Returns a rule that is exact for polynomials of degree 4 (six points).
const std::vector<TrianglePoint>& TriangleRule();

// Returns the values of the shape functions of a tetrahedron with 4 or 10 nodes.
ShapeVector TetrahedronShape(const Eigen::Vector4d& barycentric, int nodes);

// Returns the values of the shape functions of a triangle with 3 or 6 nodes.
ShapeVector TriangleShape(const Eigen::Vector3d& barycentric, int nodes);

// Returns dN/dL of a triangle with 3 or 6 nodes: nodes × 3, its coordinates taken for independent.
Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 6, 3> TriangleDerivatives(
    const Eigen::Vector3d& barycentric, int nodes);

// Geometry of an element at a point: gradients in space and the volume that the point stands for.
struct ElementPoint {
  GradientMatrix gradients;  // 3 × nodes, 1/m
  double determinant = 0;    // of the Jacobian; 6 × volume for straight-sided elements, m³
};

// Evaluates the geometry of an element. `positions` are 3 × nodes, m. A determinant of zero or less
// means an inverted element; then `gradients` are meaningless.
ElementPoint EvaluateElement(const GradientMatrix& positions, const Eigen::Vector4d& barycentric);

// Returns the normal times area of the triangle (3 × 3 or 3 × 6 positions) per unit weight at a
// point, m².
Eigen::Vector3d TriangleAreaVector(const GradientMatrix& positions,
                                   const Eigen::Vector3d& barycentric);

// Geometry of a triangle at a point: gradients of the shape functions along it, and its normal.
struct TriangleGeometry {
  GradientMatrix gradients;  // 3 × nodes, 1/m, in the triangle's plane there
  Eigen::Vector3d normal;    // of length 1, to the side from which it is counter-clockwise
};
TriangleGeometry EvaluateTriangle(const GradientMatrix& positions,
                                  const Eigen::Vector3d& barycentric);

// Returns the node positions of element `e`, 3 × 4 or 3 × 10.
GradientMatrix ElementPositions(const mesh::TetrahedralMesh& mesh, Eigen::Index e);

// Returns the node positions of face triangle `t`, 3 × 3 or 3 × 6.
GradientMatrix TrianglePositions(const mesh::TetrahedralMesh& mesh, Eigen::Index t);

}  // namespace mortise::simulator
