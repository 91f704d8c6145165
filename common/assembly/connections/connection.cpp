#include "common/assembly/connections/connection.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/assembly/connections/connection_relationships.h"
#include "common/assembly/model/rest_pose.h"

namespace mortise::parametric {
namespace {

class ConnectionSearch {
 public:
  ConnectionSearch(const Assembly& assembly, const std::vector<Element>& elements,
                   const Contacts& contacts, const std::vector<Relationship>& relationships,
                   double tolerance)
      : assembly_(assembly),
        elements_(elements),
        contacts_(contacts),
        relationships_(relationships),
        tolerance_(tolerance) {}

  std::vector<ElementConnection> Find() {
    GroupConnecting();
    AddDirectContacts();
    std::vector<ElementConnection> found;
    for (const auto& [principals, connecting] : connecting_of_) {
      found.push_back(Make(principals, connecting));
    }
    return found;
  }

 private:
  using Indices = std::vector<int>;

  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }

  // Connecting elements that touch each other, with the principals they touch.
  void GroupConnecting() {
    Indices parent(elements_.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int element) {
      while (parent[static_cast<std::size_t>(element)] != element) {
        element = parent[static_cast<std::size_t>(element)];
      }
      return element;
    };
    for (const auto& [a, b] : contacts_) {
      if (!At(a).connecting || !At(b).connecting) continue;
      const auto [low, high] = std::minmax({root(a), root(b)});
      parent[static_cast<std::size_t>(high)] = low;
    }
    std::map<int, std::set<int>> principals;
    for (const auto& [a, b] : contacts_) {
      if (At(a).connecting && !At(b).connecting) principals[root(a)].insert(b);
      if (At(b).connecting && !At(a).connecting) principals[root(b)].insert(a);
    }
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      if (!elements_[e].connecting) continue;
      const auto touched = principals.find(root(static_cast<int>(e)));
      if (touched == principals.end()) continue;
      connecting_of_[Indices(touched->second.begin(), touched->second.end())].push_back(
          static_cast<int>(e));
    }
  }

  void AddDirectContacts() {
    std::set<std::pair<int, int>> connected;
    for (const auto& [principals, connecting] : connecting_of_) {
      for (const int a : principals) {
        for (const int b : principals) connected.emplace(a, b);
      }
    }
    for (const auto& [a, b] : contacts_) {
      if (At(a).connecting || At(b).connecting || connected.contains({a, b})) continue;
      const ConnectionPatch patch =
          FindPatch(At(a), At(a).box, At(b), At(b).box, tolerance_, tolerance_);
      if (patch.kind == PatchKind::kContact) connecting_of_[{a, b}] = {};
    }
  }

  ElementConnection Make(const Indices& principals, const Indices& connecting) const {
    ElementConnection made;
    made.principals = principals;
    made.connecting = connecting;
    made.tolerance = tolerance_;
    made.group = At(principals.front()).group;
    std::vector<std::string> names;
    for (const int principal : principals) {
      made.group = LowestCommonGroup(assembly_, made.group, At(principal).group);
      names.push_back(absl::StrCat("'", At(principal).name, "'"));
    }
    made.name = absl::StrJoin(names, " with ");
    made.assembly.name = made.name;
    made.assembly.groups = assembly_.groups;
    for (const int principal : principals) AddElement(principal, made);
    for (const int element : connecting) AddElement(element, made);
    for (std::size_t joint = 0; joint < assembly_.joints.size(); ++joint) {
      if (!MovesSome(assembly_.joints[joint], made)) continue;
      made.joints.push_back(static_cast<int>(joint));
      made.assembly.joints.push_back(assembly_.joints[joint]);
    }
    AddPatches(made);
    RelateConnection(ContactsOf(made), JointTies(made), made);
    return made;
  }

