#include "services/composer/model/overlap.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/linear_design.h"

namespace mortise::composer {

using parametric::BoundingBox;

double CommonDepth(const BoundingBox& a, const BoundingBox& b) {
  return (a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum)).minCoeff();
}

std::string Millimetres(double metres) {
  return absl::StrCat(std::round(1e5 * metres) / 100, " mm");
}

SolidPart::SolidPart(std::string name, const BoundingBox& box,
                     std::shared_ptr<const mesh::DrawnShape> shape, mesh::BoxStretch stretch)
    : name_(std::move(name)), box_(box), shape_(std::move(shape)), stretch_(std::move(stretch)) {}

SolidPart::SolidPart(const parametric::AssemblyPart& part)
    : SolidPart(part.name, part.box, part.shape, mesh::BoxStretch(part.box.size())) {}

const mesh::ProbedSurface& SolidPart::Probed() const {
  if (!probed_) {
    probed_.emplace(shape_ == nullptr ? parametric::SurfaceOf(box_)
                                      : parametric::SurfaceIn(*shape_, box_.center(), stretch_));
  }
  return *probed_;
}

double SolidPart::DepthOf(const SolidPart& a, const SolidPart& b) {
  if (CommonDepth(a.box_, b.box_) <= kMaxOverlap) return 0;
  double depth =
      (a.box_.maximum - b.box_.minimum).cwiseMin(b.box_.maximum - a.box_.minimum).minCoeff();
  if (a.shape_ != nullptr || b.shape_ != nullptr) {
    depth = -mesh::ProbedSurface::Separation(a.Probed(), b.Probed(), 0);
    for (const SolidPart* part : {&a, &b}) {
      if (part->shape_ != nullptr) depth -= mesh::DeflectionIn(*part->shape_, part->stretch_);
    }
  }
  return depth > kMaxOverlap ? depth : 0;
}

std::vector<SolidPart> SolidsOf(const Design& design) {
  std::vector<SolidPart> solids;
  for (const parametric::PlacedPart& part : PartsOf(design)) {
    solids.emplace_back(part.name, part.box, design.assembly->ShapeOf(part), part.stretch);
  }
  return solids;
}

}  // namespace mortise::composer
