// Says what is believed of designs that have not been evaluated, by a Gaussian process for each
// metric, for each constraint that was ever violated, and for whether a design can be evaluated at
// all.
//
// Only the good end of metrics matters, and some have a bad end that is orders of magnitude away.
// So scaled metrics y (0 the ideal, 1 the nadir, archive.h) are learnt as they are up to `knee`,
// above everything the front spans, and as knee (1 + log(y / knee)) beyond. Constraints are learnt
// as asinh(g / s), s the median of |g|, which keeps their sign. Whether a design fails is learnt as
// 1 or -1 (least-squares classification, Rasmussen and Williams 6.5).
//
// At most `points` entries of the archive are used, those nearest to the front: first those whose
// metrics must improve the least before they are dominated no more, and those that violate
// constraints after all others. Hyperparameters are fitted anew when their number has grown by a
// tenth since, from where they were, on `fitted` of them at most. O(points^3) otherwise.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/models/gaussian_process.h"

namespace mortise::pareto {

// Metrics as they are learnt.
struct LearntMetrics {
  Scaling scaling;
  Eigen::VectorXd knees;  // d, scaled metrics

  Eigen::VectorXd Of(const Eigen::VectorXd& metrics) const;
};

class SurrogateModel {
 public:
  struct Options {
    std::size_t points = 250;  // of the archive, at most
    std::size_t fitted = 160;  // of those, for hyperparameters
  };

  // The belief about a design.
  struct Belief {
    std::vector<GaussianProcess::Prediction> metrics;  // d, as learnt
    // The logarithm of the probability that the design can be evaluated and meets all constraints,
    // and its slope (D).
    double log_feasibility = 0;
    Eigen::VectorXd log_feasibility_gradient;
  };

  struct Beliefs {
    std::vector<GaussianProcess::Predictions> metrics;  // d, each for all designs
    Eigen::VectorXd log_feasibilities;                  // of each design
  };

  explicit SurrogateModel(const Options& options) : options_(options) {}

  // Learns what the archive holds, which is a feasible entry at least.
  void Learn(const Archive& archive);

  // Takes a design that is under way for what it is believed to be.
  void Believe(const Eigen::VectorXd& u);

  Belief At(const Eigen::VectorXd& u) const;
  Beliefs AtAll(const Eigen::MatrixXd& designs) const;  // D x k

  // Returns the standard deviation of the noise of each metric as learnt, d.
  Eigen::VectorXd Noise() const;

  const LearntMetrics& learnt() const { return learnt_; }

 private:
  // The hyperparameters of one process, kept from one fit to the next.
  struct Kept {
    GaussianProcess::Hyperparameters hyperparameters;
    Eigen::Index points = 0;  // when they were fitted
  };

  GaussianProcess Trained(const Eigen::MatrixXd& points, const Eigen::VectorXd& values,
                          Kept& kept) const;
  void LearnMetrics(const Archive& archive, const std::vector<std::size_t>& entries);
  void LearnConstraints(const Archive& archive, const std::vector<std::size_t>& entries);
  void LearnFailures(const Archive& archive, const std::vector<std::size_t>& entries);

  Options options_;
  LearntMetrics learnt_;
  std::vector<GaussianProcess> metrics_;
  std::vector<GaussianProcess> limits_;  // of constraints, and of failure: below 0 is good
  std::vector<Kept> kept_metrics_, kept_constraints_;
  Kept kept_failure_;
};

}  // namespace mortise::pareto
