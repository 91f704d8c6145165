// Keeps the names of parts, groups and joints of a working model distinct.
#pragma once

#include <map>
#include <set>
#include <string>

#include "common/assembly/model/assembly.h"

namespace mortise::composer {

// What the parts, groups and joints of a component are called in a model. The component's root
// becomes the group `root`.
struct ComponentNames {
  std::string root;
  std::map<std::string, std::string> parts;   // by the names that they have in the component
  std::map<std::string, std::string> groups;  // without the root
  std::map<std::string, std::string> joints;
};

// Returns names that the model has not. They stay as they are if none of the component's parts,
// groups and joints is called as one of the model's (parts as parts, groups as groups, joints as
// joints). Otherwise all of them get the component's id before them, "shelf-2 side 1", so that rows
// stay rows by their names. The root is called as the id. What is taken even so is numbered:
// "shelf-2 (2)".
ComponentNames NamesInModel(const parametric::Assembly& model,
                            const parametric::Assembly& component, const std::string& id);

// Returns `wanted`, or "wanted (2)", "wanted (3)" … if it is taken; from then on that is taken.
std::string TakeName(const std::string& wanted, std::set<std::string>& taken);

}  // namespace mortise::composer
