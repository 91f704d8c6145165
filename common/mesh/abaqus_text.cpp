#include "common/mesh/abaqus_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <system_error>

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

std::optional<std::int64_t> Integer(std::string_view text) {
  std::int64_t value = 0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> Number(std::string_view text) {
  std::string plain(text);
  for (char& c : plain) {
    if (c == 'd' || c == 'D') c = 'e';
  }
  std::string_view rest = plain;
  if (rest.starts_with('+')) rest.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc() || end != rest.data() + rest.size()) return std::nullopt;
  return value;
}

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
    keyword.parameters[Upper(Trim(field.substr(0, equals)))] = std::string(value);
  }
  const bool is_word = !keyword.name.empty() && keyword.name.size() <= 40 &&
                       std::all_of(keyword.name.begin(), keyword.name.end(), [](unsigned char c) {
                         return std::isalnum(c) != 0 || c == ' ' || c == '-' || c == '_';
                       });
  if (!is_word) return std::nullopt;
  return keyword;
}

bool ChangesMesh(const std::string& keyword) {
  static const std::set<std::string> keywords{"NGEN",         "NFILL",
                                              "NCOPY",        "NMAP",
                                              "ELGEN",        "ELCOPY",
                                              "SYSTEM",       "SYMMETRIC MODEL GENERATION",
                                              "IMPERFECTION", "SUBSTRUCTURE GENERATE",
                                              "MODEL CHANGE"};
  return keywords.contains(keyword);
}

bool IsFrame(const std::string& keyword) {
  static const std::set<std::string> keywords{"HEADING",  "PREPRINT",    "PART",
                                              "END PART", "ASSEMBLY",    "END ASSEMBLY",
                                              "INSTANCE", "END INSTANCE"};
  return keywords.contains(keyword);
}

}  // namespace mortise::mesh::abaqus
