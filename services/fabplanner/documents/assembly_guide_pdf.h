// The assembly guide on paper.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/documents/guide_contents.h"

namespace mortise::fabplanner {

// Returns the PDF, A4: the overview with its tables, then each step on a page of its own, with its
// picture (a PNG of 4 : 3 for each step). Fails as PdfDocument does.
absl::StatusOr<std::string> AssemblyGuidePdf(const GuideContents& contents,
                                             const std::vector<std::string>& pictures);

}  // namespace mortise::fabplanner
