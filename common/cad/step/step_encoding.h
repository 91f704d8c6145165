// Decodes a STEP file's text: marks at its beginning, and names in whatever encoding.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::cad {

struct StepText {
  std::string text;                // ASCII but for the names, which are UTF-8
  std::vector<std::string> notes;  // what was taken for what, for people
};

// Decodes the text, and leaves out a mark of its encoding. Names escaped as the standard has it
// (\X\E4, \X2\00E4\X0\, \X4\…\X0\, \S\d) are decoded. Names that are neither ASCII nor UTF-8 are
// taken for GB18030 if most of their signs are common Chinese ones, or else for Latin-1 (as Windows
// has it), with a note.
//
// INVALID_ARGUMENT, "step", for UTF-16 or UTF-32, by name.
absl::StatusOr<StepText> DecodeStep(std::string_view bytes);

}  // namespace mortise::cad
