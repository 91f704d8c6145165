// Finds a label for each site of a graph so that few neighbours differ, by alpha-expansion (Boykov,
// Veksler and Zabih 2001). It chooses the affine pieces of a front (§7.5.4).
//
//   E(l) = sum_j U(j, l_j) + w sum_{j, k neighbours} [l_j != l_k]
//
// is brought down by one minimal cut after another: each lets any sites at once change to one label
// and finds the best such change, until none helps. What remains is within a factor of two of the
// least energy. A site takes none but its own candidates, so that what holds for each candidate
// (that it is within tolerance) holds for the result; thesis and Potts model would let a site take
// a foreign label for a finite price.
#pragma once

#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::pareto {

struct LabelCost {
  int label = 0;
  double cost = 0;  // U, >= 0
};

struct LabelingProblem {
  int labels = 0;                                  // labels are 0 … labels - 1
  std::vector<std::vector<LabelCost>> candidates;  // of each site, at least one, each label once
  std::vector<std::pair<int, int>> neighbours;     // sites; each pair once
  double weight = 1;                               // w, >= 0
};

// Returns E of a label for each site, all of them candidates.
double LabelingEnergy(const LabelingProblem& problem, const std::vector<int>& labels);

// Returns a label for each site, searched from the cheapest candidates on. It is the same for the
// same problem. INVALID_ARGUMENT naming "candidates[j]", "neighbours[i]" or "weight".
//
// Each round makes a cut for each label, on the sites that have it as a candidate; two to four
// rounds are usual. Memory is linear in sites and neighbours.
absl::StatusOr<std::vector<int>> MinimizeByExpansion(const LabelingProblem& problem);

}  // namespace mortise::pareto
