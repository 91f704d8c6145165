// The structure of a design: what of it is counted rather than measured. Designs of one template
// with the same structure differ in lengths alone, so that what was said of a part, a face or a
// vertex of one can be said of the other.
#pragma once

#include <string>
#include <vector>

namespace mortise::parametric {

// Says how many there are of what repeats.
struct StructureCount {
  std::string name;          // of what repeats: an element, a feature, a polygon's corners
  std::vector<int> numbers;  // along each of its directions, one or two

  friend bool operator==(const StructureCount&, const StructureCount&) = default;
};

// The counts have the order of the template, whatever its parameters are; there are none where
// nothing of it is counted. Structures of different templates say nothing of each other.
struct Structure {
  std::vector<StructureCount> counts;

  friend bool operator==(const Structure&, const Structure&) = default;
};

// Returns what tells structures of one template apart in records and caches: SHA-256, the same for
// the same structure on any machine.
std::string KeyOf(const Structure& structure);

// Says the structure for people: "shelf 1: 6, screw left 1: 2 × 6"; "always the same" where nothing
// is counted.
std::string Describe(const Structure& structure);

}  // namespace mortise::parametric
