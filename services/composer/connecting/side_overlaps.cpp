#include "services/composer/connecting/side_overlaps.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "services/composer/model/overlap.h"

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

std::vector<SideOverlap> OverlapsBetween(const BothSides& sides,
                                         const std::vector<Candidate>& connections) {
  std::vector<SideOverlap> overlaps;
  const std::vector<SolidPart> component = SolidsOf(sides.component);
  for (const SolidPart& body : SolidsOf(sides.body)) {
    for (const SolidPart& part : component) {
      const double depth = SolidPart::DepthOf(body, part);
      if (depth == 0) continue;
      const bool is_wanted =
          std::any_of(connections.begin(), connections.end(), [&](const Candidate& connection) {
            return HasOverlap(sides, connection, body.name(), part.name());
          });
      if (!is_wanted) overlaps.push_back({body.name(), part.name(), depth});
    }
  }
  return overlaps;
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
  return absl::StrCat("'", overlap.component, "' reaches ", 1000 * overlap.depth, " mm into '",
                      overlap.body, "' of the model");
}

}  // namespace mortise::composer
