// Encodings are converted by the C library's iconv.
#include "common/cad/step/step_encoding.h"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <optional>
#include <set>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/cad/step/step_tokens.h"

namespace mortise::cad {
namespace {

constexpr std::size_t kNamesInNote = 3;
constexpr std::string_view kMark = "\xEF\xBB\xBF";  // of UTF-8

bool IsAscii(char c) { return (static_cast<unsigned char>(c) & 0x80) == 0; }

// In UTF-8; nothing if it is not in this encoding.
std::optional<std::string> Converted(std::string_view text, const char* encoding) {
  const iconv_t converter = ::iconv_open("UTF-8", encoding);
  if (converter == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
  std::string from(text), to(4 * text.size() + 8, '\0');
  char* in = from.data();
  char* out = to.data();
  std::size_t in_left = from.size(), out_left = to.size();
  const std::size_t failed = ::iconv(converter, &in, &in_left, &out, &out_left);
  ::iconv_close(converter);
  if (failed == static_cast<std::size_t>(-1) || in_left != 0) return std::nullopt;
  to.resize(to.size() - out_left);
  return to;
}

bool IsUtf8(std::string_view text) {
  return std::all_of(text.begin(), text.end(), IsAscii) || Converted(text, "UTF-8").has_value();
}

// As Windows has it, which puts signs where Latin-1 has none; byte by byte, as a few are left.
std::string FromLatin1(std::string_view text) {
  std::string converted;
  for (const char c : text) {
    const std::string_view one(&c, 1);
    const auto windows = Converted(one, "WINDOWS-1252");
    converted += windows ? *windows : Converted(one, "ISO-8859-1").value_or("?");
  }
  return converted;
}

// How many of the signs that bytes beyond ASCII begin in GB18030 are common in Chinese, how many
// are not.
struct ChineseSigns {
  int common = 0, rare = 0;
};

void Count(std::string_view text, ChineseSigns& signs) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (IsAscii(text[i])) continue;
    const auto first = static_cast<unsigned char>(text[i]);
    const auto second = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : ' ');
    // The first level of GB 2312, which is nearly all of what is written, and its punctuation. Two
    // letters with accents in a row, which could be such a sign, are rare elsewhere.
    const bool is_common = ((first >= 0xB0 && first <= 0xD7) || (first >= 0xA1 && first <= 0xA3)) &&
                           second >= 0xA1 && second <= 0xFE;
    ++(is_common ? signs.common : signs.rare);
    ++i;
  }
}

// ---- Escapes ------------------------------------------------------------------------------------

// Appends a sign to a text in quotes, in which quotes and backslashes are doubled.
void Append(std::uint32_t sign, std::string& text) {
  if (sign < ' ' || sign == 127) {
    text += ' ';
    return;
  }
  const std::array<char, 4> bytes = {static_cast<char>(sign >> 24), static_cast<char>(sign >> 16),
                                     static_cast<char>(sign >> 8), static_cast<char>(sign)};
  text += Converted({bytes.data(), bytes.size()}, "UTF-32BE").value_or("?");
  if (sign == '\'' || sign == '\\') text += static_cast<char>(sign);
}

std::optional<std::uint32_t> HexadecimalAt(std::string_view text, std::size_t at,
                                           std::size_t digits) {
  std::uint32_t value = 0;
  const std::string_view word = text.substr(std::min(at, text.size()), digits);
  if (word.size() < digits ||
      !std::all_of(word.begin(), word.end(),
                   [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }) ||
      !absl::SimpleHexAtoi(absl::string_view(word.data(), word.size()), &value)) {
    return std::nullopt;
  }
  return value;
}

// Decodes the escapes of what stands in one text's quotes.
class Unescaper {
 public:
  explicit Unescaper(std::string_view text) : text_(text) {}

  std::string Text() {
    while (at_ < text_.size()) {
      if (text_[at_] != '\\' || !TakeEscape()) decoded_ += text_[at_++];
    }
    return std::move(decoded_);
  }

