// What is cut, and what is bought for it, on paper.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns the PDF, A4: of each board and sheet a diagram and its parts in cutting order, stock that
// is cut alike once; then handwork and the bill of materials. `title` of the design is for people.
// Fails as PdfDocument::Begin does.
absl::StatusOr<std::string> CutListPdf(const FabricationPlan& plan, const Items& items,
                                       const std::string& title);

}  // namespace mortise::fabplanner
