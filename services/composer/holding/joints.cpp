#include "services/composer/holding/joints.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/assembly/connections/connection_patch.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::AssemblyPart;
using parametric::Item;
using parametric::ItemKind;

constexpr double kNearlyFull = 0.9;       // of its box
constexpr double kDensityOfMetal = 2000;  // kg/m³, above that of wood, boards and plastics

FastenerKind KindOf(ItemKind kind) {
  switch (kind) {
    case ItemKind::kScrew:
      return FastenerKind::kScrew;
    case ItemKind::kBolt:
    case ItemKind::kThreadedRod:
      return FastenerKind::kBolt;
    case ItemKind::kDowel:
      return FastenerKind::kDowel;
    default:
      return FastenerKind::kHardware;
  }
}

bool IsRound(ItemKind kind) {
  return kind == ItemKind::kDowel || kind == ItemKind::kTube || kind == ItemKind::kThreadedRod ||
         kind == ItemKind::kWheel || kind == ItemKind::kBearing;
}

double LongestContact(const parametric::ElementConnection& connection) {
  double longest = 0;
  for (const parametric::ConnectionPatch& patch : connection.patches) {
    if (patch.kind != parametric::PatchKind::kContact) continue;
    longest = std::max(longest, patch.region.size().maxCoeff());
  }
  return longest;
}

}  // namespace

Fastener FastenerOf(const AssemblyPart& part, const std::vector<Item>& items) {
  Fastener fastener;
  fastener.name = part.name;
  fastener.item = part.item;
  fastener.box = part.box;
  const Item* const item = parametric::FindItem(items, part.item);
  if (item == nullptr) return fastener;
  fastener.item_kind = item->kind;
  fastener.kind = KindOf(item->kind);
  fastener.axis = static_cast<int>(part.item_axes[0]);
  fastener.diameter = item->dimensions[1].size;
  return fastener;
}

JoinedPart JoinedPartOf(const AssemblyPart& part, const std::vector<Item>& items,
                        const std::vector<parametric::Material>& materials) {
  JoinedPart joined;
  joined.name = part.name;
  joined.box = part.box;
  if (part.shape != nullptr) {
    joined.is_box = part.shape->volume >= kNearlyFull * part.shape->size.prod();
  }
  const Item* const item = parametric::FindItem(items, part.item);
  if (item == nullptr) return joined;
  joined.turns = item->kind == ItemKind::kWheel || item->kind == ItemKind::kBearing;
  if (part.shape == nullptr && IsRound(item->kind)) joined.is_box = false;
  const parametric::Material* const material = parametric::FindMaterial(materials, item->material);
  joined.is_metal = material != nullptr && material->density >= kDensityOfMetal;
  return joined;
}

std::vector<Joint> JointsOf(const Assembly& drawn,
                            const std::vector<CollectionConnection>& connections,
                            const std::vector<Item>& items,
                            const std::vector<parametric::Material>& materials) {
  std::map<std::string, const AssemblyPart*> part_of;
  for (const AssemblyPart& part : drawn.parts) part_of[part.name] = &part;
  std::vector<Joint> joints;
  for (const CollectionConnection& each : connections) {
    Joint& joint = joints.emplace_back();
    for (const std::string& name : each.Principals()) {
      joint.principals.push_back(JoinedPartOf(*part_of.at(name), items, materials));
    }
    for (const AssemblyPart& part : each.connection.assembly.parts) {
      if (part.connecting) joint.fasteners.push_back(FastenerOf(part, items));
    }
    joint.length = LongestContact(each.connection);
    joint.moves = !each.connection.joints.empty();
  }
  return joints;
}

std::vector<std::string> PrincipalNames(const Assembly& drawn) {
  std::vector<std::string> names;
  for (const AssemblyPart& part : drawn.parts) {
    if (!part.connecting) names.push_back(part.name);
  }
  return names;
}

double DepthIn(const Fastener& pin, const JoinedPart& part) {
  if (CommonDepth(pin.box, part.box) <= kMaxOverlap) return 0;
  return std::min(pin.box.maximum[pin.axis], part.box.maximum[pin.axis]) -
         std::max(pin.box.minimum[pin.axis], part.box.minimum[pin.axis]);
}

bool AreCoaxial(const Fastener& a, const Fastener& b) {
  if (a.axis != b.axis) return false;
  Eigen::Vector3d apart = a.box.center() - b.box.center();
  apart[a.axis] = 0;
  return apart.norm() <= std::min(a.diameter, b.diameter) / 2;
}

}  // namespace mortise::composer
