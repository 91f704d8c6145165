#include "services/catalog/records/list_filter.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog {

constexpr std::size_t kMaxText = 200;  // bytes

absl::StatusOr<WordFilter> WordFilter::Create(const std::string& text) {
  if (text.size() > kMaxText) {
    return InvalidField("text", absl::StrCat("is longer than ", kMaxText, " bytes"));
  }
  WordFilter filter;
  filter.words_ =
      absl::StrSplit(absl::AsciiStrToLower(text), absl::ByAnyChar(" \t\r\n"), absl::SkipEmpty());
  return filter;
}

bool WordFilter::Matches(std::string_view name,
                         std::initializer_list<std::string_view> texts) const {
  if (words_.empty()) return true;
  std::string all(name.substr(name.find('/') + 1));
  for (const std::string_view text : texts) all.append("\n").append(text);
  absl::AsciiStrToLower(&all);
  return std::all_of(words_.begin(), words_.end(),
                     [&all](const std::string& word) { return absl::StrContains(all, word); });
}

absl::Status CheckFilterName(store::ReadTransaction& transaction, const char* kind,
                             const std::string& name, const std::string& field) {
  if (name.empty()) return absl::OkStatus();
  const absl::Status found = GetRecord(transaction, kind, name).status();
  if (absl::IsNotFound(found)) {
    return InvalidField(field, std::string(WithNearName(transaction, kind, name, found).message()));
  }
  if (absl::IsInvalidArgument(found)) {
    return InvalidField(field, absl::StrCat("must be '", kind, "/' and the id of one"));
  }
  return found;
}

}  // namespace mortise::catalog
