// Who uses a resource, as far as the catalog knows: the latest revisions of others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/store/store.h"

namespace mortise::catalog {

// Whether a TemplateBundle or AssemblyBundle has the item.
template <typename Bundle>
bool UsesItem(const Bundle& bundle, const std::string& item) {
  return std::any_of(bundle.items().begin(), bundle.items().end(),
                     [&](const auto& used) { return used.name() == item; });
}

// Whether the latest revision in a record, of a Bundle, uses the item.
template <typename Bundle>
bool Uses(const store::Record& record, const std::string& item) {
  Bundle bundle;
  return bundle.ParseFromString(record.payload) && UsesItem(bundle, item);
}

// As many users as a refusal names.
inline constexpr std::size_t kMaxUsersNamed = 5;

// Adds the names of those resources of `kind` for whose latest revision `uses(record)`, until there
// are kMaxUsersNamed.
template <typename Uses>
absl::Status AddUsers(store::ReadTransaction& transaction, const char* kind, const Uses& uses,
                      std::vector<std::string>& users) {
  store::ListOptions options;
  options.limit = 100;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records,
                             transaction.List(kind, options));
    for (const store::Record& record : records) {
      if (users.size() >= kMaxUsersNamed) return absl::OkStatus();
      if (uses(record)) users.push_back(absl::StrCat(kind, "/", record.key));
    }
    if (static_cast<int>(records.size()) < options.limit) return absl::OkStatus();
    options.after_key = records.back().key;
  }
}

}  // namespace mortise::catalog
