// The light field descriptor: what a shape's silhouettes look like from all round.
#pragma once

#include <cstdint>
#include <memory>

#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

struct LightFieldSettings {
  int rows = 256;          // of a silhouette, each exact (silhouette.h); even
  int zernike_order = 10;  // 66 moments
  int fourier_order = 10;  // 21 coefficients
};

// The light field descriptor of Chen et al. 2003 as in thesis §4.6.2: the shape, centred and scaled
// into the unit sphere, is seen as orthographic silhouettes from the vertices of dodecahedra
// (light_field_views.h: two that a quarter turn maps onto each other, 16 views), and each
// silhouette is described by its Zernike moments in the unit disc up to order 10 and by the Fourier
// coefficients up to order 10 of its outline's distance from the centre: 87 numbers a view, 1392 in
// all.
//
// Where it leaves Chen et al., and why (our own):
// - Views are fixed, so that nothing jumps when views change places; four quarter turns remain.
// - The picture stands upright with the shape, so moments and coefficients keep their phases, where
//   Chen et al., whose views may turn in their planes, are left with magnitudes. Magnitudes take a
//   table for one on its head, and have a kink at zero, which phases do not. Of 249 labelled shapes
//   of the web, leaving one out, 77 in 100 have a nearest neighbour of their category with phases,
//   and 71 without; the first tier grows from 34 to 40 in 100.
// - Silhouettes are measured in the sphere of the whole shape, as the thesis says, and not each in
//   a disc of its own: that keeps what is wide in one view and narrow in another, and a sheet seen
//   edge-on shows as little as what is nearly so.
// - Outlines are measured along rays from the centre (fourier_coefficients.h), not along a contour.
// - Nothing is quantised, and rows of silhouettes end exactly, so the vector is continuous.
//
// The centre is that of the box around the shape, the sphere reaches to the vertex that is farthest
// from there.
class LightFieldDescriptor : public Descriptor {
 public:
  explicit LightFieldDescriptor(const LightFieldSettings& settings = {});

  const DescriptorProperties& properties() const override { return properties_; }

  // BoundDescriptor::Differentiate takes central differences along each field of velocities, with
  // a step of the vertices of kDifferenceStep.
  absl::StatusOr<std::unique_ptr<BoundDescriptor>> Bind(
      const mesh::SurfaceMesh& surface) const override;

  Eigen::MatrixXd QuarterTurns(const Eigen::VectorXd& vector) const override;

  // How far the fastest vertex moves either way for a difference, as a share of half of the largest
  // side of the reference's box.
  static constexpr double kDifferenceStep = 2e-3;

 private:
  class Features;
  class Bound;

  DescriptorProperties properties_;
  std::shared_ptr<const Features> features_;  // shared with what is bound
};

}  // namespace mortise::retrieval
