#include "tests/e2e/manual/manual.h"

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <sstream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "cli/launcher/state_folder.h"
#include "common/base/files.h"

namespace mortise::e2e {
namespace {

constexpr char kFence[] = "```";
constexpr char kStandInId[] = "0198c1";

std::filesystem::path Source() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return folder == nullptr ? "." : folder;
}

// A comment begins with " #" outside of quotes; the manual has none within.
std::string WithoutComment(const std::string& line) {
  const std::size_t comment = line.find(" #");
  return std::string(absl::StripAsciiWhitespace(line[0] == '#' ? "" : line.substr(0, comment)));
}

}  // namespace

std::string ManualBlock::Place(const ManualCommand& command) const {
  return absl::StrCat(document, ":", command.line);
}

std::vector<ManualBlock> ReadManual(const std::string& document) {
  std::istringstream lines(ReadFile(Source() / document).value_or(""));
  std::vector<ManualBlock> blocks;
  bool in_block = false;
  bool in_shell = false;
  bool continued = false;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (absl::StartsWith(line, kFence)) {
      in_block = !in_block;
      const std::string info = line.substr(3);
      in_shell = in_block && (info == "sh" || absl::StartsWith(info, "sh "));
      if (in_shell) blocks.push_back({document, info == "sh" ? "" : info.substr(3), "", {}});
      continue;
    }
    if (!in_shell) continue;
    ManualBlock& block = blocks.back();
    block.text += line + "\n";
    std::string text = line.empty() ? "" : WithoutComment(line);
    const bool goes_on = absl::EndsWith(text, "\\");
    if (goes_on) text.pop_back();
    if (continued) {
      absl::StrAppend(&block.commands.back().text, " ", text);
    } else if (!text.empty()) {
      block.commands.push_back({number, text});
    }
    continued = goes_on;
  }
  return blocks;
}

std::vector<std::string> ManualDocuments() {
  std::vector<std::string> documents = {"README.md"};
  for (const auto& entry : std::filesystem::directory_iterator(Source() / "docs")) {
    if (entry.path().extension() == ".md") {
      documents.push_back("docs/" + entry.path().filename().string());
    }
  }
  std::sort(documents.begin() + 1, documents.end());
  return documents;
}

StandIns::StandIns(const std::filesystem::path& state) {
  const auto house = cli::ReadRunningHouse(state);
  if (!house.ok()) return;
  real_["127.0.0.1:7700"] = house->gateway_grpc;
  real_["127.0.0.1:7780"] = house->gateway_http;
}

void StandIns::Learn(const std::string& printed) {
  static const std::regex name("(plans|fronts|maps|workOrders|operations/[a-z]+)/[0-9a-z]{26}");
  for (auto match = std::sregex_iterator(printed.begin(), printed.end(), name);
       match != std::sregex_iterator(); ++match) {
    real_[absl::StrCat((*match)[1].str(), "/", kStandInId)] = match->str();
  }
}

std::string StandIns::Replace(std::string text) const { return absl::StrReplaceAll(text, real_); }

}  // namespace mortise::e2e
