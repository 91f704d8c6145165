#include "common/mesh/files/abaqus_text.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/decimal_number.h"

namespace mortise::mesh::abaqus {

std::string_view Trim(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::string Upper(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return upper;
}

std::vector<std::string_view> Fields(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    const std::string_view field = Trim(line.substr(0, comma));
    if (comma != std::string_view::npos || !field.empty()) fields.push_back(field);
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::optional<std::int64_t> Integer(std::string_view text) { return DecimalInteger(text); }

std::optional<double> Number(std::string_view text) {
  std::string plain(text);
  for (char& c : plain) {
    if (c == 'd' || c == 'D') c = 'e';
  }
  return DecimalNumber(plain);
}

namespace {

// What a keyword that is read may have. INTERNAL hides a set from Abaqus/CAE's lists and UNSORTED
// keeps the order of its members; neither changes what is in it.
struct Parameters {
  std::set<std::string> values;  // NAME=…
  std::set<std::string> flags;
};

const std::map<std::string, Parameters>& ReadParameters() {
  static const std::map<std::string, Parameters> parameters{
      {"NODE", {{"NSET"}, {}}},
      {"ELEMENT", {{"TYPE", "ELSET"}, {}}},
      {"NSET", {{"NSET", "ELSET", "INSTANCE"}, {"GENERATE", "INTERNAL", "UNSORTED"}}},
      {"ELSET", {{"ELSET", "INSTANCE"}, {"GENERATE", "INTERNAL", "UNSORTED"}}},
      {"SURFACE", {{"NAME", "TYPE"}, {"INTERNAL"}}},
      {"PART", {{"NAME"}, {"INTERNAL"}}},
      {"INSTANCE", {{"NAME", "PART"}, {}}},
      {"ASSEMBLY", {{"NAME"}, {}}}};
  return parameters;
}

bool IsOfWord(unsigned char c) { return std::isalnum(c) != 0 || c == ' ' || c == '-' || c == '_'; }

}  // namespace

std::string Keyword::Value(const std::string& parameter) const {
  const auto found = parameters.find(parameter);
  return found == parameters.end() ? std::string() : found->second;
}

std::optional<Keyword> ParseKeyword(std::string_view line) {
  Keyword keyword;
  for (const std::string_view field : Fields(line)) {
    if (keyword.name.empty()) {
      for (const char c : Upper(field)) {
        if (c != ' ' || !keyword.name.ends_with(' ')) keyword.name += c;
      }
      continue;
    }
    const std::size_t equals = field.find('=');
    std::string_view value = equals == std::string_view::npos ? "" : Trim(field.substr(equals + 1));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"') {
      value = value.substr(1, value.size() - 2);
    }
    std::string name = Upper(Trim(field.substr(0, equals)));
    if (name.empty() && equals == std::string_view::npos) continue;  // between two commas
    const auto [known, is_new] = keyword.parameters.try_emplace(std::move(name), value);
    if (!is_new) keyword.repeated = known->first;
  }
  const bool is_word = !keyword.name.empty() && keyword.name.size() <= 40 &&
                       std::all_of(keyword.name.begin(), keyword.name.end(), IsOfWord);
  if (!is_word) return std::nullopt;
  return keyword;
}

Following WhatFollows(const Keyword& keyword, std::string_view line) {
  if (line.find_first_not_of(", \t") == std::string_view::npos) return Following::kParameters;
  const std::vector<std::string_view> fields = Fields(line);
  if (fields.front().find('=') != std::string_view::npos) return Following::kParameters;
  const auto known = ReadParameters().find(keyword.name);
  const bool is_flag =
      known != ReadParameters().end() && known->second.flags.contains(Upper(fields.front()));
  return is_flag ? Following::kParameters : Following::kData;
}

std::string UnreadParameter(const Keyword& keyword) {
  const auto known = ReadParameters().find(keyword.name);
  if (known == ReadParameters().end()) return {};
  if (!keyword.repeated.empty()) {
    return absl::StrCat("*", keyword.name, " has ", keyword.repeated, " twice");
  }
  const auto& [values, flags] = known->second;
  for (const auto& [name, value] : keyword.parameters) {
    if (name == "INPUT") {
      return absl::StrCat("*", keyword.name,
                          " with INPUT is not read: one file is uploaded; put the lines of the "
                          "other in its place");
    }
    if (name == "SYSTEM" && keyword.name == "NODE") {
      if (Upper(value) == "R") continue;  // x, y and z
      return "*NODE with SYSTEM is not read; give x, y and z";
    }
    if (flags.contains(name) && value.empty()) continue;
    if (values.contains(name)) {
      if (!value.empty()) continue;
      return absl::StrCat("*", keyword.name, " has ", name, " without a value");
    }
    const bool is_plain = name.size() <= 40 && std::all_of(name.begin(), name.end(), IsOfWord);
    return absl::StrCat("*", keyword.name, " with ", is_plain ? name : "'?'", " is not read");
  }
  return {};
}

bool ChangesMesh(const std::string& keyword) {
  static const std::set<std::string> keywords{"NGEN",         "NFILL",
                                              "NCOPY",        "NMAP",
                                              "ELGEN",        "ELCOPY",
                                              "SYSTEM",       "SYMMETRIC MODEL GENERATION",
                                              "IMPERFECTION", "SUBSTRUCTURE GENERATE",
                                              "MODEL CHANGE", "IMPORT",
                                              "RESTART",      "PARAMETER"};
  return keywords.contains(keyword);
}

bool IsFrame(const std::string& keyword) {
  static const std::set<std::string> keywords{"HEADING",  "PREPRINT",    "PART",
                                              "END PART", "ASSEMBLY",    "END ASSEMBLY",
                                              "INSTANCE", "END INSTANCE"};
  return keywords.contains(keyword);
}

bool HasNoData(const std::string& keyword) {
  static const std::set<std::string> keywords{"PART", "END PART", "ASSEMBLY", "END ASSEMBLY",
                                              "END INSTANCE"};
  return keywords.contains(keyword);
}

}  // namespace mortise::mesh::abaqus
