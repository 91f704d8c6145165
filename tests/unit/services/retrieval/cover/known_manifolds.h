// Manifolds whose shape is known, and small families with a descriptor that ignores size.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "services/retrieval/cover/function_manifold.h"

namespace mortise::retrieval::testing {

using Map = std::function<absl::StatusOr<Eigen::VectorXd>(const Eigen::VectorXd&)>;

// A manifold over a box, with derivatives by differences.
inline ManifoldFunctions Over(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                              Eigen::Index dimension, Map map) {
  return {.lower = lower, .upper = upper, .dimension = dimension, .evaluate = std::move(map)};
}

// A straight line of this length in R^10, run through unevenly.
inline ManifoldFunctions Line(double length) {
  return Over(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1), 10,
              [length](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
                const double at = 0.5 * (q[0] + q[0] * q[0]);
                return Eigen::VectorXd::Constant(10, length * at / std::sqrt(10.0));
              });
}

// A circle of radius 1 in the plane.
inline ManifoldFunctions Circle() {
  return Over(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 2 * std::numbers::pi), 2,
              [](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
                return Eigen::Vector2d(std::cos(q[0]), std::sin(q[0]));
              });
}

// z = x² + y² over [-1, 1]² (Figure 4-7).
inline ManifoldFunctions Paraboloid() {
  return Over(Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, 1), 3,
              [](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
                return Eigen::Vector3d(q[0], q[1], q.squaredNorm());
              });
}

// A square of side 1, flat in R^10.
inline ManifoldFunctions Sheet() {
  return Over(Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1), 10,
              [](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
                Eigen::VectorXd x = Eigen::VectorXd::Zero(10);
                x[2] = q[0] * 0.6 + q[1] * 0.8;
                x[7] = q[0] * 0.8 - q[1] * 0.6;
                return x;
              });
}

// A patch of the unit sphere, by longitude and latitude.
inline ManifoldFunctions SpherePatch() {
  return Over(Eigen::Vector2d(0, -0.8), Eigen::Vector2d(1.6, 0.8), 3,
              [](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
                return Eigen::Vector3d(std::cos(q[1]) * std::cos(q[0]),
                                       std::cos(q[1]) * std::sin(q[0]), std::sin(q[1]));
              });
}

// A cylinder: curved along the first parameter, straight for a length of 4 along the second.
inline ManifoldFunctions Cylinder() {
  return Over(Eigen::Vector2d(0, 0), Eigen::Vector2d(3, 4), 3,
              [](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
                return Eigen::Vector3d(std::cos(q[0]), std::sin(q[0]), q[1]);
              });
}

// Width, height and depth of a box by their proportions alone: three parameters, two directions.
inline ManifoldFunctions Proportions() {
  return Over(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(3, 3, 3), 3,
              [](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
                return Eigen::VectorXd(q / q.norm());
              });
}

// Points on bars and boards, as linear functions of the parameters: what a template is, as far as a
// descriptor sees it. Parameters are lengths between 1 and 3.
class ToyFamily {
 public:
  // A board on four legs (3: width, depth, height), with a shelf whose height and size may change
  // (5), and a back with a height and a lean (7).
  explicit ToyFamily(int parameters) : parameters_(parameters) {
    AddTop();
    for (const double x : {-0.45, 0.45}) {
      for (const double y : {-0.45, 0.45}) AddLeg(x, y);
    }
    if (parameters >= 5) AddShelf();
    if (parameters >= 7) AddBack();
  }

  // Shares of the distances between its points, as D2 has it: divided by the mean distance, through
  // Gaussian kernels of width 0.1 with means between 0 and 3.
  Eigen::VectorXd DescriptorAt(const Eigen::VectorXd& q) const {
    std::vector<Eigen::Vector3d> points;
    for (const auto& map : points_) points.emplace_back(map * q);
    std::vector<double> distances;
    double mean = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        distances.push_back((points[i] - points[k]).norm());
        mean += distances.back();
      }
    }
    mean /= static_cast<double>(distances.size());
    return Histogram(distances, mean);
  }

  ManifoldFunctions Functions() const {
    return Over(Eigen::VectorXd::Constant(parameters_, 1),
                Eigen::VectorXd::Constant(parameters_, 3), kKernels,
                [this](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
                  return DescriptorAt(q);
                });
  }

 private:
  using PointMap = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  static constexpr int kKernels = 24;

  static Eigen::VectorXd Histogram(const std::vector<double>& distances, double mean) {
    Eigen::ArrayXd means = Eigen::ArrayXd::LinSpaced(kKernels, 0, 3);
    Eigen::ArrayXd sums = Eigen::ArrayXd::Zero(kKernels);
    for (const double distance : distances) {
      sums += (-(means - distance / mean).square() / (2 * 0.1 * 0.1)).exp();
    }
    return sums.matrix() / static_cast<double>(distances.size());
  }

  // A point at (x of the width, y of the depth, z of the height).
  PointMap At(double x, double y, double z) const {
    PointMap map = PointMap::Zero(3, parameters_);
    map(0, 0) = x;
    map(1, 1) = y;
    map(2, 2) = z;
    return map;
  }

  void AddTop() {
    for (int i = -2; i <= 2; ++i) {
      for (int k = -2; k <= 2; ++k) points_.push_back(At(0.25 * i, 0.25 * k, 1));
    }
  }

  void AddLeg(double x, double y) {
    for (int i = 0; i < 4; ++i) points_.push_back(At(x, y, 0.25 * i));
  }

  void AddShelf() {
    for (int i = -1; i <= 1; ++i) {
      for (int k = -1; k <= 1; ++k) {
        PointMap map = At(0, 0.4 * k, 0);
        map(0, 3) = 0.3 * i;
        map(2, 4) = 0.3;
        points_.push_back(map);
      }
    }
  }

  void AddBack() {
    for (int i = -2; i <= 2; ++i) {
      for (int k = 1; k <= 4; ++k) {
        PointMap map = At(0.25 * i, 0.5, 1);
        map(2, 5) = 0.25 * k;
        map(1, 6) = 0.1 * k;
        points_.push_back(map);
      }
    }
  }

  int parameters_;
  std::vector<PointMap> points_;
};

}  // namespace mortise::retrieval::testing
