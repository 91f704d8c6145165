#include "common/cad/step/step_measure.h"

#include <cmath>

#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

// Share of the box's volume that a box may miss by.
constexpr double kBoxTolerance = 1e-6;
}  // namespace

SolidMeasurer::SolidMeasurer(const TopoDS_Shape& solid)
    : solid_(solid), volume_(std::abs(AccurateVolume(solid))) {}

const SolidBox& SolidMeasurer::TurnedBox(const Eigen::Matrix3d& rotation) {
  for (const auto& [known, box] : boxes_) {
    if (known == rotation) return box;
  }
  return boxes_.emplace_back(rotation, BoxOf(solid_, rotation)).second;
}

void SolidMeasurer::Measure(const Eigen::Isometry3d& placement, StepPart& part) {
  const SolidBox& turned = TurnedBox(placement.linear());
  part.volume = volume_;
  part.minimum = turned.minimum + placement.translation();
  part.maximum = turned.maximum + placement.translation();
  const double filled = (turned.maximum - turned.minimum).prod();
  part.is_box = std::abs(volume_ - filled) <= kBoxTolerance * filled;
}

}  // namespace mortise::cad
