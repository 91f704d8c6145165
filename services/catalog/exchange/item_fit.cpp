#include "services/catalog/exchange/item_fit.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"

namespace mortise::catalog {
namespace {

v1::Axis ToAxis(int axis) { return axis == 0 ? v1::X : axis == 1 ? v1::Y : v1::Z; }

// The size that the item has where the box has `drawn`.
double Nearest(const parametric::ItemDimension& dimension, double drawn) {
  if (dimension.process == parametric::Process::kNone) return dimension.size;
  return std::clamp(drawn, dimension.minimum, dimension.maximum);
}

}  // namespace

std::optional<ItemFit> FindFit(const parametric::Item& item, const Eigen::Vector3d& box,
                               v1::Axis length_axis, v1::Axis thickness_axis, double tolerance) {
  std::optional<ItemFit> best;
  std::tuple<double, double> best_order;
  for (int length = 0; length < 3; ++length) {
    for (int thickness = 0; thickness < 3; ++thickness) {
      if (thickness == length) continue;
      ItemFit fit{ToAxis(length), ToAxis(thickness), box};
      if (length_axis != v1::AXIS_UNSPECIFIED && fit.length_axis != length_axis) continue;
      if (thickness_axis != v1::AXIS_UNSPECIFIED && fit.thickness_axis != thickness_axis) continue;
      const int axes[] = {length, 3 - length - thickness, thickness};
      for (std::size_t i = 0; i < 3; ++i) {
        fit.size[axes[i]] = Nearest(item.dimensions[i], box[axes[i]]);
      }
      if ((fit.size - box).cwiseAbs().maxCoeff() > tolerance) continue;
      const std::tuple<double, double> order(-box[length], box[thickness]);
      if (best && best_order <= order) continue;
      best = fit;
      best_order = order;
    }
  }
  return best;
}

std::string DescribeMisfit(const Eigen::Vector3d& box, const parametric::Item& item) {
  std::vector<double> lengths(box.begin(), box.end());
  for (const parametric::ItemDimension& dimension : item.dimensions) {
    const bool fixed = dimension.process == parametric::Process::kNone;
    lengths.push_back(fixed ? dimension.size : dimension.minimum);
    lengths.push_back(fixed ? dimension.size : dimension.maximum);
  }
  const std::vector<std::string> texts = ComparedMillimetres(lengths);
  std::string sizes;
  for (std::size_t i = 0; i < 3; ++i) {
    const bool fixed = item.dimensions[i].process == parametric::Process::kNone;
    absl::StrAppend(&sizes, i == 0 ? "" : " × ", texts[3 + 2 * i],
                    fixed ? "" : absl::StrCat(" to ", texts[4 + 2 * i]));
  }
  return absl::StrCat("measures ", texts[0], " × ", texts[1], " × ", texts[2], " mm, in which '",
                      item.name, "' (", sizes, " mm) does not fit");
}

}  // namespace mortise::catalog
