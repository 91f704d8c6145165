// Chooses which candidate stands for each place along a front (front_places.h), and which affine
// piece it lies on (§7.5.4): few large pieces rather than the very best of each place.
//
// The unary cost of a piece at a place is e_A / delta_B: the distance by which its best candidate
// there is further from the ideal than the first, over what the buffer tolerates. Neighbours on
// different pieces cost 1 (alpha_expansion.h).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/performance_buffer.h"
#include "services/pareto/sources/patch_sampling.h"

namespace mortise::pareto {

// The candidate that stands for a place.
struct PlaceChoice {
  std::size_t entry = 0;           // of the archive
  int piece = -1;                  // index of the piece it lies on; -1: on none
  double approximation_error = 0;  // e_A, scaled performance
};

// Returns pairs of positions of an embedding (embedding.h; d - 1 x n) that are near each other,
// each once. On a line (d = 2) they ascend, and each has the next two to either side; else each has
// those whose rays are nearest, as many as NeighboursOnFront says.
std::vector<std::pair<int, int>> NeighboursAlong(const Eigen::MatrixXd& embedding);

// Returns a choice for each place. `places` are the candidates of each, nearest first, not empty;
// the first is not dominated. `neighbours` are pairs of places, and `buffer_tolerance` is delta_B.
// A candidate lies on a piece if its design is within `tolerance` of it, Euclidean in unit
// coordinates. None that is clearly dominated (Archive::ClearlyDominated, by delta_B) is chosen: in
// a wide cell it may be hardly further from the ideal than the first, and still be plainly worse
// than something else. A piece of one place would be none, so that place's choice is its first
// candidate.
std::vector<PlaceChoice> ChoosePieces(
    const Archive& archive, const Scaling& scaling,
    const std::vector<std::vector<PerformanceBuffer::Candidate>>& places,
    const std::vector<std::pair<int, int>>& neighbours, const std::vector<AffinePiece>& pieces,
    double buffer_tolerance, double tolerance = 0.02);

}  // namespace mortise::pareto
