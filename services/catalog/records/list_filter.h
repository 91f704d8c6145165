// What List methods filter by, whatever kind of record they show.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/store.h"

namespace mortise::catalog {

// Words that must all be in the texts of a thing, whatever their case.
class WordFilter {
 public:
  // INVALID_ARGUMENT, "text", if it has more than 200 bytes.
  static absl::StatusOr<WordFilter> Create(const std::string& text);

  // `name` is a resource name; only its id counts, as the collection is the same for all.
  bool Matches(std::string_view name, std::initializer_list<std::string_view> texts) const;

 private:
  std::vector<std::string> words_;  // in lower case
};

// That `name`, if it is not empty, is of a resource there is: one that is mistyped would look like
// one that nothing uses. INVALID_ARGUMENT naming `field`.
absl::Status CheckFilterName(store::ReadTransaction& transaction, const char* kind,
                             const std::string& name, const std::string& field);

}  // namespace mortise::catalog
