#include "common/assembly/codec/group_reader.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace mortise::parametric {
namespace {

constexpr int kMaxGroups = 1000;

}  // namespace

void GroupReader::Read(AssemblyDrawing& drawing) {
  if (message_.groups_size() > kMaxGroups) {
    findings_.push_back({"groups", absl::StrCat("are more than ", kMaxGroups)});
  }
  drawing.assembly.groups = {{message_.name(), -1}};
  const int count = std::min(message_.groups_size(), kMaxGroups);
  for (int i = 0; i < count; ++i) {
    const v1::AssemblyGroup& group = message_.groups(i);
    const std::string field = absl::StrCat("groups[", i, "]");
    CheckAssemblyName(field + ".name", group.name(), findings_);
    if (!names_.insert(group.name()).second) {
      findings_.push_back({field + ".name", absl::StrCat("'", group.name(), "' occurs twice")});
    }
    children_[group.parent()].push_back(i);
  }
  AddChildren("", 0, drawing);
  for (int i = 0; i < count; ++i) CheckReached(i);
  index_[""] = 0;
}

int GroupReader::Find(const std::string& name, const std::string& field) const {
  const auto found = index_.find(name);
  if (found != index_.end()) return found->second;
  if (!names_.contains(name)) {
    findings_.push_back({field, absl::StrCat("there is no group '", name, "'")});
  }
  return -1;
}

void GroupReader::AddChildren(const std::string& parent, int parent_index,
                              AssemblyDrawing& drawing) {
  const auto children = children_.find(parent);
  if (children == children_.end()) return;
  for (const int i : children->second) {
    const std::string& name = message_.groups(i).name();
    // A name given twice is a finding already; an empty one would be the root.
    if (name.empty() || index_.contains(name)) continue;
    const int index = static_cast<int>(drawing.assembly.groups.size());
    index_[name] = index;
    drawing.assembly.groups.push_back({name, parent_index});
    drawing.group_messages.push_back(i);
    AddChildren(name, index, drawing);
  }
}

void GroupReader::CheckReached(int i) {
  const v1::AssemblyGroup& group = message_.groups(i);
  if (group.name().empty() || index_.contains(group.name())) return;
  findings_.push_back({absl::StrCat("groups[", i, "].parent"),
                       names_.contains(group.parent())
                           ? "the hierarchy goes in a circle, or hangs on one that does"
                           : absl::StrCat("there is no group '", group.parent(), "'")});
}

}  // namespace mortise::parametric
