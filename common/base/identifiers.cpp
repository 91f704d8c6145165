#include "common/base/identifiers.h"

#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <mutex>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise {
namespace {

constexpr std::string_view kDigits = "0123456789abcdefghjkmnpqrstvwxyz";  // Crockford base 32

bool IsLetterOrDigit(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

constexpr std::size_t kTimeDigits = 10;
constexpr std::size_t kRandomDigits = 16;

// The value of each digit of an identifier, the most significant first.
using Digits = std::array<std::uint8_t, kTimeDigits + kRandomDigits>;

Digits RandomDigitsOfNow() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  auto milliseconds = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
  Digits digits{};
  RAND_bytes(digits.data() + kTimeDigits, kRandomDigits);
  for (std::size_t i = kTimeDigits; i < digits.size(); ++i) digits[i] &= 31;
  for (std::size_t i = kTimeDigits; i-- > 0; milliseconds >>= 5) {
    digits[i] = static_cast<std::uint8_t>(milliseconds & 31);
  }
  return digits;
}

// The next larger number. A carry out of the random digits goes into the time, as it should.
void Increment(Digits& digits) {
  for (std::size_t i = digits.size(); i-- > 0;) {
    if (++digits[i] <= 31) return;
    digits[i] = 0;
  }
}

// Gives each caller more than the one before got: within a millisecond, and while a clock that was
// set back catches up, by counting on.
class IncreasingDigits {
 public:
  Digits Next() {
    const Digits now = RandomDigitsOfNow();
    std::lock_guard lock(mutex_);
    const bool later = std::lexicographical_compare(last_.begin(), last_.begin() + kTimeDigits,
                                                    now.begin(), now.begin() + kTimeDigits);
    if (later) {
      last_ = now;
    } else {
      Increment(last_);
    }
    return last_;
  }

 private:
  std::mutex mutex_;
  Digits last_{};
};

}  // namespace

std::string NewIdentifier() {
  static IncreasingDigits increasing;  // the order of a process's identifiers is the process's own
  std::string id;
  for (const std::uint8_t digit : increasing.Next()) id.push_back(kDigits[digit]);
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
