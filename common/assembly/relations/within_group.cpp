// What of a feasible set belongs to a group.
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/feasible_set.h"

namespace mortise::parametric {

std::vector<Relationship> RelationshipsWithin(const Assembly& assembly,
                                              const std::vector<Relationship>& relationships,
                                              int group) {
  std::vector<Relationship> within;
  for (const Relationship& relationship : relationships) {
    if (IsWithin(assembly, relationship.group, group)) within.push_back(relationship);
  }
  return within;
}

std::vector<int> VariablesWithin(const Assembly& assembly, const std::vector<Element>& elements,
                                 int group) {
  std::vector<int> variables;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (!IsWithin(assembly, elements[e].group, group)) continue;
    for (int i = 0; i < 6; ++i) variables.push_back(6 * static_cast<int>(e) + i);
  }
  for (std::size_t j = 0; j < assembly.joints.size(); ++j) {
    const int home = assembly.groups[static_cast<std::size_t>(assembly.joints[j].group)].parent;
    if (!IsWithin(assembly, home, group)) continue;
    for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
      variables.push_back(JointVariable(elements.size(), static_cast<int>(j), axis));
    }
  }
  return variables;
}

}  // namespace mortise::parametric
