#include "tests/bench/services/retrieval/evaluation/result_folder.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/text_escapes.h"
#include "common/render/axis_numbers.h"

namespace mortise::retrieval {
std::string TableNumber(double value, int digits) { return render::ShortNumber(value, digits); }

std::string TablePercent(double part) { return absl::StrFormat("%.1f", 100 * part); }

std::string AsCsv(const ResultTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    return absl::StrJoin(cells, ",", [](std::string* to, const std::string& cell) {
      absl::StrAppend(to, CsvField(cell));
    });
  };
  std::string text = line(table.columns) + "\n";
  for (const std::vector<std::string>& row : table.rows) absl::StrAppend(&text, line(row), "\n");
  return text;
}

std::string AsMarkdown(const ResultTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    return absl::StrCat("| ", absl::StrJoin(cells, " | "), " |\n");
  };
  std::string text = absl::StrCat("**", table.title, "**\n\n", line(table.columns));
  absl::StrAppend(&text, line(std::vector<std::string>(table.columns.size(), "---")));
  for (const std::vector<std::string>& row : table.rows) absl::StrAppend(&text, line(row));
  return text + "\n";
}

std::filesystem::path ResultFolder::Stamp(const std::string& figure) const {
  return Kept() / absl::StrCat("figure-", figure);
}

bool ResultFolder::IsDone(const std::string& figure, const std::string& digest) const {
  const absl::StatusOr<std::string> stamp = ReadFile(Stamp(figure));
  return stamp.ok() && *stamp == digest && ReadFile(folder_ / (figure + ".md")).ok();
}

absl::Status ResultFolder::Begin(const std::string& figure, const std::string& title,
                                 const std::string& text) {
  std::error_code ignored;
  std::filesystem::remove(Stamp(figure), ignored);
  figure_ = figure;
  page_ = absl::StrCat("## ", title, "\n\n", text, "\n\n");
  return absl::OkStatus();
}

absl::Status ResultFolder::Add(const std::string& name, const ResultTable& table) {
  absl::StrAppend(&page_, AsMarkdown(table));
  return WriteFile(folder_ / (name + ".csv"), AsCsv(table));
}

absl::Status ResultFolder::Add(const std::string& name, const render::Drawing& drawing) {
  absl::StrAppend(&page_, "![", name, "](", name, ".svg)\n\n");
  MORTISE_ASSIGN_OR_RETURN(const std::string svg, render::DrawingSvg(drawing));
  return WriteFile(folder_ / (name + ".svg"), svg);
}

absl::Status ResultFolder::Add(const std::string& name, const render::Image& image) {
  absl::StrAppend(&page_, "![", name, "](", name, ".png)\n\n");
  MORTISE_ASSIGN_OR_RETURN(const std::string png, render::EncodePng(image));
  return WriteFile(folder_ / (name + ".png"), png);
}

absl::Status ResultFolder::End(const std::string& digest) {
  MORTISE_RETURN_IF_ERROR(WriteFile(folder_ / (figure_ + ".md"), page_));
  return WriteFile(Stamp(figure_), digest);
}

absl::Status ResultFolder::WritePage(const std::vector<std::string>& figures) const {
  std::string page = "# Evaluation of retrieval\n\n";
  for (const std::string& figure : figures) {
    const absl::StatusOr<std::string> part = ReadFile(folder_ / (figure + ".md"));
    if (part.ok()) absl::StrAppend(&page, *part);
  }
  return WriteFile(folder_ / "evaluation.md", page);
}

}  // namespace mortise::retrieval
