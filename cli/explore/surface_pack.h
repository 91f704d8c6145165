// The shapes of a structure's samples as a page carries them: in whole steps of 16 bits.
// Private to this folder.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/explore/exported_structure.h"
#include "common/pages/number_pack.h"

namespace mortise::cli {

// Adds meshes and shapes to a pack, and returns what the page has to know of them: of each mesh its
// box, of each of `fields` its range, where steps of each sample are. Positions are rounded to
// 2^-16 of the box of all shapes of their mesh, fields to 2^-16 of their range in this structure.
// DATA_LOSS where what was received does not fit together.
absl::StatusOr<nlohmann::ordered_json> PackSurfaces(const ExportedStructure& structure,
                                                    const std::vector<v1::MapShapes::Field>& fields,
                                                    pages::NumberPack& pack);

}  // namespace mortise::cli
