#include "common/assembly/trial/drawn_contacts.h"

#include <algorithm>
#include <numeric>

#include "common/assembly/model/linear_design.h"
#include "common/base/errors.h"
#include "common/mesh/repair/proximity.h"

namespace mortise::parametric {

absl::StatusOr<TouchingParts> FindTouchingParts(const Assembly& assembly, double tolerance) {
  std::vector<mesh::SurfaceMesh> surfaces;
  surfaces.reserve(assembly.parts.size());
  std::vector<double> deflections;  // by which triangles may miss curved faces
  for (const AssemblyPart& part : assembly.parts) {
    surfaces.push_back(SurfaceOf(part));
    deflections.push_back(part.shape == nullptr ? 0
                                                : mesh::DeflectionIn(*part.shape, part.box.size()));
  }
  const double most =
      deflections.empty() ? 0 : *std::max_element(deflections.begin(), deflections.end());
  MORTISE_ASSIGN_OR_RETURN(const std::vector<mesh::Proximity> proximities,
                           mesh::FindProximities(surfaces, tolerance + 2 * most));
  TouchingParts touching;
  for (const mesh::Proximity& proximity : proximities) {
    const double missed = deflections[static_cast<std::size_t>(proximity.first)] +
                          deflections[static_cast<std::size_t>(proximity.second)];
    if (proximity.distance > tolerance + missed) continue;
    touching.insert(std::minmax(proximity.first, proximity.second));
  }
  return touching;
}

std::vector<int> ConnectingTogether(const Assembly& assembly, const TouchingParts& touching) {
  std::vector<int> above(assembly.parts.size());
  std::iota(above.begin(), above.end(), 0);
  const auto top = [&](int part) {
    while (above[static_cast<std::size_t>(part)] != part) {
      part = above[static_cast<std::size_t>(part)];
    }
    return part;
  };
  const auto connects = [&](int part) {
    return assembly.parts[static_cast<std::size_t>(part)].connecting;
  };
  for (const auto& [a, b] : touching) {
    if (!connects(a) || !connects(b)) continue;
    const auto [low, high] = std::minmax({top(a), top(b)});
    above[static_cast<std::size_t>(high)] = low;
  }
  std::vector<int> together;
  for (int part = 0; part < static_cast<int>(above.size()); ++part) together.push_back(top(part));
  return together;
}

Contacts ContactsOf(const TouchingParts& touching, const Assembly& assembly,
                    const std::vector<Element>& elements) {
  const std::vector<int> element_of = ElementsOfParts(assembly, elements);
  std::set<std::pair<int, int>> contacts;
  for (const auto& [first, second] : touching) {
    const std::pair<int, int> pair = std::minmax(element_of[static_cast<std::size_t>(first)],
                                                 element_of[static_cast<std::size_t>(second)]);
    if (pair.first != pair.second) contacts.insert(pair);
  }
  return Contacts(contacts.begin(), contacts.end());
}

absl::StatusOr<Contacts> FindContacts(const Assembly& assembly,
                                      const std::vector<Element>& elements, double tolerance) {
  MORTISE_ASSIGN_OR_RETURN(const TouchingParts touching, FindTouchingParts(assembly, tolerance));
  return ContactsOf(touching, assembly, elements);
}

}  // namespace mortise::parametric
