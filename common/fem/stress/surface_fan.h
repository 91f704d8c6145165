// What is known round a corner of a smooth surface, taken together to what is so at the corner.
//
// The gradient of a quadratic element's displacement is nearest to the truth in the middle of its
// sides, and furthest at its corners: where a bar bends, corners were off by twice as much as
// middles. So at a corner that faces surround, a linear function along the surface is fitted by
// least squares to what each face has there and in the middles of the sides that begin there, each
// turned from its own normal to the corner's. It is exact for stresses that vary linearly on a
// plane, and linear in the stresses, so that load cases can be added. (Our own.)
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/fem/stress/part_surface.h"
#include "common/fem/stress/stress_shares.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

class SurfaceFan {
 public:
  // Returns the fan round a slot's node; nothing for linear elements, middles of sides, nodes on
  // sharp edges, those that faces of the part do not surround and those where a side begins along
  // the normal. The arguments must outlive it.
  static std::optional<SurfaceFan> Around(const mesh::TetrahedralMesh& mesh,
                                          const PartSurface& surface, int slot);

  // Returns the middles of its sides, each as the two faces beside it have it; then the corner, as
  // each face has it.
  const std::vector<FaceNode>& samples() const { return samples_; }

  // Returns the stress at the corner, from those at the samples: xx yy zz xy yz xz, Pa.
  Vector6d Stress(std::span<const Vector6d> at_samples) const;

  // Returns what multiplies the stress of each sample in direction · Stress.
  std::vector<Vector6d> Directions(const Vector6d& direction) const;

  // Adds the derivative of direction · Stress by the places of the nodes, 3 × nodes, for stresses
  // that stay as they are: by central differences, to nine digits or so, as only geometry is in it.
  void AddDerivative(const Vector6d& direction, std::span<const Vector6d> at_samples,
                     Eigen::Matrix3Xd& by_position) const;

 private:
  using Share = StressShare;  // of each sample

  SurfaceFan(const PartSurface& surface, std::span<const FaceNode> corners)
      : surface_(surface), corners_(corners.begin(), corners.end()) {}
  bool LeavesSurface() const;
  std::vector<Share> Shares(const std::vector<GradientMatrix>& positions) const;

  const PartSurface& surface_;
  std::vector<FaceNode> corners_;          // the corner on each face
  std::vector<GradientMatrix> positions_;  // of each face's nodes
  std::vector<FaceNode> samples_;          // two of each face in turn, then one of each
};

}  // namespace mortise::simulator
