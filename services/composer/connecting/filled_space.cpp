#include "services/composer/connecting/filled_space.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::composer {
namespace {

std::vector<SolidPart> SolidsOf(const Candidate& candidate,
                                const parametric::OptimizedConnection& placed) {
  std::vector<SolidPart> solids;
  const auto& elements = candidate.from->connection.elements;
  for (const parametric::PlacedPart& part : placed.parts) {
    solids.emplace_back(part.name, part.box, elements[static_cast<std::size_t>(part.element)].shape,
                        part.stretch);
  }
  return solids;
}

std::string ClashBetween(const std::vector<SolidPart>& made, const SolidPart& solid) {
  for (const SolidPart& part : made) {
    const double depth = SolidPart::DepthOf(part, solid);
    if (depth == 0) continue;
    return absl::StrCat("'", part.name(), "' would run ", Millimetres(depth), " into '",
                        solid.name(), "'");
  }
  return "";
}

}  // namespace

FilledSpace::FilledSpace(const BothSides& sides)
    : body_(composer::SolidsOf(sides.body)), component_(composer::SolidsOf(sides.component)) {}

std::string FilledSpace::ClashOf(const Candidate& candidate,
                                 const parametric::OptimizedConnection& placed,
                                 const BothSides& sides) const {
  std::set<std::string> body, component;  // names of what it connects
  for (const BoundPrincipal& bound : candidate.principals) {
    (bound.of_component ? component : body).insert(sides.PartOf(bound).name);
  }
  const std::vector<SolidPart> made = SolidsOf(candidate, placed);
  for (const auto& [solids, own] : {std::pair(&body_, &body), std::pair(&component_, &component)}) {
    for (const SolidPart& solid : *solids) {
      if (own->contains(solid.name())) continue;
      if (std::string clash = ClashBetween(made, solid); !clash.empty()) return clash;
    }
  }
  for (const SolidPart& solid : connecting_) {
    if (std::string clash = ClashBetween(made, solid); !clash.empty()) return clash;
  }
  return "";
}

const std::vector<SideOverlap>& FilledSpace::Overlaps() const {
  if (!overlaps_) overlaps_ = OverlapsBetween(body_, component_);
  return *overlaps_;
}

void FilledSpace::Add(const Candidate& candidate, const parametric::OptimizedConnection& placed) {
  for (SolidPart& solid : SolidsOf(candidate, placed)) connecting_.push_back(std::move(solid));
}

}  // namespace mortise::composer
