#include "common/mesh/edge_sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

constexpr int kClosedPieces = 4;    // of a closed edge, at least
constexpr double kNoLength = 1e-9;  // m
constexpr double kStraight = 1e-6;  // sine of a turn that is none

int AddPoint(std::string name, const Eigen::Vector3d& position, ControlVariables& variables) {
  variables.points.push_back({std::move(name), position});
  return static_cast<int>(variables.points.size()) - 1;
}

// Lines from point to point, and where along them the points are.
struct Polyline {
  Eigen::Matrix3Xd points;
  std::vector<double> along;  // m, ascending

  Eigen::Vector3d At(double distance) const {
    const auto after = std::upper_bound(along.begin() + 1, along.end() - 1, distance);
    const auto end = static_cast<Eigen::Index>(after - along.begin());
    const double piece = *after - *(after - 1);
    const double share = piece > 0 ? std::clamp((distance - *(after - 1)) / piece, 0.0, 1.0) : 0.0;
    return (1 - share) * points.col(end - 1) + share * points.col(end);
  }

  Eigen::Matrix3Xd Between(double from, double to) const {
    const double length = along.back();
    std::vector<Eigen::Vector3d> way = {At(from * length)};
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const double place = along[static_cast<std::size_t>(i)];
      // What is as near to an end as rounding is that end.
      if (place <= (from + 1e-12) * length || place >= (to - 1e-12) * length) continue;
      way.emplace_back(points.col(i));
    }
    way.push_back(At(to * length));
    Eigen::Matrix3Xd columns(3, std::ssize(way));
    for (std::size_t i = 0; i < way.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = way[i];
    return columns;
  }
};

// Returns the points at which the line turns, and its ends.
Eigen::Matrix3Xd Corners(const Eigen::Matrix3Xd& points) {
  std::vector<Eigen::Index> kept = {0};
  for (Eigen::Index i = 1; i + 1 < points.cols(); ++i) {
    const Eigen::Vector3d before = points.col(i) - points.col(kept.back());
    const Eigen::Vector3d after = points.col(i + 1) - points.col(i);
    const double product = before.norm() * after.norm();
    const bool is_straight =
        before.dot(after) >= 0 && before.cross(after).norm() <= kStraight * product;
    if (!is_straight) kept.push_back(i);
  }
  kept.push_back(points.cols() - 1);
  return points(Eigen::all, kept);
}

}  // namespace

absl::Status SampleEdge(const NamedEdge& edge, double spacing, ControlVariables& variables) {
  if (!(edge.length > kNoLength)) return absl::OkStatus();
  int pieces = edge.is_closed ? kClosedPieces : 1;
  const auto count = static_cast<int>(variables.points.size());
  while (edge.length / pieces > spacing && count + pieces <= kMaximumSamples) pieces *= 2;
  if (count + pieces > kMaximumSamples) {
    return TooLarge("the samples of the model's edges", absl::StrCat(kMaximumSamples, " points"));
  }
  std::vector<int> points;
  for (int i = 0; i <= pieces; ++i) {
    const bool is_named = (i == 0 || i == pieces) && !(edge.is_closed && edge.from < 0);
    if (is_named) {
      points.push_back(i == 0 ? edge.from : edge.to);
    } else if (i == pieces) {
      points.push_back(points.front());
    } else {
      const int divisor = std::gcd(i, pieces);
      const double share = static_cast<double>(i) / pieces;
      points.push_back(AddPoint(absl::StrCat(edge.name, " at ", i / divisor, "/", pieces / divisor),
                                edge.way(share, share + 1.0 / pieces).col(0), variables));
    }
  }
  for (int i = 0; i < pieces; ++i) {
    const auto index = static_cast<std::size_t>(i);
    if (points[index] < 0 || points[index + 1] < 0) continue;
    variables.paths.push_back(
        {edge.name, points[index], points[index + 1],
         edge.way(static_cast<double>(i) / pieces, static_cast<double>(i + 1) / pieces)});
  }
  return absl::OkStatus();
}

std::function<Eigen::Matrix3Xd(double, double)> WayAlong(const Eigen::Matrix3Xd& points,
                                                         double& length) {
  Polyline line{Corners(points), {0}};
  for (Eigen::Index i = 1; i < line.points.cols(); ++i) {
    line.along.push_back(line.along.back() + (line.points.col(i) - line.points.col(i - 1)).norm());
  }
  length = line.along.back();
  return [line = std::move(line)](double from, double to) { return line.Between(from, to); };
}

}  // namespace mortise::mesh
