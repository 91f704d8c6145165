// Scans the text twice: for what is defined, and for what is used.
#include "common/cad/step_references.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

namespace mortise::cad {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Goes through the statements of a file, past texts, binaries and comments.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  // Calls `define(number)` for each "#12 =" that begins a statement, and `use(number, user)` for
  // each other "#12", within the statement that defines `user`, or 0.
  template <typename Define, typename Use>
  void Scan(const Define& define, const Use& use) {
    bool begins = true;
    std::uint64_t user = 0;
    while (at_ < text_.size()) {
      switch (text_[at_]) {
        case ' ':
        case '\t':
        case '\r':
        case '\n':
          ++at_;
          break;
        case '\'':
        case '"':
          SkipPast(text_.substr(at_, 1), 1);
          begins = false;
          break;
        case '/':
          if (!SkipComment()) ++at_;
          break;
        case ';':
          ++at_;
          begins = true;
          user = 0;
          break;
        case '#': {
          const auto [number, is_number] = TakeNumber();
          const bool defines = is_number && begins && EqualsSignFollows();
          begins = false;
          if (defines) user = number;
          if (defines) define(number);
          if (is_number && !defines) use(number, user);
          break;
        }
        default:
          ++at_;
          begins = false;
      }
    }
  }

 private:
  // Past the next `end` behind `from` further bytes, or to the end of the text.
  void SkipPast(std::string_view end, std::size_t from) {
    const std::size_t found = text_.find(end, std::min(text_.size(), at_ + from));
    at_ = found == std::string_view::npos ? text_.size() : found + end.size();
  }

  bool SkipComment() {
    if (text_.substr(at_, 2) != "/*") return false;
    SkipPast("*/", 2);
    return true;
  }

  // The number behind the '#', the largest there is for any that is larger, and whether there is
  // one.
  std::pair<std::uint64_t, bool> TakeNumber() {
    constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
    const std::size_t begin = ++at_;
    std::uint64_t number = 0;
    for (; at_ < text_.size() && IsDigit(text_[at_]); ++at_) {
      const auto digit = static_cast<std::uint64_t>(text_[at_] - '0');
      number = number > (kLargest - digit) / 10 ? kLargest : 10 * number + digit;
    }
    return {number, at_ > begin};
  }

  bool EqualsSignFollows() {
    while (at_ < text_.size() && (IsBlank(text_[at_]) || SkipComment())) {
      if (at_ < text_.size() && IsBlank(text_[at_])) ++at_;
    }
    return at_ < text_.size() && text_[at_] == '=';
  }

  const std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<MissingEntity> MissingEntities(std::string_view text, std::size_t limit) {
  std::vector<std::uint64_t> defined;
  Scanner(text).Scan([&](std::uint64_t number) { defined.push_back(number); },
                     [](std::uint64_t, std::uint64_t) {});
  std::sort(defined.begin(), defined.end());
  defined.erase(std::unique(defined.begin(), defined.end()), defined.end());
  // Most programs number entities without gaps.
  const bool has_gaps = !defined.empty() && defined.back() - defined.front() != defined.size() - 1;
  const auto is_defined = [&](std::uint64_t number) {
    if (defined.empty() || number < defined.front() || number > defined.back()) return false;
    return !has_gaps || std::binary_search(defined.begin(), defined.end(), number);
  };
  std::map<std::uint64_t, std::uint64_t> missing;  // the smallest numbers, and who uses each first
  Scanner(text).Scan([](std::uint64_t) {},
                     [&](std::uint64_t number, std::uint64_t user) {
                       if (is_defined(number)) return;
                       missing.emplace(number, user);
                       if (missing.size() > limit) missing.erase(std::prev(missing.end()));
                     });
  std::vector<MissingEntity> found;
  for (const auto& [number, user] : missing) found.push_back({number, user});
  return found;
}

}  // namespace mortise::cad
