#include "gateway/contract/query.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"

namespace mortise::gateway {
namespace {

constexpr std::size_t kMaximalTargetBytes = 8 * 1024;
constexpr std::size_t kMaximalStreams = 64;

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char lower = absl::ascii_tolower(static_cast<unsigned char>(c));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

absl::StatusOr<std::string> Unescape(std::string_view text, bool plus_is_space) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '+' && plus_is_space) {
      result.push_back(' ');
    } else if (text[i] != '%') {
      result.push_back(text[i]);
    } else {
      const bool complete = i + 2 < text.size();
      const int high = complete ? HexDigit(text[i + 1]) : -1;
      const int low = complete ? HexDigit(text[i + 2]) : -1;
      if (high < 0 || low < 0) return InvalidField("target", "has a malformed %-escape");
      result.push_back(static_cast<char>(high << 4 | low));
      i += 2;
    }
  }
  return result;
}

// Calls `part` with each piece of `text` between separators.
template <class Part>
absl::Status ForEachPart(std::string_view text, char separator, const Part& part) {
  while (!text.empty()) {
    const auto end = text.find(separator);
    MORTISE_RETURN_IF_ERROR(part(text.substr(0, end)));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return absl::OkStatus();
}

// Cuts "http://host:7780" off the beginning of a target, and returns "host:7780"; a path is left.
std::string TakeAuthority(std::string_view& target) {
  for (const absl::string_view scheme : {"http://", "https://"}) {
    if (!absl::StartsWithIgnoreCase({target.data(), target.size()}, scheme)) continue;
    const auto begin = scheme.size();
    const auto end = std::min(target.find_first_of("/?", begin), target.size());
    std::string authority(target.substr(begin, end - begin));
    target = end == target.size() ? "/" : target.substr(end);
    return authority;
  }
  return {};
}

bool IsLoopbackAddress(const std::string& host, bool bracketed) {
  in_addr four = {};
  in6_addr six = {};
  if (bracketed) {
    return inet_pton(AF_INET6, host.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
  }
  return inet_pton(AF_INET, host.c_str(), &four) == 1 && ntohl(four.s_addr) >> 24 == 127;
}

bool IsPort(std::string_view text) {
  return text.size() <= 5 && std::all_of(text.begin(), text.end(), [](char c) {
           return absl::ascii_isdigit(static_cast<unsigned char>(c));
         });
}

}  // namespace

bool IsLoopbackAuthority(std::string_view authority) {
  const bool bracketed = authority.starts_with('[');
  const auto end = bracketed ? authority.find(']') : authority.find(':');
  if (bracketed && end == std::string_view::npos) return false;
  const std::string host(bracketed ? authority.substr(1, end - 1) : authority.substr(0, end));
  std::string_view rest =
      end == std::string_view::npos ? std::string_view() : authority.substr(end + bracketed);
  if (!rest.empty() && (rest.front() != ':' || !IsPort(rest.substr(1)))) return false;
  return (!bracketed && absl::EqualsIgnoreCase(host, "localhost")) ||
         IsLoopbackAddress(host, bracketed);
}

absl::StatusOr<Target> ParseTarget(std::string_view target) {
  if (target.size() > kMaximalTargetBytes) return InvalidField("target", "is longer than 8 KiB");
  target = target.substr(0, target.find('#'));
  Target result;
  result.authority = TakeAuthority(target);
  if (!target.starts_with('/')) return InvalidField("target", "must begin with '/'");
  const auto question = target.find('?');
  MORTISE_ASSIGN_OR_RETURN(result.path, Unescape(target.substr(0, question), false));
  if (question == std::string_view::npos) return result;
  MORTISE_RETURN_IF_ERROR(
      ForEachPart(target.substr(question + 1), '&', [&](std::string_view pair) -> absl::Status {
        if (pair.empty()) return absl::OkStatus();
        const auto equals = pair.find('=');
        MORTISE_ASSIGN_OR_RETURN(const std::string name, Unescape(pair.substr(0, equals), true));
        std::string value;
        if (equals != std::string_view::npos) {
          MORTISE_ASSIGN_OR_RETURN(value, Unescape(pair.substr(equals + 1), true));
        }
        result.parameters[name] = std::move(value);
        return absl::OkStatus();
      }));
  return result;
}

std::vector<std::string> SplitList(std::string_view text) {
  std::vector<std::string> parts;
  (void)ForEachPart(text, ',', [&parts](std::string_view part) {
    if (!part.empty()) parts.emplace_back(part);
    return absl::OkStatus();
  });
  return parts;
}

absl::StatusOr<EventPosition> ParsePosition(std::string_view text) {
  EventPosition position;
  if (text.empty()) return InvalidField("Last-Event-ID", "is empty");
  MORTISE_RETURN_IF_ERROR(ForEachPart(text, ',', [&](std::string_view part) -> absl::Status {
    const auto colon = part.find(':');
    if (colon == std::string_view::npos || !IsResourceId(part.substr(0, colon))) {
      return InvalidField("Last-Event-ID", "must have the form stream:number,…");
    }
    MORTISE_ASSIGN_OR_RETURN(const int64_t number,
                             ParseNumber(part.substr(colon + 1), "Last-Event-ID"));
    if (number < 0) return InvalidField("Last-Event-ID", "numbers begin at 0");
    if (!position.emplace(part.substr(0, colon), number).second) {
      return InvalidField("Last-Event-ID", "names a stream twice");
    }
    if (position.size() > kMaximalStreams) {
      return InvalidField("Last-Event-ID", "names too many streams");
    }
    return absl::OkStatus();
  }));
  return position;
}

std::string FormatPosition(const EventPosition& position) {
  std::string text;
  for (const auto& [stream, number] : position) {
    absl::StrAppend(&text, text.empty() ? "" : ",", stream, ":", number);
  }
  return text;
}

absl::StatusOr<int64_t> ParseNumber(std::string_view text, std::string_view field) {
  int64_t number = 0;
  const bool plain =
      !text.empty() && (absl::ascii_isdigit(static_cast<unsigned char>(text[0])) || text[0] == '-');
  if (!plain || text.find(' ') != std::string_view::npos ||
      !absl::SimpleAtoi(absl::string_view(text.data(), text.size()), &number) || number < -1) {
    return InvalidField(field, "must be a whole number of at least -1");
  }
  return number;
}

}  // namespace mortise::gateway
