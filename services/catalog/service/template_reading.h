// Template revisions with all that they use, from the store.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "mortise/v1/template.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog {

// As GetBundle.
absl::StatusOr<v1::TemplateBundle> FindBundle(const Catalog& catalog, const std::string& name,
                                              int64_t revision);

// Adds the shapes that a bundle names.
absl::Status AddShapesTo(const Catalog& catalog, v1::TemplateBundle& bundle);

}  // namespace mortise::catalog
