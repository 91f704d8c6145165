// Keeps the best designs so far, apart from each other, and makes children of them. These find
// their way where metrics have very many local optima, and slopes lead nowhere.
//
// Designs are ranked by how many layers of non-dominated ones are above them, and within a layer by
// how far apart they are in performance (NSGA-II; Deb, Pratap, Agarwal and Meyarivan 2002), one
// coming and one going at a time. Children are made in three ways, each as often as it has lately
// brought designs that stay:
//   - crossover: simulated binary crossover of two and polynomial mutation, coordinate by
//     coordinate (the same authors);
//   - difference: a + F (b − c) of three (Storn and Price 1997), in some or all coordinates. Where
//     all three lie in local optima of a regular pattern, so does the child, and the pattern may be
//     turned against the axes;
//   - transplant: one or two coordinates of another, or new ones.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

class Population {
 public:
  enum class Way { kCrossover = 0, kDifference = 1, kTransplant = 2 };

  struct Child {
    Eigen::VectorXd u;
    Way way = Way::kCrossover;
  };

  // Keeps `size` designs, at least four.
  explicit Population(std::size_t size) : size_(size) {}

  // Offers a feasible entry of the archive; returns whether it stays.
  bool Offer(const Archive& archive, std::size_t entry);

  // Tells what came of a child.
  void Report(Way way, bool stayed);

  // Makes a child; there must be four designs.
  Child MakeChild(const Archive& archive, Random& random) const;

  std::size_t size() const { return members_.size(); }
  bool Holds(std::size_t entry) const;

 private:
  std::size_t Select(Random& random) const;
  Way ChooseWay(Random& random) const;
  std::size_t WorstOf(const Archive& archive, std::vector<int>& ranks) const;

  const std::size_t size_;
  std::vector<std::size_t> members_;  // entries
  std::vector<int> ranks_;            // of the members
  std::array<double, 3> tried_ = {1, 1, 1};
  std::array<double, 3> stayed_ = {1, 1, 1};
};

// A source of some children of a population, asked for at once. `population` must outlive it.
class Breeding : public PointSource {
 public:
  Breeding(const Archive& archive, Population& population, int children, Random& random);

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override;
  void Tell(Archive& archive, std::size_t entry) override;
  bool Finished() const override { return children_.empty() && asked_.empty(); }

 private:
  Population& population_;
  std::deque<Population::Child> children_;
  std::deque<Population::Way> asked_;
};

}  // namespace mortise::pareto
