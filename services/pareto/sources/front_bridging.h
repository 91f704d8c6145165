// Proposes designs between those of neighbouring trade-offs, and a little beyond them.
//
// The designs of a front form pieces of d - 1 dimensions that are flat or bend slowly (the thesis's
// §7.4; Zhang, Zhou and Jin, RM-MEDA, 2008). Half way between two designs of a piece there is
// another that is nearly as good, for one evaluation and without any slope.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

struct Bridge {
  Eigen::VectorXd u;  // D, unit coordinates
  double length = 0;  // to the nearer of the two designs
};

class FrontBridging {
 public:
  // Returns up to `count` designs where the front has its widest holes: of some random trade-offs,
  // half way to one of the nearest or as far again beyond it. No pair is tried twice. O(n) for n
  // non-dominated entries.
  std::vector<Bridge> Next(const Archive& archive, const Scaling& scaling, std::size_t count,
                           Random& random);

 private:
  // Two entries, and whether the design was beyond the first, away from the second.
  using Pair = std::tuple<std::size_t, std::size_t, bool>;

  std::set<Pair> tried_;
};

// A source of points that are known from the start, asked for at once.
class PointList : public PointSource {
 public:
  explicit PointList(std::vector<Eigen::VectorXd> points) : points_(points.begin(), points.end()) {}

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override;
  void Tell(Archive& archive, std::size_t entry) override;
  bool Finished() const override { return points_.empty() && outstanding_ == 0; }

 private:
  std::deque<Eigen::VectorXd> points_;
  int outstanding_ = 0;
};

}  // namespace mortise::pareto
