#include "common/assembly/trial/drawn_contacts.h"

#include <algorithm>
#include <numeric>

#include "common/assembly/model/linear_design.h"
#include "common/base/errors.h"
#include "common/mesh/repair/proximity.h"

namespace mortise::parametric {

namespace {

// The parts of an assembly as they are drawn.
struct DrawnSurfaces {
  std::vector<mesh::SurfaceMesh> surfaces;
  std::vector<double> deflections;  // m, by which triangles may miss curved faces

  double MostDeflection() const {
    return deflections.empty() ? 0 : *std::max_element(deflections.begin(), deflections.end());
  }
  // By how much the triangles of two parts may miss their distance, m.
  double MissedBy(const mesh::Proximity& pair) const {
    return deflections[static_cast<std::size_t>(pair.first)] +
           deflections[static_cast<std::size_t>(pair.second)];
  }
};

DrawnSurfaces SurfacesOf(const Assembly& assembly) {
  DrawnSurfaces drawn;
  drawn.surfaces.reserve(assembly.parts.size());
  for (const AssemblyPart& part : assembly.parts) {
    drawn.surfaces.push_back(SurfaceOf(part));
    drawn.deflections.push_back(
        part.shape == nullptr ? 0 : mesh::DeflectionIn(*part.shape, part.box.size()));
  }
  return drawn;
}

}  // namespace

absl::StatusOr<TouchingParts> FindTouchingParts(
    const Assembly& assembly, double tolerance,
    const std::function<bool(std::size_t done)>& goes_on) {
  const DrawnSurfaces drawn = SurfacesOf(assembly);
  MORTISE_ASSIGN_OR_RETURN(
      const std::vector<mesh::Proximity> proximities,
      mesh::FindProximities(drawn.surfaces, tolerance + 2 * drawn.MostDeflection(), goes_on));
  TouchingParts touching;
  for (const mesh::Proximity& proximity : proximities) {
    if (proximity.distance > tolerance + drawn.MissedBy(proximity)) continue;
    touching.insert(std::minmax(proximity.first, proximity.second));
  }
  return touching;
}

absl::StatusOr<std::vector<NearMiss>> FindNearMisses(const Assembly& assembly, double tolerance,
                                                     double furthest) {
  const DrawnSurfaces drawn = SurfacesOf(assembly);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<mesh::Proximity> proximities,
                           mesh::FindProximities(drawn.surfaces, furthest));
  std::vector<NearMiss> misses;
  for (const mesh::Proximity& proximity : proximities) {
    if (proximity.distance <= tolerance + drawn.MissedBy(proximity)) continue;
    misses.push_back({proximity.first, proximity.second, proximity.distance});
  }
  std::stable_sort(misses.begin(), misses.end(),
                   [](const NearMiss& a, const NearMiss& b) { return a.gap < b.gap; });
  return misses;
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
