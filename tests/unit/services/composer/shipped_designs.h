// Components and bodies made of the assemblies that ship, as tests of the composer use them.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/sub_tree.h"
#include "services/composer/connecting/connect.h"
#include "services/composer/model/design.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::composer {

// A whole design that ships, parametrised once a process.
inline const Design& ShippedDesign(const std::string& id) {
  static auto* const designs = new std::map<std::string, Design>();
  const auto known = designs->find(id);
  if (known != designs->end()) return known->second;
  Design made = AsDrawn(parametric::ReadShippedAssembly(id).value()).value();
  return designs->emplace(id, std::move(made)).first->second;
}

// A sub-tree of it, as drawn.
inline Design ShippedComponent(const std::string& id, const std::string& node) {
  const parametric::Assembly& whole = ShippedDesign(id).assembly->assembly();
  return AsDrawn(parametric::SubTreeOf(whole, node).value()).value();
}

// The connections of a design that ships, part by part.
inline const std::vector<CollectionConnection>& ShippedConnections(const std::string& id) {
  static auto* const connections = new std::map<std::string, std::vector<CollectionConnection>>();
  const auto known = connections->find(id);
  if (known != connections->end()) return known->second;
  auto made = ConnectionsOf("assemblies/" + id, ShippedDesign(id).assembly->assembly()).value();
  return connections->emplace(id, std::move(made)).first->second;
}

inline Original ShippedOriginal(const std::string& id) {
  // They are kept for ever.
  return {"assemblies/" + id, ShippedDesign(id),
          std::shared_ptr<const std::vector<CollectionConnection>>(std::shared_ptr<const void>(),
                                                                   &ShippedConnections(id))};
}

// The connections of all designs that ship.
inline std::vector<const CollectionConnection*> AllShippedConnections() {
  std::vector<const CollectionConnection*> all;
  for (const std::string& id : parametric::ShippedAssemblyIds()) {
    for (const CollectionConnection& one : ShippedConnections(id)) all.push_back(&one);
  }
  return all;
}

inline const std::vector<parametric::Material>& ShippedMaterials() {
  static const auto* const materials = [] {
    auto* const read = new std::vector<parametric::Material>();
    for (const v1::Material& message : parametric::WhatShips().materials) {
      read->push_back(*parametric::FromProto(message));
    }
    return read;
  }();
  return *materials;
}

// Options with the materials of the items that ship.
inline ConnectOptions ShippedOptions() {
  ConnectOptions options;
  static const auto* const materials = [] {
    auto* const by_item = new std::map<std::string, std::string>();
    for (const parametric::Item& one : parametric::ShippedItems()) {
      by_item->emplace(one.name, one.material);
    }
    return by_item;
  }();
  options.material_of = [](const std::string& item) {
    const auto found = materials->find(item);
    return found == materials->end() ? std::string() : found->second;
  };
  static const auto* const kinds = [] {
    auto* const by_item = new std::map<std::string, parametric::ItemKind>();
    for (const parametric::Item& one : parametric::ShippedItems()) {
      by_item->emplace(one.name, one.kind);
    }
    return by_item;
  }();
  options.item_kind_of = [](const std::string& item) {
    const auto found = kinds->find(item);
    return found == kinds->end() ? std::nullopt : std::optional(found->second);
  };
  return options;
}

// The design with the middle of its box there, m.
inline Design DroppedAt(Design design, const Eigen::Vector3d& middle) {
  design.shift += middle - BoundsOf(design).center();
  return design;
}

}  // namespace mortise::composer
