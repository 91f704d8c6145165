#include "services/composer/connecting/part_connection.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "common/assembly/model/element.h"
#include "common/assembly/model/shape_features.h"
#include "common/assembly/relations/relationship.h"
#include "common/assembly/trial/drawn_contacts.h"
#include "common/base/errors.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::Element;
using parametric::ElementConnection;
using parametric::TouchingParts;

using Parts = std::vector<int>;  // indices into the assembly

class PartConnectionSearch {
 public:
  PartConnectionSearch(const std::string& source, const Assembly& assembly,
                       const TouchingParts& touching)
      : source_(source),
        assembly_(assembly),
        touching_(touching),
        tolerance_(parametric::ToleranceOf(assembly)) {}

  std::vector<CollectionConnection> Find() {
    GroupConnecting();
    AddDirectContacts();
    std::vector<CollectionConnection> found;
    for (const auto& [principals, connecting] : connecting_of_) {
      for (ElementConnection& made : Make(principals, connecting)) {
        if (made.principals.size() != principals.size()) continue;
        found.push_back({source_, std::move(made)});
      }
    }
    return found;
  }

 private:
  bool Connects(int part) const {
    return assembly_.parts[static_cast<std::size_t>(part)].connecting;
  }

  void GroupConnecting() {
    const std::vector<int> together = parametric::ConnectingTogether(assembly_, touching_);
    std::map<int, std::set<int>> principals;
    const auto note = [&](int connecting, int principal) {
      principals[together[static_cast<std::size_t>(connecting)]].insert(principal);
    };
    for (const auto& [a, b] : touching_) {
      if (Connects(a) && !Connects(b)) note(a, b);
      if (Connects(b) && !Connects(a)) note(b, a);
    }
    for (int part = 0; part < static_cast<int>(together.size()); ++part) {
      const auto touched = principals.find(together[static_cast<std::size_t>(part)]);
      if (!Connects(part) || touched == principals.end()) continue;
      connecting_of_[Parts(touched->second.begin(), touched->second.end())].push_back(part);
    }
  }

  void AddDirectContacts() {
    std::set<std::pair<int, int>> connected;
    for (const auto& [principals, connecting] : connecting_of_) {
      for (const int a : principals) {
        for (const int b : principals) connected.emplace(a, b);
      }
    }
    for (const auto& [a, b] : touching_) {
      if (Connects(a) || Connects(b) || connected.contains({a, b})) continue;
      connecting_of_[{a, b}] = {};
    }
  }

  // The connections of an assembly of these parts alone: one, or none of principals that touch in
  // an edge only.
  std::vector<ElementConnection> Make(const Parts& principals, const Parts& connecting) const {
    Assembly part_of;
    part_of.name = assembly_.name;
    part_of.groups = assembly_.groups;
    std::map<int, int> index_of;
    std::set<int> lone;
    for (const Parts* parts : {&principals, &connecting}) {
      for (const int part : *parts) {
        index_of[part] = static_cast<int>(part_of.parts.size());
        if (!Connects(part)) lone.insert(index_of[part]);
        part_of.parts.push_back(assembly_.parts[static_cast<std::size_t>(part)]);
      }
    }
    AddJoints(part_of);
    parametric::ShapeFeatures known;
    const std::vector<Element> elements =
        parametric::MakeElements(part_of, tolerance_, {{}, lone}, known);
    const parametric::Contacts contacts =
        parametric::ContactsOf(Among(index_of), part_of, elements);
    // Only what ties joints to elements is asked of these.
    std::vector<parametric::Relationship> relationships;
    if (!part_of.joints.empty()) {
      relationships = parametric::FindRelationships(part_of, elements, contacts, tolerance_);
    }
    return parametric::FindConnections(part_of, elements, contacts, relationships, tolerance_);
  }

  // Joints that move some of the parts and not others.
  void AddJoints(Assembly& part_of) const {
    for (const parametric::Joint& joint : assembly_.joints) {
      const auto moved =
          std::count_if(part_of.parts.begin(), part_of.parts.end(), [&](const auto& part) {
            return parametric::IsWithin(assembly_, part.group, joint.group);
          });
      if (moved > 0 && moved < static_cast<std::ptrdiff_t>(part_of.parts.size())) {
        part_of.joints.push_back(joint);
      }
    }
  }

  TouchingParts Among(const std::map<int, int>& index_of) const {
    TouchingParts among;
    for (const auto& [part, index] : index_of) {
      for (auto pair = touching_.lower_bound({part, 0});
           pair != touching_.end() && pair->first == part; ++pair) {
        const auto other = index_of.find(pair->second);
        if (other != index_of.end()) among.insert(std::minmax(index, other->second));
      }
    }
    return among;
  }

  const std::string& source_;
  const Assembly& assembly_;
  const TouchingParts& touching_;
  const double tolerance_;
  std::map<Parts, Parts> connecting_of_;  // by the principals
};

}  // namespace

std::vector<std::string> CollectionConnection::Principals() const {
  std::vector<std::string> names;
  for (int i = 0; i < connection.principal_count(); ++i) {
    names.push_back(connection.elements[static_cast<std::size_t>(i)].name);
  }
  return names;
}

absl::StatusOr<std::vector<CollectionConnection>> ConnectionsOf(const std::string& source,
                                                                const Assembly& assembly) {
  MORTISE_ASSIGN_OR_RETURN(
      const TouchingParts touching,
      parametric::FindTouchingParts(assembly, parametric::ToleranceOf(assembly)));
  return PartConnectionSearch(source, assembly, touching).Find();
}

absl::StatusOr<std::vector<CollectionConnection>> ConnectionsAmong(
    const CollectionConnection& connection, const std::set<std::string>& principals) {
  const Assembly& whole = connection.connection.assembly;
  const auto reaches_out = [&](const parametric::AssemblyPart& part) {
    return std::any_of(whole.parts.begin(), whole.parts.end(), [&](const auto& other) {
      return !other.connecting && !principals.contains(other.name) &&
             CommonDepth(part.box, other.box) > kMaxOverlap;
    });
  };
  Assembly left = whole;
  std::erase_if(left.parts, [&](const parametric::AssemblyPart& part) {
    return part.connecting ? reaches_out(part) : !principals.contains(part.name);
  });
  return ConnectionsOf(connection.source, left);
}

}  // namespace mortise::composer
