// Compares connections by what they connect, and how that lies to each other, so that a few of a
// collection can be tried for two parts (thesis §5.6.1).
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "services/composer/connecting/motions.h"
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

// Of two principals of a connection as drawn.
PairDescriptor DescriptorOf(const parametric::ElementConnection& connection, int first, int second);

// Returns how far apart two are, m: the root of the sum of the squares of all differences. Those of
// sizes that are fixed in one of the two count `fixed_size_weight` times.
double DistanceOf(const PairDescriptor& a, const PairDescriptor& b, double fixed_size_weight);

// A connection of a collection that may be used for a pair.
struct RankedConnection {
  const CollectionConnection* connection = nullptr;
  // The principals of it that stand for the two parts. There may be others: it is then used without
  // them (ConnectionsAmong), as the slides of a drawer without its front.
  int first = 0, second = 1;
  double distance = 0;  // m, of the descriptors
};

// Returns what an item may be exchanged for as a principal: any other that it returns the same for,
// such as those of one material.
using KindOfItem = std::function<std::string(const std::string& item)>;

// The connections of a collection that can be used for pairs: those with two principals and with
// connecting parts; and of those with more principals each two that a joint of theirs moves against
// each other. It is made once for all pairs of a component, so that each is only compared
// with connections of its own materials. Of one thread.
class ConnectionIndex {
 public:
  // The connections outlive it. `item_kind_of` tells what guides (guides.h). O(connections).
  ConnectionIndex(const std::vector<const CollectionConnection*>& connections, KindOfItem kind_of,
                  ItemKindOf item_kind_of = nullptr);

  // Returns up to `count` connections for two parts, nearest first: those whose principals are of
  // their kinds, and that let the second move against the first as wanted. Of connections that look
  // the same the first stands for all. O(connections of these kinds).
  std::vector<RankedConnection> Nearest(const PrincipalPart& first, const PrincipalPart& second,
                                        const WantedMotion& motion, double fixed_size_weight,
                                        int count);

 private:
  struct Pair {
    const CollectionConnection* connection = nullptr;
    int first = 0, second = 1;
  };
  struct Entry {
    Pair pair;
    PairDescriptor descriptor;
    AllowedMotion motion;
  };
  // What is between parts of two kinds. Most kinds of a collection are asked for by no component,
  // so that what is compared is only made of those that are.
  struct OfKinds {
    std::vector<Pair> pairs;
    std::vector<Entry> entries;
    bool is_made = false;
  };

  // The number of the kind of an item.
  int NumberOf(const std::string& item);
  const std::vector<Entry>& EntriesOf(OfKinds& of);

  KindOfItem kind_of_;
  ItemKindOf item_kind_of_;
  std::map<std::string, int> numbers_;                 // of kinds
  std::unordered_map<std::string_view, int> by_item_;  // of items of the connections
  std::map<std::pair<int, int>, OfKinds> by_kinds_;
};

}  // namespace mortise::composer
