// Reads assemblies from the messages of mortise/v1/assembly.proto; collection.h reads their files.
// Target mortise_assembly_codec.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/assembly/model/assembly.h"
#include "common/design/template_definition.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::parametric {

// The assembly with its names resolved: groups (the root first, named as the assembly is), repeated
// parts one by one, size limits from the items, shapes their own or else their item's, whose large
// planar faces are prominent planes. INVALID_ARGUMENT naming every field at fault, as the message
// has it ("parts[3].item"): names that are wrong, missing or given twice, hierarchies that are no
// trees, fixed sizes that differ from their item's or their shape's, colours out of range, and
// whatever ValidateAssembly finds.
absl::StatusOr<Assembly> FromProto(const v1::Assembly& message, const std::vector<Item>& items,
                                   const ShapesByName& shapes = {});

// SHA-256 of all that an assembly's parametrisation depends on: its content without name, revision,
// digest, external ids, labels, creator and time, and that of its items and materials, each without
// revision, external ids, labels, creator and times.
std::string BundleDigest(const v1::AssemblyBundle& message);

}  // namespace mortise::parametric
