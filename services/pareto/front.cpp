// Extraction, labelling and picking of fronts.
#include "services/pareto/front.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/pareto/non_dominated.h"

namespace mortise::pareto {
namespace {

Eigen::VectorXd Embed(const Eigen::VectorXd& scaled) {
  const Eigen::VectorXd y = scaled.cwiseMax(0.0);
  Eigen::VectorXd embedding(y.size() - 1);
  for (Eigen::Index k = 0; k < embedding.size(); ++k)
    embedding[k] = std::atan2(y.tail(y.size() - 1 - k).norm(), y[k]) / (std::numbers::pi / 2);
  return embedding;
}

double DistanceToPiece(const AffinePiece& piece, const Eigen::VectorXd& u) {
  const Eigen::VectorXd offset = u - piece.centre;
  return (offset - piece.directions * (piece.directions.transpose() * offset)).norm();
}

// Greedy cover: again and again the piece that explains most of the points not yet labelled.
std::vector<int> LabelByPieces(const std::vector<Eigen::VectorXd>& designs,
                               const std::vector<AffinePiece>& pieces, double tolerance,
                               int& labels) {
  std::vector<std::vector<std::size_t>> explained(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (std::size_t i = 0; i < designs.size(); ++i)
      if (DistanceToPiece(pieces[p], designs[i]) <= tolerance) explained[p].push_back(i);
  std::vector<int> label(designs.size(), -1);
  while (true) {
    std::size_t best = 0;
    std::size_t most = 1;  // a piece of one point explains nothing
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      std::erase_if(explained[p], [&](std::size_t i) { return label[i] >= 0; });
      if (explained[p].size() > most) {
        most = explained[p].size();
        best = p;
      }
    }
    if (most == 1) return label;
    for (const std::size_t i : explained[best]) label[i] = labels;
    ++labels;
  }
}

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

// Numbers the pieces in the order in which they appear along the front.
void NumberAlongFront(Front& front) {
  std::vector<int> number;
  for (FrontPoint& point : front.points) {
    const auto at = std::find(number.begin(), number.end(), point.piece);
    const auto index = static_cast<int>(at - number.begin());
    if (at == number.end()) number.push_back(point.piece);
    point.piece = index;
  }
  front.pieces = static_cast<int>(number.size());
}

absl::Status EmptyFront() {
  return PreconditionFailed("FRONT_EMPTY", "the front has no points: every evaluation failed");
}

}  // namespace

Front BuildFront(const DesignSpace& space, const Archive& archive, const PerformanceBuffer& buffer,
                 const std::vector<AffinePiece>& pieces, double tolerance, double joining) {
  Front front;
  front.scaling = buffer.scaling();
  std::vector<std::pair<PerformanceBuffer::CellId, std::size_t>> best;
  std::vector<Eigen::VectorXd> performances;
  for (const auto& [cell, candidates] : buffer.cells()) {
    best.emplace_back(cell, candidates.front().entry);
    performances.push_back(archive[candidates.front().entry].metrics);
  }
  std::vector<std::size_t> kept = NonDominated(performances);
  std::vector<std::pair<Eigen::VectorXd, std::size_t>> order;
  for (const std::size_t i : kept)
    order.emplace_back(Embed(front.scaling.Apply(performances[i])), i);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.first.begin(), a.first.end(), b.first.begin(),
                                        b.first.end());
  });
  std::vector<Eigen::VectorXd> designs;
  for (const auto& [embedding, i] : order) {
    const ArchiveEntry& entry = archive[best[i].second];
    designs.push_back(entry.u);
    front.points.push_back({space.FromUnit(entry.u), entry.metrics, best[i].first, 0, embedding});
  }
  int labels = 0;
  std::vector<int> label = LabelByPieces(designs, pieces, tolerance, labels);
  LabelTheRest(designs, joining, label, labels);
  for (std::size_t i = 0; i < label.size(); ++i) front.points[i].piece = label[i];
  NumberAlongFront(front);
  return front;
}

absl::StatusOr<FrontPoint> PickAtEmbedding(const Front& front, const Eigen::VectorXd& position) {
  if (front.points.empty()) return EmptyFront();
  const Eigen::Index size = front.points.front().embedding.size();
  if (position.size() != size)
    return InvalidField("embedding",
                        absl::StrCat(size, " coordinates are needed, not ", position.size()));
  for (Eigen::Index i = 0; i < size; ++i)
    if (!(position[i] >= 0 && position[i] <= 1))
      return InvalidField(absl::StrCat("embedding[", i, "]"), "must lie between 0 and 1");
  return *std::min_element(
      front.points.begin(), front.points.end(), [&](const FrontPoint& a, const FrontPoint& b) {
        return (a.embedding - position).norm() < (b.embedding - position).norm();
      });
}

absl::StatusOr<FrontPoint> PickAtMetric(const Front& front, Eigen::Index index, double value) {
  if (front.points.empty()) return EmptyFront();
  if (index < 0 || index >= front.points.front().metrics.size())
    return InvalidField("metric.name", "the front has no such metric");
  if (!std::isfinite(value)) return InvalidField("metric.value", "must be a finite number");
  return *std::min_element(
      front.points.begin(), front.points.end(), [&](const FrontPoint& a, const FrontPoint& b) {
        return std::abs(a.metrics[index] - value) < std::abs(b.metrics[index] - value);
      });
}

}  // namespace mortise::pareto
