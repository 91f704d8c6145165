// The stress within an element as its own displacements give it, not smoothed. Private to this
// folder.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/fem/elements/shape_functions.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Stands at one element of a body at a time; each thread takes its own.
class ElementStress {
 public:
  // All must outlive it. `materials`: one for each part; `temperature`: nodes, K above that of no
  // stress, or empty.
  ElementStress(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                const Eigen::Matrix3Xd& displacement, const Eigen::VectorXd& temperature);

  // Goes to an element; before, nothing else may be called.
  void MoveTo(Eigen::Index element);

  // Of the element's nodes: 3 × nodes, m.
  const GradientMatrix& positions() const { return positions_; }
  // The stiffness of the element's material, Pa.
  const Matrix6d& stiffness() const { return stiffness_[part_]; }

  // Returns σ = D (ε − ε_T) at a point of the element: xx yy zz xy yz xz, Pa.
  Vector6d At(const ElementPoint& point, const Eigen::Vector4d& barycentric) const;

  // Returns the gradient of the displacement there, its derivatives by x, y and z as columns.
  Eigen::Matrix3d DisplacementGradient(const ElementPoint& point) const {
    return u_ * point.gradients.transpose();
  }

 private:
  const mesh::TetrahedralMesh& mesh_;
  const Eigen::Matrix3Xd& displacement_;
  const Eigen::VectorXd& temperature_;
  std::vector<Matrix6d> stiffness_;  // of each part
  std::vector<Vector6d> expansion_;  // likewise, 1/K
  // Of the element where it stands:
  std::size_t part_ = 0;
  GradientMatrix positions_, u_;
  ShapeVector warmth_;  // empty if nothing is warm
};

}  // namespace mortise::simulator
