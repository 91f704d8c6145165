// Writes fronts as files: rows for spreadsheets, pictures for reports.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace mortise::v1 {
class Front;
}

namespace mortise::pareto {

// Returns one row a point in the order of the embedding: parameters, metrics (with units in the
// heading), piece. RFC 4180, numbers with 17 significant digits.
std::string FrontAsCsv(const v1::Front& front);

// Returns the Front message as JSON, as the API gives it.
absl::StatusOr<std::string> FrontAsJson(const v1::Front& front);

// Return the picture of front_picture.h. FAILED_PRECONDITION for a front without points.
absl::StatusOr<std::string> FrontAsSvg(const v1::Front& front);
absl::StatusOr<std::string> FrontAsPng(const v1::Front& front);

}  // namespace mortise::pareto
