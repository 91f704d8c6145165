#include "common/mesh/measures/floating_solid.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

constexpr double kTolerance = 1e-12;  // of the height
constexpr std::uintmax_t kTrials = 100;

// Integrals of what is below the water. By the divergence theorem they are integrals over the wet
// surface of its height below the water, of that squared, and of 1, x, y … times the upward share
// of the outward normal: the water's own plane adds nothing to the first two, and is all that the
// others see.
struct Submerged {
  double volume = 0;
  double height_moment = 0;                          // ∫ (z − water) dV
  double area = 0;                                   // of the plane cut by the water
  Eigen::Vector2d first = Eigen::Vector2d::Zero();   // ∫ (x, y) dA of that plane
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();  // ∫ (x, y)ᵀ(x, y) dA

  // A triangle wholly below the water, by the rule of edge middles, exact to degree 2.
  void Add(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
           double water) {
    const double upward = (b - a).cross(c - a).z() / 2;
    const std::array<Eigen::Vector3d, 3> middles{(a + b) / 2, (b + c) / 2, (c + a) / 2};
    for (const Eigen::Vector3d& middle : middles) {
      const double weight = upward / 3, depth = middle.z() - water;
      volume += weight * depth;
      height_moment += weight * depth * depth / 2;
      area -= weight;
      first -= weight * middle.head<2>();
      second -= weight * middle.head<2>() * middle.head<2>().transpose();
    }
  }
};

// The part of a triangle below the water, as a fan of triangles.
void AddWet(const std::array<Eigen::Vector3d, 3>& corners, double water, Submerged& submerged) {
  std::array<Eigen::Vector3d, 4> wet;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d &from = corners[k], &to = corners[(k + 1) % 3];
    const double above = from.z() - water, next_above = to.z() - water;
    if (above <= 0) wet[count++] = from;
    if ((above < 0 && next_above > 0) || (above > 0 && next_above < 0)) {
      wet[count++] = from + (to - from) * (above / (above - next_above));
    }
  }
  for (std::size_t k = 2; k < count; ++k) submerged.Add(wet[0], wet[k - 1], wet[k], water);
}

// Below the water, in coordinates about `middle`, whose z is kept.
Submerged Submerge(std::span<const SurfaceMesh> solids, double water,
                   const Eigen::Vector2d& middle) {
  Submerged submerged;
  const Eigen::Vector3d shift(middle.x(), middle.y(), 0);
  for (const SurfaceMesh& solid : solids) {
    for (const auto& triangle : solid.triangles.colwise()) {
      AddWet({solid.vertices.col(triangle[0]) - shift, solid.vertices.col(triangle[1]) - shift,
              solid.vertices.col(triangle[2]) - shift},
             water, submerged);
    }
  }
  return submerged;
}

// The least second moment of the water plane about a level axis through its centre, m⁴.
double LeastSecondMoment(const Submerged& submerged) {
  if (!(submerged.area > 0)) return 0;
  const Eigen::Matrix2d central =
      submerged.second - submerged.first * submerged.first.transpose() / submerged.area;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(central).eigenvalues().minCoeff();
}

}  // namespace

absl::StatusOr<Floating> FloatUpright(std::span<const SurfaceMesh> solids, double mass,
                                      const Eigen::Vector3d& center_of_mass, double water_density) {
  Eigen::AlignedBox3d box;
  for (const SurfaceMesh& solid : solids) {
    for (const auto& vertex : solid.vertices.colwise()) box.extend(vertex.eval());
  }
  if (box.isEmpty()) return PreconditionFailed("SINKS", "there is nothing that could float");
  const double low = box.min().z(), high = box.max().z();
  const Eigen::Vector2d middle = box.center().head<2>();
  Floating floating;
  floating.displaced_volume = mass / water_density;
  const double whole = Submerge(solids, high, middle).volume;
  if (!(floating.displaced_volume < whole)) {
    return PreconditionFailed(
        "SINKS",
        absl::StrFormat("it has a mass of %.4g kg, and all of it displaces only %.4g kg of "
                        "water: it sinks",
                        mass, whole * water_density));
  }
  std::uintmax_t trials = kTrials;
  const auto bracket = boost::math::tools::toms748_solve(
      [&](double water) {
        return Submerge(solids, water, middle).volume - floating.displaced_volume;
      },
      low, high, -floating.displaced_volume, whole - floating.displaced_volume,
      [&](double a, double b) { return std::abs(b - a) <= kTolerance * (high - low); }, trials);
  const double water = (bracket.first + bracket.second) / 2;
  floating.draught = water - low;
  floating.freeboard = high - water;
  const Submerged submerged = Submerge(solids, water, middle);
  const double buoyancy_height = water + submerged.height_moment / submerged.volume;
  floating.metacentric_height =
      buoyancy_height + LeastSecondMoment(submerged) / submerged.volume - center_of_mass.z();
  return floating;
}

}  // namespace mortise::mesh
