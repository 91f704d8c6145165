#include "services/fabplanner/documents/bill_workbook.h"

#include <xlsxwriter.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/temporary_folder.h"
#include "services/fabplanner/documents/bill_table.h"
#include "services/fabplanner/plan/money.h"

namespace mortise::fabplanner {
namespace {

constexpr std::size_t kMaxCell = 32767;   // characters
constexpr int kMaxLevel = 7;              // of rows that can be folded
constexpr std::size_t kMaxProperty = 60;  // characters

absl::Status NotWritten(lxw_error error) {
  return absl::InternalError(
      absl::StrCat("the workbook of the bill cannot be written: ", lxw_strerror(error)));
}

bool BeginsCharacter(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) != 0x80; }

// The text, or as much of it as `most` characters hold with "…" at the end.
std::string CutOff(const std::string& text, std::size_t most) {
  std::size_t characters = 0, end = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!BeginsCharacter(text[i])) continue;
    if (++characters == most) end = i;
  }
  return characters <= most ? text : absl::StrCat(text.substr(0, end), "…");
}

// A property of the file, which takes no line breaks and no text of any length.
std::string PropertyText(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  return CutOff(text, kMaxProperty);
}

// The library's workbook, written when it is closed. What it is given as text it copies.
class Workbook {
 public:
  explicit Workbook(const TemporaryFolder& folder)
      : folder_(folder.path().string()), path_((folder.path() / "bill.xlsx").string()) {
    lxw_workbook_options options = {};
    options.tmpdir = folder_.data();
    book_ = workbook_new_opt(path_.c_str(), &options);
    if (book_ == nullptr) return;
    sheet_ = workbook_add_worksheet(book_, "Bill");
    bold_ = workbook_add_format(book_);
    format_set_bold(bold_);
    for (std::size_t digits = 0; digits < amounts_.size(); ++digits) {
      amounts_[digits] = workbook_add_format(book_);
      const std::string decimals = digits == 0 ? "" : absl::StrCat(".", std::string(digits, '0'));
      format_set_num_format(amounts_[digits], absl::StrCat("#,##0", decimals).c_str());
    }
  }
  Workbook(const Workbook&) = delete;
  Workbook& operator=(const Workbook&) = delete;
  ~Workbook() {
    if (book_ != nullptr) workbook_close(book_);
  }

  bool is_open() const { return book_ != nullptr && sheet_ != nullptr; }

  void SetProperties(std::string title, int64_t created) {
    lxw_doc_properties properties = {};
    properties.title = title.data();
    properties.created = static_cast<time_t>(std::max<int64_t>(created, 1));  // 0 stands for now
    Note(workbook_set_properties(book_, &properties));
  }

  void WriteHeader(const std::vector<BillColumn>& columns) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto column = static_cast<lxw_col_t>(i);
      Note(worksheet_set_column(sheet_, column, column, columns[i].width, nullptr));
      Note(worksheet_write_string(sheet_, 0, column, columns[i].name, bold_));
    }
    worksheet_freeze_panes(sheet_, 1, 0);
    // Nodes stand above what is below them in the tree.
    worksheet_outline_settings(sheet_, LXW_TRUE, LXW_FALSE, LXW_FALSE, LXW_FALSE);
  }

  void WriteRow(std::size_t number, const BillRow& row) {
    const auto line = static_cast<lxw_row_t>(number);
    lxw_row_col_options options = {};
    options.level = static_cast<uint8_t>(std::min(row.level, kMaxLevel));
    Note(worksheet_set_row_opt(sheet_, line, LXW_DEF_ROW_HEIGHT, nullptr, &options));
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      WriteCell(line, static_cast<lxw_col_t>(i), row.cells[i]);
    }
  }

  absl::StatusOr<std::string> Bytes() {
    const lxw_error closed = workbook_close(std::exchange(book_, nullptr));
    Note(closed);
    if (error_ != LXW_NO_ERROR) return NotWritten(error_);
    return ReadFile(path_);
  }

 private:
  void WriteCell(lxw_row_t row, lxw_col_t column, const BillCell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) {
      const std::string fitting = CutOff(*text, kMaxCell);
      Note(worksheet_write_string(sheet_, row, column, fitting.c_str(), nullptr));
    } else if (const auto* number = std::get_if<double>(&cell)) {
      Note(worksheet_write_number(sheet_, row, column, *number, nullptr));
    } else if (const auto* money = std::get_if<Money>(&cell)) {
      const auto digits = static_cast<std::size_t>(MinorDigits(money->currency));
      Note(worksheet_write_number(sheet_, row, column, money->amount, amounts_.at(digits)));
    }
  }

  // Keeps the first error.
  void Note(lxw_error error) {
    if (error_ == LXW_NO_ERROR) error_ = error;
  }

  std::string folder_, path_;
  lxw_workbook* book_ = nullptr;
  lxw_worksheet* sheet_ = nullptr;
  lxw_format* bold_ = nullptr;
  std::array<lxw_format*, 5> amounts_ = {};  // by the decimals of a currency
  lxw_error error_ = LXW_NO_ERROR;
};

}  // namespace

absl::StatusOr<std::string> BillWorkbook(const BillTree& tree, const std::string& title) {
  const TemporaryFolder folder("bill");
  Workbook workbook(folder);
  if (!workbook.is_open()) return NotWritten(LXW_ERROR_MEMORY_MALLOC_FAILED);
  workbook.SetProperties(PropertyText(title), tree.effective_from);
  workbook.WriteHeader(BillColumns());
  const std::vector<BillRow> rows = BillRows(tree);
  for (std::size_t i = 0; i < rows.size(); ++i) workbook.WriteRow(i + 1, rows[i]);
  return workbook.Bytes();
}

}  // namespace mortise::fabplanner
