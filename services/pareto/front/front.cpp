// Extraction and labelling of fronts.
#include "services/pareto/front/front.h"

#include <algorithm>

#include "services/pareto/archive/embedding.h"
#include "services/pareto/archive/front_places.h"
#include "services/pareto/front/front_labeling.h"

namespace mortise::pareto {
namespace {

// Points on no piece: the label of the nearest earlier point within `joining`, else a new one.
void LabelTheRest(const std::vector<Eigen::VectorXd>& designs, double joining,
                  std::vector<int>& label, int& labels) {
  const std::vector<int> known = label;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    if (label[i] >= 0) continue;
    double least = joining;
    for (std::size_t other = 0; other < designs.size(); ++other) {
      if (other == i || (other > i && known[other] < 0)) continue;
      const double distance = (designs[other] - designs[i]).norm();
      if (distance < least) {
        least = distance;
        label[i] = label[other];
      }
    }
    if (label[i] < 0) label[i] = labels++;
  }
}

// Numbers the labels in the order in which they appear along the front, and counts their points.
// Gives the label of each number.
std::vector<int> NumberAlongFront(const std::vector<int>& labels, Front& front) {
  std::vector<int> numbered;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto at = std::ranges::find(numbered, labels[i]);
    const auto piece = static_cast<std::size_t>(at - numbered.begin());
    if (at == numbered.end()) {
      numbered.push_back(labels[i]);
      front.pieces.emplace_back();
    }
    front.points[i].piece = static_cast<int>(piece);
    ++front.pieces[piece].points;
  }
  return numbered;
}

Eigen::MatrixXd Columns(const std::vector<Eigen::VectorXd>& vectors) {
  if (vectors.empty()) return {};
  Eigen::MatrixXd columns(vectors.front().size(), static_cast<Eigen::Index>(vectors.size()));
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    columns.col(static_cast<Eigen::Index>(i)) = vectors[i];
  }
  return columns;
}

void MeasureJumps(const std::vector<Eigen::VectorXd>& designs, Front& front) {
  std::vector<Eigen::VectorXd> embeddings;
  for (const FrontPoint& point : front.points) embeddings.push_back(point.embedding);
  for (const auto& [i, k] : NeighboursAlong(Columns(embeddings))) {
    // On a line those after the next are neighbours for the labels only.
    if (embeddings[i].size() == 1 && k != i + 1) continue;
    const double distance = (designs[i] - designs[k]).norm();
    front.points[i].jump = std::max(front.points[i].jump, distance);
    front.points[k].jump = std::max(front.points[k].jump, distance);
  }
}

struct Labelled {
  FrontPoint point;
  std::size_t entry = 0;
  int piece = -1;
};

// A point for each place along the front, with the affine piece it lies on.
std::vector<Labelled> ChoosePoints(const DesignSpace& space, const Archive& archive,
                                   const PerformanceBuffer& buffer,
                                   const std::vector<AffinePiece>& pieces) {
  const std::vector<FrontPlace> found = PlacesOfFront(archive, buffer);
  std::vector<std::pair<Eigen::VectorXd, std::size_t>> order;  // embedding, place
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::VectorXd& best = archive[found[i].candidates.front().entry].metrics;
    order.emplace_back(Embed(buffer.scaling().Apply(best)), i);
  }
  std::ranges::stable_sort(order, [](const auto& a, const auto& b) {
    return std::ranges::lexicographical_compare(a.first, b.first);
  });
  std::vector<Eigen::VectorXd> embeddings;
  std::vector<std::vector<PerformanceBuffer::Candidate>> places;
  for (const auto& [embedding, i] : order) {
    embeddings.push_back(embedding);
    places.push_back(found[i].candidates);
  }
  const std::vector<PlaceChoice> choices =
      ChoosePieces(archive, buffer.scaling(), places, NeighboursAlong(Columns(embeddings)), pieces,
                   buffer.tolerance());
  std::vector<Labelled> chosen;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const auto& [entry, piece, error] = choices[i];
    const Eigen::VectorXd& metrics = archive[entry].metrics;
    chosen.push_back({{.x = space.FromUnit(archive[entry].u),
                       .metrics = metrics,
                       .constraints = archive[entry].constraints,
                       .cell = found[order[i].second].cell,
                       .embedding = Embed(buffer.scaling().Apply(metrics)),
                       .approximation_error = error,
                       .entry = entry},
                      entry,
                      piece});
  }
  return chosen;
}

}  // namespace

Front BuildFront(const DesignSpace& space, const Archive& archive, const PerformanceBuffer& buffer,
                 const std::vector<AffinePiece>& pieces, double joining) {
  Front front;
  front.scaling = buffer.scaling();
  std::vector<Labelled> chosen = ChoosePoints(space, archive, buffer, pieces);
  std::ranges::stable_sort(chosen, [](const Labelled& a, const Labelled& b) {
    return std::ranges::lexicographical_compare(a.point.embedding, b.point.embedding);
  });
  std::vector<Eigen::VectorXd> designs;
  std::vector<int> label;
  for (Labelled& one : chosen) {
    designs.push_back(archive[one.entry].u);
    label.push_back(one.piece);
    front.points.push_back(std::move(one.point));
  }
  int labels = static_cast<int>(pieces.size());
  LabelTheRest(designs, joining, label, labels);
  const std::vector<int> numbered = NumberAlongFront(label, front);
  for (std::size_t p = 0; p < numbered.size(); ++p) {
    const bool is_affine = numbered[p] < static_cast<int>(pieces.size());
    FrontPiece& piece = front.pieces[p];
    if (is_affine) {
      piece.origin =
          space.lower + (space.upper - space.lower).cwiseProduct(pieces[numbered[p]].centre);
      piece.directions = (space.upper - space.lower).asDiagonal() * pieces[numbered[p]].directions;
    } else {
      piece.origin = std::ranges::find(front.points, static_cast<int>(p), &FrontPoint::piece)->x;
      piece.directions.resize(space.size(), 0);
    }
  }
  MeasureJumps(designs, front);
  return front;
}

}  // namespace mortise::pareto
