// Compares connections by what they connect, and how that lies to each other, so that a few of a
// collection can be tried for two parts (thesis §5.6.1).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "services/composer/connecting/part_connection.h"
#include "services/composer/model/placed_forms.h"

namespace mortise::composer {

// Two parts as a connection sees them.
struct PairDescriptor {
  std::array<Eigen::Vector3d, 2> sizes;         // m
  std::array<std::array<bool, 3>, 2> is_fixed;  // sizes that the items leave no choice
  // m, by axis: of the second part's lower and upper face each, from the first's lower and upper.
  std::array<Eigen::Vector4d, 3> planes;
};

PairDescriptor DescriptorOf(const PrincipalPart& first, const PrincipalPart& second);

// Of a connection with two principals as drawn; exchanged: with its second first.
PairDescriptor DescriptorOf(const parametric::ElementConnection& connection, bool exchanged);

// Returns how far apart two are, m: the root of the sum of the squares of all differences. Those of
// sizes that are fixed in one of the two count `fixed_size_weight` times.
double DistanceOf(const PairDescriptor& a, const PairDescriptor& b, double fixed_size_weight);

// A connection of a collection that may be used for a pair.
struct RankedConnection {
  const CollectionConnection* connection = nullptr;
  bool exchanged = false;  // its second principal stands for the first part
  double distance = 0;     // m, of the descriptors
};

// Whether two items may be exchanged for each other as principals.
using SameMaterial = std::function<bool(const std::string& item, const std::string& other)>;

// Returns up to `count` connections for two parts, nearest first: those with two principals of
// their materials and with connecting parts. Of connections that look the same the first stands for
// all. O(connections).
std::vector<RankedConnection> NearestConnections(
    const PrincipalPart& first, const PrincipalPart& second,
    const std::vector<const CollectionConnection*>& connections, const SameMaterial& same_material,
    double fixed_size_weight, int count);

}  // namespace mortise::composer
