#include "services/catalog/item_filter.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "services/catalog/record_access.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kMaxText = 200;  // bytes

// The name without "items/", which all have.
std::string IdOf(const v1::Item& item) { return item.name().substr(item.name().find('/') + 1); }

}  // namespace

absl::StatusOr<ItemFilter> ItemFilter::Create(store::ReadTransaction& transaction,
                                              const v1::ListItemsRequest& request) {
  ItemFilter filter;
  filter.kind_ = request.kind();
  filter.material_ = request.material();
  if (!filter.material_.empty()) {
    // A name that is mistyped would look like a material of which nothing is made.
    const absl::Status found = GetRecord(transaction, kMaterials, filter.material_).status();
    if (absl::IsNotFound(found)) {
      return InvalidField("material", absl::StrCat("there is no '", filter.material_, "'"));
    }
    if (absl::IsInvalidArgument(found)) {
      return InvalidField("material", "must be 'materials/' and the id of a material");
    }
    MORTISE_RETURN_IF_ERROR(found);
  }
  if (request.text().size() > kMaxText) {
    return InvalidField("text", absl::StrCat("is longer than ", kMaxText, " bytes"));
  }
  filter.words_ = absl::StrSplit(absl::AsciiStrToLower(request.text()), absl::ByAnyChar(" \t\r\n"),
                                 absl::SkipEmpty());
  return filter;
}

bool ItemFilter::Takes(const v1::Item& item) const {
  if (kind_ != v1::ITEM_KIND_UNSPECIFIED && item.kind() != kind_) return false;
  if (!material_.empty() && item.material() != material_) return false;
  if (words_.empty()) return true;
  const std::string text = absl::AsciiStrToLower(absl::StrCat(
      IdOf(item), "\n", item.title(), "\n", item.standard(), "\n", item.designation()));
  return std::all_of(words_.begin(), words_.end(),
                     [&text](const std::string& word) { return absl::StrContains(text, word); });
}

}  // namespace mortise::catalog
