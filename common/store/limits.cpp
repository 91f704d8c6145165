#include "common/store/limits.h"

#include <cstdint>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::store {
namespace {

constexpr std::size_t kMaxNameLength = 1024;
constexpr std::size_t kMaxPayload = std::size_t{64} << 20;
constexpr uint32_t kLastCodePoint = 0x10FFFF;  // reserved: bounds the keys of a prefix from above

// The number of bytes of the character that starts with `lead`; 0 if none does.
std::size_t LengthOfCharacter(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead < 0xE0) return 2;
  if (lead >= 0xE0 && lead < 0xF0) return 3;
  if (lead >= 0xF0 && lead < 0xF5) return 4;
  return 0;
}

// Whether `text` starts with a printable character; its length goes to `length`.
bool StartsWithCharacter(std::string_view text, std::size_t* length) {
  const auto lead = static_cast<unsigned char>(text[0]);
  *length = LengthOfCharacter(lead);
  if (*length == 0 || *length > text.size()) return false;
  if (*length == 1) return lead >= 0x20 && lead != 0x7F;
  uint32_t code = lead & (0x7Fu >> *length);
  for (std::size_t i = 1; i < *length; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xC0) != 0x80) return false;
    code = code << 6 | (next & 0x3F);
  }
  constexpr uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  const bool control = code >= 0x80 && code < 0xA0;
  return code >= kSmallest[*length] && code < kLastCodePoint && !surrogate && !control;
}

}  // namespace

absl::Status CheckName(std::string_view field, std::string_view name) {
  if (name.size() > kMaxNameLength) {
    return InvalidField(field, absl::StrCat("is longer than ", kMaxNameLength, " bytes"));
  }
  for (std::size_t at = 0, length = 0; at < name.size(); at += length) {
    if (!StartsWithCharacter(name.substr(at), &length)) {
      return InvalidField(field, absl::StrCat("is not printable UTF-8 at byte ", at));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckRequiredName(std::string_view field, std::string_view name) {
  if (name.empty()) return InvalidField(field, "must not be empty");
  return CheckName(field, name);
}

absl::Status CheckPayload(std::string_view field, std::string_view payload) {
  if (payload.size() > kMaxPayload) return TooLarge(field, "64 MiB");
  return absl::OkStatus();
}

absl::Status CheckLimit(std::string_view field, int limit, int most) {
  if (limit < 1 || limit > most) {
    return InvalidField(field, absl::StrCat("must be 1 to ", most, ", not ", limit));
  }
  return absl::OkStatus();
}

}  // namespace mortise::store
