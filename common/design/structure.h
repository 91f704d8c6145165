// The structure of a design: what of it is there, counted or chosen rather than measured. Designs
// of one template with the same structure differ in lengths alone, so that what was said of a part,
// a face or a vertex of one can be said of the other.
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

// Says what a choice is.
struct StructureChoice {
  std::string parameter;
  std::string value;  // name of it

  friend bool operator==(const StructureChoice&, const StructureChoice&) = default;
};

// Says what a part is made of that can be of several items.
struct StructureItem {
  std::string part;  // of the template
  std::string item;  // items/{id}

  friend bool operator==(const StructureItem&, const StructureItem&) = default;
};

// Lists have the order of the template, whatever its parameters are. There are no counts where
// nothing of it is counted, and so on. Structures of different templates say nothing of each other.
struct Structure {
  std::vector<StructureCount> counts;
  std::vector<StructureChoice> choices = {};
  std::vector<std::string> absent_parts = {};
  std::vector<std::string> absent_conditions = {};  // boundary conditions
  std::vector<std::string> absent_features = {};    // of a list of features
  std::vector<StructureItem> items = {};            // of parts that are there

  friend bool operator==(const Structure&, const Structure&) = default;
};

// Returns what tells structures of one template apart in records and caches: SHA-256, the same for
// the same structure on any machine.
std::string KeyOf(const Structure& structure);

// Says the structure for people: "armrests = none, without arm, shelf 1: 6, screw left 1: 2 × 6";
// "always the same" where nothing differs.
std::string Describe(const Structure& structure);

}  // namespace mortise::parametric
