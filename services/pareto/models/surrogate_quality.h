// Measures how well a surrogate has predicted what was then evaluated.
#pragma once

#include <cstdint>
#include <vector>

namespace mortise::pareto {

struct SurrogateQuality {
  std::int64_t proposals = 0;    // designs that the surrogate proposed and that were evaluated
  std::int64_t predictions = 0;  // of those that did not fail: metrics predicted
  // The share of predictions off by at most two of their standard deviations: .95 for one that
  // knows how good it is, less for one that is too sure of itself.
  double within_two_deviations = 0;
  // The median of how far predictions were off, in parts of the front's range.
  double median_error = 0;
};

// Counts predictions as what came of them becomes known.
class SurrogateTally {
 public:
  void AddProposal() { ++proposals_; }

  // Counts the prediction of a metric that came out as `value`; all are in units of the front's
  // range.
  void AddPrediction(double mean, double deviation, double value);

  // Adds all that `other` has counted.
  void Add(const SurrogateTally& other);

  SurrogateQuality quality() const;

 private:
  std::int64_t proposals_ = 0;
  std::int64_t within_ = 0;
  std::vector<double> errors_;
};

}  // namespace mortise::pareto
