// Maps of functions that are known, for tests of what is done with maps.
#pragma once

#include <cmath>

#include "common/maps/interpolation_map.h"
#include "common/maps/map_sampling.h"

namespace mortise::interpolator::testing {

// A map of two outputs over K numbers, one that bends and one that is linear, which fails beyond a
// corner so that elements are cut off.
inline maps::InterpolationMap SampledMap(int dimension, maps::Basis basis, int budget) {
  maps::MapSamplingOptions options;
  options.basis = basis;
  options.budget = budget;
  maps::MapSampling sampling = maps::MapSampling::Create(dimension, 2, options).value();
  while (!sampling.Done()) {
    for (const maps::AskedPoint& point : sampling.Ask(4)) {
      const double sum = point.position.sum();
      const Eigen::Vector2d values(std::exp(2 * point.position[0]) * std::sin(3 * sum), 4e6 * sum);
      const absl::Status told =
          point.position.minCoeff() > 0.8
              ? sampling.TellFailure(point.number, absl::InternalError("it fails"))
              : sampling.Tell(point.number, values);
      if (!told.ok()) std::abort();
    }
  }
  return maps::InterpolationMap::Create(sampling.Content().value()).value();
}

}  // namespace mortise::interpolator::testing
