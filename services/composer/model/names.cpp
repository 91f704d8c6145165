#include "services/composer/model/names.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace mortise::composer {
namespace {

template <typename Named>
std::set<std::string> NamesOf(const std::vector<Named>& named) {
  std::set<std::string> names;
  for (const Named& one : named) names.insert(one.name);
  return names;
}

template <typename Named>
bool AnyTaken(const std::vector<Named>& named, std::size_t first,
              const std::set<std::string>& taken) {
  for (std::size_t i = first; i < named.size(); ++i) {
    if (taken.contains(named[i].name)) return true;
  }
  return false;
}

template <typename Named>
std::map<std::string, std::string> Renamed(const std::vector<Named>& named, std::size_t first,
                                           const std::string& before,
                                           std::set<std::string>& taken) {
  std::map<std::string, std::string> names;
  for (std::size_t i = first; i < named.size(); ++i) {
    names[named[i].name] = TakeName(absl::StrCat(before, named[i].name), taken);
  }
  return names;
}

}  // namespace

std::string TakeName(const std::string& wanted, std::set<std::string>& taken) {
  if (taken.insert(wanted).second) return wanted;
  for (int number = 2;; ++number) {
    std::string name = absl::StrCat(wanted, " (", number, ")");
    if (taken.insert(name).second) return name;
  }
}

ComponentNames NamesInModel(const parametric::Assembly& model,
                            const parametric::Assembly& component, const std::string& id) {
  std::set<std::string> parts = NamesOf(model.parts);
  std::set<std::string> groups = NamesOf(model.groups);
  std::set<std::string> joints = NamesOf(model.joints);
  ComponentNames names;
  names.root = TakeName(id, groups);
  const bool clash = AnyTaken(component.parts, 0, parts) || AnyTaken(component.groups, 1, groups) ||
                     AnyTaken(component.joints, 0, joints);
  const std::string before = clash ? absl::StrCat(id, " ") : "";
  names.parts = Renamed(component.parts, 0, before, parts);
  names.groups = Renamed(component.groups, 1, before, groups);
  names.joints = Renamed(component.joints, 0, before, joints);
  return names;
}

}  // namespace mortise::composer