  // Held levels go by elements of the whole design, which a connection by itself does not know.
  // What lies between them is nothing to be level with, then.
  static void ForgetFeatureAnchors(Element& element) {
    std::erase_if(element.planes, [&](const ElementPlane& plane) {
      return std::abs(plane.fraction) != 0.5 &&
             !element.feature_anchors[static_cast<std::size_t>(plane.axis)].empty();
    });
    element.feature_anchors = {};
  }

  void AddElement(int index, ElementConnection& made) const {
    Element element = At(index);
    ForgetFeatureAnchors(element);
    for (int& part : element.parts) {
      made.assembly.parts.push_back(assembly_.parts[static_cast<std::size_t>(part)]);
      part = static_cast<int>(made.assembly.parts.size()) - 1;
    }
    made.elements.push_back(std::move(element));
  }

  // Whether a joint moves some of the elements and others not.
  bool MovesSome(const Joint& joint, const ElementConnection& made) const {
    const auto moved = std::count_if(
        made.elements.begin(), made.elements.end(),
        [&](const Element& element) { return IsWithin(assembly_, element.group, joint.group); });
    return moved > 0 && moved < static_cast<std::ptrdiff_t>(made.elements.size());
  }

  void AddPatches(ElementConnection& made) const {
    const int count = made.principal_count();
    const auto box = [&](int principal) -> const BoundingBox& {
      return made.elements[static_cast<std::size_t>(principal)].box;
    };
    const auto add = [&](ConnectionPatch patch, int first, int second) {
      patch.first = first;
      patch.second = second;
      made.patches.push_back(std::move(patch));
    };
    if (count == 1) add(WholeOf(box(0)), 0, 0);
    std::vector<bool> touches(static_cast<std::size_t>(count), false);
    for (int a = 0; a < count; ++a) {
      for (int b = a + 1; b < count; ++b) {
        ConnectionPatch patch =
            FindPatch(made.elements[static_cast<std::size_t>(a)], box(a),
                      made.elements[static_cast<std::size_t>(b)], box(b), tolerance_, tolerance_);
        if (patch.kind != PatchKind::kContact) continue;
        add(std::move(patch), a, b);
        touches[static_cast<std::size_t>(a)] = touches[static_cast<std::size_t>(b)] = true;
      }
    }
    for (int a = 0; count > 1 && a < count; ++a) {
      if (touches[static_cast<std::size_t>(a)]) continue;
      const auto [first, second] = std::minmax({a, Nearest(made, a)});
      const bool known = std::any_of(made.patches.begin(), made.patches.end(),
                                     [&, low = first, high = second](const auto& p) {
                                       return p.first == low && p.second == high;
                                     });
      if (!known) add(GapBetween(box(first), box(second)), first, second);
    }
  }

  // The principal nearest to another.
  static int Nearest(const ElementConnection& made, int principal) {
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    const BoundingBox& box = made.elements[static_cast<std::size_t>(principal)].box;
    for (int other = 0; other < made.principal_count(); ++other) {
      if (other == principal) continue;
      const BoundingBox& its = made.elements[static_cast<std::size_t>(other)].box;
      const double apart =
          (its.minimum - box.maximum).cwiseMax(box.minimum - its.maximum).cwiseMax(0).norm();
      if (apart < least) {
        least = apart;
        nearest = other;
      }
    }
    return nearest;
  }

  // From the design's elements to the connection's.
  std::map<int, int> LocalOf(const ElementConnection& made) const {
    std::map<int, int> local;
    for (const Indices* indices : {&made.principals, &made.connecting}) {
      for (const int element : *indices) local.emplace(element, static_cast<int>(local.size()));
    }
    return local;
  }

  Contacts ContactsOf(const ElementConnection& made) const {
    const std::map<int, int> local = LocalOf(made);
    Contacts contacts;
    for (const auto& [a, b] : contacts_) {
      const auto first = local.find(a);
      const auto second = local.find(b);
      if (first == local.end() || second == local.end()) continue;
      contacts.push_back(std::minmax(first->second, second->second));
    }
    return contacts;
  }

