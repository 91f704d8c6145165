// The assemblies that ship, as structs, with the shapes of their parts.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "common/assembly/codec/assembly_codec.h"
#include "common/base/errors.h"
#include "common/files/collection.h"
#include "common/files/template_codec.h"

namespace mortise::parametric {

inline const Collection& WhatShips() {
  static const auto* const collection = [] {
    const char* source = std::getenv("MORTISE_SOURCE_DIR");
    const std::filesystem::path root = source == nullptr ? "." : source;
    return new Collection(ReadCollection(root / "collection").value());
  }();
  return *collection;
}

inline const std::vector<Item>& ShippedItems() {
  static const auto* const items = [] {
    auto* const read = new std::vector<Item>();
    for (const v1::Item& message : WhatShips().items) read->push_back(*FromProto(message));
    return read;
  }();
  return *items;
}

inline const ShapesByName& ShippedShapes() {
  static const auto* const shapes =
      new ShapesByName(FromProto(google::protobuf::RepeatedPtrField<v1::Shape>(
                                     WhatShips().shapes.begin(), WhatShips().shapes.end()))
                           .value());
  return *shapes;
}

// "tool_cart" and the like, which also names tests.
inline std::vector<std::string> ShippedAssemblyIds() {
  std::vector<std::string> ids;
  for (const v1::Assembly& assembly : WhatShips().assemblies) {
    std::string id = assembly.name().substr(assembly.name().find('/') + 1);
    std::replace(id.begin(), id.end(), '-', '_');
    ids.push_back(id);
  }
  return ids;
}

// NOT_FOUND; otherwise as FromProto.
inline absl::StatusOr<Assembly> ReadShippedAssembly(std::string id) {
  std::replace(id.begin(), id.end(), '_', '-');
  for (const v1::Assembly& assembly : WhatShips().assemblies) {
    if (assembly.name() == "assemblies/" + id) {
      return FromProto(assembly, ShippedItems(), ShippedShapes());
    }
  }
  return ResourceNotFound(id);
}

}  // namespace mortise::parametric
