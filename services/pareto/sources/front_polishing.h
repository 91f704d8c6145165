// Pushes designs near the front on to it as far as is known without evaluating anything.
//
// Around a design u that is nearly Pareto-optimal, quadratic models (quadratic_model.h) of what has
// been evaluated nearby tell a direction -alpha normal to the front (first_order_expansion.h), and
// a step p that brings the performance towards a point just beyond the front, as in the thesis's
// measure of how far a design is from it (Eq. 7.8):
//
//   min over p of |y(u + p) - (y(u) - delta_N alpha / |alpha|)|^2,   y the scaled performance,
//
// and then back along the front to the line through y(u) that the normal and a little of all
// metrics make, so that the new design is better than u in all of them and takes its place. At the
// edge of the front alpha has zeros: metrics of which u may have less without any of the others
// having more. They may get better than on that line, as far as they like.
//
// The models are good where the front is well sampled, so that the step costs one evaluation and
// takes the error of half way between two designs from the square of their distance to about its
// fourth power.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <map>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/performance_buffer.h"

namespace mortise::pareto {

struct PolishedDesign {
  Eigen::VectorXd u;  // D, within the unit box; bounds that the design was on are kept
  double gain = 0;    // how much nearer to that point p brings it, as foretold; scaled performance
};

// Returns `u` moved by p, no coordinate by more than `reach`. The archive must have an evaluated
// entry. O(D^3).
PolishedDesign Polished(const Archive& archive, const Scaling& scaling, const Eigen::VectorXd& u,
                        double reach);

// Polishes trade-offs, round after round.
class FrontPolishing {
 public:
  // Says which trade-offs are polished, by what they gain, in scaled performance. The thesis asks
  // for errors below 1e-5.
  struct Choice {
    double least = 2e-6;
    double most = std::numeric_limits<double>::infinity();
    bool typical = false;  // some of all that gain, rather than those that gain most
  };

  // Returns polished trade-offs that gain as much as `choice` says, at most `count`: first the best
  // of each cell of `buffer`, those that gain most first, then others in the same order. It looks
  // at some four for each that is wanted. It looks at a trade-off that gains no more than the least
  // again only some rounds later, and never at one that still is a trade-off after it was polished
  // three times. O(n) for n trade-offs, and a Polished for each that is looked at.
  std::vector<Eigen::VectorXd> Next(const Archive& archive, const PerformanceBuffer& buffer,
                                    std::size_t count, const Choice& choice);

 private:
  struct Tries {
    std::size_t count = 0;  // how often it was polished
    double gain = 0;        // as foretold last,
    int round = 0;          // in which it was
  };

  std::vector<std::size_t> LookedAt(const Archive& archive, const std::vector<std::size_t>& best,
                                    std::size_t most, double least_gain) const;

  int rounds_ = 0;
  std::map<std::size_t, Tries> tries_;  // by entry, of those that were looked at
};

}  // namespace mortise::pareto
