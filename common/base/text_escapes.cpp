#include "common/base/text_escapes.h"

#include <algorithm>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "common/base/string_views.h"

namespace mortise {
namespace {

// Whether a spreadsheet computes it. A number with its sign, and several between blanks, such as a
// direction, stay what they are.
bool IsFormula(std::string_view text) {
  if (text.empty()) return false;
  if (std::string_view("=@\t\r").find(text.front()) != std::string_view::npos) return true;
  if (text.front() != '+' && text.front() != '-') return false;
  for (const absl::string_view piece : absl::StrSplit(AbslView(text), ' ')) {
    double ignored = 0;
    if (!absl::SimpleAtod(piece, &ignored)) return true;
  }
  return false;
}

std::string_view WithoutLeadingQuotes(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of('\''), text.size()));
  return text;
}

}  // namespace

std::string SpreadsheetText(std::string_view text) {
  return absl::StrCat(IsFormula(WithoutLeadingQuotes(text)) ? "'" : "", AbslView(text));
}

std::string FromSpreadsheetText(std::string_view cell) {
  const bool is_quoted = cell.starts_with('\'') && IsFormula(WithoutLeadingQuotes(cell));
  return std::string(is_quoted ? cell.substr(1) : cell);
}

std::string CsvField(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  return absl::StrCat("\"", absl::StrReplaceAll(AbslView(text), {{"\"", "\"\""}}), "\"");
}

std::string EscapeControls(std::string_view text) {
  std::string shown;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // U+0080 to U+009F, in UTF-8, do what escape sequences do.
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    const bool is_wide = byte == 0xC2 && next >= 0x80 && next <= 0x9F;
    const bool is_control = (byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7F;
    if (is_wide) {
      absl::StrAppend(&shown, "\\x", absl::Hex(next, absl::kZeroPad2));
      ++i;
    } else if (is_control) {
      absl::StrAppend(&shown, "\\x", absl::Hex(byte, absl::kZeroPad2));
    } else {
      shown += text[i];
    }
  }
  return shown;
}

std::string EscapeXml(std::string_view text) {
  return absl::StrReplaceAll(
      AbslView(text),
      {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"}});
}

}  // namespace mortise
