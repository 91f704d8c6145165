// The folder that the evaluation writes: tables as CSV and Markdown, charts as SVG, pictures as
// PNG, and one page with all of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/render/drawing.h"
#include "common/render/image.h"

namespace mortise::retrieval {

struct ResultTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // as many cells each as there are columns
};

// A number for a table: at most `digits` significant digits.
std::string TableNumber(double value, int digits = 3);

// "77.0": a part of 1 in hundredths.
std::string TablePercent(double part);

// The table as RFC 4180 and as Markdown have it.
std::string AsCsv(const ResultTable& table);
std::string AsMarkdown(const ResultTable& table);

// A figure is what is made in one go, and skipped by a later run: what it wrote is there, and was
// made of the same.
class ResultFolder {
 public:
  explicit ResultFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // `digest` tells what the figure is made of.
  bool IsDone(const std::string& figure, const std::string& digest) const;

  // Begins a figure: forgets what an earlier run said of it. `text` is for people.
  absl::Status Begin(const std::string& figure, const std::string& title, const std::string& text);

  // Writes NAME.csv, and the table into the figure's part of the page.
  absl::Status Add(const std::string& name, const ResultTable& table);
  // Writes NAME.svg.
  absl::Status Add(const std::string& name, const render::Drawing& drawing);
  // Writes NAME.png.
  absl::Status Add(const std::string& name, const render::Image& image);

  // Writes FIGURE.md, and notes that the figure is done.
  absl::Status End(const std::string& digest);

  // Writes evaluation.md of all figures that are done, in the order given.
  absl::Status WritePage(const std::vector<std::string>& figures) const;

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path Kept() const { return folder_ / "kept"; }  // for later runs alone

 private:
  std::filesystem::path Stamp(const std::string& figure) const;

  std::filesystem::path folder_;
  std::string figure_;
  std::string page_;
};

}  // namespace mortise::retrieval
