#include "common/maps/packed_weights.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mortise::maps {
namespace {

// Of the two B-splines along a direction that are not zero at a place, the lower one's centre and
// both values.
struct Along {
  std::int32_t low = 0;
  double lower = 0;
  double upper = 0;
};

Along AlongAt(double place, int level) {
  const double scaled = std::ldexp(place, level);
  const int cell = std::min(static_cast<int>(scaled), (1 << level) - 1);
  const double upper = scaled - cell;
  return {cell * SpacingOf(level), 1 - upper, upper};
}

}  // namespace

PackedWeights::PackedWeights(const RefinementTree& tree) : tree_(tree) {
  const SplineSet& splines = tree.splines();
  first_.reserve(static_cast<std::size_t>(splines.count()) + 1);
  for (int number = 0; number < splines.count(); ++number) {
    first_.push_back(allocations_.size());
    if (!splines.At(number).active) continue;
    const std::vector<SampleWeight> allocation = tree.Allocation(splines.At(number));
    allocations_.insert(allocations_.end(), allocation.begin(), allocation.end());
  }
  first_.push_back(allocations_.size());
  allocations_.shrink_to_fit();
}

int PackedWeights::At(const double* point, std::vector<SampleWeight>& weights) const {
  const int dimension = tree_.dimension();
  std::array<double, kMostDirections> inside{};
  for (int d = 0; d < dimension; ++d) {
    inside[d] = point[d] > 0 ? std::min(point[d], 1.0) : 0.0;  // NaN is not greater
  }
  const int element = tree_.elements().Locate(inside.data());
  // By locality no other samples act.
  const std::vector<int>& samples = tree_.ElementSamples(element);
  weights.assign(samples.size(), {});
  for (std::size_t n = 0; n < samples.size(); ++n) weights[n].sample = samples[n];
  for (int level = tree_.CoarsestLevel(element); level <= tree_.FinestLevel(element); ++level) {
    std::array<Along, kMostDirections> along;
    for (int d = 0; d < dimension; ++d) along[d] = AlongAt(inside[d], level);
    for (unsigned corner = 0; corner < 1U << dimension; ++corner) {
      LatticePoint centre{};
      double value = 1;
      for (int d = 0; d < dimension; ++d) {
        const bool upper = (corner >> d & 1U) != 0;
        centre[d] = along[d].low + (upper ? SpacingOf(level) : 0);
        value *= upper ? along[d].upper : along[d].lower;
      }
      if (value == 0) continue;
      const int number = tree_.splines().Find(level, centre);
      if (number < 0) continue;
      for (std::size_t n = first_[number]; n < first_[number + 1]; ++n) {
        const auto at = std::lower_bound(samples.begin(), samples.end(), allocations_[n].sample);
        weights[static_cast<std::size_t>(at - samples.begin())].weight +=
            allocations_[n].weight * value;
      }
    }
  }
  std::erase_if(weights, [](const SampleWeight& each) { return each.weight == 0; });
  return element;
}

}  // namespace mortise::maps
