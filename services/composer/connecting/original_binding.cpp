#include "services/composer/connecting/original_binding.h"

#include <algorithm>
#include <limits>

namespace mortise::composer {
namespace {

using parametric::BoundingBox;

using SameMaterial = std::function<bool(const std::string& item, const std::string& other)>;

int ComponentPart(const BothSides& sides, const std::string& name) {
  for (std::size_t i = 0; i < sides.component_parts.size(); ++i) {
    if (sides.component_parts[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

// A principal outside the component.
struct Outside {
  const std::string& item;
  const BoundingBox& box;
};

// The part of the body that stands for it, linked to one of `inside`; -1 for none.
int NearestOfBody(const Outside& outside, const BothSides& sides,
                  const std::vector<LinkedPair>& linked, const std::vector<int>& inside,
                  const std::set<int>& taken, const SameMaterial& same_material) {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const LinkedPair& pair : linked) {
    if (taken.contains(pair.body)) continue;
    if (std::find(inside.begin(), inside.end(), pair.component) == inside.end()) continue;
    const PrincipalPart& part = sides.body_parts[static_cast<std::size_t>(pair.body)];
    if (same_material && !same_material(outside.item, part.item)) continue;
    const double distance = CornerDistance(outside.box, part.box);
    if (distance < least) {
      least = distance;
      nearest = pair.body;
    }
  }
  return nearest;
}

}  // namespace

std::optional<Candidate> BindOriginal(const CollectionConnection& connection,
                                      const BothSides& sides, const std::vector<LinkedPair>& linked,
                                      const std::map<std::string, const PrincipalPart*>& fitted,
                                      const SameMaterial& same_material,
                                      std::set<std::string>& missing) {
  const std::vector<std::string> names = connection.Principals();
  Candidate candidate{&connection, {}};
  std::vector<int> inside;
  for (const std::string& name : names) {
    const int part = ComponentPart(sides, name);
    candidate.principals.push_back({part >= 0, part});
    if (part >= 0) inside.push_back(part);
  }
  if (inside.empty() || inside.size() == names.size()) return std::nullopt;
  const bool only_touches = connection.connection.connecting.empty();
  std::set<int> taken;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (candidate.principals[i].of_component) continue;
    const auto its = fitted.find(names[i]);
    const parametric::Element& drawn = connection.connection.elements[i];
    const BoundingBox& box = its == fitted.end() ? drawn.box : its->second->box;
    const int part = NearestOfBody({drawn.item, box}, sides, linked, inside, taken,
                                   only_touches ? SameMaterial() : same_material);
    if (part < 0) missing.insert(names[i]);
    taken.insert(part);
    candidate.principals[i].part = part;
  }
  if (!missing.empty()) return std::nullopt;
  return candidate;
}

}  // namespace mortise::composer
