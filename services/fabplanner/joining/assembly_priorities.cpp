#include "services/fabplanner/joining/assembly_priorities.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::fabplanner {
namespace {

absl::Status Contradiction(const std::string& message, const std::string& part) {
  return PreconditionFailed("PRIORITIES_CONTRADICT", message, part);
}

}  // namespace

AssemblyPriorities::AssemblyPriorities(const Design& design, const Joints& joints)
    : design_(design), joints_(joints) {
  for (const Part& part : design.parts) any_ = any_ || part.priority > 0;
  for (const Fixing& fixing : joints.fixings) {
    PriorityTag tag;
    for (int connector : fixing.connectors) {
      const int priority = design.parts[connector].priority;
      if (tag.priority == 0 && priority > 0) tag = {priority, connector};
    }
    fixings_.push_back(tag);
  }
}

std::vector<PriorityTag> AssemblyPriorities::OfUnits(const std::vector<AssemblyUnit>& units) const {
  std::vector<PriorityTag> tags(units.size());
  if (!any_) return tags;
  const std::vector<int> unit_of = UnitOfParts(design_, units);
  for (std::size_t i = 0; i < units.size(); ++i) {
    const int first = units[i].parts.front();
    const int priority = design_.parts[first].priority;
    if (units[i].built.empty() && priority > 0) tags[i] = {priority, first};
  }
  const std::vector<PriorityTag> own = tags;
  for (std::size_t i = 0; i < fixings_.size(); ++i) {
    if (fixings_[i].priority == 0) continue;
    std::set<int> joined;
    for (int part : joints_.fixings[i].principals) joined.insert(unit_of[part]);
    if (joined.size() < 2 || joined.contains(-1)) continue;
    for (int unit : joined) {
      if (own[unit].priority > 0) continue;
      if (tags[unit].priority == 0 || fixings_[i].priority < tags[unit].priority) {
        tags[unit] = fixings_[i];
      }
    }
  }
  return tags;
}

ConnectionPriorities AssemblyPriorities::BetweenUnits(
    const std::vector<AssemblyUnit>& units) const {
  if (!any_) return {};
  const std::vector<int> unit_of = UnitOfParts(design_, units);
  ConnectionPriorities between(units.size(), std::vector<int>(units.size(), 0));
  for (std::size_t i = 0; i < fixings_.size(); ++i) {
    if (fixings_[i].priority == 0) continue;
    std::set<int> joined;
    for (int part : joints_.fixings[i].principals) joined.insert(unit_of[part]);
    joined.erase(-1);
    for (int a : joined) {
      for (int b : joined) {
        int& lowest = between[a][b];
        if (a != b && (lowest == 0 || fixings_[i].priority < lowest)) {
          lowest = fixings_[i].priority;
        }
      }
    }
  }
  return between;
}

absl::Status AssemblyPriorities::Check() const {
  for (std::size_t i = 0; i < fixings_.size(); ++i) {
    const PriorityTag& tag = fixings_[i];
    if (tag.priority == 0) continue;
    const Part& first = design_.parts[tag.part];
    for (int connector : joints_.fixings[i].connectors) {
      const Part& other = design_.parts[connector];
      if (other.priority == 0 || other.priority == tag.priority) continue;
      return Contradiction(
          absl::StrCat("'", first.name, "' (", first.priority, ") and '", other.name, "' (",
                       other.priority,
                       ") touch, so they are one connection: give them one priority"),
          other.name);
    }
    for (int principal : joints_.fixings[i].principals) {
      const Part& part = design_.parts[principal];
      if (part.priority <= tag.priority) continue;
      return Contradiction(
          absl::StrCat("'", part.name, "' (", part.priority, ") comes in after '", first.name,
                       "' (", tag.priority, "), which holds it: give '", first.name, "' ",
                       part.priority, " or more, or '", part.name, "' ", tag.priority, " or less"),
          part.name);
    }
  }
  return absl::OkStatus();
}

absl::Status AssemblyPriorities::CheckBuilt(const std::vector<int>& parts, const std::string& name,
                                            const PriorityTag& joined) const {
  if (joined.priority == 0) return absl::OkStatus();
  for (int part : parts) {
    const Part& within = design_.parts[part];
    if (within.priority <= joined.priority) continue;
    return Contradiction(
        absl::StrCat("'", within.name, "' (", within.priority, ") is within the ", name,
                     ", which is built before '", design_.parts[joined.part].name, "' (",
                     joined.priority, ") joins it to the rest: give '",
                     design_.parts[joined.part].name, "' ", within.priority, " or more, or '",
                     within.name, "' ", joined.priority, " or less"),
        within.name);
  }
  return absl::OkStatus();
}

absl::Status AssemblyPriorities::Conflict(const PriorityTag& late,
                                          const std::vector<int>& late_parts,
                                          const PriorityTag& early,
                                          const std::vector<int>& early_parts) const {
  const std::string& late_name = design_.parts[late.part].name;
  const std::string& early_name = design_.parts[early.part].name;
  return Contradiction(
      absl::StrCat(Told(late, late_parts), " cannot come in after ", Told(early, early_parts),
                   ", which closes its way: give '", early_name, "' ", late.priority,
                   " or more, or '", late_name, "' ", early.priority, " or less"),
      late_name);
}

absl::Status AssemblyPriorities::PegConflict(int fixing, int due) const {
  const PriorityTag& tag = fixings_[fixing];
  const std::string& name = design_.parts[tag.part].name;
  return Contradiction(
      absl::StrCat("'", name, "' (", tag.priority,
                   ") is a peg, which goes in with the parts that it joins, while a part of "
                   "priority ",
                   due, " is still to come: give '", name, "' ", due, " or less"),
      name);
}

std::string AssemblyPriorities::Told(const PriorityTag& tag, const std::vector<int>& parts) const {
  const std::string& tagged = design_.parts[tag.part].name;
  if (std::find(parts.begin(), parts.end(), tag.part) != parts.end()) {
    return absl::StrCat("'", tagged, "' (", tag.priority, ")");
  }
  return absl::StrCat("'", design_.parts[parts.front()].name, "' (", tag.priority, ", by '", tagged,
                      "')");
}

}  // namespace mortise::fabplanner
