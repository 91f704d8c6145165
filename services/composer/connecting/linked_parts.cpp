#include "services/composer/connecting/linked_parts.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace mortise::composer {

using parametric::BoundingBox;

std::vector<LinkedPair> FindLinkedParts(const std::vector<PrincipalPart>& body,
                                        const std::vector<PrincipalPart>& component,
                                        double distance, double least) {
  std::vector<LinkedPair> linked;
  for (std::size_t w = 0; w < body.size(); ++w) {
    for (std::size_t a = 0; a < component.size(); ++a) {
      const BoundingBox& first = body[w].box;
      const BoundingBox& second = component[a].box;
      Eigen::Vector3d gaps =
          (first.minimum - second.maximum).cwiseMax(second.minimum - first.maximum);
      std::sort(gaps.begin(), gaps.end());
      if (gaps[2] > distance || gaps[1] >= -least) continue;
      linked.push_back({static_cast<int>(w), static_cast<int>(a), gaps[2]});
    }
  }
  std::sort(linked.begin(), linked.end(), [](const LinkedPair& a, const LinkedPair& b) {
    return std::tie(a.apart, a.body, a.component) < std::tie(b.apart, b.body, b.component);
  });
  return linked;
}

LinkedPair NearestParts(const std::vector<PrincipalPart>& body,
                        const std::vector<PrincipalPart>& component) {
  LinkedPair nearest{0, 0, std::numeric_limits<double>::infinity()};
  for (std::size_t w = 0; w < body.size(); ++w) {
    for (std::size_t a = 0; a < component.size(); ++a) {
      const double apart = DistanceBetween(body[w].box, component[a].box);
      if (apart < nearest.apart) nearest = {static_cast<int>(w), static_cast<int>(a), apart};
    }
  }
  return nearest;
}

}  // namespace mortise::composer