 private:
  // False, with nothing taken, where no escape is.
  bool TakeEscape() {
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("\\\\")) {
      decoded_ += "\\\\";
      at_ += 2;
      return true;
    }
    if (rest.starts_with("\\X2\\")) return TakeSigns(4);
    if (rest.starts_with("\\X4\\")) return TakeSigns(8);
    if (rest.starts_with("\\X\\")) {
      const auto sign = HexadecimalAt(rest, 3, 2);
      if (!sign) return false;
      Append(*sign, decoded_);
      at_ += 5;
      return true;
    }
    if (rest.starts_with("\\S\\") && rest.size() > 3) {
      const char upper = static_cast<char>(rest[3] | 0x80);
      decoded_ += Converted({&upper, 1}, page_.c_str()).value_or("?");
      at_ += 4;
      return true;
    }
    if (rest.starts_with("\\P") && rest.size() > 3 && rest[2] >= 'A' && rest[2] <= 'I' &&
        rest[3] == '\\') {
      page_ = absl::StrCat("ISO-8859-", rest[2] - 'A' + 1);
      at_ += 4;
      return true;
    }
    return false;
  }

  // Signs of so many digits each, up to \X0\.
  bool TakeSigns(std::size_t digits) {
    std::string signs;
    std::size_t at = at_ + 4;
    for (auto sign = HexadecimalAt(text_, at, digits); sign;
         sign = HexadecimalAt(text_, at, digits)) {
      at += digits;
      const auto second = HexadecimalAt(text_, at, digits);
      if (digits == 4 && *sign >= 0xD800 && *sign < 0xDC00 && second && *second >= 0xDC00 &&
          *second < 0xE000) {
        sign = 0x10000 + ((*sign - 0xD800) << 10) + (*second - 0xDC00);
        at += digits;
      }
      Append(*sign, signs);
    }
    if (!text_.substr(std::min(at, text_.size())).starts_with("\\X0\\")) return false;
    decoded_ += signs;
    at_ = at + 4;
    return true;
  }

  const std::string_view text_;
  std::size_t at_ = 0;
  std::string decoded_;
  std::string page_ = "ISO-8859-1";
};

std::string Unescaped(std::string_view text) {
  const std::size_t quotes = text.size() > 1 && text.ends_with('\'') ? 2 : 1;
  const std::string inside = Unescaper(text.substr(1, text.size() - quotes)).Text();
  return absl::StrCat("'", inside, quotes == 2 ? "'" : "");
}

// ---- The whole ----------------------------------------------------------------------------------

absl::Status CheckUnit(std::string_view bytes) {
  const auto refuse = [](const char* encoding) {
    return InvalidField(
        "step", absl::StrCat("is in ", encoding, "; save it in ASCII or UTF-8, as STEP is"));
  };
  using std::string_view_literals::operator""sv;
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv)) {
    return refuse("UTF-32");
  }
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF") ||
      bytes.starts_with("I\0S\0"sv) || bytes.starts_with("\0I\0S"sv)) {
    return refuse("UTF-16");
  }
  return absl::OkStatus();
}

// Names in the file that are in another encoding, without their quotes.
std::vector<std::string_view> OtherTexts(std::string_view bytes) {
  std::vector<std::string_view> others;
  StepTokens tokens(bytes);
  for (StepToken token = tokens.Next(); token.kind != StepToken::Kind::kEnd;
       token = tokens.Next()) {
    if (token.kind == StepToken::Kind::kText && !IsUtf8(token.text)) others.push_back(token.text);
  }
  return others;
}

bool AreChinese(const std::vector<std::string_view>& texts) {
  ChineseSigns signs;
  for (const std::string_view text : texts) {
    if (!Converted(text, "GB18030")) return false;
    Count(text, signs);
  }
  return signs.common > 2 * signs.rare;
}

std::string NoteOn(const std::vector<std::string>& names, bool is_chinese) {
  const std::size_t shown = std::min(names.size(), kNamesInNote);
  return absl::StrCat(
      "names that are not UTF-8 are taken for ", is_chinese ? "GB18030" : "Latin-1", ": ",
      absl::StrJoin(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
      shown < names.size() ? absl::StrCat(" and ", names.size() - shown, " more") : "");
}

}  // namespace

absl::StatusOr<StepText> DecodeStep(std::string_view bytes) {
  MORTISE_RETURN_IF_ERROR(CheckUnit(bytes));
  if (bytes.starts_with(kMark)) bytes.remove_prefix(kMark.size());
  StepText decoded;
  if (std::all_of(bytes.begin(), bytes.end(), IsAscii) &&
      bytes.find('\\') == std::string_view::npos) {
    decoded.text = bytes;
    return decoded;
  }
  const std::vector<std::string_view> others = OtherTexts(bytes);
  const bool is_chinese = AreChinese(others);
  std::vector<std::string> names;  // in the order of the file, once each
  std::set<std::string> told;
  std::size_t copied = 0;
  StepTokens tokens(bytes);
  for (StepToken token = tokens.Next(); token.kind != StepToken::Kind::kEnd;
       token = tokens.Next()) {
    if (token.kind != StepToken::Kind::kText) continue;
    std::string text(token.text);
    if (!IsUtf8(text)) {
      text = is_chinese ? *Converted(text, "GB18030") : FromLatin1(text);
      if (told.insert(text).second) names.push_back(text);
    }
    if (text.find('\\') != std::string::npos) text = Unescaped(text);
    absl::StrAppend(&decoded.text, absl::string_view(bytes.data() + copied, token.at - copied),
                    text);
    copied = token.at + token.text.size();
  }
  decoded.text.append(bytes.substr(copied));
  if (!names.empty()) decoded.notes.push_back(NoteOn(names, is_chinese));
  return decoded;
}

}  // namespace mortise::cad
