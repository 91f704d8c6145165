// How an item lies in the box of a part that is drawn.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "common/design/template_definition.h"
#include "mortise/v1/types.pb.h"

namespace mortise::catalog {

struct ItemFit {
  v1::Axis length_axis = v1::X;  // of the design, along which the item's X lies
  v1::Axis thickness_axis = v1::Z;
  // m, along the design's axes: the box's, but the item's where that is fixed or limited.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
};

// Returns the way in which each size of `box`, m, along the design's axes misses the item's by
// `tolerance` at most; of several, the one with the length along the longest and the thickness
// along the shortest. Axes that are specified are kept to. Nothing if there is no way.
std::optional<ItemFit> FindFit(const parametric::Item& item, const Eigen::Vector3d& box,
                               v1::Axis length_axis, v1::Axis thickness_axis, double tolerance);

// "measures 38 × 89 × 700 mm, in which 'items/board-38x89' (40 to 4800 × 89 × 38 mm) does not fit",
// with digits in which lengths that differ read differently.
std::string DescribeMisfit(const Eigen::Vector3d& box, const parametric::Item& item);

}  // namespace mortise::catalog
