#include "common/base/identifiers.h"

#include <openssl/rand.h>

#include <array>
#include <chrono>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise {
namespace {

constexpr std::string_view kDigits = "0123456789abcdefghjkmnpqrstvwxyz";  // Crockford base 32

bool IsLetterOrDigit(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

}  // namespace

std::string NewIdentifier() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  auto milliseconds = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
  std::array<unsigned char, 16> random{};
  RAND_bytes(random.data(), static_cast<int>(random.size()));
  std::string id(26, '0');
  for (int i = 9; i >= 0; --i, milliseconds >>= 5) id[i] = kDigits[milliseconds & 31];
  for (int i = 0; i < 16; ++i) id[10 + i] = kDigits[random[i] & 31];
  return id;
}

bool IsResourceId(std::string_view text) {
  if (text.empty() || text.size() > 63) return false;
  if (!IsLetterOrDigit(text.front()) || !IsLetterOrDigit(text.back())) return false;
  for (const char c : text) {
    if (!IsLetterOrDigit(c) && c != '-') return false;
  }
  return true;
}

absl::StatusOr<std::string> ParseResourceName(std::string_view name, std::string_view collection,
                                              std::string_view field) {
  const std::string prefix = std::string(collection) + "/";
  if (name.substr(0, prefix.size()) != prefix || !IsResourceId(name.substr(prefix.size()))) {
    return InvalidField(
        field, absl::StrCat("'", absl::string_view(name.data(), name.size()).substr(0, 100),
                            "' is not of the form ", prefix, "{id}"));
  }
  return std::string(name.substr(prefix.size()));
}

}  // namespace mortise
