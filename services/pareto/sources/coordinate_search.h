// Looks along one parameter for something better, everywhere and then nearby.
//
// Where metrics are nearly sums over parameters, however many local optima each term has, this
// finds in some dozens of evaluations a parameter what no search in all directions at once would:
// the optima multiply, and these do not. Where parameters act together it brings little, and gets
// little of the budget.
//
// Some values of the parameter are tried side by side, half of them anywhere (one of them a bound:
// between there and here designs may not be allowed, or be worse), half near the start. If the best
// of them comes nearer to the target than the start, parabolas through three points follow it down,
// in nine evaluations at most. With no values to try, it only follows parabolas.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/sources/local_optimization.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

class CoordinateSearch : public PointSource {
 public:
  // Looks along a parameter of an evaluated design, with so many values anywhere on its range.
  CoordinateSearch(const Archive& archive, const Scaling& scaling,
                   const LocalOptimization::Target& target, std::size_t start,
                   Eigen::Index parameter, int values, Random& random);

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override;
  void Tell(Archive& archive, std::size_t entry) override;
  bool Finished() const override { return queue_.empty() && outstanding_ == 0; }

 private:
  struct Tried {
    double value = 0;     // of the parameter
    double distance = 0;  // to the target, scaled performance
  };

  std::optional<double> Vertex() const;
  void Follow();
  double DistanceOf(const Archive& archive, std::size_t entry) const;

  const Scaling scaling_;
  const Eigen::VectorXd z_;
  const Eigen::VectorXd start_;
  const Eigen::Index parameter_;
  Tried best_;
  double step_ = 0;  // of the parabola; 0 while values anywhere are tried
  bool improved_ = false;
  std::deque<double> queue_;
  std::vector<Tried> around_;  // of this round, and the best before it
  int outstanding_ = 0;
};

}  // namespace mortise::pareto
