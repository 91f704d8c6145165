#include "services/composer/connecting/connection_descriptor.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

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

PairDescriptor DescriptorOf(const parametric::ElementConnection& connection, int first,
                            int second) {
  const Element& a = connection.elements[static_cast<std::size_t>(first)];
  const Element& b = connection.elements[static_cast<std::size_t>(second)];
  return {
      {a.box.size(), b.box.size()}, {FixedSizes(a), FixedSizes(b)}, PlanesBetween(a.box, b.box)};
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

ConnectionIndex::ConnectionIndex(const std::vector<const CollectionConnection*>& connections,
                                 KindOfItem kind_of, ItemKindOf item_kind_of)
    : kind_of_(std::move(kind_of)), item_kind_of_(std::move(item_kind_of)) {
  std::vector<int> kinds;  // of the principals
  for (const CollectionConnection* candidate : connections) {
    const parametric::ElementConnection& connection = candidate->connection;
    const int principals = connection.principal_count();
    if (connection.connecting.empty()) continue;
    if (principals > 2 && connection.assembly.joints.empty()) continue;
    kinds.clear();
    for (int i = 0; i < principals; ++i) {
      const std::string& item = connection.elements[static_cast<std::size_t>(i)].item;
      const auto [known, is_new] = by_item_.try_emplace(item);
      if (is_new) known->second = NumberOf(item);
      kinds.push_back(known->second);
    }
    for (int i = 0; i < principals; ++i) {
      for (int j = 0; j < principals; ++j) {
        if (i == j) continue;
        by_kinds_[{kinds[static_cast<std::size_t>(i)], kinds[static_cast<std::size_t>(j)]}]
            .pairs.push_back({candidate, i, j});
      }
    }
  }
}

int ConnectionIndex::NumberOf(const std::string& item) {
  return numbers_.try_emplace(kind_of_(item), static_cast<int>(numbers_.size())).first->second;
}

const std::vector<ConnectionIndex::Entry>& ConnectionIndex::EntriesOf(OfKinds& of) {
  if (of.is_made) return of.entries;
  of.is_made = true;
  for (const Pair& pair : of.pairs) {
    const parametric::ElementConnection& connection = pair.connection->connection;
    AllowedMotion motion = AllowedMotionOf(connection, pair.first, pair.second, item_kind_of_);
    if (connection.principal_count() > 2 && motion.kinds.empty()) continue;
    of.entries.push_back(
        {pair, DescriptorOf(connection, pair.first, pair.second), std::move(motion)});
  }
  return of.entries;
}

std::vector<RankedConnection> ConnectionIndex::Nearest(const PrincipalPart& first,
                                                       const PrincipalPart& second,
                                                       const WantedMotion& motion,
                                                       double fixed_size_weight, int count) {
  const auto found = by_kinds_.find({NumberOf(first.item), NumberOf(second.item)});
  if (found == by_kinds_.end()) return {};
  const std::vector<Entry>& entries = EntriesOf(found->second);
  const PairDescriptor wanted = DescriptorOf(first, second);
  std::vector<std::pair<double, std::size_t>> ranked;  // by distance, then in order
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Entry& entry = entries[i];
    if (!Allows(entry.motion, motion)) continue;
    ranked.emplace_back(DistanceOf(wanted, entry.descriptor, fixed_size_weight), i);
  }
  // Few are taken of many: a heap need not be sorted whole.
  std::make_heap(ranked.begin(), ranked.end(), std::greater<>());
  std::vector<RankedConnection> nearest;
  while (!ranked.empty() && static_cast<int>(nearest.size()) < count) {
    std::pop_heap(ranked.begin(), ranked.end(), std::greater<>());
    const auto [distance, place] = ranked.back();
    ranked.pop_back();
    const Entry& entry = entries[place];
    const bool is_known = std::any_of(nearest.begin(), nearest.end(), [&](const auto& known) {
      return std::abs(known.distance - distance) <= kSame &&
             UseTheSameParts(*known.connection, *entry.pair.connection);
    });
    if (is_known) continue;
    nearest.push_back({entry.pair.connection, entry.pair.first, entry.pair.second, distance});
  }
  return nearest;
}

}  // namespace mortise::composer
