// Finds solids that readers of STEP files will have as they are. Private to this folder: it brings
// Open CASCADE.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"

namespace mortise::cad {

// Writes the bytes of a STEP file with one solid.
using SolidWriter = std::function<absl::StatusOr<std::string>(const Solid&)>;

// Returns a solid that is the same valid solid when what `write` makes of it is read again: the
// solid itself, or else one with its closed faces cut open, whose volume agrees to 1e-6. Returns
// nothing if there is none. It is meant for solids with faces that close on themselves: in a file
// these have neither a seam nor poles, so that readers may take the wrong side of a loop in one.
// Fails as `write` does. It takes two hundredths of a second each time that the solid is written.
absl::StatusOr<std::optional<Solid>> ReadableSolid(const Solid& solid, const SolidWriter& write);

}  // namespace mortise::cad
