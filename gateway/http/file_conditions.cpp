#include "gateway/http/file_conditions.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace mortise::gateway {
namespace {

constexpr std::string_view kBytesUnit = "bytes=";
constexpr char kAnyMediaType[] = "application/octet-stream";
constexpr std::size_t kLongestFileName = 200;

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

bool IsNumber(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_isdigit(static_cast<unsigned char>(c));
  });
}

// A number of bytes; what does not fit is larger than any file.
int64_t NumberOf(std::string_view text) {
  int64_t number = 0;
  const bool fits = absl::SimpleAtoi(absl::string_view(text.data(), text.size()), &number);
  return fits ? number : INT64_MAX;
}

bool IsPlainByte(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '-';
}

// RFC 8187: bytes that are not plain as %XX.
std::string PercentEncoded(std::string_view text) {
  std::string encoded;
  for (const char c : text) {
    if (IsPlainByte(c)) {
      encoded.push_back(c);
    } else {
      absl::StrAppendFormat(&encoded, "%%%02X", static_cast<unsigned char>(c));
    }
  }
  return encoded;
}

}  // namespace

RangeChoice ChooseRange(std::string_view range, int64_t size) {
  range = Trimmed(range);
  if (!absl::StartsWithIgnoreCase({range.data(), range.size()},
                                  {kBytesUnit.data(), kBytesUnit.size()})) {
    return {};
  }
  range = Trimmed(range.substr(kBytesUnit.size()));
  const auto dash = range.find('-');
  if (dash == std::string_view::npos) return {};
  const std::string_view first = Trimmed(range.substr(0, dash));
  const std::string_view last = Trimmed(range.substr(dash + 1));
  if (first.empty() && IsNumber(last)) {
    const int64_t suffix = std::min(NumberOf(last), size);
    if (suffix == 0) return {false, std::nullopt};
    return {true, ByteRange{size - suffix, size - 1}};
  }
  if (!IsNumber(first) || (!last.empty() && !IsNumber(last))) return {};
  const int64_t begin = NumberOf(first);
  const int64_t end = last.empty() ? INT64_MAX : NumberOf(last);
  if (end < begin) return {};
  if (begin >= size) return {false, std::nullopt};
  return {true, ByteRange{begin, std::min(end, size - 1)}};
}

bool NamesTag(std::string_view if_none_match, std::string_view tag) {
  if_none_match = Trimmed(if_none_match);
  if (if_none_match == "*") return true;
  while (!if_none_match.empty()) {
    const auto comma = std::min(if_none_match.find(','), if_none_match.size());
    std::string_view named = Trimmed(if_none_match.substr(0, comma));
    if (named.starts_with("W/")) named.remove_prefix(2);
    if (named == tag) return true;
    if_none_match.remove_prefix(std::min(comma + 1, if_none_match.size()));
  }
  return false;
}

bool AllowsRange(std::string_view if_range, std::string_view tag) {
  return if_range.empty() || Trimmed(if_range) == tag;
}

std::string AttachmentNamed(std::string_view file_name) {
  std::string name(file_name.substr(file_name.find_last_of("/\\") + 1));
  name.erase(std::remove_if(name.begin(), name.end(),
                            [](char c) {
                              return absl::ascii_iscntrl(static_cast<unsigned char>(c)) ||
                                     c == '"' || c == '\\';
                            }),
             name.end());
  if (name.size() > kLongestFileName) name.resize(kLongestFileName);
  if (name.empty() || name == "." || name == "..") return "attachment";
  if (std::all_of(name.begin(), name.end(), IsPlainByte)) {
    return absl::StrCat("attachment; filename=\"", name, "\"");
  }
  std::string plain = name;
  std::replace_if(
      plain.begin(), plain.end(), [](char c) { return !IsPlainByte(c) && c != ' '; }, '_');
  return absl::StrCat("attachment; filename=\"", plain, "\"; filename*=UTF-8''",
                      PercentEncoded(name));
}

std::string SafeMediaType(std::string_view media_type) {
  const auto slash = media_type.find('/');
  const bool plain = std::all_of(media_type.begin(), media_type.end(), [](char c) {
    return IsPlainByte(c) || c == '/' || c == '+' || c == ';' || c == ' ' || c == '=';
  });
  if (!plain || slash == 0 || slash == std::string_view::npos || slash + 1 == media_type.size() ||
      media_type.size() > kLongestFileName) {
    return kAnyMediaType;
  }
  return std::string(media_type);
}

}  // namespace mortise::gateway
