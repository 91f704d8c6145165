#include "common/files/csv_table.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/decimal_number.h"
#include "common/base/text_encoding.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxFindings = 100;

// How many bytes of `text` are the UTF-8 form of its first character; 0 if none are. Overlong
// forms, surrogates and what lies beyond Unicode are no characters.
std::size_t CharacterLength(std::string_view text) {
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  const unsigned second = byte(1);
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F)) {
    return 0;
  }
  return length;
}

// Takes a text apart, one row after the other.
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  CsvTable Run() {
    // Excel's own line before the header says no more here than that cells are as they should be.
    if (text_.substr(0, text_.find_first_of("\r\n")) == "sep=,") SkipLine();
    while (at_ < text_.size()) {
      if (AtLineEnd()) {
        SkipLineEnd();
      } else {
        TakeRow();
      }
    }
    return std::move(table_);
  }

 private:
  bool AtEnd() const { return at_ == text_.size(); }
  char Here() const { return text_[at_]; }

  bool AtLineEnd() const { return !AtEnd() && (Here() == '\n' || text_.substr(at_, 2) == "\r\n"); }

  void SkipLineEnd() {
    at_ += Here() == '\r' ? 2 : 1;
    ++line_;
  }

  void Report(const CsvCell& cell, std::string message) {
    if (table_.findings.size() < kMaxFindings) {
      table_.findings.push_back({PlaceOf(cell), std::move(message)});
    } else {
      ++table_.unlisted;
    }
  }

  void TakeRow() {
    const std::size_t begin = at_;
    CsvRow row;
    bool sound = true;
    while (true) {
      CsvCell& cell = row.emplace_back();
      cell.line = line_;
      cell.column = static_cast<int>(row.size());
      sound = !AtEnd() && Here() == '"' ? TakeQuoted(cell) : TakePlain(cell);
      if (!sound || AtEnd() || Here() != ',') break;
      ++at_;
    }
    if (!sound) return width_ == 0 ? SkipAll() : SkipLine();
    // Spreadsheets write empty rows as commas.
    const std::string_view text = text_.substr(begin, at_ - begin);
    const bool is_empty = text.find_first_not_of(',') == std::string_view::npos;
    if (AtLineEnd()) SkipLineEnd();
    if (!is_empty) Keep(std::move(row));
  }

  // What follows a fault may be sound again on the next line.
  void SkipLine() {
    while (!AtEnd() && Here() != '\n') ++at_;
    if (!AtEnd()) SkipLineEnd();
  }

  // Without the first row nobody knows what the others mean.
  void SkipAll() { at_ = text_.size(); }

  void Keep(CsvRow row) {
    if (width_ == 0) width_ = row.size();
    if (row.size() != width_) {
      Report(row[0], absl::StrCat("the row has ", row.size(), " cells, the first one ", width_));
      table_.ragged.push_back(std::move(row));
      return;
    }
    table_.rows.push_back(std::move(row));
  }

  // The character here, to the cell; false with a finding if it is none.
  bool TakeCharacter(CsvCell& cell) {
    const std::size_t length = CharacterLength(text_.substr(at_, 4));
    if (length == 0) {
      Report(cell, "is not UTF-8");
      return false;
    }
    if (Here() == '\0') {
      Report(cell, "has a NUL in it");
      return false;
    }
    if (Here() == '\n') ++line_;
    cell.text.append(text_.substr(at_, length));
    at_ += length;
    return true;
  }

  bool TakePlain(CsvCell& cell) {
    while (!AtEnd() && Here() != ',' && !AtLineEnd()) {
      if (Here() == '"') {
        Report(cell, "has a quote inside, so the whole must be quoted and the quote doubled");
        return false;
      }
      if (Here() == '\r') {
        Report(cell, "has a carriage return without a line feed after it");
        return false;
      }
      if (!TakeCharacter(cell)) return false;
    }
    return true;
  }

  bool TakeQuoted(CsvCell& cell) {
    ++at_;
    while (!AtEnd()) {
      if (Here() != '"') {
        if (!TakeCharacter(cell)) return false;
        continue;
      }
      ++at_;
      if (AtEnd() || Here() == ',' || AtLineEnd()) return true;
      if (Here() != '"') {
        Report(cell, "goes on after its closing quote");
        return false;
      }
      cell.text += '"';
      ++at_;
    }
    Report(cell, "begins with a quote that is never closed");
    return false;
  }

  const std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::size_t width_ = 0;  // cells of the first row
  CsvTable table_;
};

}  // namespace

CsvTable ParseCsv(std::string_view text) {
  std::string fault = EncodingFault(text);
  if (fault.empty()) return Parser(SkipByteOrderMark(text)).Run();
  CsvTable table;
  table.findings.push_back({"line 1", std::move(fault)});
  return table;
}

std::string OtherSeparator(std::string_view text) {
  text = SkipByteOrderMark(text);
  // Excel's own line, which other programs take for cells.
  constexpr std::string_view kSeparatorLine = "sep=";
  if (text.starts_with(kSeparatorLine)) {
    text.remove_prefix(kSeparatorLine.size());
    text = text.substr(0, 1);
  } else {
    text = text.substr(0, text.find_first_of("\r\n"));
    if (text.find(',') != std::string_view::npos) return "";
  }
  constexpr struct {
    char character;
    const char* name;
  } kSeparators[] = {{';', "semicolons"}, {'\t', "tabs"}, {'|', "vertical bars"}};
  for (const auto& separator : kSeparators) {
    if (text.find(separator.character) != std::string_view::npos) return separator.name;
  }
  return "";
}

absl::StatusOr<double> ParseCsvNumber(const std::string& text, bool thousandths) {
  // The shift is made in decimals: a quotient is not always the nearest number.
  const bool shifted = thousandths && text.find_first_of("eE") == std::string::npos;
  const std::optional<double> value = DecimalNumber(absl::StrCat(text, shifted ? "e-3" : ""));
  if (!value) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", text.substr(0, 80), "' is no number, such as 12.5"));
  }
  return thousandths && !shifted ? *value / 1000 : *value;
}

std::string PlaceOf(const CsvCell& cell) {
  return absl::StrCat("line ", cell.line, ", column ", cell.column);
}

}  // namespace mortise::parametric
