// QR codes (ISO/IEC 18004) of texts.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "services/fabplanner/paper/pdf_document.h"

namespace mortise::fabplanner {

// Returns the modules of the smallest code that holds the text's bytes, of which readers may lose
// 15 % (level M), without the quiet zone of four modules around it. INVALID_ARGUMENT of an empty
// text, or of one of more than 2,331 bytes, which is more than a code holds.
absl::StatusOr<ModuleSquare> QrCodeOf(const std::string& text);

}  // namespace mortise::fabplanner
