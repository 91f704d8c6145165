#include "common/base/text_encoding.h"

#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise {
namespace {

using std::string_view_literals::operator""sv;

// The other encoding that the text is in; nothing for UTF-8. Texts that are read here begin with a
// character of ASCII, of which the wider encodings make a byte and zeros.
std::optional<std::string_view> WideEncoding(std::string_view bytes) {
  const auto is_zero = [&](std::size_t k) { return k < bytes.size() && bytes[k] == '\0'; };
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv)) return "UTF-32";
  if (bytes.starts_with("\xFF\xFE"sv) || bytes.starts_with("\xFE\xFF"sv)) return "UTF-16";
  if (bytes.size() < 4) return std::nullopt;
  const bool is_little = !is_zero(0) && is_zero(1), is_big = is_zero(0) && !is_zero(1);
  if (is_little && is_zero(2) && is_zero(3)) return "UTF-32";
  if (is_zero(0) && is_zero(1) && is_zero(2) && !is_zero(3)) return "UTF-32";
  if ((is_little && !is_zero(2) && is_zero(3)) || (is_big && is_zero(2) && !is_zero(3))) {
    return "UTF-16";
  }
  return std::nullopt;
}

}  // namespace

std::string EncodingFault(std::string_view bytes) {
  const std::optional<std::string_view> wide = WideEncoding(bytes);
  if (!wide) return {};
  const absl::string_view name(wide->data(), wide->size());
  return absl::StrCat("is ", name,
                      ", not UTF-8; save it as UTF-8, as editors offer and Excel as \"CSV UTF-8\", "
                      "or convert it: iconv -f ",
                      name, " -t UTF-8");
}

std::string_view SkipByteOrderMark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

absl::StatusOr<std::string_view> WithoutByteOrderMark(std::string_view bytes,
                                                      std::string_view field) {
  const std::string fault = EncodingFault(bytes);
  if (!fault.empty()) return InvalidField(field, fault);
  return SkipByteOrderMark(bytes);
}

}  // namespace mortise
