#include "gateway/http/cross_origin.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::gateway {
namespace {

constexpr std::size_t kLongestOrigin = 256;
constexpr std::size_t kMostHeaderNames = 1024;  // bytes of what a preflight asks for
// What a page's script may read of an answer besides its body.
constexpr char kExposed[] =
    "ETag, Content-Disposition, Content-Encoding, Content-Length, Content-Range, Accept-Ranges, "
    "Retry-After, WWW-Authenticate, X-Request-Id";

// "scheme://host[:port]" in lower case, with nothing behind it.
bool IsOrigin(std::string_view text) {
  const std::size_t scheme = text.starts_with("https://") ? 8 : text.starts_with("http://") ? 7 : 0;
  if (scheme == 0 || text.size() == scheme || text.size() > kLongestOrigin) return false;
  return std::all_of(text.begin() + static_cast<std::ptrdiff_t>(scheme), text.end(), [](char c) {
    return absl::ascii_islower(static_cast<unsigned char>(c)) ||
           absl::ascii_isdigit(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == ':' ||
           c == '[' || c == ']';
  });
}

bool AreHeaderNames(std::string_view text) {
  return text.size() <= kMostHeaderNames && std::all_of(text.begin(), text.end(), [](char c) {
           return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ||
                  c == ',' || c == ' ';
         });
}

}  // namespace

absl::StatusOr<CrossOrigins> CrossOrigins::Parse(const std::vector<std::string>& origins) {
  CrossOrigins result;
  for (const std::string& origin : origins) {
    if (!IsOrigin(origin)) {
      return InvalidField("cors-origin",
                          absl::StrCat("'", origin.substr(0, kLongestOrigin),
                                       "' is no origin, such as https://plm.example or "
                                       "http://localhost:5173"));
    }
    result.origins_.insert(origin);
  }
  return result;
}

HeaderList CrossOrigins::HeadersFor(std::string_view origin) const {
  if (origins_.empty()) return {};
  if (!Allows(origin)) return {{"vary", "Origin"}};
  return {{"vary", "Origin"},
          {"access-control-allow-origin", std::string(origin)},
          {"access-control-expose-headers", kExposed}};
}

HeaderList CrossOrigins::PreflightHeaders(std::string_view origin,
                                          std::string_view asked_headers) const {
  if (!Allows(origin)) return {};
  HeaderList headers = {{"access-control-allow-methods", "GET, HEAD, POST, PUT"},
                        {"access-control-max-age", "600"}};
  if (!asked_headers.empty() && AreHeaderNames(asked_headers)) {
    headers.emplace_back("access-control-allow-headers", std::string(asked_headers));
  }
  return headers;
}

}  // namespace mortise::gateway
