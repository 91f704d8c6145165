// Spends the end of a budget on rounds that bring what is nearly on the front on to it.
//
// A search leaves many designs that are trade-offs only because nothing has dominated them yet.
// Models of all that has been evaluated tell where the front is far better than any of its steps
// did. So towards the end there are rounds, one after the other, of two kinds of designs: outliers
// put back in line (outlier_repair.h), and trade-offs pushed on to the front (front_polishing.h),
// the best of each cell first.
//
// The first round polishes a few only, to see whether that pays: models do not see very many local
// optima, or noise. It does where at least a quarter of what was polished last are trade-offs. As
// long as it does not, rounds stay trials. With an ample budget the first trial is early, and if it
// pays the second round polishes what there is; the others follow as what is left halves, since
// other ways go on to find designs that are nearly on the front. If polishing pays, the very last
// evaluations of an ample budget are for that alone.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/performance_buffer.h"
#include "services/pareto/sources/front_polishing.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

class FrontFinishing {
 public:
  struct Options {
    std::int64_t evaluations = 0;  // the whole budget
    bool is_ample = false;         // enough to know all of the front as well as models can tell it
    int window = 8;                // evaluations under way at once
    PerformanceBuffer::Options cells;
  };

  explicit FrontFinishing(const Options& options) : options_(options) {}

  // Returns the next round, if one is due when `left` evaluations are left and the last one has
  // ended; else none. A round is to be told all before it is destroyed. It takes a few model fits
  // for each of its designs.
  std::unique_ptr<PointSource> NextRound(const Archive& archive, std::int64_t left);

  // Whether the `left` evaluations are for polishing alone, so that nothing is added any more that
  // is nearly on the front only.
  bool PolishesOnly(std::int64_t left) const;

 private:
  // The outcome of a round, which outlives its source.
  struct Outcome {
    std::size_t polished = 0;  // designs that were not known before
    std::size_t kept = 0;      // of these, trade-offs when they were told
    bool has_ended = true;
  };
  class Round;

  bool Pays() const;
  bool IsDue(std::int64_t left) const;
  double ShareLeft() const;

  Options options_;
  FrontPolishing polishing_;
  int rounds_ = 0;
  std::int64_t last_left_ = 0;  // when the last round began
  bool paid_ = false;           // in the last round before this one that polished anything
  std::shared_ptr<Outcome> outcome_ = std::make_shared<Outcome>();  // of the last round
};

}  // namespace mortise::pareto
