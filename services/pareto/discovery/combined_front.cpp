// The merged front of all combinations, in pieces that are each of one combination.
//
// Cells, pieces and jumps are chosen as those of a single discovery (front.h), in a space that has,
// after the other parameters, a coordinate for each combination with a candidate: 1 / sqrt(2) for
// the design's own, else 0. So designs of two combinations are at least a whole range apart, and no
// affine piece of one passes another.
#include <map>
#include <numbers>
#include <utility>

#include "services/pareto/archive/front_places.h"
#include "services/pareto/discovery/combined_discovery.h"
#include "services/pareto/front/front.h"

namespace mortise::pareto {
namespace {

constexpr double kOwn = 1 / std::numbers::sqrt2;

// Returns the ranges of `parameters`, followed by as many from 0 to 1 as make `width`.
DesignSpace WithUnitRanges(const DesignSpace& space, const std::vector<Eigen::Index>& parameters,
                           Eigen::Index width) {
  const auto size = static_cast<Eigen::Index>(parameters.size());
  DesignSpace wide{Eigen::VectorXd::Zero(width), Eigen::VectorXd::Ones(width),
                   Eigen::VectorXd::Zero(width)};
  wide.lower.head(size) = space.lower(parameters);
  wide.upper.head(size) = space.upper(parameters);
  if (space.step.size() > 0) wide.step.head(size) = space.step(parameters);
  return wide;
}

}  // namespace

Front CombinedDiscovery::front() const {
  const auto size = static_cast<Eigen::Index>(others_.size());
  std::map<std::size_t, Eigen::Index> column;  // of each member with a candidate
  std::vector<bool> is_candidate(archive_.size(), false);
  for (const FrontPlace& place : PlacesOfFront(archive_, buffer_)) {
    for (const PerformanceBuffer::Candidate& candidate : place.candidates) {
      is_candidate[candidate.entry] = true;
      column.emplace(member_of_[candidate.entry], 0);
    }
  }
  Eigen::Index width = size;
  for (auto& [member, index] : column) index = width++;
  const DesignSpace space = WithUnitRanges(space_, others_, width);
  const auto embedded = [&](const Eigen::VectorXd& others, std::size_t member) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(width);
    u.head(size) = others;
    u[column.at(member)] = kOwn;
    return u;
  };
  Archive archive;
  for (std::size_t entry = 0; entry < archive_.size(); ++entry) {
    ArchiveEntry copy = archive_[entry];
    copy.u = is_candidate[entry] ? embedded(OthersOf(entry), member_of_[entry])
                                 : Eigen::VectorXd(Eigen::VectorXd::Zero(width));
    archive.Add(std::move(copy));
  }
  std::vector<AffinePiece> pieces;
  for (const auto& [member, index] : column) {
    for (const AffinePiece& piece : members_[member].search->Pieces()) {
      if (size == 0) break;
      AffinePiece& added = pieces.emplace_back();
      added.centre = embedded(piece.centre, member);
      added.directions = Eigen::MatrixXd::Zero(width, piece.directions.cols());
      added.directions.topRows(size) = piece.directions;
    }
  }
  Front front = BuildFront(space, archive, buffer_, pieces);
  const auto restored = [&](const Eigen::VectorXd& x) {
    Eigen::VectorXd whole = space_.lower;
    for (const auto& [member, index] : column) {
      if (x[index] > 0) whole = members_[member].space.lower;
    }
    whole(others_) = x.head(size);
    return whole;
  };
  for (FrontPoint& point : front.points) {
    point.x = evaluated_[point.entry];
    point.deviations = deviations_[point.entry];
  }
  for (FrontPiece& piece : front.pieces) {
    piece.origin = restored(piece.origin);
    Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(space_.size(), piece.directions.cols());
    directions(others_, Eigen::all) = piece.directions.topRows(size);
    piece.directions = std::move(directions);
  }
  return front;
}

}  // namespace mortise::pareto
