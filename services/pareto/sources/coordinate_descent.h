// Looks along the parameters one by one, each over its whole range (line_minimum.h), and goes on
// from what is best: the beginning of a search with evaluations to spare.
//
// Where metrics are nearly sums over parameters, or some function of such a sum, however many local
// optima each term has, this leads to the best of them in some dozens of evaluations a parameter. A
// search in all directions at once meets the product of those optima. Where parameters act together
// this is a walk downhill along the axes, for which there are better ways: more than two passes
// over the parameters (one, with few values for each) are made only where metrics ripple along most
// of them, and none after one that brought little.
//
// Some parameters are looked along side by side, from the same design; then all that has been found
// is put together, which is right where they do not act together, and tried beside the best of
// them. Parameters come in random order. Designs are compared by about their distance to a point
// below the ideal one, so any metric may gain.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/sources/line_minimum.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

class CoordinateDescent : public PointSource {
 public:
  struct Options {
    int evaluations = 1000;  // at most, but for those of lines that have begun
    int lines = 4;           // side by side
    double progress = 0.02;  // in a pass over all parameters, in ranges, that is worth another one
    LineMinimum::Options line;
  };

  // Begins at a feasible entry.
  CoordinateDescent(const Options& options, const Archive& archive, std::size_t start,
                    Random& random);

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override;
  void Tell(Archive& archive, std::size_t entry) override;
  bool Finished() const override { return finished_; }

 private:
  struct Line {
    Eigen::Index parameter;
    LineMinimum minimum;
    std::size_t best;  // entry
  };

  double BadnessOf(const Archive& archive, std::size_t entry) const;
  void BeginPass(const Archive& archive);
  void BeginLines(const Archive& archive);
  void EndLines(const Archive& archive);

  const Options options_;
  Random random_;
  std::size_t best_;
  std::size_t best_of_last_pass_;
  Scaling scaling_;  // while these lines are looked along
  std::vector<Eigen::Index> order_;
  std::size_t next_ = 0;  // in `order_`
  std::vector<Line> lines_;
  std::ptrdiff_t rippled_ = 0;  // lines of this pass
  std::optional<Eigen::VectorXd> together_;
  std::deque<std::size_t> asked_;  // in `lines_`, or their number for what was put together
  int evaluations_ = 0;
  int passes_ = 0;
  bool finished_ = false;
};

}  // namespace mortise::pareto
