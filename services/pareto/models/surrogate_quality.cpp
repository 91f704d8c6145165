#include "services/pareto/models/surrogate_quality.h"

#include <algorithm>
#include <cmath>

namespace mortise::pareto {

void SurrogateTally::AddPrediction(double mean, double deviation, double value) {
  errors_.push_back(std::abs(value - mean));
  if (errors_.back() <= 2 * deviation) ++within_;
}

void SurrogateTally::Add(const SurrogateTally& other) {
  proposals_ += other.proposals_;
  within_ += other.within_;
  errors_.insert(errors_.end(), other.errors_.begin(), other.errors_.end());
}

SurrogateQuality SurrogateTally::quality() const {
  SurrogateQuality quality;
  quality.proposals = proposals_;
  quality.predictions = static_cast<std::int64_t>(errors_.size());
  if (errors_.empty()) return quality;
  quality.within_two_deviations =
      static_cast<double>(within_) / static_cast<double>(errors_.size());
  std::vector<double> errors = errors_;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  quality.median_error = *middle;
  return quality;
}

}  // namespace mortise::pareto
