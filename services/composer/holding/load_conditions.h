// Supports and loads of a model, by which it can be analysed as any template can: what it stands on
// is held, and what of it bears is loaded (bearing_surfaces.h).
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_definition.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// Returns the conditions of an assembly template of the design as Redraw draws it:
//
// - FIXED on the lower face of each principal part that stands on the floor, within 0.1 mm;
// - GRAVITY, in every load case;
// - FORCE downwards on the upper faces of each surface, in a load case of its own called as its
//   kind, "seat", or "shelf_1", "shelf_2" … of several: its load, by the parts' areas. Of more than
//   20 surfaces, which are as many load cases as there may be, those of one kind are loaded
//   together.
//
// FAILED_PRECONDITION: NO_SUPPORTS where no principal part with a level lower face stands on the
// floor, as of what rolls on castors; NO_LOADS where nothing of it is a surface that bears.
absl::StatusOr<std::vector<parametric::BoundaryCondition>> SupportsAndLoads(
    const Design& design, const std::vector<parametric::Item>& items);

}  // namespace mortise::composer
