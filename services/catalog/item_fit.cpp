#include "services/catalog/item_fit.h"

#include <algorithm>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace mortise::catalog {
namespace {

std::string Millimetres(double metres) { return absl::StrFormat("%.6g", 1000 * metres); }

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

std::string SizeText(const Eigen::Vector3d& size) {
  return absl::StrCat(Millimetres(size.x()), " × ", Millimetres(size.y()), " × ",
                      Millimetres(size.z()), " mm");
}

std::string DescribeSizes(const parametric::Item& item) {
  std::string text = absl::StrCat("'", item.name, "' (");
  for (std::size_t i = 0; i < 3; ++i) {
    const parametric::ItemDimension& dimension = item.dimensions[i];
    absl::StrAppend(&text, i == 0 ? "" : " × ");
    if (dimension.process == parametric::Process::kNone) {
      absl::StrAppend(&text, Millimetres(dimension.size));
    } else {
      absl::StrAppend(&text, Millimetres(dimension.minimum), " to ",
                      Millimetres(dimension.maximum));
    }
  }
  return text + " mm)";
}

}  // namespace mortise::catalog
