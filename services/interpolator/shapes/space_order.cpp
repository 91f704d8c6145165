#include "services/interpolator/shapes/space_order.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace mortise::interpolator {
namespace {

constexpr int kBits = 21;  // of each coordinate, so that the place along the curve has 63

// Skilling's transform of axes, then the bits of the three numbers one after another.
std::uint64_t PlaceAlongCurve(std::array<std::uint32_t, 3> x) {
  constexpr std::uint32_t kHighest = std::uint32_t{1} << (kBits - 1);
  for (std::uint32_t bit = kHighest; bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (std::uint32_t& axis : x) {
      if ((axis & bit) != 0) {
        x[0] ^= below;
      } else {
        const std::uint32_t swapped = (x[0] ^ axis) & below;
        x[0] ^= swapped;
        axis ^= swapped;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t flipped = 0;
  for (std::uint32_t bit = kHighest; bit > 1; bit >>= 1) {
    if ((x[2] & bit) != 0) flipped ^= bit - 1;
  }
  for (std::uint32_t& axis : x) axis ^= flipped;
  std::uint64_t place = 0;
  for (int bit = kBits - 1; bit >= 0; --bit) {
    for (const std::uint32_t axis : x) place = place << 1 | (axis >> bit & 1);
  }
  return place;
}

}  // namespace

void SortInSpace(const Eigen::Matrix3Xd& points, std::vector<int>& indices) {
  if (points.cols() == 0) return;
  const Eigen::Vector3d lowest = points.rowwise().minCoeff();
  const double side = (points.rowwise().maxCoeff() - lowest).maxCoeff();
  const double scale = side > 0 ? ((1 << kBits) - 1) / side : 0;
  std::vector<std::pair<std::uint64_t, int>> order;
  order.reserve(indices.size());
  for (const int index : indices) {
    const Eigen::Vector3d steps = (points.col(index) - lowest) * scale;
    order.emplace_back(
        PlaceAlongCurve({static_cast<std::uint32_t>(steps[0]), static_cast<std::uint32_t>(steps[1]),
                         static_cast<std::uint32_t>(steps[2])}),
        index);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = order[i].second;
}

}  // namespace mortise::interpolator
