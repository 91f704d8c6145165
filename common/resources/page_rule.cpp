#include "common/resources/page_rule.h"

#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"

namespace mortise::resources {
namespace {

constexpr std::size_t kMaxPosition = 4096;  // bytes; a merged list has one of each source
constexpr char kForeignToken[] = "is not one that this method gave";

bool MayBePosition(const std::string& text) {
  return text.size() <= kMaxPosition &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 127; });
}

}  // namespace

absl::StatusOr<PageQuery> ReadPageQuery(int page_size, const std::string& page_token) {
  std::vector<FieldViolation> violations;
  if (page_size < 0 || page_size > kMaxPageSize) {
    violations.push_back({"page_size", absl::StrCat("must be 0 to ", kMaxPageSize)});
  }
  if (!MayBePosition(page_token)) violations.push_back({"page_token", kForeignToken});
  if (!violations.empty()) return InvalidFields(violations);
  return PageQuery{page_size == 0 ? kDefaultPageSize : page_size, page_token};
}

absl::Status NotAPageToken() { return InvalidField("page_token", kForeignToken); }

bool PageRoom::Take(std::size_t bytes) {
  const bool is_full = entries_ == most_ || (entries_ > 0 && bytes_ + bytes > kMaxPageBytes);
  if (is_full) return false;
  ++entries_;
  bytes_ += bytes;
  return true;
}

}  // namespace mortise::resources
