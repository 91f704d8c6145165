#include "cli/files/compose_script.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/field_violations.h"
#include "common/base/string_views.h"

namespace mortise::cli {
namespace {

std::string FieldOf(int line) { return absl::StrCat("line ", line); }

// The words of a command, taken from its text character by character.
class WordReader {
 public:
  void Read(std::string_view text) {
    for (const char c : text) {
      if (c == '#' && quote_ == 0 && !in_word_) break;
      Take(c);
      text_ += c;
    }
    EndWord();
  }

  bool is_open() const { return quote_ != 0; }
  std::vector<std::string> TakeWords() { return std::move(words_); }
  std::string Text() const { return std::string(absl::StripAsciiWhitespace(text_)); }

 private:
  void Take(char c) {
    if (quote_ != 0) {
      if (c == quote_) {
        quote_ = 0;
      } else {
        word_ += c;
      }
    } else if (c == '"' || c == '\'') {
      quote_ = c;
      in_word_ = true;
    } else if (absl::ascii_isspace(static_cast<unsigned char>(c))) {
      EndWord();
    } else {
      word_ += c;
      in_word_ = true;
    }
  }

  void EndWord() {
    if (in_word_) words_.push_back(std::exchange(word_, {}));
    in_word_ = false;
  }

  std::vector<std::string> words_;
  std::string word_, text_;
  bool in_word_ = false;
  char quote_ = 0;  // that the present word stands in; 0 for none
};

// Joins lines that go on in the next; each with the number of its first.
std::vector<std::pair<int, std::string>> WholeLines(std::string_view text) {
  std::vector<std::pair<int, std::string>> lines;
  int number = 0;
  bool goes_on = false;
  for (const absl::string_view each : absl::StrSplit(AbslView(text), '\n')) {
    ++number;
    std::string line(each);
    absl::StripTrailingAsciiWhitespace(&line);
    const std::size_t begin = line.find_first_not_of(" \t");
    const bool is_comment = !goes_on && begin != std::string::npos && line[begin] == '#';
    const bool ends_open = !is_comment && absl::EndsWith(line, "\\");
    if (ends_open) line.pop_back();
    if (goes_on) {
      absl::StripLeadingAsciiWhitespace(&line);
      absl::StrAppend(&lines.back().second, " ", line);
    } else {
      lines.emplace_back(number, line);
    }
    goes_on = ends_open;
  }
  return lines;
}

// Finds what is wrong with the choice of commands and with their order.
void CheckOrder(const std::vector<ScriptLine>& lines, std::vector<FieldViolation>& findings) {
  if (lines.empty()) {
    findings.push_back({"line 1", "the script has no commands"});
    return;
  }
  const ScriptLine& first = lines.front();
  if (first.words[0] != "new" || first.words.size() < 2 || absl::StartsWith(first.words[1], "-")) {
    findings.push_back({FieldOf(first.number),
                        "a script begins with `new` and the id of its model, such as: new desk"});
  }
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].words[0] != "new") continue;
    findings.push_back({FieldOf(lines[i].number), "a script is of one model"});
  }
}

}  // namespace

absl::StatusOr<ComposeScript> ParseComposeScript(std::string_view text) {
  ComposeScript script;
  std::vector<FieldViolation> findings;
  for (const auto& [number, line] : WholeLines(text)) {
    WordReader reader;
    reader.Read(line);
    if (reader.is_open()) {
      findings.push_back({FieldOf(number), "a quotation mark is not closed"});
    }
    std::vector<std::string> words = reader.TakeWords();
    if (!words.empty()) script.lines.push_back({number, reader.Text(), std::move(words)});
  }
  CheckOrder(script.lines, findings);
  if (!findings.empty()) return InvalidFields(findings);
  script.model = script.lines.front().words[1];
  return script;
}

}  // namespace mortise::cli
