// Crosses the whole front along a single parameter of a design.
//
// Often one parameter for each metric but one is what trades metrics off (a thickness: mass against
// stiffness), while the others are better or worse for all of them. Once a design has been brought
// near to the front, such a parameter taken from bound to bound, everything else as it is, gives
// trade-offs along the whole front, also across what is dominated between its parts, where a walk
// along an affine piece ends. See TradingParameters (parameter_lines.h).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <set>

#include "services/pareto/archive/archive.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

// It asks first for a few values over the range of the parameter, then for the middle of the widest
// gaps in performance between neighbours, but for those between designs that are clearly dominated.
class FrontTraverse : public PointSource {
 public:
  struct Options {
    int evaluations = 16;    // at most, or 8
    double spacing = 0.05;   // of neighbours, scaled performance, where gaps end
    double tolerance = 0.1;  // of dominance, scaled performance
  };

  // Goes along `parameter` of an evaluated, feasible entry.
  FrontTraverse(const Options& options, const Archive& archive, const Scaling& scaling,
                std::size_t entry, Eigen::Index parameter);

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override;
  void Tell(Archive& archive, std::size_t entry) override;
  bool Finished() const override { return queue_.empty() && outstanding_ == 0; }

 private:
  void QueueGaps(const Archive& archive);

  Options options_;
  Scaling scaling_;
  Eigen::VectorXd start_;
  Eigen::Index parameter_;
  std::map<double, std::size_t> line_;  // value to entry, of feasible designs
  std::deque<double> queue_;
  std::set<double> tried_;
  int outstanding_ = 0;
  int evaluations_ = 0;
};

}  // namespace mortise::pareto