  // What ties a joint's centre to one element in the design, if the connection has that element.
  std::vector<Relationship> JointTies(const ElementConnection& made) const {
    std::vector<Relationship> ties;
    if (made.joints.empty()) return ties;
    const std::map<int, int> local = LocalOf(made);
    const int of_elements = 6 * static_cast<int>(elements_.size());
    for (const Relationship& relationship : relationships_) {
      if (!relationship.equality) continue;
      std::set<int> its_elements;
      std::set<int> its_joints;
      for (const LinearTerm& term : relationship.form.terms) {
        if (term.variable < of_elements) {
          its_elements.insert(term.variable / 6);
        } else {
          its_joints.insert((term.variable - of_elements) / 3);
        }
      }
      if (its_joints.size() != 1 || its_elements.size() != 1) continue;
      const auto element = local.find(*its_elements.begin());
      const auto joint = std::find(made.joints.begin(), made.joints.end(), *its_joints.begin());
      if (element == local.end() || joint == made.joints.end()) continue;
      Relationship tie = relationship;
      for (LinearTerm& term : tie.form.terms) {
        const int base = term.variable < of_elements
                             ? 6 * element->second
                             : static_cast<int>(6 * made.elements.size()) +
                                   3 * static_cast<int>(joint - made.joints.begin());
        const int offset =
            term.variable < of_elements ? term.variable % 6 : (term.variable - of_elements) % 3;
        term.variable = base + offset;
      }
      std::sort(tie.form.terms.begin(), tie.form.terms.end(),
                [](const auto& a, const auto& b) { return a.variable < b.variable; });
      ties.push_back(std::move(tie));
    }
    return ties;
  }

  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const Contacts& contacts_;
  const std::vector<Relationship>& relationships_;
  const double tolerance_;
  std::map<Indices, Indices> connecting_of_;  // by the principals
};

}  // namespace

LinearForm PatchEdge(const ElementConnection& connection, int patch, Axis axis, bool upper) {
  const int center = connection.PatchVariable(patch, axis);
  return Combine(1, LinearForm::Variable(center), upper ? 0.5 : -0.5,
                 LinearForm::Variable(center + 3));
}

ConnectionPatch PatchAt(const ElementConnection& connection, int patch,
                        const std::vector<BoundingBox>& principals) {
  const ConnectionPatch& drawn = connection.patches[static_cast<std::size_t>(patch)];
  const auto first = static_cast<std::size_t>(drawn.first);
  const auto second = static_cast<std::size_t>(drawn.second);
  ConnectionPatch found;
  switch (drawn.kind) {
    case PatchKind::kWhole:
      found = WholeOf(principals[first]);
      break;
    case PatchKind::kGap:
      found = GapBetween(principals[first], principals[second]);
      break;
    case PatchKind::kContact:
      // What met over an area as drawn may do so over ever less.
      found = FindPatch(connection.elements[first], principals[first], connection.elements[second],
                        principals[second], connection.tolerance, 0);
      break;
  }
  found.first = drawn.first;
  found.second = drawn.second;
  return found;
}

Eigen::VectorXd DrawnParameters(const ElementConnection& connection) {
  Eigen::VectorXd q(connection.parameter_count());
  q.head(connection.end_unknown()) = DrawnParameters(connection.assembly, connection.elements);
  for (std::size_t patch = 0; patch < connection.patches.size(); ++patch) {
    const BoundingBox& region = connection.patches[patch].region;
    q.segment<3>(connection.PatchVariable(static_cast<int>(patch), Axis::kX)) = region.center();
    q.segment<3>(connection.PatchVariable(static_cast<int>(patch), Axis::kX) + 3) = region.size();
  }
  return q;
}

std::vector<ElementConnection> FindConnections(const Assembly& assembly,
                                               const std::vector<Element>& elements,
                                               const Contacts& contacts,
                                               const std::vector<Relationship>& relationships,
                                               double tolerance) {
  return ConnectionSearch(assembly, elements, contacts, relationships, tolerance).Find();
}

}  // namespace mortise::parametric
