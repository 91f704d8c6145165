// A sheet of labels, to be printed on paper that is cut for them.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/documents/part_labels.h"

namespace mortise::fabplanner {

// Returns the PDF: A4, 3 × 8 labels of 70 × 36 mm a page, with 4.5 mm above and below. Each has the
// part's name, its step, size, stock and item, and a QR code of 25 mm. `title` is of the document.
// Fails as PdfDocument::Begin and QrCodeOf do.
absl::StatusOr<std::string> LabelsPdf(const std::vector<LabelContents>& labels,
                                      const std::string& title);

}  // namespace mortise::fabplanner
