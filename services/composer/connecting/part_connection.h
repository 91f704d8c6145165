// Connections part by part, which is how they are carried over from one design to another (thesis
// §5.6.1): the screws of one shelf of a row, where the design's own connection is of the whole row.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/connections/connection.h"
#include "common/assembly/model/assembly.h"

namespace mortise::composer {

// A connection of a design that may be used in another. It refers to nothing outside itself.
struct CollectionConnection {
  std::string source;                        // the assembly that it is of: assemblies/{id}
  parametric::ElementConnection connection;  // each principal one part

  // Returns the names of its principal parts, in the order of the connection's elements.
  std::vector<std::string> Principals() const;
};

// Returns the connections of a valid assembly part by part: connecting parts that touch each other,
// directly or by others, with all principal parts that any of them touches, are one; those with the
// same principals together. Two principal parts that touch over an area, without anything that
// connects them, are a connection without connecting parts. Rows are rows of connecting parts only.
// Fails as FindTouchingParts. O(parts²); it is to be kept: an assembly of 200 parts takes some
// 50 ms.
absl::StatusOr<std::vector<CollectionConnection>> ConnectionsOf(
    const std::string& source, const parametric::Assembly& assembly);

// Returns what is left of a connection when it is to hold these of its principals only: the
// connections among them of the connecting parts that reach into none of the others, as screws do;
// what only lies against one stays. Fails as ConnectionsOf.
absl::StatusOr<std::vector<CollectionConnection>> ConnectionsAmong(
    const CollectionConnection& connection, const std::set<std::string>& principals);

}  // namespace mortise::composer
