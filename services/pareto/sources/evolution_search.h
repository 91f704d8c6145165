// Searches for trade-offs with a Gaussian that learns how metrics fall (evolution_strategy.h), one
// place of the front after the other. It goes on where metrics have kinks, or fall along directions
// that are turned against the parameters.
//
// Each search is against a snapshot of the front: a design counts for the hypervolume that it adds
// to what the snapshot dominates, or, where it adds none, against how far all its metrics together
// would have to improve to add some (the uncrowded hypervolume improvement of Toure, Hansen, Auger
// and Brockhoff, COMO-CMA-ES, 2019). The first has no snapshot and goes for the middle of the
// front. A search that no longer gains is followed by another, from a trade-off beside a large
// hole, with the shape of the Gaussian kept. Of a few samples it takes the one of which a local
// model of known evaluations promises most.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/models/quadratic_model.h"
#include "services/pareto/sources/evolution_strategy.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

class EvolutionSearch {
 public:
  struct Sample {
    Eigen::VectorXd u;  // D, unit coordinates
    int search = 0;     // that it is of
  };

  explicit EvolutionSearch(std::uint64_t seed) : random_(seed) {}

  // Draws another sample of what has been learnt so far; the archive holds a feasible entry. Any
  // number of samples may be under way.
  Sample Next(const Archive& archive, const Scaling& scaling);

  // Takes what came of a sample, as an entry. Every generation of samples is learnt from as soon as
  // it is complete; those of a search that is over are not.
  void Tell(const Archive& archive, const Scaling& scaling, int search, std::size_t entry);

  // Returns up to `count` designs that are to other trade-offs what the best design of the search
  // is to what it was when those were found: as the designs of a front hang together, what improves
  // one of them may well improve the others. It returns none twice.
  std::vector<Eigen::VectorXd> Transfers(const Archive& archive, std::size_t count);

  // Returns the part of its patience that the first search has left, 1 before it has begun; 0 for
  // later ones.
  double Promise() const;

 private:
  double MeritOf(const Archive& archive, const Scaling& scaling, std::size_t entry) const;
  double MeritOf(const Scaling& scaling, const Eigen::VectorXd& metrics) const;
  double Patience() const;
  std::size_t FirstStart(const Archive& archive, const Scaling& scaling) const;
  std::size_t NextStart(const Archive& archive, const Scaling& scaling);
  void Begin(const Archive& archive, const Scaling& scaling);
  void Learn(const Archive& archive, const Scaling& scaling);

  Random random_;
  std::optional<EvolutionStrategy> strategy_;
  Eigen::MatrixXd snapshot_;  // d x n, scaled by
  Scaling snapshot_scaling_;
  std::vector<std::size_t> bests_;       // entries, of the search under way, the present one last
  std::vector<std::size_t> generation_;  // entries told
  std::optional<QuadraticModel> model_;  // around the mean
  int barren_ = 0;                       // generations without a better one
  int searches_ = 0;
  std::set<std::pair<std::size_t, std::size_t>> transferred_;  // trade-off and best
};

// A source of some samples, asked for at once. `search` must outlive it.
class Evolving : public PointSource {
 public:
  Evolving(const Archive& archive, const Scaling& scaling, int samples, EvolutionSearch& search);

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override;
  void Tell(Archive& archive, std::size_t entry) override;
  bool Finished() const override { return samples_.empty() && asked_.empty(); }

 private:
  EvolutionSearch& search_;
  std::deque<EvolutionSearch::Sample> samples_;
  std::deque<int> asked_;  // the searches they are of
};

}  // namespace mortise::pareto
