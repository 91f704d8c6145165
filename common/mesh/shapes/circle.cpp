#include "common/mesh/shapes/circle.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace mortise::mesh {
namespace {

constexpr double kOnCircle = 1e-9;       // m, by which the corners of triangles may miss a circle
constexpr double kOnCircleShare = 1e-8;  // of its radius, the same
constexpr double kNearCircle = 1e-6;     // m, the same where they lie in another curved face too
constexpr int kMaxRounds = 4;            // of looking for the corners that lie on a circle

// The circle nearest to points (least squares; Kåsa 1976); none if they lie in a line.
std::optional<Circle> CircleNear(const Eigen::Matrix2Xd& points) {
  const Eigen::Vector2d mean = points.rowwise().mean();
  const double scale = (points.colwise() - mean).cwiseAbs().maxCoeff();
  if (!(scale > 0)) return std::nullopt;
  const Eigen::Matrix2Xd scaled = (points.colwise() - mean) / scale;
  Eigen::MatrixX3d rows(points.cols(), 3);
  rows << 2 * scaled.transpose(), Eigen::VectorXd::Ones(points.cols());
  Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> factors;
  factors.setThreshold(1e-9);
  factors.compute(rows);
  if (factors.rank() < 3) return std::nullopt;
  const Eigen::Vector3d found = factors.solve(scaled.colwise().squaredNorm().transpose());
  return Circle{mean + scale * found.head<2>(),
                scale * std::sqrt(found[2] + found.head<2>().squaredNorm())};
}

}  // namespace

std::optional<Circle> CircleThrough(const Eigen::Matrix2Xd& points) {
  std::optional<Circle> circle = CircleNear(points);
  std::vector<int> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), 0);
  const auto half = order.begin() + (std::ssize(order) + 1) / 2;
  for (int round = 0; circle.has_value(); ++round) {
    const Eigen::VectorXd missed =
        ((points.colwise() - circle->middle).colwise().norm().array() - circle->radius)
            .abs()
            .transpose();
    if (!(missed.maxCoeff() <= kNearCircle)) return std::nullopt;
    std::nth_element(order.begin(), half - 1, order.end(),
                     [&](int a, int b) { return missed[a] < missed[b]; });
    const double exact = std::max(kOnCircle, kOnCircleShare * circle->radius);
    if (missed.maxCoeff() <= exact) return circle;
    if (round == kMaxRounds) return missed[*(half - 1)] <= exact ? circle : std::nullopt;
    circle = CircleNear(points(Eigen::all, std::vector<int>(order.begin(), half)));
  }
  return std::nullopt;
}

}  // namespace mortise::mesh
