#include "services/pareto/front/front_labeling.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "services/pareto/archive/embedding.h"
#include "services/pareto/front/alpha_expansion.h"

namespace mortise::pareto {
namespace {

constexpr double kSameDirections = 0.02;  // sine of the angle between pieces that are one

Eigen::MatrixXd OutsideOf(const AffinePiece& piece, const Eigen::MatrixXd& vectors) {
  return vectors - piece.directions * (piece.directions.transpose() * vectors);
}

bool LiesOn(const AffinePiece& piece, const Eigen::VectorXd& u, double tolerance) {
  return OutsideOf(piece, u - piece.centre).norm() <= tolerance;
}

bool IsSame(const AffinePiece& a, const AffinePiece& b, double tolerance) {
  return a.directions.cols() == b.directions.cols() && LiesOn(a, b.centre, 0.5 * tolerance) &&
         OutsideOf(a, b.directions).norm() <= kSameDirections;
}

// Without those that are the same as an earlier one.
std::vector<int> DifferentPieces(const std::vector<AffinePiece>& pieces, double tolerance) {
  std::vector<int> different;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const bool is_known = std::ranges::any_of(
        different, [&](int other) { return IsSame(pieces[other], pieces[p], tolerance); });
    if (!is_known) different.push_back(static_cast<int>(p));
  }
  return different;
}

// A candidate that may stand for a place.
struct Option {
  int piece = 0;
  PerformanceBuffer::Candidate candidate;
};

// Finds out which pieces pass a place, and with which candidate.
class Options {
 public:
  Options(const Archive& archive, const Scaling& scaling, const std::vector<AffinePiece>& pieces,
          double buffer_tolerance, double tolerance)
      : archive_(archive),
        scaling_(scaling),
        pieces_(pieces),
        different_(DifferentPieces(pieces, tolerance)),
        buffer_tolerance_(buffer_tolerance),
        tolerance_(tolerance) {}

  // Each piece that passes the place gives the candidate that is nearest to the ideal.
  std::vector<Option> At(const std::vector<PerformanceBuffer::Candidate>& place) const {
    std::vector<Option> options;
    for (const int p : different_) {
      const auto on_piece = std::ranges::find_if(place, [&](const auto& candidate) {
        return LiesOn(pieces_[p], archive_[candidate.entry].u, tolerance_) &&
               (candidate.entry == place.front().entry ||
                !archive_.ClearlyDominated(archive_[candidate.entry].metrics, scaling_,
                                           buffer_tolerance_));
      });
      if (on_piece != place.end()) options.push_back({p, *on_piece});
    }
    return options;
  }

 private:
  const Archive& archive_;
  const Scaling& scaling_;
  const std::vector<AffinePiece>& pieces_;
  const std::vector<int> different_;
  const double buffer_tolerance_;
  const double tolerance_;
};

}  // namespace

std::vector<std::pair<int, int>> NeighboursAlong(const Eigen::MatrixXd& embedding) {
  const auto count = static_cast<int>(embedding.cols());
  std::set<std::pair<int, int>> pairs;
  if (embedding.rows() == 1) {
    for (int i = 0; i < count; ++i) {
      for (int k = i + 1; k <= i + 2 && k < count; ++k) pairs.emplace(i, k);
    }
    return {pairs.begin(), pairs.end()};
  }
  const Eigen::MatrixXd rays = RaysAt(embedding);
  const int wanted = NeighboursOnFront(embedding.rows() + 1);
  for (int i = 0; i < count; ++i) {
    const Eigen::VectorXd distance = (rays.colwise() - rays.col(i)).colwise().squaredNorm();
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    const int nearest = std::min(wanted + 1, count);  // with itself
    std::partial_sort(order.begin(), order.begin() + nearest, order.end(), [&](int a, int b) {
      return std::pair(distance[a], a) < std::pair(distance[b], b);
    });
    for (int n = 0; n < nearest; ++n) {
      if (order[n] != i) pairs.emplace(std::minmax(i, order[n]));
    }
  }
  return {pairs.begin(), pairs.end()};
}

std::vector<PlaceChoice> ChoosePieces(
    const Archive& archive, const Scaling& scaling,
    const std::vector<std::vector<PerformanceBuffer::Candidate>>& places,
    const std::vector<std::pair<int, int>>& neighbours, const std::vector<AffinePiece>& pieces,
    double buffer_tolerance, double tolerance) {
  std::vector<PlaceChoice> choices;
  for (const auto& place : places) choices.push_back({.entry = place.front().entry});
  const Options passing(archive, scaling, pieces, buffer_tolerance, tolerance);
  LabelingProblem problem;
  problem.labels = static_cast<int>(pieces.size());
  std::vector<int> sites;  // places that some piece passes
  std::vector<int> site_of(places.size(), -1);
  std::vector<std::vector<Option>> options;  // of each site
  for (std::size_t j = 0; j < places.size(); ++j) {
    std::vector<Option> of_place = passing.At(places[j]);
    if (of_place.empty()) continue;
    site_of[j] = static_cast<int>(sites.size());
    sites.push_back(static_cast<int>(j));
    std::vector<LabelCost>& costs = problem.candidates.emplace_back();
    for (const auto& [piece, candidate] : of_place) {
      costs.push_back(
          {piece, (candidate.distance - places[j].front().distance) / buffer_tolerance});
    }
    options.push_back(std::move(of_place));
  }
  for (const auto& [j, k] : neighbours) {
    if (site_of[j] >= 0 && site_of[k] >= 0) problem.neighbours.emplace_back(site_of[j], site_of[k]);
  }
  // The problem is as it should be by construction.
  const std::vector<int> labels = *MinimizeByExpansion(problem);
  std::map<int, int> sizes;
  for (const int label : labels) ++sizes[label];
  for (std::size_t s = 0; s < sites.size(); ++s) {
    if (sizes[labels[s]] < 2) continue;
    const auto option = std::ranges::find(options[s], labels[s], &Option::piece);
    const std::size_t place = sites[s];
    choices[place] = {option->candidate.entry, labels[s],
                      option->candidate.distance - places[place].front().distance};
  }
  return choices;
}

}  // namespace mortise::pareto
