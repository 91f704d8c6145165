// The physical groups of Gmsh's files; for gmsh_reader.cpp.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/files/grouped_mesh_builder.h"

namespace mortise::mesh {

struct GmshPhysicalGroup {
  int dimension;
  std::int64_t tag;
  friend auto operator<=>(const GmshPhysicalGroup&, const GmshPhysicalGroup&) = default;
};

// A piece of geometry in MSH 4.1. Its elements are in the physical groups of the entity.
struct GmshEntity {
  int dimension;
  std::int64_t tag;
  friend auto operator<=>(const GmshEntity&, const GmshEntity&) = default;
};

// Every physical group is a group of the builder's, called by its name, or else by its number.
// Failures are INVALID_ARGUMENT naming "mesh_file", with the place.
class GmshGroups {
 public:
  GmshGroups(const FilePlaces& places, GroupedMeshBuilder& builder)
      : places_(places), builder_(builder) {}

  absl::Status Name(const GmshPhysicalGroup& physical, const std::string& name, std::size_t place);

  // Notes that the file has a list of entities, and that elements must be of one of them.
  void BeginEntities() { has_entities_ = true; }

  // Adds an entity; returns false if there is one already.
  bool AddEntity(const GmshEntity& entity, std::vector<std::int64_t> tags);

  // Returns the builder's group for a physical group.
  absl::StatusOr<int> Of(const GmshPhysicalGroup& physical, std::size_t place);

  // Returns the builder's groups of an entity's elements, each once. They are kept, as many blocks
  // may be of one entity.
  absl::StatusOr<const std::vector<int>*> Of(const GmshEntity& entity, std::size_t place);

  // Counts an element of this dimension that is in no group.
  void CountUngrouped(int dimension) { ++ungrouped_[dimension]; }

  // Tells the builder of what may be a fault of the file. It is called once everything has been
  // read.
  void AddNotes();

 private:
  absl::StatusOr<int> AddGroup(int dimension, const std::string& name, std::size_t place);
  bool HasNames(int dimension) const;

  const FilePlaces& places_;
  GroupedMeshBuilder& builder_;
  bool has_entities_ = false;
  std::map<GmshPhysicalGroup, std::string> names_;
  std::set<std::pair<int, std::string>> taken_;  // names, by dimension
  std::map<GmshPhysicalGroup, int> groups_;
  std::map<GmshEntity, std::vector<std::int64_t>> tags_;
  std::map<GmshEntity, std::vector<int>> groups_of_;
  std::map<int, std::int64_t> ungrouped_;              // elements, by dimension
  std::map<GmshPhysicalGroup, std::size_t> nameless_;  // where others of the dimension have names
  bool lacks_entities_ = false;
};

}  // namespace mortise::mesh
