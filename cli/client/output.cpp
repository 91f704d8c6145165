#include "cli/client/output.h"

#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "cli/client/ending_signals.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/text_escapes.h"

namespace mortise::cli {
namespace {

// Columns that a terminal shows for UTF-8 text: bytes that do not continue a character.
std::size_t Width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

// A cell as it is shown: on one line, so that it stands below its title.
std::string CellText(const std::string& cell) {
  return absl::StrReplaceAll(EscapeControls(cell), {{"\n", " "}, {"\t", " "}});
}

std::string TableRow(const std::vector<std::string>& cells,
                     const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    line += cells[i];
    if (i + 1 < cells.size()) line += std::string(widths[i] - Width(cells[i]) + 2, ' ');
  }
  return line + "\n";
}

}  // namespace

void Output::Line(const std::string& text) const {
  if (form_ != Form::kText) return;
  std::printf("%s\n", EscapeControls(text).c_str());
  std::fflush(stdout);
}

void Output::Table(const std::vector<std::string>& titles,
                   const std::vector<std::vector<std::string>>& rows) const {
  if (form_ != Form::kText) return;
  std::vector<std::size_t> widths;
  for (const std::string& title : titles) widths.push_back(Width(title));
  std::vector<std::vector<std::string>> shown = rows;
  for (auto& row : shown) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = CellText(row[i]);
      widths[i] = std::max(widths[i], Width(row[i]));
    }
  }
  std::string text = TableRow(titles, widths);
  for (const auto& row : shown) text += TableRow(row, widths);
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

void Output::Document(const nlohmann::ordered_json& document) {
  last_document_ = document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (form_ != Form::kJson) return;
  std::printf("%s\n", last_document_.c_str());
  std::fflush(stdout);
}

void Output::DocumentOf(const google::protobuf::Message& message) { Document(ToJson(message)); }

void Output::Progress(long done, long total, const std::string& text) {
  constexpr int kBar = 30;
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  std::string line;
  if (total > 0) {
    const int filled = static_cast<int>(kBar * std::min(done, total) / total);
    line = absl::StrFormat("[%s%s] %d/%d  %s", std::string(filled, '#'),
                           std::string(kBar - filled, '.'), done, total, text);
  } else {
    line = text;
  }
  line = CellText(line);
  const std::lock_guard lock(mutex_);
  if (form_ == Form::kSilent || line == last_progress_) return;
  last_progress_ = line;
  if (terminal) {
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    progress_open_ = true;
  } else if (form_ == Form::kText) {
    std::fprintf(stderr, "%s\n", line.c_str());
  }
  std::fflush(stderr);
}

void Output::Note(const std::string& text) {
  if (form_ == Form::kSilent) return;
  const std::lock_guard lock(mutex_);
  BreakProgress();
  std::fprintf(stderr, "%s\n", EscapeControls(text).c_str());
  std::fflush(stderr);
}

void Output::EndProgress() {
  const std::lock_guard lock(mutex_);
  BreakProgress();
  last_progress_.clear();
}

void Output::BreakProgress() {
  if (progress_open_) std::fputc('\n', stderr);
  progress_open_ = false;
}

int Output::Failure(const absl::Status& status) {
  const ErrorDetail detail = DetailOf(status);
  const std::lock_guard lock(mutex_);
  BreakProgress();
  const std::string code = absl::StatusCodeToString(status.code());
  nlohmann::ordered_json error = {{"code", code},
                                  {"message", std::string(status.message())},
                                  {"reason", detail.reason},
                                  {"field", detail.field}};
  const std::vector<FieldViolation> violations = ViolationsOf(status);
  const std::string message = EscapeControls(std::string(status.message()));
  if (ExitCodeOf(status) > 1) {
    // No failure: what somebody asked for, with commands to copy.
    std::fprintf(stderr, "mortise: %s\n", message.c_str());
  } else if (violations.empty()) {
    std::fprintf(stderr, "mortise: %s (%s)\n", message.c_str(), code.c_str());
  } else {
    // The message has them all in one line, and may be cut short.
    std::fprintf(stderr, "mortise: %zu findings (%s)\n", violations.size(), code.c_str());
  }
  for (const FieldViolation& violation : violations) {
    std::fprintf(stderr, "  %s: %s\n", EscapeControls(violation.field).c_str(),
                 EscapeControls(violation.message).c_str());
    error["violations"].push_back({{"field", violation.field}, {"message", violation.message}});
  }
  Document({{"error", error}});
  return ExitCodeOf(status);
}

nlohmann::ordered_json ToJson(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text, options);
  if (!status.ok()) return {{"unprintable", status.ToString()}};
  return nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
}

}  // namespace mortise::cli
