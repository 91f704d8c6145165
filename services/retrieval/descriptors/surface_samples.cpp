#include "services/retrieval/descriptors/surface_samples.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

namespace mortise::retrieval {
namespace {

// The steps of Roberts' sequence R2: powers of the inverse of the plastic number, the root of
// x³ = x + 1.
constexpr double kFirstStep = 0.7548776662466927;
constexpr double kSecondStep = 0.5698402909980532;

// Uniform in [0, 1) from a seed and a number, by SplitMix64 (Steele, Lea, Flood 2014).
double Offset(std::uint64_t seed, std::uint64_t number) {
  std::uint64_t bits = seed * 2 + number + 0x9e3779b97f4a7c15ULL;
  bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ bits >> 27) * 0x94d049bb133111ebULL;
  return static_cast<double>((bits ^ bits >> 31) >> 11) * 0x1p-53;
}

// From the unit square to barycentric coordinates, keeping areas; each half of the square is shrunk
// onto the triangle (Heitz 2019, "A low-distortion map between triangle and square").
Eigen::Vector3d FoldIntoTriangle(double u, double v) {
  if (v > u) {
    u /= 2;
    v -= u;
  } else {
    v /= 2;
    u -= v;
  }
  return {u, v, 1 - u - v};
}

Eigen::Vector3d DoubledNormal(const Eigen::Matrix3Xd& vertices, const Eigen::Vector3i& corners) {
  const Eigen::Vector3d a = vertices.col(corners[0]);
  return (vertices.col(corners[1]) - a).cross(vertices.col(corners[2]) - a);
}

}  // namespace

SurfaceSamples::SurfaceSamples(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                               Eigen::Index count, std::uint64_t seed)
    : triangle_of_(count), barycentric_(3, count) {
  double total = 0;
  for (const auto& corners : triangles.colwise()) total += DoubledNormal(vertices, corners).norm();
  const double first = Offset(seed, 0), second = Offset(seed, 1);
  std::vector<int> chosen;
  Eigen::Index next = 0;
  double below = 0;
  for (Eigen::Index t = 0; t < triangles.cols() && next < count; ++t) {
    below += DoubledNormal(vertices, triangles.col(t)).norm();
    const bool last = t + 1 == triangles.cols();
    const Eigen::Index begin = next;
    for (; next < count && (last || (double(next) + 0.5) / double(count) * total < below); ++next) {
      const double u = first + kFirstStep * double(next), v = second + kSecondStep * double(next);
      triangle_of_[next] = static_cast<int>(chosen.size());
      barycentric_.col(next) = FoldIntoTriangle(u - std::floor(u), v - std::floor(v));
    }
    if (next > begin) chosen.push_back(static_cast<int>(t));
  }
  numbers_ = Eigen::Map<const Eigen::VectorXi>(chosen.data(), Eigen::Index(chosen.size()));
  triangles_ = triangles(Eigen::all, numbers_);
  first_areas_ = Areas(vertices);
}

Eigen::VectorXd SurfaceSamples::Areas(const Eigen::Matrix3Xd& vertices) const {
  Eigen::VectorXd areas(triangles_.cols());
  for (Eigen::Index t = 0; t < areas.size(); ++t) {
    areas[t] = DoubledNormal(vertices, triangles_.col(t)).norm() / 2;
  }
  return areas;
}

WeightedPoints SurfaceSamples::At(const Eigen::Matrix3Xd& vertices) const {
  const Eigen::VectorXd growth = Areas(vertices).cwiseQuotient(first_areas_);
  WeightedPoints points{Eigen::Matrix3Xd(3, size()), Eigen::VectorXd(size())};
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Eigen::Vector3i corners = triangles_.col(triangle_of_[i]);
    points.positions.col(i) = vertices(Eigen::all, corners) * barycentric_.col(i);
    points.weights[i] = growth[triangle_of_[i]];
  }
  const double sum = points.weights.sum();
  if (sum > 0) points.weights /= sum;
  return points;
}

PointVelocities SurfaceSamples::Differentiate(const Eigen::Matrix3Xd& vertices,
                                              const Eigen::Matrix3Xd& velocities) const {
  Eigen::VectorXd growth(triangles_.cols()), growth_rate(triangles_.cols());
  for (Eigen::Index t = 0; t < growth.size(); ++t) {
    const Eigen::Vector3i corners = triangles_.col(t);
    const Eigen::Vector3d normal = DoubledNormal(vertices, corners);
    const Eigen::Vector3d a = vertices.col(corners[0]), da = velocities.col(corners[0]);
    const Eigen::Vector3d ab = vertices.col(corners[1]) - a, ac = vertices.col(corners[2]) - a;
    const Eigen::Vector3d rate =
        (velocities.col(corners[1]) - da).cross(ac) + ab.cross(velocities.col(corners[2]) - da);
    const double length = normal.norm();
    growth[t] = length / 2 / first_areas_[t];
    // A triangle without area stays without, to first order, or opens with a kink.
    growth_rate[t] = length > 0 ? normal.dot(rate) / length / 2 / first_areas_[t] : 0;
  }
  PointVelocities moving{Eigen::Matrix3Xd(3, size()), Eigen::VectorXd(size())};
  double sum = 0, sum_rate = 0;
  for (Eigen::Index i = 0; i < size(); ++i) {
    sum += growth[triangle_of_[i]];
    sum_rate += growth_rate[triangle_of_[i]];
  }
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Eigen::Index t = triangle_of_[i];
    const Eigen::Vector3i corners = triangles_.col(t);
    moving.positions.col(i) = velocities(Eigen::all, corners) * barycentric_.col(i);
    moving.weights[i] = sum > 0 ? (growth_rate[t] - growth[t] * sum_rate / sum) / sum : 0;
  }
  return moving;
}

}  // namespace mortise::retrieval
