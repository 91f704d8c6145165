#include "services/simulator/analysis/place_displacement.h"

#include <cmath>
#include <utility>

#include "common/base/errors.h"
#include "common/fem/elements/point_location.h"
#include "common/fem/elements/shape_derivative.h"
#include "common/fem/elements/shape_functions.h"
#include "services/simulator/analysis/place_functions.h"

namespace mortise::simulator {
namespace {

// The length of a displacement where `axis` is -1, else its component; and the derivative by it.
std::pair<double, Eigen::Vector3d> Measured(const Eigen::Vector3d& u, int axis) {
  if (axis < 0) return {u.norm(), u.normalized()};
  return {u[axis], Eigen::Vector3d::Unit(axis)};
}

// A point stays where it is, or moves with the parameters; the mesh moves through it.
absl::StatusOr<PlaceDisplacement> DisplacementOfPoint(
    const mesh::TetrahedralMesh& mesh, const parametric::MetricExpressions::PlacedPoint& point,
    const Eigen::Matrix3Xd& displacement, int axis) {
  const LocatedPoint located = LocatePoints(mesh, {point.position})[0];
  if (located.element < 0) {
    return InvalidField("metric_definitions", "a point lies outside of the body");
  }
  const GradientMatrix positions = ElementPositions(mesh, located.element);
  const ElementPoint at = EvaluateElement(positions, located.barycentric);
  const ShapeVector shape =
      TetrahedronShape(located.barycentric, static_cast<int>(positions.cols()));
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  Eigen::Matrix3d by_u = Eigen::Matrix3d::Zero();  // ∇u
  for (Eigen::Index a = 0; a < positions.cols(); ++a) {
    const Eigen::Vector3d of_node = displacement.col(mesh.tetrahedra(a, located.element));
    u += shape[a] * of_node;
    by_u += of_node * at.gradients.col(a).transpose();
  }
  const auto [value, direction] = Measured(u, axis);
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  PlaceDisplacement place{value, none, none,
                          point.velocity.transpose() * by_u.transpose() * direction};
  for (Eigen::Index a = 0; a < positions.cols(); ++a) {
    const int node = mesh.tetrahedra(a, located.element);
    place.by_field.col(node) = shape[a] * direction;
    place.by_position.col(node) = -shape[a] * (by_u.transpose() * direction);
  }
  return place;
}

PlaceDisplacement LargestOnFace(const mesh::TetrahedralMesh& mesh,
                                const std::vector<int>& triangles,
                                const Eigen::Matrix3Xd& displacement, int axis) {
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  PlaceDisplacement largest{0, none, none};
  int at = -1;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const int t : triangles) {
    for (const int node : mesh.face_triangles.col(t)) {
      const auto [value, by_u] = Measured(displacement.col(node), axis);
      if (at >= 0 && !(std::abs(value) > std::abs(largest.value))) continue;
      at = node;
      largest.value = value;
      direction = by_u;
    }
  }
  if (at >= 0) largest.by_field.col(at) = direction;
  return largest;
}

}  // namespace

absl::StatusOr<PlaceDisplacement> DisplacementOf(const parametric::MetricCall& call,
                                                 const SolvedLoads& solved, const SolvedCase& of) {
  const std::string& function = call.function->name;
  const Eigen::Matrix3Xd& displacement = of.solution.displacement;
  const int axis = function.ends_with("displacement") ? -1 : function.back() - 'x';
  MORTISE_ASSIGN_OR_RETURN(const auto point, solved.own.PointAt(call.places[0], solved.parameters));
  if (point) return DisplacementOfPoint(solved.mesh, *point, displacement, axis);
  const auto face = FindFace(solved.model, call.places[0]);
  if (!face) return InvalidField("metric_definitions", "there is no face " + call.places[0]);
  const std::vector<int> triangles = TrianglesOn(solved.mesh, *face, false);
  if (function.starts_with("max")) {
    return LargestOnFace(solved.mesh, triangles, displacement, axis);
  }
  FaceMean mean = axis < 0 ? MeanLengthOverTriangles(solved.mesh, triangles, displacement)
                           : MeanOverTriangles(solved.mesh, triangles, displacement,
                                               Eigen::Vector3d::Unit(axis));
  return PlaceDisplacement{mean.value, std::move(mean.by_field), std::move(mean.by_position)};
}

}  // namespace mortise::simulator
