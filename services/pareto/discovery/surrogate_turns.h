// Divides the turns of a discovery between its surrogate and its other ways: by how well the
// surrogate has foretold, and by the hypervolume that either has lately gained an evaluation.
//
// The surrogate has most turns, two of five, while its predictions are about as good as it says and
// it gains as much as the others; the fewer the less that is so, down to one of twenty by which it
// can show that it has learnt. More than two of five gain nothing on most problems, and where the
// surrogate errs they take from the others what they need before they gain anything (docs/pareto.md
// has what was measured). Our own, after the credit of adaptive operator selection (Fialho 2010).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "services/pareto/models/surrogate_quality.h"

namespace mortise::pareto {

class SurrogateTurns {
 public:
  // `size` is the number of parameters that can vary: what is counted fades the more slowly the
  // more there are, as other ways need the more evaluations before they gain anything.
  // With `fixed` the surrogate has this share of the proposals whatever it earns.
  SurrogateTurns(Eigen::Index size, std::optional<double> fixed);

  // Counts an evaluation, and the hypervolume that it gained.
  void Count(bool is_surrogates, double gain);

  // Counts a proposal. `foretold` is how good the surrogate's predictions have been.
  void Propose(bool is_surrogates, const SurrogateQuality& foretold);

  // Whether its share does not follow from what it earns.
  bool IsFixed() const { return fixed_.has_value(); }

  // Whether the next proposal is the surrogate's.
  bool IsDue() const { return balance_ >= 0; }

  // Returns the share of the proposals that the surrogate has now: .05 to .4, or what is fixed.
  double Share(const SurrogateQuality& foretold) const;

 private:
  // What a way of proposing designs has earned; fades.
  struct Earned {
    double gain = 0;
    double evaluations = 0;
  };

  // How much its foretelling, and its gains beside those of the others, earn it: 0 to 1.
  double Trust(const SurrogateQuality& foretold) const;
  double Lead() const;

  std::optional<double> fixed_;
  double memory_;  // evaluations
  Earned surrogate_, others_;
  double balance_ = 0;  // proposals that it has earned and not had
};

}  // namespace mortise::pareto
