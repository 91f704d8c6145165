// Solids as readers of STEP files will have them. Private to this folder: it brings Open CASCADE.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"

namespace mortise::cad {

// The bytes of a STEP file with one solid.
using SolidWriter = std::function<absl::StatusOr<std::string>(const Solid&)>;

// For solids with faces that close on themselves: of a loop in one, which has neither a seam nor
// poles in a file, readers may take the wrong side. The solid itself, if what `write` makes of it
// is the same valid solid when it is read again; else one with its closed faces cut open of which
// that holds, up to 1e-6 of the volume. Nothing if there is none. Errors of `write`. Takes two
// hundredths of a second, each time that it is written.
absl::StatusOr<std::optional<Solid>> ReadableSolid(const Solid& solid, const SolidWriter& write);

}  // namespace mortise::cad
