#include "services/composer/snapping/clearance.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/assembly/model/element.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;

// How far one of two boxes that overlap must be moved to be free of the other, m.
double DepthOfBoxes(const BoundingBox& a, const BoundingBox& b) {
  return (a.maximum - b.minimum).cwiseMin(b.maximum - a.minimum).minCoeff();
}

}  // namespace

Clearance::Clearance(const Design& component, const Design* original, const Design& body)
    : component_(component),
      original_(original),
      body_(PrincipalsOf(body)),
      dropped_(SolidsAt(InSpace(component))) {}

std::vector<Clearance::PlacedSolid> Clearance::PrincipalsOf(const Design& design) {
  std::vector<PlacedSolid> solids;
  for (const parametric::PlacedPart& part : PartsOf(design)) {
    if (design.assembly->elements()[static_cast<std::size_t>(part.element)].connecting) continue;
    auto shape = design.assembly->ShapeOf(part);
    const bool has_shape = shape != nullptr;
    solids.push_back(
        {part.element, has_shape, {part.name, part.box, std::move(shape), part.stretch}});
  }
  return solids;
}

std::vector<Clearance::PlacedSolid> Clearance::SolidsAt(const Eigen::VectorXd& q) const {
  return PrincipalsOf(FromSpace(component_.assembly, q));
}

double Clearance::OverlapAt(const Eigen::VectorXd& q) const {
  double sum = 0;
  for (const PlacedSolid& part : SolidsAt(q)) {
    for (const PlacedSolid& other : body_) sum += SolidPart::DepthOf(part.solid, other.solid);
  }
  return sum;
}

bool Clearance::RunsInto(const Eigen::VectorXd& q) const {
  const std::vector<PlacedSolid> parts = SolidsAt(q);
  // Boxes are quick, and mostly enough.
  for (const bool with_shapes : {false, true}) {
    for (const PlacedSolid& part : parts) {
      for (std::size_t i = 0; i < body_.size(); ++i) {
        if ((part.has_shape || body_[i].has_shape) != with_shapes) continue;
        if (CommonDepth(part.solid.box(), body_[i].solid.box()) <= kMaxOverlap) continue;
        if (IsDeeper(part, i)) return true;
      }
    }
  }
  return false;
}

bool Clearance::IsDeeper(const PlacedSolid& part, std::size_t body_part) const {
  // As deep as boxes shapes are at most.
  const SolidPart& other = body_[body_part].solid;
  const double most = DepthOfBoxes(part.solid.box(), other.box());
  const double allowed = kMaxOverlap + std::max(DepthInOriginal(part.element),
                                                DepthWhereDropped(part.solid.name(), body_part));
  return most > allowed && SolidPart::DepthOf(part.solid, other) > allowed;
}

double Clearance::DepthWhereDropped(const std::string& part, std::size_t body_part) const {
  const auto [known, is_new] = where_dropped_.try_emplace({part, body_part}, 0);
  if (!is_new) return known->second;
  for (const PlacedSolid& one : dropped_) {
    if (one.solid.name() == part)
      known->second = SolidPart::DepthOf(one.solid, body_[body_part].solid);
  }
  return known->second;
}

double Clearance::DepthInOriginal(int element) const {
  if (original_ == nullptr) return 0;
  const auto [known, is_new] = in_original_.try_emplace(element, 0);
  if (!is_new) return known->second;
  const parametric::Assembly& part_of = component_.assembly->assembly();
  std::set<std::string> inside, own;
  for (const parametric::AssemblyPart& part : part_of.parts) inside.insert(part.name);
  for (const int part : component_.assembly->elements()[static_cast<std::size_t>(element)].parts) {
    own.insert(part_of.parts[static_cast<std::size_t>(part)].name);
  }
  const std::vector<parametric::AssemblyPart>& drawn = original_->assembly->assembly().parts;
  for (const parametric::AssemblyPart& part : drawn) {
    if (!own.contains(part.name)) continue;
    const SolidPart solid(part);
    for (const parametric::AssemblyPart& outside : drawn) {
      if (outside.connecting || inside.contains(outside.name)) continue;
      known->second = std::max(known->second, SolidPart::DepthOf(solid, SolidPart(outside)));
    }
  }
  return known->second;
}

}  // namespace mortise::composer
