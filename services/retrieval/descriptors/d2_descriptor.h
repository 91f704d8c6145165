// The shape distribution D2: how far two points of a surface lie from each other.
#pragma once

#include <cstdint>
#include <memory>

#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

struct D2Settings {
  // Points on the surface. The thesis takes 3,000 random ones; so many evenly spread ones miss what
  // very many would give by less than 0.01, and have a quarter of the pairs.
  Eigen::Index points = 1448;
  Eigen::Index kernels = 300;  // N
  double width = 0.1;          // σ of the Gaussian kernels, in mean distances
  double range = 3;            // of the kernels' means, from 0, in mean distances
  std::uint64_t seed = 0;      // of the points
};

// D2 of Osada et al. 2001 as in thesis §4.6.2: all distances between pairs of points spread by
// area, divided by their mean, seen through Gaussian kernels: with x the distance of a pair and w
// the product of the areas that its points stand for,
//
//   f_k = Σ w exp(-(x - c_k)² / 2σ²) / Σ w,   c_k = k · range / (kernels - 1), k = 0 … kernels - 1.
//
// It does not see turns, nor mirror images. The distances are binned at σ/20 first, each into the
// two nearest bins in proportion, and the kernels taken of the bins, which blurs a kernel's
// variance by less than 1/2000 and keeps f continuous and piecewise smooth. Cost: points²/2
// distances.
class D2Descriptor : public Descriptor {
 public:
  explicit D2Descriptor(const D2Settings& settings = {});

  const DescriptorProperties& properties() const override { return properties_; }

  // BoundDescriptor::Differentiate is exact: the derivative of what Describe gives.
  absl::StatusOr<std::unique_ptr<BoundDescriptor>> Bind(
      const mesh::SurfaceMesh& surface) const override;

 private:
  D2Settings settings_;
  DescriptorProperties properties_;
  std::shared_ptr<const Eigen::MatrixXd> kernels_;  // N × bins, shared with what is bound
};

}  // namespace mortise::retrieval
