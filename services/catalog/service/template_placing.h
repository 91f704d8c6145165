// Puts templates on ground: the same template with other height fields.
#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog {

// Returns the template that is asked for on the ground of the request, with all that it used when
// it was imported: completed, checked, under a name of its own, and without external ids and
// labels. INVALID_ARGUMENT naming what is wrong with the request
// ("height_fields[0].grid.heights[7]"), and in the message which field of the template asks for
// what; NOT_FOUND; CANCELLED as soon as `is_given_up`.
absl::StatusOr<v1::TemplateBundle> PlaceOn(const Catalog& catalog,
                                           const v1::PlaceTemplateRequest& asked,
                                           const std::function<bool()>& is_given_up);

}  // namespace mortise::catalog
