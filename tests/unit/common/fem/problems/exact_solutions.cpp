#include "tests/unit/common/fem/problems/exact_solutions.h"

#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {

TrueError MeasureError(const mesh::TetrahedralMesh& mesh, const BubbleSolution& exact,
                       const Eigen::Matrix3Xd& displacement) {
  const Matrix6d d = StiffnessMatrix(exact.material);
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  TrueError error;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    GradientMatrix u(3, nodes);
    for (int k = 0; k < nodes; ++k) u.col(k) = displacement.col(mesh.tetrahedra(k, e));
    for (const TetrahedronPoint& at : TetrahedronRule(5)) {
      const ElementPoint point = EvaluateElement(positions, at.barycentric);
      const ShapeVector shape = TetrahedronShape(at.barycentric, nodes);
      const double volume = at.weight * point.determinant / 6;
      const Eigen::Vector3d x = positions * shape;
      const Vector6d strain = StrainOf(u * point.gradients.transpose() - exact.Gradient(x));
      error.displacement += volume * (u * shape - exact.Displacement(x)).squaredNorm();
      error.energy += volume * strain.dot(d * strain);
    }
  }
  error.displacement = std::sqrt(error.displacement);
  error.energy = std::sqrt(error.energy);
  return error;
}

}  // namespace mortise::simulator
