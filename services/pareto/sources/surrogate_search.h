// Proposes designs where a surrogate expects the most hypervolume to be gained.
//
// It is for expensive evaluators. What has been evaluated, and what is under way (taken for what it
// is believed to become: Kriging believer, Ginsbourger, Le Riche, Carraro 2010), makes a
// SurrogateModel; the design proposed is about the largest of
//
//   E[hypervolume gained] * P(no constraint is violated and the evaluation does not fail)
//
// (expected_improvement.h; Schonlau, Welch, Jones 1998). Hypervolume is measured up to a reference
// a tenth beyond what the front spans or, where that is more, what it may come to span: the
// performance where each metric by itself may be best. So a front of which only a corner is known
// is looked for elsewhere. The largest is sought among designs that fill the space, trade-offs
// moved a little, some of their parameters moved, designs between and beyond two of them, and then
// along the slope from the best of those (L-BFGS of NLopt).
//
// The evaluator decides: only what it answers enters the archive. The quality of predictions is
// kept beside.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/models/expected_improvement.h"
#include "services/pareto/models/surrogate_model.h"
#include "services/pareto/models/surrogate_quality.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

class SurrogateSearch {
 public:
  struct Options {
    SurrogateModel::Options model;
    int candidates = 400;  // before slopes are followed; a quarter of them fills the space
    int ascents = 6;       // of the best of those
    int steps = 40;        // of an ascent, at most
  };

  // Proposes designs that can be set in `box`, whose unit coordinates are those of the archive.
  SurrogateSearch(const Options& options, const DesignSpace& box, std::uint64_t seed)
      : options_(options), box_(box), random_(seed), model_(options.model) {}

  // Asks for the next design, or for none where every candidate is known. `archive` holds a
  // feasible entry; `under_way` are designs (unit coordinates) that have been proposed and not yet
  // been answered. This must outlive the source.
  std::unique_ptr<PointSource> Next(const Archive& archive,
                                    const std::vector<Eigen::VectorXd>& under_way);

  SurrogateQuality quality() const { return tally_.quality(); }
  const SurrogateTally& tally() const { return tally_; }

 private:
  Eigen::MatrixXd Candidates(const Archive& archive);
  Eigen::VectorXd Candidate(const Archive& archive);
  Eigen::VectorXd MayBeBest(const Archive& archive, const Eigen::MatrixXd& candidates,
                            const Eigen::VectorXd& weights) const;
  Eigen::VectorXd Reference(const Archive& archive, const Eigen::MatrixXd& candidates) const;
  std::vector<Eigen::VectorXd> FrontWith(const Archive& archive,
                                         const std::vector<Eigen::VectorXd>& under_way);
  std::vector<Eigen::VectorXd> MostExpected(const ExpectedHypervolumeImprovement& improvement,
                                            const Eigen::MatrixXd& candidates) const;

  Options options_;
  DesignSpace box_;
  Random random_;
  SurrogateModel model_;
  SurrogateTally tally_;
};

}  // namespace mortise::pareto
