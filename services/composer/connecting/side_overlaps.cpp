#include "services/composer/connecting/side_overlaps.h"

#include <algorithm>
#include <iterator>

#include "absl/strings/str_cat.h"

namespace mortise::composer {
namespace {

// Whether a connection has its two principals reach into each other.
bool HasOverlap(const BothSides& sides, const Candidate& connection, const std::string& body,
                const std::string& component) {
  bool has_body = false, has_component = false;
  for (const BoundPrincipal& bound : connection.principals) {
    const std::string& name = sides.PartOf(bound).name;
    (bound.of_component ? has_component : has_body) |=
        name == (bound.of_component ? component : body);
  }
  if (!has_body || !has_component) return false;
  const auto& patches = connection.from->connection.patches;
  return std::any_of(patches.begin(), patches.end(), [](const auto& patch) {
    const auto normal = static_cast<Eigen::Index>(patch.normal);
    return patch.kind == parametric::PatchKind::kContact &&
           patch.region.size()[normal] > kMaxOverlap;
  });
}

}  // namespace

std::vector<SideOverlap> OverlapsBetween(const std::vector<SolidPart>& body,
                                         const std::vector<SolidPart>& component) {
  std::vector<SideOverlap> overlaps;
  for (const SolidPart& first : body) {
    for (const SolidPart& second : component) {
      const double depth = SolidPart::DepthOf(first, second);
      if (depth > 0) overlaps.push_back({first.name(), second.name(), depth});
    }
  }
  return overlaps;
}

std::vector<SideOverlap> Unwanted(const std::vector<SideOverlap>& overlaps, const BothSides& sides,
                                  const std::vector<Candidate>& connections) {
  std::vector<SideOverlap> unwanted;
  std::copy_if(overlaps.begin(), overlaps.end(), std::back_inserter(unwanted),
               [&](const SideOverlap& overlap) {
                 return std::none_of(
                     connections.begin(), connections.end(), [&](const Candidate& connection) {
                       return HasOverlap(sides, connection, overlap.body, overlap.component);
                     });
               });
  return unwanted;
}

std::vector<SideOverlap> NewOverlaps(const std::vector<SideOverlap>& before,
                                     const std::vector<SideOverlap>& after) {
  std::vector<SideOverlap> made;
  for (const SideOverlap& overlap : after) {
    const bool was_there = std::any_of(before.begin(), before.end(), [&](const SideOverlap& old) {
      return old.body == overlap.body && old.component == overlap.component &&
             old.depth >= overlap.depth - kMaxOverlap;
    });
    if (!was_there) made.push_back(overlap);
  }
  return made;
}

std::string Describe(const SideOverlap& overlap) {
  return absl::StrCat("'", overlap.component, "' reaches ", Millimetres(overlap.depth), " into '",
                      overlap.body, "' of the model");
}

}  // namespace mortise::composer
