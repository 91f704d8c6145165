#include "services/composer/connecting/merge.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "common/base/errors.h"
#include "services/composer/connecting/motions.h"
#include "services/composer/model/names.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::AssemblyPart;
using parametric::ElementConnection;
using parametric::Joint;

class Merger {
 public:
  Merger(const BothSides& sides, const std::vector<UsedConnection>& used)
      : sides_(sides), used_(used) {}

  absl::StatusOr<Merged> Merge(const std::string& component_id) {
    MORTISE_ASSIGN_OR_RETURN(Redrawn body, Redraw(sides_.body));
    MORTISE_ASSIGN_OR_RETURN(const Redrawn component, Redraw(sides_.component));
    AddBody(std::move(body));
    names_ = NamesInModel(made_.assembly, component.assembly, component_id);
    AddComponent(component);
    for (const AssemblyPart& part : made_.assembly.parts) taken_.insert(part.name);
    for (const Joint& joint : made_.assembly.joints) joints_taken_.insert(joint.name);
    for (const UsedConnection& connection : used_) AddConnection(connection);
    made_.component_names = std::move(names_.parts);
    return std::move(made_);
  }

 private:
  Assembly& assembly() { return made_.assembly; }

  void AddBody(Redrawn body) {
    for (std::size_t i = 0; i < body.assembly.parts.size(); ++i) {
      made_.parts.push_back({Provenance::From::kBody, "", body.drawn_as[i]});
    }
    for (const Joint& joint : body.assembly.joints) {
      made_.joints.push_back({Provenance::From::kBody, "", joint.name});
    }
    made_.assembly = std::move(body.assembly);
  }

  // The lowest group of the body that contains all parts of it that are connected.
  int GroupAbove() {
    std::optional<int> above;
    for (const UsedConnection& connection : used_) {
      for (const BoundPrincipal& bound : connection.candidate.principals) {
        if (bound.of_component) continue;
        const int group = GroupOf(sides_.PartOf(bound).name);
        above = above ? parametric::LowestCommonGroup(assembly(), *above, group) : group;
      }
    }
    return above.value_or(0);
  }

  int GroupOf(const std::string& part) {
    const auto found = std::find_if(assembly().parts.begin(), assembly().parts.end(),
                                    [&](const AssemblyPart& one) { return one.name == part; });
    return found == assembly().parts.end() ? 0 : found->group;
  }

  void AddComponent(const Redrawn& component) {
    const int above = GroupAbove();
    root_ = static_cast<int>(assembly().groups.size());
    made_.insert_below = assembly().groups[static_cast<std::size_t>(above)].name;
    made_.group = names_.root;
    assembly().groups.push_back({names_.root, above});
    for (std::size_t i = 1; i < component.assembly.groups.size(); ++i) {
      const parametric::AssemblyGroup& group = component.assembly.groups[i];
      assembly().groups.push_back({names_.groups.at(group.name), root_ + group.parent});
    }
    for (std::size_t i = 0; i < component.assembly.parts.size(); ++i) {
      AssemblyPart& part = assembly().parts.emplace_back(component.assembly.parts[i]);
      part.name = names_.parts.at(part.name);
      part.group += root_;
      made_.parts.push_back({Provenance::From::kComponent, "", component.drawn_as[i]});
    }
    for (const Joint& joint : component.assembly.joints) {
      Joint& made = assembly().joints.emplace_back(joint);
      made.name = names_.joints.at(joint.name);
      made.group += root_;
      made_.joints.push_back({Provenance::From::kComponent, "", joint.name});
    }
  }

  std::string NameOf(const BoundPrincipal& bound) const {
    const std::string& name = sides_.PartOf(bound).name;
    return bound.of_component ? names_.parts.at(name) : name;
  }

  void AddConnection(const UsedConnection& used) {
    const CollectionConnection& from = *used.candidate.from;
    const ElementConnection& connection = from.connection;
    MadeConnection& made = made_.connections.emplace_back();
    made.source = from.source;
    made.as = connection.name;
    made.moved_by = used.moved_by;
    std::optional<int> group;
    for (const BoundPrincipal& bound : used.candidate.principals) {
      made.principals.push_back(NameOf(bound));
      const int its = GroupOf(made.principals.back());
      group = group ? parametric::LowestCommonGroup(assembly(), *group, its) : its;
    }
    std::map<int, std::size_t> seen;  // parts of each element so far
    for (const parametric::PlacedPart& placed : used.placed.parts) {
      const parametric::Element& element =
          connection.elements[static_cast<std::size_t>(placed.element)];
      const std::size_t index = seen[placed.element]++;
      const AssemblyPart& drawn = connection.assembly.parts[static_cast<std::size_t>(
          index < element.parts.size() ? element.parts[index] : element.parts.front())];
      AssemblyPart& part = assembly().parts.emplace_back(drawn);
      part.name = TakeName(placed.name, taken_);
      part.box = placed.box;
      part.group = GroupOfConnecting(connection, drawn, *group);
      for (parametric::ProminentPlane& plane : part.prominent_planes) {
        const auto axis = static_cast<Eigen::Index>(plane.axis);
        const double share = (plane.position - drawn.box.center()[axis]) / drawn.box.size()[axis];
        plane.position = part.box.center()[axis] + share * part.box.size()[axis];
      }
      made.parts.push_back(part.name);
      made_.parts.push_back({Provenance::From::kConnection, from.source, drawn.name});
    }
    if (used.with_joint) AddJoints(used);
  }

  // Connecting parts that a joint of the connection moves with the component go on moving with it.
  int GroupOfConnecting(const ElementConnection& connection, const AssemblyPart& drawn,
                        int common) const {
    for (const Joint& joint : connection.assembly.joints) {
      if (parametric::IsWithin(connection.assembly, drawn.group, joint.group)) return root_;
    }
    return common;
  }

  void AddJoints(const UsedConnection& used) {
    const std::optional<int> moving = JointOfComponent(used.candidate);
    if (!moving || has_joint_) return;
    has_joint_ = true;  // a group has one: both slides of a drawer tell of the same
    const Joint& made =
        assembly().joints.emplace_back(JointWhere(used.candidate, used.placed, *moving));
    made_.joints.push_back({Provenance::From::kConnection, used.candidate.from->source, made.name});
    assembly().joints.back().name = TakeName(made.name, joints_taken_);
    assembly().joints.back().group = root_;
  }

  const BothSides& sides_;
  const std::vector<UsedConnection>& used_;
  Merged made_;
  ComponentNames names_;
  int root_ = 0;  // the group that the component's root becomes
  bool has_joint_ = false;
  std::set<std::string> taken_, joints_taken_;
};

}  // namespace

absl::StatusOr<Merged> Merge(const BothSides& sides, const std::string& component_id,
                             const std::vector<UsedConnection>& used) {
  return Merger(sides, used).Merge(component_id);
}

}  // namespace mortise::composer
