#include "common/mesh/files/gmsh_groups.h"

#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::mesh {

absl::Status GmshGroups::Name(const GmshPhysicalGroup& physical, const std::string& name,
                              std::size_t place) {
  const auto [named, is_new] = names_.try_emplace(physical, name);
  if (!is_new && named->second != name) {
    return places_.Fault(place, absl::StrCat("the physical group ", physical.tag, " of dimension ",
                                             physical.dimension, " has a name already"));
  }
  if (is_new && !taken_.emplace(physical.dimension, name).second) {
    builder_.AddNote(absl::StrCat(places_.Where(place), ": the physical group ", physical.tag,
                                  " has the name of another of its dimension; they are one"));
  }
  return AddGroup(physical.dimension, name, place).status();
}

bool GmshGroups::AddEntity(const GmshEntity& entity, std::vector<std::int64_t> tags) {
  return tags_.try_emplace(entity, std::move(tags)).second;
}

absl::StatusOr<int> GmshGroups::AddGroup(int dimension, const std::string& name,
                                         std::size_t place) {
  if (dimension == 3) return builder_.AddElementGroup(name, place);
  return dimension == 2 ? builder_.AddFaceGroup(name, place) : builder_.AddNodeGroup(name, place);
}

bool GmshGroups::HasNames(int dimension) const {
  const auto first = names_.lower_bound({dimension, std::numeric_limits<std::int64_t>::lowest()});
  return first != names_.end() && first->first.dimension == dimension;
}

absl::StatusOr<int> GmshGroups::Of(const GmshPhysicalGroup& physical, std::size_t place) {
  const auto done = groups_.find(physical);
  if (done != groups_.end()) return done->second;
  const auto known = names_.find(physical);
  if (known == names_.end() && HasNames(physical.dimension)) nameless_.emplace(physical, place);
  const std::string name = known == names_.end() ? absl::StrCat(physical.tag) : known->second;
  MORTISE_ASSIGN_OR_RETURN(const int group, AddGroup(physical.dimension, name, place));
  groups_.emplace(physical, group);
  return group;
}

absl::StatusOr<const std::vector<int>*> GmshGroups::Of(const GmshEntity& entity,
                                                       std::size_t place) {
  const auto [found, is_new] = groups_of_.try_emplace(entity);
  if (!is_new) return &found->second;
  const auto tags = tags_.find(entity);
  if (tags == tags_.end() && has_entities_) {
    return places_.Fault(place,
                         absl::StrCat("elements are of entity ", entity.tag, " of dimension ",
                                      entity.dimension, ", which $Entities does not have"));
  }
  if (tags == tags_.end() && !names_.empty()) {
    return places_.Fault(place,
                         "these elements may be in groups of $PhysicalNames, but the file has no "
                         "$Entities, which says so; save it with $Entities, or as version 2.2");
  }
  if (tags == tags_.end()) {
    lacks_entities_ = true;
    return &found->second;
  }
  std::set<int> groups;  // two of one name are one
  for (const std::int64_t tag : tags->second) {
    MORTISE_ASSIGN_OR_RETURN(const int group, Of(GmshPhysicalGroup{entity.dimension, tag}, place));
    groups.insert(group);
  }
  found->second.assign(groups.begin(), groups.end());
  return &found->second;
}

void GmshGroups::AddNotes() {
  if (lacks_entities_) {
    builder_.AddNote("the file has no $Entities, which would say what physical groups there are");
  }
  if (!nameless_.empty()) {
    const auto& [physical, place] = *nameless_.begin();
    std::string note =
        absl::StrCat(places_.Where(place), ": the physical group ", physical.tag, " of dimension ",
                     physical.dimension, " has no name in $PhysicalNames");
    if (nameless_.size() > 1) absl::StrAppend(&note, ", and ", nameless_.size() - 1, " more");
    builder_.AddNote(std::move(note));
  }
  for (const auto& [dimension, count] : ungrouped_) {
    if (!HasNames(dimension)) continue;
    builder_.AddNote(absl::StrCat(count, count == 1 ? " element" : " elements", " of dimension ",
                                  dimension, count == 1 ? " is" : " are",
                                  " in no physical group, where others are"));
  }
}

}  // namespace mortise::mesh
