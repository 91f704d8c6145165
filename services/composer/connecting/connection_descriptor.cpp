#include "services/composer/connecting/connection_descriptor.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::Element;

constexpr double kSame = 1e-6;  // m, of descriptors' distances; connections that look alike

std::array<Eigen::Vector4d, 3> PlanesBetween(const BoundingBox& first, const BoundingBox& second) {
  std::array<Eigen::Vector4d, 3> planes;
  for (int axis = 0; axis < 3; ++axis) {
    planes[static_cast<std::size_t>(axis)] << second.minimum[axis] - first.minimum[axis],
        second.minimum[axis] - first.maximum[axis], second.maximum[axis] - first.minimum[axis],
        second.maximum[axis] - first.maximum[axis];
  }
  return planes;
}

std::array<bool, 3> FixedSizes(const Element& element) {
  std::array<bool, 3> is_fixed;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    is_fixed[axis] = element.limits[axis].minimum == element.limits[axis].maximum;
  }
  return is_fixed;
}

// Whether two connections put the same parts between their principals.
bool UseTheSameParts(const CollectionConnection& a, const CollectionConnection& b) {
  const auto items = [](const CollectionConnection& of) {
    std::vector<std::string> names;
    for (std::size_t i = static_cast<std::size_t>(of.connection.principal_count());
         i < of.connection.elements.size(); ++i) {
      names.push_back(of.connection.elements[i].item);
    }
    std::sort(names.begin(), names.end());
    return names;
  };
  return items(a) == items(b);
}

}  // namespace

PairDescriptor DescriptorOf(const PrincipalPart& first, const PrincipalPart& second) {
  return {{first.box.size(), second.box.size()},
          {first.is_fixed, second.is_fixed},
          PlanesBetween(first.box, second.box)};
}

PairDescriptor DescriptorOf(const parametric::ElementConnection& connection, bool exchanged) {
  const Element& first = connection.elements[exchanged ? 1 : 0];
  const Element& second = connection.elements[exchanged ? 0 : 1];
  return {{first.box.size(), second.box.size()},
          {FixedSizes(first), FixedSizes(second)},
          PlanesBetween(first.box, second.box)};
}

double DistanceOf(const PairDescriptor& a, const PairDescriptor& b, double fixed_size_weight) {
  double squares = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t part = 0; part < 2; ++part) {
      const bool is_fixed = a.is_fixed[part][axis] || b.is_fixed[part][axis];
      const double difference = a.sizes[part][static_cast<Eigen::Index>(axis)] -
                                b.sizes[part][static_cast<Eigen::Index>(axis)];
      squares += std::pow((is_fixed ? fixed_size_weight : 1) * difference, 2);
    }
    squares += (a.planes[axis] - b.planes[axis]).squaredNorm();
  }
  return std::sqrt(squares);
}

std::vector<RankedConnection> NearestConnections(
    const PrincipalPart& first, const PrincipalPart& second,
    const std::vector<const CollectionConnection*>& connections, const SameMaterial& same_material,
    double fixed_size_weight, int count) {
  const PairDescriptor wanted = DescriptorOf(first, second);
  std::vector<RankedConnection> ranked;
  for (const CollectionConnection* candidate : connections) {
    const parametric::ElementConnection& connection = candidate->connection;
    if (connection.principal_count() != 2 || connection.connecting.empty()) continue;
    for (const bool exchanged : {false, true}) {
      if (!same_material(connection.elements[exchanged ? 1 : 0].item, first.item) ||
          !same_material(connection.elements[exchanged ? 0 : 1].item, second.item)) {
        continue;
      }
      const PairDescriptor its = DescriptorOf(connection, exchanged);
      ranked.push_back({candidate, exchanged, DistanceOf(wanted, its, fixed_size_weight)});
    }
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.distance < b.distance; });
  std::vector<RankedConnection> nearest;
  for (const RankedConnection& candidate : ranked) {
    if (static_cast<int>(nearest.size()) == count) break;
    const bool is_known = std::any_of(nearest.begin(), nearest.end(), [&](const auto& known) {
      return std::abs(known.distance - candidate.distance) <= kSame &&
             UseTheSameParts(*known.connection, *candidate.connection);
    });
    if (!is_known) nearest.push_back(candidate);
  }
  return nearest;
}

}  // namespace mortise::composer
