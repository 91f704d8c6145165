#include "cli/client/bearer_token.h"

#include <cstdlib>
#include <utility>

#include "absl/strings/ascii.h"
#include "common/base/errors.h"
#include "common/base/files.h"

namespace mortise::cli {
namespace {

constexpr std::size_t kMaxBytes = 64 << 10;

absl::StatusOr<std::string> TokenIn(const std::string& file) {
  if (file.empty()) {
    const char* const value = std::getenv("MORTISE_TOKEN");
    return std::string(value == nullptr ? "" : value);
  }
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxBytes));
  return std::string(absl::StripAsciiWhitespace(text));
}

}  // namespace

absl::StatusOr<std::unique_ptr<BearerToken>> BearerToken::Read(const std::string& file) {
  MORTISE_ASSIGN_OR_RETURN(std::string text, TokenIn(file));
  return std::unique_ptr<BearerToken>(new BearerToken(file, std::move(text)));
}

BearerToken::BearerToken(std::string file, std::string text)
    : file_(std::move(file)), text_(std::move(text)) {}

std::string BearerToken::text() const {
  const std::lock_guard lock(mutex_);
  return text_;
}

bool BearerToken::IsRenewed(const std::string& refused) {
  const std::lock_guard lock(mutex_);
  // A file that cannot be read, or is just being written, has nothing better.
  absl::StatusOr<std::string> text = TokenIn(file_);
  if (text.ok() && !text->empty()) text_ = *std::move(text);
  return text_ != refused;
}

}  // namespace mortise::cli
