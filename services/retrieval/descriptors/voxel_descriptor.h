// The voxel shape histogram: where in space around its centre a surface lies.
#pragma once

#include <cstdint>
#include <memory>

#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

struct VoxelSettings {
  // Points on the surface. The thesis takes a million random ones; so many evenly spread ones have
  // no more noise.
  Eigen::Index points = 65536;
  Eigen::Index kernels = 10;  // along each axis; N = kernels³
  double width = 0.2;         // σ of the isotropic Gaussian kernels, in largest distances
  std::uint64_t seed = 0;     // of the points
};

// The shape histogram of Ankerst et al. 1999 as in thesis §4.6.2: with p a point of the surface, of
// area w, c the centre of the area and R the largest distance from there to the surface,
//
//   f_k = Σ w exp(-|(p - c) / R - m_k|² / 2σ²) / Σ w,
//
// m_k on a grid of kernels³ points from -1 to 1, x fastest, then y. The points are binned on a grid
// of 64³ first, each into the eight nearest nodes in proportion, and the kernels taken of the
// nodes, axis by axis; that blurs a kernel's variance by 1/200 and keeps f continuous and piecewise
// smooth.
//
// The width: the thesis says "variance σ" and "σ = 0.2"; it is taken for the standard deviation, as
// with D2, since with the root of 0.2 each kernel would see half of the space.
class VoxelDescriptor : public Descriptor {
 public:
  explicit VoxelDescriptor(const VoxelSettings& settings = {});

  const DescriptorProperties& properties() const override { return properties_; }

  // BoundDescriptor::Differentiate is exact: the derivative of what Describe gives, where one point
  // of the surface is the farthest from the centre.
  absl::StatusOr<std::unique_ptr<BoundDescriptor>> Bind(
      const mesh::SurfaceMesh& surface) const override;

  Eigen::MatrixXd QuarterTurns(const Eigen::VectorXd& vector) const override;

 private:
  VoxelSettings settings_;
  DescriptorProperties properties_;
  std::shared_ptr<const Eigen::MatrixXd> kernels_;  // kernels × nodes of one axis
};

}  // namespace mortise::retrieval
