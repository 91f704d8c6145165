// The shape in the file of an ImportShape request.
#pragma once

#include "absl/status/statusor.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::catalog {

// As it will be stored, named by its content, with notes on what was repaired of it.
// INVALID_ARGUMENT, "format" or "file", with all that is wrong with it; RESOURCE_EXHAUSTED, "file".
// Takes a while.
absl::StatusOr<v1::Shape> ReadShape(const v1::ImportShapeRequest& asked);

}  // namespace mortise::catalog
