// Finds the motions of rows, grids and rings.
#include "common/templates/features/pattern_placements.h"

#include <cmath>
#include <gp_Ax1.hxx>
#include <gp_Dir.hxx>
#include <gp_Vec.hxx>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/templates/features/sketch_faces.h"

namespace mortise::cad {
namespace {

constexpr double kMinStep = 1e-3;   // mm
constexpr double kMinAngle = 1e-6;  // rad

}  // namespace

absl::StatusOr<std::vector<gp_Trsf>> PlacementsOf(const LinearPattern& pattern,
                                                  const Numbers& numbers) {
  const int count = static_cast<int>(numbers(pattern.count));
  const int rows =
      pattern.second_count.empty() ? 1 : static_cast<int>(numbers(pattern.second_count));
  const gp_Vec step(gp_Pnt(), KernelPoint(numbers(pattern.step)));
  const gp_Vec second(gp_Pnt(), KernelPoint(numbers(pattern.second_step)));
  if (count > 1 && step.Magnitude() < kMinStep) {
    return InvalidField("linear_pattern.step", "has no length");
  }
  if (rows > 1 && second.Magnitude() < kMinStep) {
    return InvalidField("linear_pattern.second_step", "has no length");
  }
  if (count * rows > kMaxInstances) {
    return InvalidField("linear_pattern.count",
                        absl::StrCat("makes more than ", kMaxInstances, " instances"));
  }
  std::vector<gp_Trsf> placements;
  for (int k = 1; k < count * rows; ++k) {
    gp_Trsf placement;
    placement.SetTranslation(step * (k % count) + second * (k / count));
    placements.push_back(placement);
  }
  return placements;
}

absl::StatusOr<std::vector<gp_Trsf>> PlacementsOf(const CircularPattern& pattern,
                                                  const Numbers& numbers) {
  const int count = static_cast<int>(numbers(pattern.count));
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  if (pattern.axis_direction) axis = numbers(*pattern.axis_direction);
  if (axis.norm() < 1e-9) {
    return InvalidField("circular_pattern.axis_direction", "has no length");
  }
  const double angle =
      pattern.angle.empty() ? 2 * std::numbers::pi / count : numbers(pattern.angle);
  if (count > 1 && std::abs(angle) < kMinAngle) {
    return InvalidField("circular_pattern.angle", "is 0");
  }
  const gp_Ax1 around(KernelPoint(numbers(pattern.axis_point)),
                      gp_Dir(axis.x(), axis.y(), axis.z()));
  std::vector<gp_Trsf> placements;
  for (int k = 1; k < count; ++k) {
    gp_Trsf placement;
    placement.SetRotation(around, k * angle);
    placements.push_back(placement);
  }
  return placements;
}

}  // namespace mortise::cad
