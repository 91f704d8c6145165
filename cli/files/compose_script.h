// Reads scripts of `mortise compose run`: plain text, one command a line, in the words of `mortise
// compose` without the model, which the first command names.
//
//   # A table that is wider than the one it comes from.
//   new wide-table --title "Wide table"
//   add dining-table --group frame --id frame
//   add dining-table --group top --id top --at "0.8, 0.45, 0.74"
//   snap top
//   connect top
//   drag --control width --to 1.9m
//   save
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::cli {

// A command of a script.
struct ScriptLine {
  int number = 0;                  // where it begins; the first is 1
  std::string text;                // as it is written, in one line, without comments
  std::vector<std::string> words;  // quotes taken away
};

struct ComposeScript {
  std::string model;              // that `new` names
  std::vector<ScriptLine> lines;  // the first is `new`
};

// Most bytes of a script.
inline constexpr std::size_t kMaxScriptBytes = std::size_t{1} << 20;

// Returns the commands of a script. Words are parted by blanks; what stands in "…" or '…' is one
// word, with all that is in it as it is. `#` at the beginning of a word begins a comment. A line
// that ends with `\` goes on in the next.
//
// INVALID_ARGUMENT, with the lines as fields ("line 7"): quotes that nothing closes; a script that
// does not begin with `new` and the id of a model, or has another `new`.
absl::StatusOr<ComposeScript> ParseComposeScript(std::string_view text);

}  // namespace mortise::cli
